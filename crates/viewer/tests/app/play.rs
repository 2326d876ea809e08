//! Local and network matches of a small game: limits, recordings and what happens after errors.

use std::thread;
use std::time::Duration;

use lockstep2d::hash::StateHash;
use lockstep2d::lockstep::{Game, RulesId, SetupError};
use lockstep2d::peer::{LinkConditions, Network, Peer, PeerEvent, PeerIdentity, PeerOptions, Port};
use lockstep2d::replay::{Limits, Verdict, verify};
use lockstep2d::session;
use lockstep2d_viewer::{
    App, Controls, Event, Key, LocalMatch, Online, Player, Request, Source, Viewer, sandbox,
};
use serde::{Deserialize, Serialize};

use super::common::frames;

/// At this tick, the game returns two claims with the same name, so no replay that ends here can be saved.
const BAD_TICK: u64 = 100;

/// A game that adds up the lengths of its inputs. Each tick costs `work` units.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Count {
    players: u32,
    work: u64,
    tick: u64,
    pressed: u64,
}

impl Game for Count {
    type Setup = (u32, u64);
    type Input = Vec<u8>;
    type Save = Count;
    const RULES: RulesId = RulesId { name: "count", version: 1 };

    fn new(&(players, work): &(u32, u64)) -> Result<Self, SetupError> {
        Ok(Count { players, work, tick: 0, pressed: 0 })
    }
    fn players(&self) -> u32 {
        self.players
    }
    fn tick_rate(&self) -> u32 {
        60
    }
    fn step(&mut self, inputs: &[Vec<u8>]) {
        self.tick += 1;
        self.pressed += inputs.iter().map(|input| input.len() as u64).sum::<u64>();
    }
    fn state_hash(&self) -> StateHash {
        StateHash::of(self)
    }
    fn save(&self) -> Count {
        self.clone()
    }
    fn load(&mut self, save: &Count) {
        self.clone_from(save);
    }
    fn work(&self, _: &[Vec<u8>]) -> u64 {
        self.work
    }
    fn claims(&self) -> Vec<(String, i64)> {
        let count = if self.tick == BAD_TICK { 2 } else { 1 };
        vec![("pressed".to_owned(), i64::try_from(self.pressed).unwrap()); count]
    }
}

/// Work units above the default limit for a tick.
const HEAVY: u64 = 1 << 40;

fn unlimited() -> Limits {
    Limits { tick_work: u64::MAX, total_work: u64::MAX, ..Limits::default() }
}

/// The key `x` gives an input of 1 byte, the key `l` one of 100 bytes.
fn keys() -> Controls<Vec<u8>> {
    let keys = Controls::new().key('x', |input: &mut Vec<u8>| input.push(1));
    keys.key('l', |input| input.extend([1; 100]))
}

const X: Key = Key::Character('x');

fn tap(source: &mut dyn Source) {
    assert!(source.handle(&Event::Pressed(X)) && source.handle(&Event::Released(X)));
}

fn local() -> LocalMatch<Count> {
    LocalMatch::new("count", &(1, 1), &[Player::Keys(keys())], 0).unwrap()
}

#[test]
fn a_scene_is_played_within_the_limits_of_the_viewer() {
    let heavy = |limits| Viewer::<Count>::new().limits(limits).scene("heavy", "", |_| (1, HEAVY)).app();
    let mut app = heavy(unlimited());
    assert!(app.show_scene("heavy", 0));
    frames(&mut app, 60);
    assert!(app.report().tick > 50 && app.report().status == "live", "{}", app.report());
    let mut app = heavy(Limits { total_work: HEAVY, ..unlimited() });
    assert!(app.show_scene("heavy", 0));
    frames(&mut app, 5);
    let hint = format!("verify it with --max-work above {}", app.report().tick * HEAVY);
    assert!(app.report().status.ends_with(&hint), "{}", app.report());
    let mut app = sandbox().limits(Limits { total_work: 1, ..Limits::default() }).app();
    assert!(app.show_scene("pyramid", 0));
    frames(&mut app, 3);
    assert!(app.report().status.contains("verify it with --max-work above "), "{}", app.report());
}

#[test]
fn a_save_that_fails_changes_nothing() {
    let mut play = local();
    play.seek(BAD_TICK).unwrap();
    play.seek(50).unwrap();
    assert!(play.save_replay().unwrap().is_err(), "two claims have one name");
    assert_eq!((play.tick(), play.recorded(), play.game().tick), (50, BAD_TICK, 50));
    play.seek(200).unwrap();
    let end = play.hash();
    let file = play.save_replay().unwrap().unwrap();
    assert_eq!(verify::<Count>(&file, &Limits::default()), Verdict::Match { ticks: 200, hash: end });
}

#[test]
fn a_step_back_forgets_a_tap_of_a_key() {
    let mut play = local();
    play.seek(30).unwrap();
    play.seek(10).unwrap();
    tap(&mut play);
    play.seek(9).unwrap();
    play.seek(12).unwrap();
    assert_eq!((play.tick(), play.recorded(), play.game().pressed), (12, 30, 0));
    // A tap before a step forwards counts, and so does a key that is held during a step back.
    tap(&mut play);
    play.seek(13).unwrap();
    assert_eq!((play.recorded(), play.game().pressed), (13, 1));
    assert!(play.handle(&Event::Pressed(X)));
    play.seek(10).unwrap();
    play.seek(12).unwrap();
    assert_eq!((play.recorded(), play.game().pressed), (12, 2));
}

