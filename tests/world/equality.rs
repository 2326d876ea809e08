//! Neither caches nor the broad phase affect results: eight worlds receive equal commands, and must have equal hashes
//! and events after every tick.

use lockstep2d::body::ShapeId;
use lockstep2d::collision::BroadPhaseKind;
use lockstep2d::world::{Backend, Command, ContactEvent, Events, SensorChange, World};
use std::collections::BTreeSet;
use std::sync::Mutex;

use super::churn::Churn;
use super::sweep;

/// Variant of a world: another broad phase, backend or number of threads, or a disturbance of its caches. Results must
/// not depend on the variant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Variant {
    BruteForce,
    SweepAndPrune,
    /// Clears all caches before every tick and after every command.
    Cleared,
    /// Encodes and decodes the world before every tick.
    Bytes,
    /// Saves, simulates three ticks with other commands, and restores.
    RolledBack,
    /// Uses no vector instructions.
    Scalar,
    /// Steps on three threads, if the feature `parallel` is enabled.
    Threads,
}

const OTHERS: [Variant; 7] = [
    Variant::BruteForce,
    Variant::SweepAndPrune,
    Variant::Cleared,
    Variant::Bytes,
    Variant::RolledBack,
    Variant::Scalar,
    Variant::Threads,
];

impl Variant {
    fn begin(self, world: &World) -> World {
        let mut world = world.clone();
        match self {
            Variant::BruteForce => world.set_broad_phase(BroadPhaseKind::BruteForce),
            Variant::SweepAndPrune => world.set_broad_phase(BroadPhaseKind::SweepAndPrune),
            Variant::Scalar => assert!(world.set_backend(Backend::Scalar)),
            #[cfg(feature = "parallel")]
            Variant::Threads => assert!(world.force_threads(3)),
            _ => {}
        }
        world
    }

    fn perturb(self, world: &mut World, churn: &Churn) {
        match self {
            Variant::BruteForce | Variant::SweepAndPrune | Variant::Scalar | Variant::Threads => {}
            Variant::Cleared => world.clear_scratch(),
            Variant::Bytes => *world = World::from_bytes(&world.to_bytes()).expect("its own bytes"),
            Variant::RolledBack => {
                let saved = world.save();
                let mut astray = churn.clone();
                for _ in 0..3 {
                    for command in astray.commands(world) {
                        let _refused_or_not = world.execute(&command);
                    }
                    world.step();
                }
                world.restore(&saved);
            }
        }
    }

    fn execute(self, world: &mut World, command: &Command) {
        let _refused_as_by_the_first_world = world.execute(command);
        if self == Variant::Cleared {
            world.clear_scratch();
        }
    }
}

/// Contacts and sensor overlaps that have begun and not ended.
#[derive(Default)]
struct Open {
    contacts: BTreeSet<ContactEvent>,
    visits: BTreeSet<(ShapeId, ShapeId)>,
}

impl Open {
    fn follow(&mut self, events: &Events) {
        for event in &events.contact_end {
            assert!(self.contacts.remove(event), "{event:?} ended without having begun");
        }
        for event in &events.contact_begin {
            assert!(self.contacts.insert(*event), "{event:?} began twice");
        }
        for change in events.sensor_changes() {
            match change {
                SensorChange::Begin(event) => {
                    let is_new = self.visits.insert((event.sensor, event.visitor));
                    assert!(is_new, "{event:?} began twice");
                }
                SensorChange::End(event) => {
                    let is_open = self.visits.remove(&(event.sensor, event.visitor));
                    assert!(is_open, "{event:?} ended without having begun");
                }
            }
        }
    }

    /// Expects that the shapes of open contacts and overlaps exist, and that the world lists the same overlaps. The
    /// shapes of an overlap must touch.
    fn check(&self, world: &World) {
        let ends = self.contacts.iter().flat_map(|event| [event.shape_a, event.shape_b]);
        let ends = ends.chain(self.visits.iter().flat_map(|event| [event.0, event.1]));
        ends.for_each(|shape| {
            assert!(world.shape(shape).is_some(), "shape {shape} was removed without end events")
        });
        let listed = world.shapes().flat_map(|(sensor, _)| {
            world.sensor_overlaps(sensor).into_iter().map(move |visitor| (sensor, visitor))
        });
        assert_eq!(listed.collect::<Vec<_>>(), self.visits.iter().copied().collect::<Vec<_>>());
        for &(sensor, visitor) in &self.visits {
            let distance = world.distance(sensor, visitor).expect("both are there").distance;
            assert!(distance <= 0, "{sensor} and {visitor} are {distance} m apart");
        }
    }
}

