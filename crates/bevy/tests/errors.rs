//! Matches and replays that stop with an error. The other peers of a match continue, and the stopped peer can join
//! again.

use std::cell::Cell;
use std::time::Duration;

use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_lockstep2d::*;
use lockstep2d::hash::StateHash;
use lockstep2d::lockstep::{Game, RulesId, SetupError};
use lockstep2d::peer::{LinkConditions, Network, PeerError, PeerEvent, PeerIdentity, PeerOptions};
use lockstep2d::replay::{Limits, Recording};
use lockstep2d::session::{Event, Status};
use serde::{Deserialize, Serialize};

const TICK: Duration = Duration::from_nanos(16_666_667);

thread_local! {
    /// Number that each tick adds to the count. A replay that was recorded with another number diverges.
    static STEP: Cell<u64> = const { Cell::new(1) };
    /// Number that is added to a state that is loaded.
    static LOADED: Cell<u64> = const { Cell::new(0) };
}

/// A game that adds a number to a count in each tick. Its inputs are lists of bytes of any length.
#[derive(Clone, Serialize, Deserialize)]
struct Count(u64);

impl Game for Count {
    type Setup = ();
    type Input = Vec<u8>;
    type Save = Count;
    const RULES: RulesId = RulesId { name: "count", version: 1 };

    fn new((): &()) -> Result<Self, SetupError> {
        Ok(Count(0))
    }
    fn players(&self) -> u32 {
        2
    }
    fn tick_rate(&self) -> u32 {
        60
    }
    fn step(&mut self, _: &[Vec<u8>]) {
        self.0 += STEP.get();
    }
    fn state_hash(&self) -> StateHash {
        StateHash::of(self)
    }
    fn save(&self) -> Count {
        self.clone()
    }
    fn load(&mut self, save: &Count) {
        self.0 = save.0 + LOADED.get();
    }
    fn work(&self, _: &[Vec<u8>]) -> u64 {
        1
    }
}

fn app(game: Lockstep<Count>) -> App {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, LockstepPlugin::<Count>::default()))
        .insert_resource(TimeUpdateStrategy::ManualDuration(TICK))
        .insert_resource(game);
    app
}

fn lockstep(app: &mut App) -> Mut<'_, Lockstep<Count>> {
    app.world_mut().resource_mut::<Lockstep<Count>>()
}

fn drained<M: Message>(app: &mut App) -> Vec<M> {
    app.world_mut().resource_mut::<Messages<M>>().drain().collect()
}

#[test]
fn a_peer_with_an_error_leaves_and_can_join_again() {
    let network = Network::new(LinkConditions::latency(Duration::from_millis(30)), 1);
    // The patience is so long that a silent peer is not dropped.
    let patience = Duration::from_secs(600);
    let options = PeerOptions { input_bytes: Some(8), patience, ..PeerOptions::rollback() };
    let me = |number: u64| PeerIdentity::new([number, number + 10, number + 20, number + 30]);
    let contact = Network::address(1);
    let mut host = app(Lockstep::host(&(), options, me(1), network.port(1)).unwrap());
    let mut guest = app(Lockstep::join(&(), options, me(2), network.port(2), contact).unwrap());
    let play = |host: &mut App, guest: &mut App, frames: u32| {
        for _ in 0..frames {
            network.set_time(network.time() + TICK);
            host.update();
            guest.update();
        }
    };
    play(&mut host, &mut guest, 200);
    assert!(lockstep(&mut guest).confirmed() > 60);
    // An input that is too long for the match.
    *guest.world_mut().resource_mut::<Inputs<Count>>().once(0) = vec![1; 100];
    drained::<MatchEvent>(&mut host);
    play(&mut host, &mut guest, 1);
    assert!(matches!(lockstep(&mut guest).failure(), Some(LockstepError::Match(_))));
    assert_eq!(drained::<LockstepFailed>(&mut guest).len(), 1);
    let (played, tick) = (lockstep(&mut guest).tick(), lockstep(&mut host).tick());
    let mut left = false;
    for _ in 0..120 {
        play(&mut host, &mut guest, 1);
        let has_left = |event: &MatchEvent| matches!(event.0, PeerEvent::Session(Event::Unseated { .. }));
        left |= drained::<MatchEvent>(&mut host).iter().any(has_left);
    }
    assert!(left, "the host has not heard that the guest leaves");
    assert!(lockstep(&mut host).tick() > tick + 60, "the host waits for the guest");
    assert_eq!(lockstep(&mut guest).tick(), played);
    assert!(lockstep(&mut guest).failure().is_some());
    assert_eq!(drained::<LockstepFailed>(&mut guest).len(), 0, "it is sent once");
    lockstep(&mut guest).peer_mut().unwrap().ask(contact);
    play(&mut host, &mut guest, 240);
    assert!(lockstep(&mut guest).failure().is_none());
    let difference = lockstep(&mut host).tick().abs_diff(lockstep(&mut guest).tick());
    assert!(difference < 20 && lockstep(&mut guest).confirmed() > tick + 200, "{difference}");
    assert_eq!(lockstep(&mut guest).seats(), [1]);
}

