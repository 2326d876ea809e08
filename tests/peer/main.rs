//! Matches of a game with physics over a network in memory, in simulated time.

mod another_match;
mod errors;
mod pause;
mod presses;
mod pushers;
#[cfg(feature = "sealed")]
mod sealed;
mod seats;
mod so_far;
mod start;

use std::time::Duration;

use lockstep2d::lockstep::Game;
use lockstep2d::peer::{
    LinkConditions, Network, Peer, PeerDesync, PeerError, PeerEvent, PeerIdentity, PeerOptions, Port,
};
use lockstep2d::replay::{Limits, Verdict, verify};
use lockstep2d::report::{Blame, DesyncReport, Evidence, Side, compare};
use lockstep2d::session::{Event, Status};
use lockstep2d::world::BodyField;
use pushers::{FAULT, Fault, Pushers, Setup, bot};

struct Table {
    network: Network,
    peers: Vec<Option<Peer<Pushers, Port>>>,
    events: Vec<Vec<PeerEvent>>,
    replays: Vec<Vec<u8>>,
    /// Index of a peer that plays no ticks: its game calls `update`, but not `advance`.
    stopped: Option<usize>,
}

fn identity(number: u32) -> PeerIdentity {
    let number = u64::from(number);
    PeerIdentity::new([number + 1, number, number + 0x5555, 77])
}

fn conditions(latency: u64, loss: u8) -> LinkConditions {
    LinkConditions {
        jitter: Duration::from_millis(4),
        loss,
        ..LinkConditions::latency(Duration::from_millis(latency))
    }
}

impl Table {
    fn new(latency: u64, loss: u8) -> Self {
        let network = Network::new(conditions(latency, loss), 3);
        Table { network, peers: Vec::new(), events: Vec::new(), replays: Vec::new(), stopped: None }
    }

    fn next(&self) -> (PeerIdentity, Port) {
        let number = u32::try_from(self.peers.len()).expect("valid");
        (identity(number), self.network.port(number))
    }

    fn sit(&mut self, peer: Peer<Pushers, Port>) {
        self.peers.push(Some(peer));
        self.events.push(Vec::new());
        self.replays.push(Vec::new());
    }

    fn host(&mut self, options: PeerOptions) {
        let (me, port) = self.next();
        self.sit(Peer::host(&Setup::default(), options, me, port).expect("valid"));
    }

    fn join(&mut self, options: PeerOptions, contact: u32) {
        let (me, port) = self.next();
        let peer = Peer::join(&Setup::default(), options, me, port, Network::address(contact));
        self.sit(peer.expect("valid"));
    }

    fn watch(&mut self, options: PeerOptions, contact: u32) {
        let (me, port) = self.next();
        let peer = Peer::watch(&Setup::default(), options, me, port, Network::address(contact));
        self.sit(peer.expect("valid"));
    }

    /// Plays for a number of simulated milliseconds. Removes peers that have closed.
    fn play(&mut self, milliseconds: u64) {
        for _ in 0..milliseconds {
            let now = self.network.time() + Duration::from_millis(1);
            self.network.set_time(now);
            for at in 0..self.peers.len() {
                let Some(peer) = &mut self.peers[at] else { continue };
                peer.update(now).expect("valid");
                while self.stopped != Some(at) && peer.is_due() {
                    let tick = peer.tick();
                    let inputs: Vec<u8> = peer.seats().iter().map(|&seat| bot(seat, tick)).collect();
                    peer.advance(&inputs).expect("valid");
                }
                while let Some(event) = peer.next_event() {
                    self.events[at].push(event);
                }
                let replay = peer.take_replay();
                self.replays[at].extend_from_slice(&replay);
                if peer.status() == Some(Status::Closed) {
                    let rest = self.peers[at].take().map(Peer::finish).expect("valid").expect("valid");
                    self.replays[at].extend_from_slice(&rest.replay);
                }
            }
        }
    }

    fn peer(&mut self, at: usize) -> &mut Peer<Pushers, Port> {
        self.peers[at].as_mut().expect("valid")
    }

