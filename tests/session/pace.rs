//! Lockstep plays at full speed with a delay of the one-way latency plus one tick.

use lockstep2d::session::{Config, Role, View};

use super::sim::{LinkConditions, MS, S, Sim, Us, id, key};

/// A running match. Its sessions are called every millisecond.
pub(crate) fn players(count: usize, link: LinkConditions, configure: impl Fn(&mut Config)) -> Sim {
    let mut sim = Sim::new(count as u64 + link.latency, count);
    sim.look = MS;
    sim.doubled = 0;
    sim.links = vec![vec![link; count]; count];
    let mut first = View::opened_by(id(0), key(0), 0, true);
    first.voters.clear();
    for index in 0..count {
        first.found(id(index), key(index), 1, 1 << index);
    }
    let mut config = Config::new(5, count as u8);
    configure(&mut config);
    sim.input_bytes = u64::from(config.input_bytes);
    for index in 0..count {
        let skew = [1000, 1003, 998, 1001, 999, 1002, 1000, 997][index % 8];
        sim.add(config.clone(), Role::Player { seats: 1 }, &first, skew);
        sim.start(index, index as u64 * 7 * MS);
    }
    sim
}

pub(crate) fn link(latency: Us) -> LinkConditions {
    LinkConditions { exists: true, latency, jitter: 0, loss: 0, cut_until: 0 }
}

/// Pace of the slowest peer during `seconds` after the first 5 s, in hundredths of a confirmed tick per second.
pub(crate) fn pace(sim: &mut Sim, seconds: u64) -> u64 {
    let played =
        |sim: &Sim| sim.peers.iter().map(|peer| u64::from(peer.session.confirmed())).min().unwrap_or(0);
    sim.run(5 * S);
    let before = played(sim);
    sim.run((5 + seconds) * S);
    assert_eq!(sim.failure, None);
    (played(sim) - before) * 100 / seconds
}

/// Delay in ticks: the latency plus one tick. A packet may wait a millisecond for the next call of the session.
fn documented_delay(latency: Us) -> u16 {
    ((latency + MS) * 60).div_ceil(S) as u16 + 1
}

#[test]
fn lockstep_plays_at_full_speed_at_any_latency() {
    for latency in [1, 5, 20, 40, 60, 100, 150].map(|latency| latency * MS) {
        for count in [2, 4] {
            let mut sim = players(count, link(latency), |_| ());
            let pace = pace(&mut sim, 20);
            assert!(pace >= 5950, "{latency} us: {pace} hundredths of a tick per second");
            for peer in &sim.peers {
                assert!(
                    peer.session.delay() <= documented_delay(latency),
                    "{latency} us: {}",
                    peer.session.delay()
                );
            }
        }
    }
}

/// Two players do not hear each other. A third one relays their inputs.
#[test]
fn lockstep_plays_at_full_speed_in_a_star() {
    let mut sim = players(3, link(75 * MS), |_| ());
    (sim.links[1][2].exists, sim.links[2][1].exists) = (false, false);
    let pace = pace(&mut sim, 20);
    let delays: Vec<_> = sim.peers.iter().map(|peer| peer.session.delay()).collect();
    assert!(pace >= 5900, "{pace} hundredths of a tick per second, delays {delays:?}");
    assert!(
        delays[0] <= documented_delay(75 * MS) && delays[1] <= documented_delay(150 * MS) + 2,
        "{delays:?}"
    );
}

#[test]
fn a_fixed_delay_of_the_latency_and_a_tick_is_enough() {
    for latency in [20, 60, 150].map(|latency| latency * MS) {
        let delay = documented_delay(latency);
        let mut sim =
            players(2, link(latency), |config| (config.delay_min, config.delay_max) = (delay, delay));
        let pace = pace(&mut sim, 20);
        assert!(pace >= 5950, "{latency} us: {pace} hundredths of a tick per second");
    }
}

#[test]
fn the_delay_follows_the_latency_within_its_bounds_and_without_a_stall() {
    let mut sim = players(2, link(20 * MS), |config| (config.delay_min, config.delay_max) = (1, 12));
    assert!(pace(&mut sim, 5) >= 5950);
    assert!(sim.peers.iter().all(|peer| peer.session.delay() == 3));
    sim.links = vec![vec![link(90 * MS); 2]; 2];
    sim.run(15 * S);
    assert!(sim.peers.iter().all(|peer| (7..=8).contains(&peer.session.delay())));
    sim.peers[0].session.set_delay(0, 5);
    sim.links = vec![vec![link(30 * MS); 2]; 2];
    sim.run(25 * S);
    assert_eq!(sim.failure, None);
    assert!(sim.peers.iter().all(|peer| (3..=4).contains(&peer.session.delay())));
}

#[test]
fn rollback_hides_latency_and_corrects_guesses() {
    let configure = |config: &mut Config| {
        (config.guess, config.save_interval) = (8, 1);
        (config.delay_min, config.delay_max) = (1, 1);
    };
    let mut sim = players(4, LinkConditions { jitter: 20 * MS, loss: 5, ..link(60 * MS) }, configure);
    let pace = pace(&mut sim, 20);
    assert!(pace >= 5900, "{pace} hundredths of a tick per second");
    for peer in &sim.peers {
        assert_eq!(peer.session.delay(), 1);
        let statistics = peer.session.statistics();
        assert!(statistics.replayed > 0 && statistics.replayed_max <= 16, "{statistics:?}");
    }
}

