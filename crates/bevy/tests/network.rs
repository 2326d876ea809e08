//! Two apps play over a bad network, and a third app watches from the middle on. They have the same states and
//! confirmed events, and their views follow the bodies.

mod common;

use std::collections::BTreeMap;
use std::time::Duration;

use bevy::prelude::*;
use bevy_lockstep2d::*;
use common::arena::{Arena, Setup};
use common::{Heard, TICK, app, check_views};
use lockstep2d::hash::StateHash;
use lockstep2d::lockstep::Game;
use lockstep2d::peer::{LinkConditions, Network, PeerEvent, PeerIdentity, PeerOptions};
use lockstep2d::replay::{Limits, Step, Verdict, VerifiedReplay, verify};
use lockstep2d::session::Event;

fn identity(number: u64) -> PeerIdentity {
    PeerIdentity::new([number, number * 77 + 1, number * 91 + 5, number * 13 + 7])
}

fn bad_network() -> Network {
    let ms = Duration::from_millis;
    let conditions =
        LinkConditions { latency: ms(20), jitter: ms(70), loss: 12, duplication: 6, reordering: 20 };
    Network::new(conditions, 1)
}

struct Player {
    app: App,
    hashes: BTreeMap<u64, StateHash>,
    depth: u32,
    desyncs: u32,
}

impl Player {
    fn new(game: Lockstep<Arena>, seed: u64) -> Self {
        let mut app = app(game, seed, TICK);
        app.init_resource::<Desyncs>().add_systems(Update, count_desyncs);
        Player { app, hashes: BTreeMap::new(), depth: 0, desyncs: 0 }
    }

    fn update(&mut self) {
        self.app.update();
        check_views(&mut self.app);
        let world = self.app.world();
        let lockstep = world.resource::<Lockstep<Arena>>();
        let confirmed = lockstep.confirmed();
        let history = lockstep.peer().unwrap().history();
        let fresh = history.iter().filter(|past| past.tick <= confirmed && past.tick > 0);
        for past in fresh {
            let known = *self.hashes.entry(past.tick).or_insert(past.hash);
            assert_eq!(known, past.hash, "a confirmed tick changed");
        }
        self.depth = self.depth.max(world.resource::<LockstepStatus>().rolled_back);
        self.desyncs = world.resource::<Desyncs>().0;
    }

    fn confirmed(&self) -> u64 {
        self.app.world().resource::<Lockstep<Arena>>().confirmed()
    }

    fn heard(&self) -> &Heard {
        self.app.world().resource::<Heard>()
    }

    fn events(&self, from: u64, to: u64) -> BTreeMap<u64, Vec<WorldEvent>> {
        self.heard().confirmed.range(from..=to).map(|(tick, events)| (*tick, events.clone())).collect()
    }
}

#[derive(Resource, Default)]
struct Desyncs(u32);

fn count_desyncs(mut events: MessageReader<MatchEvent>, mut desyncs: ResMut<Desyncs>) {
    desyncs.0 += events.read().filter(|event| matches!(event.0, PeerEvent::Desync(_))).count() as u32;
}

#[test]
fn two_apps_and_a_late_spectator_have_the_same_match() {
    let network = bad_network();
    let setup = Setup::default();
    let options = PeerOptions { delay: (1, 3), ..PeerOptions::rollback() };
    let host = Lockstep::host(&setup, options, identity(1), network.port(1)).unwrap();
    let guest = Lockstep::join(&setup, options, identity(2), network.port(2), Network::address(1)).unwrap();
    let mut players = vec![Player::new(host, 11), Player::new(guest, 29)];
    let mut frames = 0;
    while players.iter().any(|player| player.confirmed() < 2000) {
        network.set_time(network.time() + TICK);
        players.iter_mut().for_each(Player::update);
        frames += 1;
        if frames == 600 {
            let watch =
                Lockstep::watch(&setup, options, identity(3), network.port(3), Network::address(1)).unwrap();
            players.push(Player::new(watch, 0));
        }
        assert!(frames < 5000, "the match stands still");
    }
    let end = players.iter().map(Player::confirmed).min().unwrap();
    for player in &players {
        assert_eq!(player.desyncs, 0);
        let common =
            player.hashes.range(..=end).filter(|(tick, hash)| players[0].hashes.get(tick) == Some(hash));
        let count = common.count();
        assert_eq!(count, player.hashes.range(..=end).count());
    }
    assert!(players[0].hashes.len() > 1900 && players[2].hashes.len() > 1000);
    assert!(players[0].depth > 1 || players[1].depth > 1, "there was no rollback");
    check_events(&players, end);
    check_replay(players, end);
}

