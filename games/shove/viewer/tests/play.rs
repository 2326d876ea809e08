//! Shove with human players: keys become pads, matches give replays that verify, and peers of a network match stay
//! equal.

#![expect(clippy::unwrap_used, reason = "a failed unwrap fails the test")]
#![expect(clippy::disallowed_types, reason = "drawing uses floats")]

use std::rc::Rc;
use std::time::Duration;

use lockstep2d::math::{Aabb, Rng, Vec2};
use lockstep2d::peer::{LinkConditions, Network, Peer, PeerIdentity, PeerOptions, Port};
use lockstep2d::replay::{Limits, RawReplay, Step, Verdict, verify};
use lockstep2d_render::{Camera, DrawList};
use lockstep2d_shove::{Pad, Phase, START_RADIUS, Setup, Shove};
use lockstep2d_shove_viewer::{SEAT_COLOURS, bot, decorate, left, right, viewer};
use lockstep2d_viewer::{Controls, Event, Key, LocalMatch, Online, Player, Source};

type Netplay = LocalMatch<Shove>;

fn person(side: Controls<Pad>) -> Player<Shove> {
    Player::Keys(side)
}

fn machine() -> Player<Shove> {
    Player::Bot(Rc::new(bot))
}

/// A match of two people, with bots on the other seats.
fn for_two(seed: u64, bots: u8) -> Netplay {
    let setup = Setup { seats: 2 + bots, seed, ..Setup::default() };
    let players = [person(left()), person(right()), machine(), machine()];
    Netplay::new("shove", &setup, &players, seed).unwrap()
}

/// Pads of every tick of a replay.
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
    (0, Key::Character('f'), Pad::DASH),
    (1, Key::Up, Pad::UP),
    (1, Key::Left, Pad::LEFT),
    (1, Key::Down, Pad::DOWN),
    (1, Key::Right, Pad::RIGHT),
    (1, Key::Enter, Pad::DASH),
    (1, Key::Control, Pad::DASH),
];

#[test]
fn keys_of_two_players_become_their_pads() {
    let mut netplay = for_two(3, 0);
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
    let mut netplay = for_two(1, 2);
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
    let players = [person(left().with(&right())), Player::Absent, machine()];
    let setup = Setup { seats: 4, seed: 2, ..Setup::default() };
    let mut netplay = Netplay::new("shove", &setup, &players, 2).unwrap();
    netplay.seek(600).unwrap();
    let file = check_replay(&mut netplay);
    let pads = pads(&file);
    assert!(pads.iter().all(|pads| pads[1].is_absent() && pads[3].is_absent() && pads[0] == Pad::default()));
    assert!(pads.iter().any(|pads| pads[2] != Pad::default()), "the bot should press something");
    let alone = Setup { seats: 1, ..setup };
    assert!(Netplay::new("shove", &alone, &players, 2).is_err(), "a match with one seat should be refused");
}