/// Measured ping, jitter and loss agree with those of the links.
#[test]
fn measurements_are_those_of_the_links() {
    let mut sim = players(2, LinkConditions { jitter: 10 * MS, loss: 20, ..link(50 * MS) }, |_| ());
    pace(&mut sim, 20);
    let link = sim.peers[0].session.link(id(1)).expect("valid");
    assert!((100 * MS..130 * MS).contains(&link.round_trip), "{link:?}");
    assert!((MS..15 * MS).contains(&link.jitter), "{link:?}");
    assert!((50..400).contains(&link.loss_per_mille), "{link:?}");
    assert_eq!(link.bytes_sent, sim.bytes_from(0));
}

/// The inputs of a slow peer with a long input delay arrive in time. The others stop even so, because they may not run
/// further ahead of the slow peer.
#[test]
fn a_slow_peer_slows_others_and_is_named() {
    for (count, delay, guess) in [(3, 0, 0), (3, 20, 0), (2, 20, 0), (3, 0, 8), (3, 20, 8)] {
        let mut sim = players(count, link(20 * MS), |config| {
            (config.guess, config.save_interval) = (guess, 1);
        });
        let slow = count - 1;
        sim.peers[slow].session.set_delay(delay, 20);
        pace(&mut sim, 2);
        sim.peers[slow].in_menu = true;
        sim.run(9 * S);
        let still: Vec<u32> = sim.peers.iter().map(|peer| peer.session.played()).collect();
        sim.run(14 * S);
        for (peer, &still) in sim.peers[..slow].iter().zip(&still) {
            assert_eq!(peer.session.waiting_for(), Some(id(slow)), "{count} {delay} {guess}");
            assert_eq!(peer.session.played(), still, "a peer that is heard is not dropped");
            assert_eq!(peer.session.view().number, 0);
            assert_eq!(peer.waiting, [(id(slow), true)], "the game is told once, and that the peer is heard");
        }
        assert!(sim.peers[slow].waiting.is_empty(), "{:?}", sim.peers[slow].waiting);
        sim.peers[slow].in_menu = false;
        sim.run(16 * S);
        assert!(sim.peers.iter().zip(&still).all(|(peer, still)| peer.session.played() > still + 60));
        assert_eq!(sim.failure, None);
    }
}

#[test]
fn a_delay_above_the_latency_does_not_speed_up_the_match() {
    for (count, guess) in [(1, 0), (2, 0), (2, 8), (3, 0)] {
        let mut sim = players(count, link(20 * MS), |config| {
            (config.guess, config.save_interval) = (guess, 1);
            (config.delay_min, config.delay_max) = (30, 30);
        });
        let pace = pace(&mut sim, 5);
        assert!((5950..6100).contains(&pace), "{count} players: {pace} hundredths of a tick per second");
    }
}

#[test]
fn a_match_keeps_its_pace_when_the_latency_falls() {
    let mut sim = players(2, link(200 * MS), |_| ());
    assert!(pace(&mut sim, 5) >= 5950);
    assert!(sim.peers.iter().all(|peer| peer.session.delay() >= 12));
    let before = sim.peers[0].session.played();
    sim.links = vec![vec![link(5 * MS); 2]; 2];
    sim.run(15 * S);
    assert_eq!(sim.failure, None);
    let played = sim.peers[0].session.played() - before;
    assert!((297..320).contains(&played), "{played} ticks in 5 s");
}

/// In matches of more than 32 peers, a peer sends a packet only in every third tick, and its inputs wait for this
/// packet.
#[test]
fn a_large_match_plays_at_full_speed() {
    let mut sim = players(34, link(40 * MS), |config| config.tick_micros = 50_000);
    sim.look = 5 * MS;
    let pace = pace(&mut sim, 5);
    assert!(pace >= 1960, "{pace} hundredths of a tick per second");
}

/// The inputs of all ticks of a round trip do not fit in one packet.
#[test]
fn large_inputs_play_at_full_speed() {
    for (input_bytes, count, latency) in [(512, 2, 40), (512, 2, 100), (512, 4, 40), (200, 4, 100)] {
        for loss in [0, 2] {
            let mut sim = players(count, LinkConditions { loss, ..link(latency * MS) }, |config| {
                config.input_bytes = input_bytes
            });
            let pace = pace(&mut sim, 20);
            let case = format!("{input_bytes} bytes, {count} players, {latency} ms, {loss} % loss");
            assert!(pace >= 5500, "{case}: {pace} hundredths of a tick per second");
        }
    }
}

/// A spectator that begins 5 s late hears only one peer, through which it receives the inputs of all players.
#[test]
fn a_late_spectator_keeps_up_with_many_bytes() {
    for (count, input_bytes) in [(2, 512), (4, 300), (32, 8)] {
        let link = LinkConditions { loss: 2, ..link(40 * MS) };
        let mut sim = players(count, link, |config| config.input_bytes = input_bytes);
        sim.look = 4 * MS;
        sim.links = vec![vec![link; count + 1]; count + 1];
        let first = sim.peers[0].session.view().clone();
        let config = Config { input_bytes, ..Config::new(5, count as u8) };
        sim.add(config, Role::Spectator, &first, 1000);
        sim.introduce(count, 0);
        sim.start(count, 5 * S);
        sim.run(12 * S);
        assert_eq!(sim.failure, None);
        let lag = sim.peers[0].session.final_tick() - sim.peers[count].session.played();
        assert!(lag < 40, "{input_bytes} bytes, {count} players: {lag} ticks");
    }
}
