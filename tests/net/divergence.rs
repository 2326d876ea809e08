//! A peer with a memory fault is detected within two checkpoints, and the reports name the peer, the tick and the
//! field.

use lockstep2d::math::Rng;
use lockstep2d::net::{Divergence, Event, LinkConditions, Mode, NetOptions, Peer};
use lockstep2d::replay::Limits;
use lockstep2d::report::{Blame, DesyncReport, Evidence, Side, compare};
use lockstep2d::world::BodyField;

use super::matches::MODES;
use super::pushers::{FAULT, Fault, Pushers, Setup};
use super::sweep;
use super::table::Table;

fn found(table: &Table, at: usize) -> Option<Divergence> {
    table.events[at].iter().find_map(|event| match event {
        Event::Diverged(found) => Some(*found),
        _ => None,
    })
}

fn check(options: NetOptions, seed: u64) {
    let mut rng = Rng::new(seed);
    let fault = Fault {
        tick: 40 + u64::from(rng.below(40)),
        disc: usize::try_from(rng.below(12)).unwrap(),
        motion: BodyField::ALL[usize::try_from(rng.below(3)).unwrap()],
        bit: rng.below(24),
    };
    let players = 2 + rng.below(2);
    let faulty = rng.below(players);
    let options = options.start_with(players);
    let mut table = Table::new(
        LinkConditions { latency: std::time::Duration::from_millis(20), ..LinkConditions::default() },
        seed,
    );
    for address in 0..players {
        FAULT.set((address == faulty).then_some(fault));
        let port = table.network.port(address);
        let peer = match address {
            0 => Peer::host(&Setup::default(), options, port),
            _ => Peer::join(&Setup::default(), options, port, 0, None),
        };
        table.sit(peer.unwrap());
    }
    let seen = table.play(40, |table| (0..players).all(|at| found(table, at as usize).is_some()));
    assert!(seen, "{fault:?}: {}", table.describe());

    let other = (faulty + 1) % players;
    // The faulty peer differs from all other peers and receives all their hashes; in lockstep every peer receives all
    // hashes.
    let told = |at: u32, first: &Divergence| {
        let report = table.peers[at as usize].as_ref().unwrap().report(first);
        DesyncReport::from_bytes(&report, &Limits::default()).unwrap()
    };
    if options.mode == Mode::Lockstep {
        let groups = told(other, &found(&table, other as usize).unwrap()).groups();
        let sizes: Vec<_> = groups.iter().map(|group| group.seats.len()).collect();
        assert_eq!(sizes, if players == 2 { vec![1, 1] } else { vec![2, 1] }, "{groups:?}");
    }
    let mut sides = Vec::new();
    for at in [faulty, other] {
        let first = found(&table, at as usize).unwrap();
        let checkpoints = (first.tick - fault.tick) / u64::from(options.check_interval);
        assert!(
            first.tick >= fault.tick && checkpoints < 2,
            "{fault:?} was not detected within two checkpoints: {first:?}"
        );
        let report = table.peers[at as usize].as_ref().unwrap().report(&first);
        sides.push(Evidence::read(report, &Limits::default()).unwrap());
    }
    let told = compare::<Pushers>(&sides[0], &sides[1], &Limits::default()).unwrap();
    let what = format!("{options:?} {fault:?} on {faulty}: {told:?}");
    assert_eq!(told.blame, Blame::Side(Side::A), "{what}");
    assert_eq!(told.first_different, Some(fault.tick), "{what}");
    let seat = table.peers[faulty as usize].as_ref().unwrap().seat().unwrap();
    assert_eq!(told.trajectories[0].seats, [seat], "{what}");
    assert_eq!(told.subjects.len(), 1, "{what}");
    let differences = &told.subjects[0].differences;
    // A fault in the spin shows up as two fields: its raw bits, and the angular velocity derived from them.
    let derived = usize::from(fault.motion == BodyField::Spin);
    assert_eq!(
        (differences.len(), differences[0].field().name()),
        (1 + derived, fault.motion.name()),
        "{what}"
    );
}

#[test]
fn a_bit_that_flips_is_noticed_within_two_checkpoints_and_named() {
    let seeds = sweep::sample((0..3).flat_map(|batch| (0..16).map(move |seed| 100 * batch + seed)), 3);
    for seeds in seeds.chunks(16) {
        sweep::at_once(seeds, |&seed| check(MODES[usize::from(seed % 2 == 1)](), seed));
    }
}
