//! The shove game with people: keys become pads, every match gives a replay that verifies, and the peers of a network
//! match stay equal.

#![expect(clippy::unwrap_used, reason = "a failed unwrap fails the test")]
#![expect(clippy::disallowed_types, reason = "drawing uses floats")]

use std::time::Duration;

use lockstep2d::math::{Aabb, Rng, Vec2};
use lockstep2d::peer::{LinkConditions, Network, PeerIdentity, PeerOptions, Port};
use lockstep2d::replay::{Limits, RawReplay, Step, Verdict, verify};
use lockstep2d_render::{Camera, DrawList};
use lockstep2d_shove::online::Participation;
use lockstep2d_shove::{Pad, Phase, START_RADIUS, Setup, Shove};
use lockstep2d_viewer::netplay::{Chair, Netplay, Online, SEAT_COLOURS, Side};
use lockstep2d_viewer::{Event, Key, Source};

/// Returns the pads of every tick of a replay.
fn pads(replay: &[u8]) -> Vec<Vec<Pad>> {
    let mut raw = RawReplay::<Shove>::open(replay, &Limits::default()).unwrap();
    let mut pads = vec![];
    while raw.step().unwrap() == Step::Ticked {
        pads.push(raw.inputs().to_vec());
    }
    pads
}

fn play(netplay: &mut Netplay, ticks: u64) {
    for _ in 0..ticks {
        netplay.seek(netplay.tick() + 1).unwrap();
    }
}

fn check_replay(netplay: &mut Netplay) -> Vec<u8> {
    let file = netplay.save_replay().unwrap().unwrap();
    let verdict = verify::<Shove>(&file, &Limits::default());
    netplay.seek(netplay.recorded()).unwrap();
    assert_eq!(verdict, Verdict::Match { ticks: netplay.recorded(), hash: netplay.hash() });
    file
}

const KEYS: [(usize, Key, Pad); 11] = [
    (0, Key::Character('w'), Pad::UP),
    (0, Key::Character('a'), Pad::LEFT),
    (0, Key::Character('s'), Pad::DOWN),
    (0, Key::Character('d'), Pad::RIGHT),
    (0, Key::Shift, Pad::DASH),
    (1, Key::Up, Pad::UP),
    (1, Key::Left, Pad::LEFT),
    (1, Key::Down, Pad::DOWN),
    (1, Key::Right, Pad::RIGHT),
    (1, Key::Enter, Pad::DASH),
    (1, Key::Control, Pad::DASH),
];

#[test]
fn keys_of_two_players_become_their_pads() {
    let mut netplay = Netplay::for_two(3, 0).unwrap();
    let mut expected = vec![];
    let rng = &mut Rng::new(3);
    let mut down: Vec<(usize, Key, Pad)> = vec![];
    for _ in 0..900 {
        let (seat, key, button) = KEYS[rng.below(11) as usize];
        match down.iter().position(|held| held.1 == key) {
            Some(at) => {
                down.remove(at);
                assert!(netplay.handle(&Event::Released(key)));
            }
            None => {
                down.push((seat, key, button));
                assert!(netplay.handle(&Event::Pressed(key)));
            }
        }
        assert!(
            !netplay.handle(&Event::Pressed(Key::Space)),
            "the space bar should not be a key of the players"
        );
        let pad = |seat| {
            let held = down.iter().filter(|held| held.0 == seat);
            held.fold(Pad::default(), |pad, held| pad.with(held.2))
        };
        expected.push(vec![pad(0), pad(1)]);
        play(&mut netplay, 1);
    }
    let file = check_replay(&mut netplay);
    assert_eq!(pads(&file), expected);
}

#[test]
fn who_goes_back_sees_the_same_again_until_somebody_plays() {
    let mut netplay = Netplay::for_two(1, 2).unwrap();
    let mut seen = vec![netplay.hash()];
    netplay.handle(&Event::Pressed(Key::Character('a')));
    for _ in 0..300 {
        play(&mut netplay, 1);
        seen.push(netplay.hash());
    }
    netplay.handle(&Event::Released(Key::Character('a')));
    netplay.seek(120).unwrap();
    play(&mut netplay, 100);
    assert_eq!((netplay.tick(), netplay.recorded(), netplay.hash()), (220, 300, seen[220]));
    netplay.handle(&Event::Pressed(Key::Enter));
    play(&mut netplay, 1);
    assert_eq!((netplay.tick(), netplay.recorded()), (221, 221));
    assert_ne!(netplay.hash(), seen[221]);
    play(&mut netplay, 50);
    let file = check_replay(&mut netplay);
    assert_eq!(pads(&file)[220][1], Pad::DASH);
}

#[test]
fn bots_and_empty_chairs_fill_the_table() {
    let chairs = [Chair::Person(Side::Both), Chair::Empty, Chair::Bot];
    let mut netplay = Netplay::new(Setup { seed: 2, ..Setup::default() }, &chairs).unwrap();
    netplay.seek(600).unwrap();
    let file = check_replay(&mut netplay);
    let pads = pads(&file);
    assert!(pads.iter().all(|pads| pads[1].is_absent() && pads[0] == Pad::default()));
    assert!(pads.iter().any(|pads| pads[2] != Pad::default()), "the bot should press something");
    assert!(Netplay::new(Setup::default(), &chairs[..1]).is_err(), "a match with one seat should be refused");
}