/// The viewer draws a disc in the seat's colour for each player who has not fallen, and a score for each seat.
#[test]
fn players_and_scores_are_seen() {
    let mut netplay = for_two(1, 2);
    netplay.seek(400).unwrap();
    let corner = Vec2::new(START_RADIUS, START_RADIUS);
    let camera = Camera::new(Aabb::new(-corner, corner), [0.0; 2], [960.0, 720.0]);
    let mut list = DrawList::default();
    decorate(netplay.game(), &mut list, &camera);
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

type Guest = Online<Shove, Port>;

fn host_and_guest([ours, theirs]: [Setup; 2]) -> [Guest; 2] {
    // All packets arrive at once.
    let network = Network::new(LinkConditions::default(), 1);
    let (options, me) = (PeerOptions::rollback(), |number: u64| PeerIdentity::new([number; 4]));
    let host = Peer::host(&ours, options, me(1), network.port(0)).unwrap();
    let guest = Peer::join(&theirs, options, me(2), network.port(1), Network::address(0)).unwrap();
    let both = || left().with(&right());
    [Online::new("shove", host, both()), Online::new("shove", guest, both())]
}

#[test]
fn two_keyboards_far_apart_play_the_same_match() {
    let setup = Setup { seats: 2, seed: 4, ..Setup::default() };
    let mut guests = host_and_guest([setup; 2]);
    assert!(guests[0].save_replay().unwrap().is_err(), "saving should fail before the first tick");
    let rng = &mut Rng::new(1);
    let mut frames = 0;
    while guests.iter().any(|guest| guest.peer().confirmed() < 300) {
        frames += 1;
        assert!(frames < 4000, "the peers are at {:?}", guests.each_ref().map(Source::tick));
        for guest in &mut guests {
            assert_eq!(guest.advance(Duration::from_millis(10)), Ok(true));
        }
        let key = KEYS[rng.below(11) as usize].1;
        let who = &mut guests[rng.below(2) as usize];
        let event = if rng.chance(1, 2) { Event::Pressed(key) } else { Event::Released(key) };
        assert!(who.handle(&event));
    }
    let [ours, theirs] = guests.each_mut().map(|guest| {
        assert!(guest.seek(3).is_err() && guest.desync().is_none(), "{}", guest.status());
        assert!(guest.status().ends_with("somebody has joined"), "{}", guest.status());
        let file = guest.save_replay().unwrap().unwrap();
        let verdict = verify::<Shove>(&file, &Limits::default());
        assert!(verdict.is_match(), "{verdict}");
        pads(&file)
    });
    let both = ours.len().min(theirs.len());
    assert!(both >= 300, "{both}: all final ticks");
    assert_eq!(ours[..both], theirs[..both]);
    for seat in 0..2 {
        let pressed = ours.iter().filter(|pads| pads[seat] != Pad::default()).count();
        assert!(pressed > 20, "seat {seat} pressed buttons in only {pressed} ticks");
    }
    // The host leaves. The guest is no longer updated and does not answer, so `close` waits for at most half a second.
    let [host, _] = &mut guests;
    host.close();
    assert!(host.status().ends_with("out of the match"), "{}", host.status());
}

#[test]
fn somebody_who_cannot_come_in_says_why() {
    let (two, four) = (Setup { seats: 2, ..Setup::default() }, Setup::default());
    let [mut host, mut guest] = host_and_guest([four, two]);
    let mut refused = None;
    for _ in 1..200 {
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

#[test]
fn the_viewer_has_scenes_and_opens_replays_of_this_game_only() {
    let mut app = viewer().app();
    assert_eq!(app.scenes().map(|(name, _)| name).collect::<Vec<_>>(), ["three", "duel", "four"]);
    let replay = |path: &str| std::fs::read(format!("{}/../{path}", env!("CARGO_MANIFEST_DIR"))).unwrap();
    app.show_file("match", replay("replays/match.replay")).unwrap();
    app.handle(Event::Pressed(Key::PageDown));
    (0..10).for_each(|_| app.advance(Duration::from_millis(16)));
    let texts = |app: &mut lockstep2d_viewer::App| {
        app.draw().texts().iter().map(|text| text.text.clone()).collect::<Vec<_>>()
    };
    assert!(texts(&mut app).iter().any(|text| text.starts_with("1: ")), "{:?}", texts(&mut app));
    // The displayed state leaves out the world.
    app.handle(Event::Pressed(Key::Character('t')));
    let state = texts(&mut app);
    assert!(state.iter().any(|text| text.starts_with("rules.seats[0].score")), "{state:?}");
    assert!(!state.iter().any(|text| text.starts_with("world")), "{state:?}");
    let refused = app.show_file("ragdoll", replay("../../replays/ragdoll.replay")).unwrap_err();
    assert_eq!(refused.to_string(), "a replay of \"sandbox\": this viewer shows \"shove\"");
}