#[test]
fn a_peer_that_cannot_use_the_state_of_its_next_session_leaves_it() {
    let network = Network::new(LinkConditions::latency(Duration::from_millis(30)), 1);
    let patience = Duration::from_secs(600);
    let options = PeerOptions { input_bytes: Some(8), patience, ..PeerOptions::rollback() };
    let me = |number: u64| PeerIdentity::new([number, number + 10, number + 20, number + 30]);
    let contact = Network::address(1);
    let mut host = app(Lockstep::host(&(), options, me(1), network.port(1)).unwrap());
    let mut guest = app(Lockstep::join(&(), options, me(2), network.port(2), contact).unwrap());
    let play = |host: &mut App, guest: &mut App, frames: u32, loaded: u64| {
        let mut failures = Vec::new();
        for _ in 0..frames {
            network.set_time(network.time() + TICK);
            host.update();
            LOADED.set(loaded);
            guest.update();
            LOADED.set(0);
            failures.extend(drained::<LockstepFailed>(guest).into_iter().map(|LockstepFailed(error)| error));
        }
        failures
    };
    assert!(play(&mut host, &mut guest, 200, 0).is_empty());
    *guest.world_mut().resource_mut::<Inputs<Count>>().once(0) = vec![1; 100];
    let failures = play(&mut host, &mut guest, 120, 0);
    assert!(matches!(failures[..], [LockstepError::Match(PeerError::InputLength { .. })]), "{failures:?}");
    for _ in 0..2 {
        lockstep(&mut guest).peer_mut().unwrap().ask(contact);
        let failures = play(&mut host, &mut guest, 240, 1);
        assert!(matches!(failures[..], [LockstepError::Match(PeerError::State { .. })]), "{failures:?}");
        let failure = lockstep(&mut guest).failure().cloned();
        assert!(matches!(failure, Some(LockstepError::Match(PeerError::State { .. }))), "{failure:?}");
        let status = lockstep(&mut guest).peer().unwrap().status();
        assert!(matches!(status, Some(Status::Left | Status::Closed)), "{status:?}");
        let tick = lockstep(&mut host).tick();
        play(&mut host, &mut guest, 60, 0);
        assert!(lockstep(&mut host).tick() > tick + 50, "the host waits for the guest");
    }
    lockstep(&mut guest).peer_mut().unwrap().ask(contact);
    assert!(play(&mut host, &mut guest, 240, 0).is_empty());
    assert!(lockstep(&mut guest).failure().is_none());
    assert_eq!(lockstep(&mut guest).seats(), [1]);
}

#[test]
fn a_refused_peer_can_ask_another_one() {
    let network = Network::new(LinkConditions::latency(Duration::from_millis(10)), 1);
    let options = |bytes| PeerOptions { input_bytes: Some(bytes), start_with: 1, ..PeerOptions::rollback() };
    let me = |number: u64| PeerIdentity::new([number, number + 10, number + 20, number + 30]);
    let host =
        |number: u32, bytes| Lockstep::host(&(), options(bytes), me(number.into()), network.port(number));
    let [other, same] = [1, 2].map(Network::address);
    let guest = Lockstep::join(&(), options(16), me(3), network.port(3), other).unwrap();
    let mut apps = [app(host(1, 8).unwrap()), app(host(2, 16).unwrap()), app(guest)];
    // Returns the number of `LockstepFailed` messages of the guest, whether the guest has stopped, and whether it has
    // more than 60 confirmed ticks.
    let mut play = |contact| {
        if let Some(contact) = contact {
            lockstep(&mut apps[2]).peer_mut().unwrap().ask(contact);
        }
        let mut failures = 0;
        for _ in 0..120 {
            network.set_time(network.time() + TICK);
            apps.iter_mut().for_each(App::update);
            failures += drained::<LockstepFailed>(&mut apps[2]).len();
        }
        (failures, lockstep(&mut apps[2]).failure().is_some(), lockstep(&mut apps[2]).confirmed() > 60)
    };
    assert_eq!(play(None), (1, true, false));
    assert_eq!(play(Some(other)), (1, true, false), "it is refused again");
    assert_eq!(play(Some(same)), (0, false, true));
}

#[test]
fn single_steps_of_a_failed_replay_are_forgotten() {
    let mut recording = Recording::<Count>::start(&(), 10).unwrap();
    (0..60).for_each(|_| recording.step(&[vec![], vec![]]).unwrap());
    let file = recording.finish().unwrap();
    STEP.set(2);
    let mut app = app(Lockstep::replay(file, &Limits::default()).unwrap());
    (0..60).for_each(|_| app.update());
    assert!(matches!(lockstep(&mut app).failure(), Some(LockstepError::Seek(_))));
    lockstep(&mut app).pause();
    for _ in 0..3 {
        lockstep(&mut app).step_once();
        app.update();
    }
    lockstep(&mut app).seek(0).unwrap();
    app.update();
    assert_eq!(lockstep(&mut app).tick(), 0);
    lockstep(&mut app).step_once();
    app.update();
    assert_eq!(lockstep(&mut app).tick(), 1);
}