/// Executes a command. The invariants must hold, and a refused command must change nothing.
fn execute_checked(world: &mut World, command: &Command) {
    let before = world.state_hash();
    let refused = world.execute(command).is_err();
    assert_eq!(world.validate(), Ok(()), "{command:?}");
    assert!(!refused || world.state_hash() == before, "{command:?} was refused, but changed the world");
}

/// Counts of events, which prove that events were covered.
#[derive(Debug, Default)]
struct Seen {
    slept: usize,
    woken: usize,
    visits: usize,
    contacts: usize,
    hits: usize,
}

impl Seen {
    fn add(&mut self, other: &Seen) {
        self.slept += other.slept;
        self.woken += other.woken;
        self.visits += other.visits;
        self.contacts += other.contacts;
        self.hits += other.hits;
    }
}

fn churn(seed: u64, ticks: u32, seen: &mut Seen) {
    let mut churn = Churn::new(seed);
    let mut first = churn.world();
    let mut others = OTHERS.map(|variant| (variant, variant.begin(&first)));
    let mut open = Open::default();
    for tick in 0..ticks {
        for (variant, world) in &mut others {
            variant.perturb(world, &churn);
        }
        for command in churn.commands(&first) {
            execute_checked(&mut first, &command);
            others.iter_mut().for_each(|(variant, world)| variant.execute(world, &command));
        }
        let sleepers = |world: &World| world.bodies().filter(|(_, body)| body.is_asleep()).count();
        let before = sleepers(&first);
        first.step();
        assert_eq!(first.validate(), Ok(()), "seed {seed}, tick {tick}");
        for (variant, world) in &mut others {
            world.step();
            let differing = first.digest().differing(&world.digest());
            assert!(differing.is_empty(), "seed {seed}, tick {tick}, {variant:?}: {differing:?} differ");
            assert_eq!(first.events(), world.events(), "seed {seed}, tick {tick}, {variant:?}");
        }
        let events = first.events();
        open.follow(events);
        open.check(&first);
        seen.slept += events.moved.iter().filter(|event| event.fell_asleep).count();
        seen.woken += before.saturating_sub(sleepers(&first));
        seen.visits += events.sensor_begin.len();
        seen.contacts += events.contact_begin.len();
        seen.hits += events.hits.len();
    }
}

/// Runs all seeds, and returns the sum of the counts.
fn churn_each(seeds: Vec<u64>) -> Seen {
    let total = Mutex::new(Seen::default());
    sweep::for_each(seeds, |seed| {
        let mut seen = Seen::default();
        churn(seed, 300, &mut seen);
        total.lock().expect("no check holds the lock").add(&seen);
    });
    total.into_inner().expect("no check holds the lock")
}

/// Seeds 0 to 29, or a sample of them.
#[test]
fn nothing_that_is_done_to_the_caches_is_seen() {
    let seeds = sweep::sample(0..30, 4);
    let count = seeds.len();
    let Seen { slept, woken, visits, contacts, hits } = churn_each(seeds);
    // `least` is the count that 30 seeds must exceed.
    let enough = |happened: usize, least: usize| {
        assert!(
            happened * 30 > least * count,
            "{happened} with {count} seeds, at least {least} with 30 expected"
        );
    };
    enough(slept, 200);
    enough(woken, 60);
    enough(visits, 400);
    enough(contacts, 1500);
    enough(hits, 400);
}

/// A thousand other seeds, or those of the environment variable `SEEDS`: `SEEDS=1000..3000 cargo test --test world --
/// --ignored many`.
#[test]
#[ignore = "takes minutes: .ci/long"]
fn nothing_that_is_done_to_the_caches_is_seen_with_many_seeds() {
    let seeds = std::env::var("SEEDS").unwrap_or("1000..2000".into());
    let (from, to) = seeds.split_once("..").expect("from..to");
    let (from, to): (u64, u64) = (from.parse().expect("a number"), to.parse().expect("a number"));
    println!("{:?}", churn_each((from..to).collect()));
}