type CountPeer = Peer<Count, Port>;

const OPTIONS: PeerOptions = PeerOptions { input_bytes: Some(64), ..PeerOptions::rollback() };

fn host(work: u64, players: u8, network: &Network) -> CountPeer {
    let (setup, options) = ((players.into(), work), PeerOptions { start_with: players, ..OPTIONS });
    Peer::host(&setup, options, PeerIdentity::new([1; 4]), network.port(0)).unwrap()
}

fn guest(work: u64, network: &Network) -> CountPeer {
    let (options, me) = (PeerOptions { start_with: 2, ..OPTIONS }, PeerIdentity::new([2; 4]));
    Peer::join(&(2, work), options, me, network.port(1), Network::address(0)).unwrap()
}

fn shown(peer: CountPeer) -> Online<Count, Port> {
    Online::new("count", peer, keys())
}

/// Advances the peers by ten milliseconds at a time.
fn advance<'a>(peers: impl IntoIterator<Item = &'a mut Online<Count, Port>>, milliseconds: u64) {
    let mut peers: Vec<_> = peers.into_iter().collect();
    for _ in 0..milliseconds / 10 {
        for peer in &mut peers {
            peer.advance(Duration::from_millis(10)).unwrap();
        }
    }
}

#[test]
fn a_saved_match_has_all_final_ticks_whatever_they_cost() {
    let network = Network::new(LinkConditions::default(), 1);
    let mut peers = [host(HEAVY, 2, &network), guest(HEAVY, &network)].map(shown);
    assert!(peers[0].save_replay().unwrap().is_err(), "no tick has been played");
    for milliseconds in [1450, 730] {
        advance(&mut peers, milliseconds);
        peers.iter_mut().for_each(|peer| assert!(peer.handle(&Event::Pressed(X))));
        // The host plays further ticks with predicted inputs of the guest.
        advance(&mut peers[..1], 70);
        for peer in &mut peers {
            let (shown, ticks) = (peer.hash(), peer.peer().confirmed());
            assert!(ticks > 30 && ticks % 60 > 0, "{ticks} ticks of {} are final", peer.tick());
            let file = peer.save_replay().unwrap().unwrap();
            match verify::<Count>(&file, &unlimited()) {
                Verdict::Match { ticks: saved, .. } => assert_eq!((saved, peer.recorded()), (ticks, ticks)),
                verdict => panic!("{verdict}"),
            }
            assert_eq!(peer.hash(), shown, "saving should not change the match");
        }
        assert!(peers[0].tick() > peers[0].peer().confirmed());
    }
    assert_eq!(peers.each_ref().map(Online::desync), [None; 2]);
    let [_, guest] = peers;
    let mut app = App::default();
    let saved = format!("count.replay: {} ticks saved", guest.recorded());
    app.show(Box::new(guest));
    app.save();
    assert_eq!(app.message(), Some(saved.as_str()));
    assert!(matches!(&app.take_requests()[..], [Request::Save { .. }]));
}

#[test]
fn a_peer_catches_up_in_many_frames() {
    let network = Network::new(LinkConditions::default(), 1);
    let me = PeerIdentity::new([2; 4]);
    let spectator = Peer::watch(
        &(1, 1),
        PeerOptions { start_with: 1, ..OPTIONS },
        me,
        network.port(1),
        Network::address(0),
    )
    .unwrap();
    let [mut host, mut spectator] = [host(1, 1, &network), spectator].map(shown);
    advance([&mut host, &mut spectator], 1000);
    // The spectator is not updated, like a window that is suspended.
    advance([&mut host], 5000);
    let (mut most, mut waited) = (0, 0);
    while spectator.tick() + 30 < host.tick() && waited < 300 {
        let before = spectator.tick();
        advance([&mut host, &mut spectator], 10);
        most = most.max(spectator.tick() - before);
        waited += 1;
    }
    assert!(waited < 300 && (30..=64).contains(&most), "up to {most} ticks in each of {waited} frames");
}

/// Plays as the host until the guest has left, but at most 1.5 s: a silent guest would lose its seat after 2 s. Returns
/// whether the guest has left.
fn play_until_left(host: &mut CountPeer, from: Duration) -> bool {
    (1..=300).any(|step| {
        host.update(from + step * Duration::from_millis(5)).unwrap();
        while host.is_due() {
            host.advance(&[vec![]]).unwrap();
        }
        thread::sleep(Duration::from_millis(5));
        let mut events = std::iter::from_fn(|| host.next_event());
        events.any(|event| matches!(event, PeerEvent::Session(session::Event::Unseated { .. })))
    })
}

#[test]
fn who_closes_after_an_error_leaves_the_match() {
    let network = Network::new(LinkConditions::default(), 1);
    let (mut host, mut guest) = (host(1, 2, &network), shown(guest(1, &network)));
    let mut now = Duration::ZERO;
    let mut error = None;
    while error.is_none() && now < Duration::from_secs(2) {
        now += Duration::from_millis(10);
        host.update(now).unwrap();
        while host.is_due() {
            host.advance(&[vec![]]).unwrap();
        }
        error = guest.advance(Duration::from_millis(10)).err();
        if now == Duration::from_secs(1) {
            assert!(guest.handle(&Event::Pressed(Key::Character('l'))));
        }
    }
    assert!(error.unwrap().0.starts_with("an input has ") && now > Duration::from_secs(1));
    let left = thread::spawn(move || play_until_left(&mut host, now));
    guest.close();
    assert!(left.join().unwrap(), "the host waits for the guest");
}