/// The overlay has a disc in the seat's colour for each player who has not fallen, and a score for each seat.
#[test]
fn players_and_scores_are_seen() {
    let mut netplay = Netplay::for_two(1, 2).unwrap();
    netplay.seek(400).unwrap();
    let corner = Vec2::new(START_RADIUS, START_RADIUS);
    let camera = Camera::new(Aabb::new(-corner, corner), [0.0; 2], [960.0, 720.0]);
    let mut list = DrawList::default();
    netplay.decorate(&mut list, &camera);
    assert_ne!(netplay.game().phase(), Phase::Over);
    for (seat, player) in netplay.game().players_in_order().enumerate() {
        let discs = list.items().iter().filter(|item| item.fill == SEAT_COLOURS[seat]);
        assert_eq!(discs.clone().count(), usize::from(player.is_alive()), "seat {seat}");
        for disc in discs {
            let points = list.points(disc);
            let count = points.len() as f32;
            let middle = points.iter().fold([0.0, 0.0], |sum, at| [sum[0] + at[0], sum[1] + at[1]]);
            let [x, y] = camera.place(player.position);
            assert!((middle[0] / count - x).abs() < 0.5 && (middle[1] / count - y).abs() < 0.5);
        }
        let score = list.texts().iter().filter(|text| text.colour == SEAT_COLOURS[seat]);
        let text: Vec<_> = score.map(|text| text.text.clone()).collect();
        assert!(text.len() == 1 && text[0].contains(&player.score.to_string()), "{text:?}");
    }
    assert!(list.texts().iter().any(|text| text.text.contains("round 1")), "{:?}", list.texts());
}

type Guest = Online<Port>;

/// Plays a match over a network in memory, in simulated time, until every participant has confirmed this number of ticks.
fn play_online(network: &Network, guests: &mut [Guest], ticks: u64, mut act: impl FnMut(&mut [Guest])) {
    let step = Duration::from_millis(2);
    while guests.iter().any(|guest| guest.peer().confirmed() < ticks) {
        let now = network.time() + step;
        assert!(
            now < Duration::from_secs(40),
            "{ticks} ticks should be confirmed within 40 s; the participants are at {:?}",
            guests.iter().map(Source::tick).collect::<Vec<_>>()
        );
        network.set_time(now);
        for guest in &mut *guests {
            assert_eq!(guest.advance(step), Ok(true));
        }
        act(guests);
    }
}

fn identity(number: u64) -> PeerIdentity {
    PeerIdentity::new([number; 4])
}

#[test]
fn two_keyboards_far_apart_play_the_same_match() {
    let network = Network::new(LinkConditions::default(), 1);
    let setup = Setup { seats: 2, seed: 4, ..Setup::default() };
    let options = PeerOptions::rollback();
    let host = Participation::Host.enter(&setup, options, identity(1), network.port(0)).unwrap();
    let contact = Network::address(0);
    let guest = Participation::Join { contact }.enter(&setup, options, identity(2), network.port(1)).unwrap();
    let mut guests = [Online::new(host), Online::new(guest)];
    assert!(guests[0].save_replay().unwrap().is_err(), "saving should fail before the first tick");
    let rng = &mut Rng::new(1);
    play_online(&network, &mut guests, 300, |guests| {
        let key = KEYS[rng.below(11) as usize].1;
        let who = &mut guests[rng.below(2) as usize];
        let event = if rng.chance(1, 2) { Event::Pressed(key) } else { Event::Released(key) };
        assert!(who.handle(&event));
    });
    for guest in &mut guests {
        assert!(guest.seek(3).is_err() && guest.desync().is_none(), "{}", guest.status());
        let file = guest.save_replay().unwrap().unwrap();
        let verdict = verify::<Shove>(&file, &Limits::default());
        assert!(verdict.is_match(), "{verdict}");
    }
    guests[1].leave();
    for _ in 0..2000 {
        network.set_time(network.time() + Duration::from_millis(10));
        for guest in &mut guests {
            assert_eq!(guest.advance(Duration::from_millis(10)), Ok(true));
        }
    }
    assert!(guests[1].has_left() && !guests[0].has_left());
    let replays = guests.map(|guest| guest.finish().unwrap());
    let verdicts = replays.each_ref().map(|replay| verify::<Shove>(replay, &Limits::default()));
    assert!(verdicts.iter().all(Verdict::is_match), "{verdicts:?}");
    let [ours, theirs] = replays.each_ref().map(|replay| pads(replay));
    let both = ours.len().min(theirs.len());
    assert!(both >= 300, "{both}");
    assert_eq!(ours[..both], theirs[..both]);
    for seat in 0..2 {
        let pressed = ours.iter().filter(|pads| pads[seat] != Pad::default()).count();
        assert!(pressed > 20, "seat {seat} pressed buttons in only {pressed} ticks");
    }
}

#[test]
fn somebody_who_cannot_come_in_says_why() {
    let network = Network::new(LinkConditions::default(), 1);
    let (two, four) = (Setup { seats: 2, ..Setup::default() }, Setup::default());
    let options = PeerOptions::rollback();
    let mut host =
        Online::new(Participation::Host.enter(&four, options, identity(1), network.port(0)).unwrap());
    let participation = Participation::Join { contact: Network::address(0) };
    let mut guest = Online::new(participation.enter(&two, options, identity(2), network.port(1)).unwrap());
    let mut refused = None;
    for moment in 1..200 {
        network.set_time(Duration::from_millis(moment * 10));
        assert_eq!(host.advance(Duration::from_millis(10)), Ok(true));
        if let Err(error) = guest.advance(Duration::from_millis(10)) {
            refused = Some(error.0);
            break;
        }
    }
    let why = refused.unwrap();
    assert!(why.contains("number of seats"), "{why}");
    assert_eq!(guest.advance(Duration::from_millis(10)), Ok(true), "the error should be returned only once");
    assert!(guest.status().contains(&why), "{}", guest.status());
}