    fn end(&mut self) -> Vec<Vec<u8>> {
        let tick = u32::try_from(self.peer(0).tick()).expect("valid");
        self.peer(0).session_mut().expect("valid").end_at(tick + 20);
        self.play(6000);
        assert!(self.peers.iter().all(Option::is_none), "all have finished");
        std::mem::take(&mut self.replays)
    }
}

fn modes() -> [PeerOptions; 2] {
    [PeerOptions::lockstep(), PeerOptions::rollback()]
}

#[test]
fn all_have_the_same_replay_and_it_verifies() {
    for options in modes() {
        let options = PeerOptions { start_with: 3, ..options };
        let mut table = Table::new(30, 5);
        table.host(options);
        table.join(options, 0);
        table.join(options, 0);
        table.play(5000);
        assert!(table.peer(0).tick() > 200, "{}", table.peer(0).tick());
        let replays = table.end();
        assert_eq!(replays[0], replays[1]);
        assert_eq!(replays[0], replays[2]);
        let verdict = verify::<Pushers>(&replays[0], &Limits::default());
        assert!(matches!(verdict, Verdict::Match { .. }), "{verdict:?}");
        let desyncs = table.events.iter().flatten().filter(|event| matches!(event, PeerEvent::Desync(_)));
        assert_eq!(desyncs.count(), 0);
    }
}

/// The host's replay continues across a late join and a departure.
#[test]
fn late_joiners_and_spectators_follow() {
    for options in modes() {
        let mut table = Table::new(20, 2);
        table.host(options);
        table.join(options, 0);
        table.play(3000);
        table.watch(options, 1);
        table.join(options, 1);
        table.play(4000);
        assert_eq!(table.peer(3).seats(), [2]);
        assert_eq!(table.peer(2).status(), Some(Status::Watching));
        assert!(
            table.events[3].iter().any(|event| matches!(event, PeerEvent::Joined { tick } if *tick > 60))
        );
        table.peer(1).session_mut().expect("valid").leave();
        table.play(4000);
        assert!(table.peers[1].is_none());
        // The peer that sent the match to the spectator has left. The spectator has found another one.
        assert_eq!(table.peer(2).status(), Some(Status::Watching));
        let lead = table.peer(0).tick();
        for at in [2, 3] {
            let tick = table.peer(at).confirmed();
            assert!(tick + 30 > lead, "{at}: {tick} of {lead}");
            let hash = table
                .peer(at)
                .history()
                .iter()
                .rev()
                .find(|past| past.tick <= tick)
                .map(|past| (past.tick, past.hash));
            let (tick, hash) = hash.expect("valid");
            let own = table.peer(0).history().get(tick).map(|past| past.hash);
            assert!(own.is_none() || own == Some(hash));
        }
        let replays = table.end();
        let verdict = verify::<Pushers>(&replays[0], &Limits::default());
        assert!(matches!(verdict, Verdict::Match { .. }), "{verdict:?}");
        assert!(replays[3].is_empty(), "the inputs before the join are not known");
    }
}

/// After an outage of 6 s, the guest gets its seat back, and its replay is complete.
#[test]
fn an_outage_costs_no_replay() {
    let options = PeerOptions::lockstep();
    let mut table = Table::new(20, 0);
    table.host(options);
    table.join(options, 0);
    table.play(2000);
    table.network.set_conditions(conditions(20, 100));
    table.play(6000);
    assert_eq!(table.peer(1).status(), Some(Status::Paused));
    table.network.set_conditions(conditions(20, 0));
    table.play(3000);
    assert_eq!(table.peer(1).seats(), [1]);
    assert!(
        table.events[0].contains(&PeerEvent::Session(Event::Waiting { peer: identity(1).id, heard: false }))
    );
    let replays = table.end();
    assert_eq!(replays[0], replays[1]);
    assert!(matches!(verify::<Pushers>(&replays[1], &Limits::default()), Verdict::Match { .. }));
}