/// Frames are as long as ticks. To catch up, the spectator has to play several ticks in a frame.
#[test]
fn a_spectator_that_was_suspended_catches_up() {
    let network = bad_network();
    let (setup, options) = (Setup::default(), PeerOptions::rollback());
    let contact = Network::address(1);
    let host = Lockstep::host(&setup, options, identity(1), network.port(1)).unwrap();
    let guest = Lockstep::join(&setup, options, identity(2), network.port(2), contact).unwrap();
    let watch = Lockstep::watch(&setup, options, identity(3), network.port(3), contact).unwrap();
    let mut players = [(host, 11), (guest, 29), (watch, 0)].map(|(game, seed)| Player::new(game, seed));
    let mut behind = 0;
    for frame in 0..900 {
        network.set_time(network.time() + TICK);
        let suspended = (300..500).contains(&frame);
        players[..if suspended { 2 } else { 3 }].iter_mut().for_each(Player::update);
        if frame == 499 {
            behind = players[0].confirmed() - players[2].confirmed();
        }
    }
    assert!(behind > 150, "{behind} ticks");
    let behind = players[0].confirmed() - players[2].confirmed().min(players[0].confirmed());
    assert!(behind < 20, "{behind} ticks");
}

#[test]
fn every_prediction_is_confirmed_or_retracted_when_a_match_has_ended() {
    const END: u64 = 200;
    let mut late = 0;
    for seed in 0..6 {
        let network = bad_network();
        let (setup, options) = (Setup::default(), PeerOptions { delay: (1, 1), ..PeerOptions::rollback() });
        let host = Lockstep::host(&setup, options, identity(1), network.port(1)).unwrap();
        let contact = Network::address(1);
        let guest = Lockstep::join(&setup, options, identity(2), network.port(2), contact).unwrap();
        let mut players = [(host, 11 + seed), (guest, 29 + seed)].map(|(game, seed)| Player::new(game, seed));
        let mut host = players[0].app.world_mut().resource_mut::<Lockstep<Arena>>();
        host.peer_mut().unwrap().session_mut().unwrap().end_at(END as u32);
        for _ in 0..600 {
            network.set_time(network.time() + TICK);
            players.iter_mut().for_each(Player::update);
        }
        for player in &players {
            assert_eq!(player.confirmed(), END);
            let heard = player.heard();
            let confirmed: usize = heard.confirmed.values().map(Vec::len).sum();
            assert_eq!(heard.predicted.len() - heard.retracted.len(), confirmed);
            late += heard.retracted.iter().filter(|(tick, _)| tick + 16 >= END).count();
        }
    }
    assert!(late > 0, "no prediction near an end was wrong");
}

#[test]
fn a_replay_that_is_saved_in_mid_match_changes_nothing() {
    let network = bad_network();
    let (setup, options) = (Setup::default(), PeerOptions { delay: (1, 1), ..PeerOptions::rollback() });
    let host = Lockstep::host(&setup, options, identity(1), network.port(1)).unwrap();
    let guest = Lockstep::join(&setup, options, identity(2), network.port(2), Network::address(1)).unwrap();
    let mut players = [(host, 11), (guest, 29)].map(|(game, seed)| Player::new(game, seed));
    let mut guessed = 0;
    for frame in 0..900 {
        network.set_time(network.time() + TICK);
        players.iter_mut().for_each(Player::update);
        let mut host = players[0].app.world_mut().resource_mut::<Lockstep<Arena>>();
        if frame % 60 != 59 || host.confirmed() == 0 {
            continue;
        }
        let state = |host: &Lockstep<Arena>| (host.tick(), host.confirmed(), host.game().state_hash());
        let before = state(&host);
        let verdict = verify::<Arena>(&host.replay_so_far().unwrap(), &Limits::default());
        assert!(matches!(verdict, Verdict::Match { ticks, .. } if ticks == before.1), "{verdict}");
        assert_eq!(state(&host), before);
        guessed += before.0 - before.1;
    }
    assert!(guessed > 10, "only {guessed} ticks had to be played again");
    let end = players.iter().map(Player::confirmed).min().unwrap();
    let events = players.each_ref().map(|player| player.events(1, end));
    assert!(events[0].len() > 50 && events[0] == events[1]);
    let heard = players[0].heard();
    let confirmed: usize = heard.confirmed.values().map(Vec::len).sum();
    let predicted = heard.predicted.len() - heard.retracted.len();
    assert!(predicted >= confirmed && predicted - confirmed < 40, "{predicted} {confirmed}");
}