#[test]
fn a_desync_is_reported_and_the_reports_blame_the_one_with_the_fault() {
    for options in modes() {
        let mut table = Table::new(20, 0);
        table.host(options);
        FAULT.set(Some(Fault { tick: 70, disc: 1, field: BodyField::ALL[0], bit: 9 }));
        table.join(options, 0);
        table.play(4000);
        let desync = |events: &[PeerEvent]| -> Option<PeerDesync> {
            events.iter().find_map(|event| match event {
                PeerEvent::Desync(desync) => Some(*desync),
                _ => None,
            })
        };
        let found: Vec<PeerDesync> = table.events.iter().filter_map(|events| desync(events)).collect();
        assert_eq!(found.len(), 2, "both notice it");
        let reports: Vec<Evidence> = (0..2)
            .map(|at| {
                let bytes = table.peer(at).report(&found[at]).expect("valid");
                assert!(DesyncReport::from_bytes(&bytes, &Limits::default()).is_ok());
                Evidence::read(bytes, &Limits::default()).expect("valid")
            })
            .collect();
        let comparison = compare::<Pushers>(&reports[0], &reports[1], &Limits::default()).expect("valid");
        assert_eq!(comparison.blame, Blame::Side(Side::B), "{comparison:?}");
    }
}

#[test]
fn another_setup_is_refused_with_all_differences() {
    let mut table = Table::new(10, 0);
    table.host(PeerOptions::lockstep());
    let (me, port) = table.next();
    let setup = Setup { tick_rate: 30, ..Setup::default() };
    let options = PeerOptions { patience: Duration::from_secs(5), ..PeerOptions::lockstep() };
    let mut peer = Peer::<Pushers, _>::join(&setup, options, me, port, Network::address(0)).expect("valid");
    let mut error = None;
    for _ in 0..1000 {
        table.play(1);
        let now = table.network.time();
        error = error.or(peer.update(now).err());
    }
    let Some(PeerError::Parameters(differences)) = error else { panic!("{error:?}") };
    let what: Vec<&str> = differences.iter().map(|difference| difference.what).collect();
    assert_eq!(what, ["setup", "tick rate", "patience in microseconds"]);
}

/// The server's replay equals those of the players.
#[test]
fn a_dedicated_server_plays_no_seat() {
    let options = PeerOptions::lockstep();
    let mut table = Table::new(15, 1);
    table.host(PeerOptions { seats: 0, ..options });
    table.join(options, 0);
    table.join(options, 0);
    table.play(4000);
    assert_eq!((table.peer(0).seats(), table.peer(1).seats().len()), (vec![], 1));
    assert!(table.peer(0).tick() > 100);
    let replays = table.end();
    assert_eq!(replays[0], replays[1]);
    assert!(matches!(verify::<Pushers>(&replays[0], &Limits::default()), Verdict::Match { .. }));
}

/// The server plays no seat. After the first player has left, nobody plays until the second player gets a seat.
#[test]
fn a_late_player_who_is_alone_plays_at_the_rate_of_the_game() {
    let options = PeerOptions { start_with: 1, ..PeerOptions::rollback() };
    let mut table = Table::new(20, 0);
    table.host(PeerOptions { seats: 0, ..options });
    table.join(options, 0);
    table.play(1000);
    table.peer(1).leave();
    table.play(3000);
    table.join(options, 0);
    table.play(2000);
    let before = table.peer(2).tick();
    table.play(2000);
    let played = table.peer(2).tick() - before;
    assert!((115..=125).contains(&played), "{played} ticks in 2 s");
}

/// Before the match begins, no tick can be overdue. The spectator must notice from the lack of packets that its contact
/// has left.
#[test]
fn a_spectator_whose_contact_leaves_the_lobby_finds_another_one() {
    let options = PeerOptions { start_with: 3, ..PeerOptions::rollback() };
    let mut table = Table::new(20, 0);
    table.host(options);
    table.join(options, 0);
    table.play(1000);
    table.watch(options, 0);
    table.play(2000);
    table.peer(0).leave();
    table.play(3500);
    table.join(options, 1);
    table.join(options, 1);
    table.play(3000);
    assert!(table.peer(1).tick() > 60);
    assert!(table.peer(2).confirmed() + 30 > table.peer(1).tick());
}

#[test]
fn a_second_process_with_the_same_identity_is_refused() {
    let mut table = Table::new(10, 0);
    table.host(PeerOptions { start_with: 1, ..PeerOptions::lockstep() });
    table.play(100);
    let (_, port) = table.next();
    let contact = Network::address(0);
    let options = PeerOptions::lockstep();
    let mut twin =
        Peer::<Pushers, _>::join(&Setup::default(), options, identity(0), port, contact).expect("valid");
    let mut error = None;
    for _ in 0..500 {
        table.play(1);
        error = error.or(twin.update(table.network.time()).err());
    }
    assert_eq!(error, Some(PeerError::Refused { why: "the identity is taken" }));
    assert!(table.peer(0).tick() > 20);
}

#[test]
fn more_inputs_than_seats_are_an_error() {
    let mut table = Table::new(1, 0);
    let options = PeerOptions { start_with: 1, ..PeerOptions::lockstep() };
    table.host(options);
    table.play(100);
    assert_eq!(table.peer(0).game().players(), 4);
    let now = Duration::from_millis(500);
    table.peer(0).update(now).expect("valid");
    assert!(matches!(table.peer(0).advance(&[1, 2]), Err(PeerError::InputCount { seats: 1, inputs: 2 })));
}

fn refused(options: PeerOptions) -> String {
    let network = Network::new(conditions(1, 0), 3);
    let peer = Peer::<Pushers, _>::host(&Setup::default(), options, identity(0), network.port(0));
    peer.expect_err("an option that is out of its range").to_string()
}

#[test]
fn an_option_out_of_its_range_is_named_as_the_caller_knows_it() {
    let options = PeerOptions::lockstep();
    for (options, expected) in [
        (PeerOptions { delay: (9, 3), ..options }, "`delay.0` is 0 to 3, not 9"),
        (PeerOptions { delay: (0, 61), ..options }, "`delay.1` is 0 to 60, not 61"),
        (PeerOptions { guess: 33, ..options }, "`guess` is 0 to 32, not 33"),
        (PeerOptions { start_with: 5, ..options }, "`start_with` is 0 to 4, not 5"),
        (PeerOptions { seats: 5, ..options }, "`seats` is 0 to 4, not 5"),
        (PeerOptions { seats: 255, ..options }, "`seats` is 0 to 4, not 255"),
        (PeerOptions { input_bytes: Some(511), ..options }, "`input_bytes` is 0 to 510, not 511"),
    ] {
        assert_eq!(refused(options), format!("the session cannot start: {expected}"));
    }
    assert_eq!(
        refused(PeerOptions { first_seat: Some(4), ..options }),
        "there is no seat 4: the match has seats 0 to 3"
    );
}

#[test]
fn a_peer_without_a_free_seat_follows_the_match_and_its_status_is_joining() {
    let mut table = Table::new(10, 0);
    table.host(PeerOptions { seats: 4, ..PeerOptions::lockstep() });
    table.join(PeerOptions::lockstep(), 0);
    table.play(3000);
    let peer = table.peer(1);
    assert_eq!((peer.status(), peer.seats()), (Some(Status::Joining), vec![]));
    // A session has 64 seats, of which the game uses four.
    assert_eq!(peer.session().map(|session| session.view().free_seats() & 0b1111), Some(0));
    assert!(peer.confirmed() > 60, "{}", peer.confirmed());
    // The peer has no seat, so a game that makes an input for each of its seats passes none.
    assert_eq!(peer.advance(&[]).map(|_| ()), Ok(()));
}

#[test]
fn a_contact_that_does_not_answer_is_no_status_and_no_event() {
    let mut table = Table::new(10, 0);
    table.host(PeerOptions::lockstep());
    table.join(PeerOptions::lockstep(), 77);
    table.join(PeerOptions { match_tag: 5, ..PeerOptions::lockstep() }, 0);
    table.play(5000);
    for at in [1, 2] {
        assert_eq!((table.peer(at).status(), table.peer(at).tick()), (None, 0));
        assert!(!table.peer(at).is_due());
        assert!(table.events[at].is_empty(), "{:?}", table.events[at]);
    }
    table.peer(1).ask(Network::address(0));
    table.play(2000);
    assert_eq!(table.peer(1).status(), Some(Status::Playing));
}