#[test]
fn a_pause_before_a_seat_is_requested_when_there_is_a_seat() {
    let network = bad_network();
    let (setup, options) = (Setup::default(), PeerOptions::rollback());
    let host = Lockstep::host(&setup, options, identity(1), network.port(1)).unwrap();
    let guest = Lockstep::join(&setup, options, identity(2), network.port(2), Network::address(1)).unwrap();
    let mut players = [(host, 11), (guest, 29)].map(|(game, seed)| Player::new(game, seed));
    let mut pauses = Vec::new();
    for is_paused in [true, false] {
        let mut guest = players[1].app.world_mut().resource_mut::<Lockstep<Arena>>();
        if is_paused {
            guest.pause()
        } else {
            guest.resume()
        }
        for _ in 0..200 {
            network.set_time(network.time() + TICK);
            players.iter_mut().for_each(Player::update);
            let mut events = players[0].app.world_mut().resource_mut::<Messages<MatchEvent>>();
            pauses.extend(events.drain().filter_map(|event| match event.0 {
                PeerEvent::Session(Event::Pause { paused, .. }) => Some(paused),
                _ => None,
            }));
        }
        assert_eq!(players[1].app.world().resource::<Lockstep<Arena>>().tick() == 0, is_paused);
    }
    assert_eq!(pauses, [true, false]);
}

/// Checks that all players have the same confirmed events, and that predicted events are either retracted or confirmed.
fn check_events(players: &[Player], end: u64) {
    let all = players[0].events(1, end);
    assert!(all.values().map(Vec::len).sum::<usize>() > 500);
    assert_eq!(players[1].events(1, end), all);
    // The spectator joined in the middle of the match.
    let from = players[2].heard().confirmed.keys().next().copied().unwrap() + 1;
    assert!(from > 300, "{from}");
    assert_eq!(players[2].events(from, end), players[0].events(from, end));
    let retracted: usize = players.iter().map(|player| player.heard().retracted.len()).sum();
    assert!(retracted > 0, "no prediction was wrong");
    for player in &players[..2] {
        // Predicted events that were not retracted are confirmed, except near the end of the compared ticks.
        let heard = player.heard();
        assert!(heard.retracted.iter().all(|event| heard.predicted.contains(event)), "with the same tick");
        let confirmed: usize = heard.confirmed.values().map(Vec::len).sum();
        let predicted = heard.predicted.len() - heard.retracted.len();
        assert!(predicted >= confirmed && predicted - confirmed < 40, "{predicted} {confirmed}");
    }
}

/// Checks that the replay of the host verifies for the game without Bevy, and has the same events.
fn check_replay(mut players: Vec<Player>, end: u64) {
    let events = players[0].events(1, end);
    let world = players[0].app.world_mut();
    let mut game = world.remove_resource::<Lockstep<Arena>>().unwrap();
    let mut file = game.take_replay();
    file.extend(game.finish().unwrap());
    let verdict = verify::<Arena>(&file, &Limits::default());
    assert!(verdict.is_match(), "{verdict}");
    let mut replay = VerifiedReplay::<Arena>::open(&file, &Limits::default()).unwrap();
    let mut played = BTreeMap::new();
    while replay.tick() < end && matches!(replay.step().unwrap(), Step::Ticked) {
        let found = common::events_of(replay.game().world().unwrap());
        if !found.is_empty() {
            played.insert(replay.tick(), found);
        }
    }
    assert_eq!(played, events);
}

/// Largest distance, in metres, by which the host's view of the guest's body moves in one frame.
fn largest_jump(settings: LockstepSettings) -> f32 {
    let network = bad_network();
    let setup = Setup::default();
    let options = PeerOptions { delay: (1, 1), ..PeerOptions::rollback() };
    let host = Lockstep::host(&setup, options, identity(1), network.port(1)).unwrap();
    let guest = Lockstep::join(&setup, options, identity(2), network.port(2), Network::address(1)).unwrap();
    let mut apps = [app(host, 11, TICK), app(guest, 29, TICK)];
    for app in &mut apps {
        app.insert_resource(settings);
    }
    let (mut largest, mut last) = (0.0_f32, None);
    for _ in 0..1200 {
        network.set_time(network.time() + TICK);
        apps.iter_mut().for_each(App::update);
        let world = apps[0].world();
        // The body of the guest, whose inputs the host guesses.
        let Some((_, view)) = world.resource::<BodyViews>().iter().nth(5) else { continue };
        let place = world.get::<Transform>(view).unwrap().translation.truncate() / settings.pixels_per_metre;
        if let Some(last) = last.replace(place).filter(|_| world.resource::<LockstepStatus>().tick > 60) {
            largest = largest.max(place.distance(last));
        }
    }
    largest
}

#[test]
fn views_do_not_jump_when_a_guess_was_wrong() {
    let exact = largest_jump(LockstepSettings::default().exact());
    let smooth = largest_jump(LockstepSettings::default());
    assert!(smooth < 0.8 * exact, "{smooth} m instead of {exact} m");
}
