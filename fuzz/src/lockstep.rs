//! One scene run in ways that must not differ: as it is, rolled back, and in two of four others: through bytes,
//! without caches, with another broad phase.

use std::sync::Mutex;

use lockstep2d::collision::BroadPhaseKind;
use lockstep2d::hash::StateHash;
use lockstep2d::world::{Command, Events, Motion, Snapshot, World};

use crate::generator::{self, Generator};
use crate::source::Source;

/// Most work of a run, as [`generator::cost`] counts it.
const COST_MAX: u64 = 150_000;

/// What a run has seen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Seen {
    /// Ticks simulated.
    pub ticks: u64,
    /// Touching contacts, summed over the ticks.
    pub touching: u64,
    /// Most touching contacts at the end of a tick.
    pub most_touching: u64,
    /// Commands carried out.
    pub done: u64,
    /// Commands refused.
    pub refused: u64,
    /// Clamps of the solver.
    pub faults: u64,
    /// Bodies that fell asleep.
    pub slept: u64,
    /// Shapes that sensors noticed.
    pub noticed: u64,
    /// Hits, and joints above their threshold.
    pub hits: u64,
    /// Whether the scene is an ordinary one, which should have none.
    pub calm: bool,
}

/// A way of running that must make no difference.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Way {
    ThroughBytes,
    Uncached,
    SweepAndPrune,
    BruteForce,
}

/// Two ways each: more of them in one run only make it slower.
const WAYS: [[Way; 2]; 6] = {
    use Way::{BruteForce, SweepAndPrune, ThroughBytes, Uncached};
    [
        [ThroughBytes, BruteForce],
        [Uncached, SweepAndPrune],
        [ThroughBytes, SweepAndPrune],
        [Uncached, BruteForce],
        [ThroughBytes, Uncached],
        [SweepAndPrune, BruteForce],
    ]
};

/// The worlds that must stay equal.
struct Variants {
    plain: World,
    others: [(Way, World); 2],
}

/// Runs the scene that the bytes describe.
///
/// # Panics
/// When the variants differ, an invariant breaks, or a refused command has changed something.
pub fn run(bytes: &[u8]) -> Seen {
    play(bytes, |_| ())
}

/// The same, with a fault that the comparison has to find: in a crowd, a bit of one body of one world flips.
///
/// # Panics
/// Always, if the scene has a crowd.
pub fn run_with_a_fault(bytes: &[u8]) {
    play(bytes, |variants| {
        let touching = variants.plain.contacts().filter(|contact| contact.touching).count();
        let (_, other) = &mut variants.others[1];
        let bodies: Vec<_> = other.bodies().map(|(id, _)| id).collect();
        if touching > 12
            && let Some(&body) = bodies.get(7)
        {
            // Refused while the body sleeps.
            let _ = other.flip_bit(body, Motion::ALL[0], 0);
        }
    });
}

fn play(bytes: &[u8], mut meddle: impl FnMut(&mut Variants)) -> Seen {
    let mut source = Source::new(bytes);
    let config = generator::config(&mut source);
    let plain = World::new(config).unwrap_or_default();
    let others = source.pick(&WAYS).map(|way| (way, way.begin(&plain)));
    let mut variants = Variants { plain, others };
    let mut generator = Generator::new(&mut source);
    let ticks = source.pick(&[60, 60, 60, 120]);
    let rollback_at = source.below(ticks);
    let mut seen = Seen::default();
    let mut cost = 0;
    let mut rollback: Option<Rollback> = None;
    for tick in 0..ticks {
        let commands = if tick == 0 {
            generator.setup(&mut source)
        } else {
            generator.tick(&mut source, &variants.plain)
        };
        if tick == rollback_at {
            rollback = Some(Rollback { save: variants.plain.save(), ticks: Vec::new() });
        }
        variants.disturb(&mut source);
        variants.execute(&commands, &mut seen);
        meddle(&mut variants);
        let hash = variants.step();
        if let Some(rollback) = &mut rollback {
            rollback.ticks.push((commands, hash, variants.plain.events().clone()));
        }
        seen.ticks += 1;
        let touching = variants.plain.contacts().filter(|contact| contact.touching).count() as u64;
        seen.touching += touching;
        seen.most_touching = seen.most_touching.max(touching);
        let events = variants.plain.events();
        seen.slept += events.moved.iter().filter(|event| event.fell_asleep).count() as u64;
        seen.noticed += events.sensor_begin.len() as u64;
        seen.hits += (events.hits.len() + events.joints.len()) as u64;
        cost += generator::cost(&variants.plain);
        if cost > COST_MAX {
            break;
        }
    }
    seen.faults = variants.plain.faults();
    seen.calm = source.is_calm();
    if let Some(rollback) = rollback {
        rollback.repeat(variants.plain);
    }
    seen
}

impl Way {
    fn begin(self, plain: &World) -> World {
        let mut world = plain.clone();
        match self {
            Way::SweepAndPrune => world.set_broad_phase(BroadPhaseKind::SweepAndPrune),
            Way::BruteForce => world.set_broad_phase(BroadPhaseKind::BruteForce),
            Way::ThroughBytes | Way::Uncached => {}
        }
        world
    }

    /// What must not make a difference.
    fn disturb(self, source: &mut Source<'_>, world: &mut World) {
        match self {
            Way::ThroughBytes if source.below(4) == 0 => {
                *world = World::from_bytes(&world.to_bytes()).expect("a world's own bytes");
            }
            Way::Uncached if source.below(2) == 0 => world.clear_scratch(),
            _ => {}
        }
    }
}

impl Variants {
    fn disturb(&mut self, source: &mut Source<'_>) {
        for (way, world) in &mut self.others {
            way.disturb(source, world);
        }
    }

    fn execute(&mut self, commands: &[Command], seen: &mut Seen) {
        for command in commands {
            let outcome = self.plain.execute(command);
            match &outcome {
                Ok(_) => seen.done += 1,
                Err(error) => {
                    seen.refused += 1;
                    // The others have not seen the command yet.
                    let changed = self.plain.digest().differing(&self.others[0].1.digest());
                    assert!(changed.is_empty(), "refused ({error}), yet changed {changed:?}: {command:?}");
                }
            }
            for (way, world) in &mut self.others {
                assert_eq!(world.execute(command), outcome, "{way:?}: {command:?}");
            }
        }
        if !commands.is_empty() {
            check(&self.plain, &commands);
        }
    }

    fn step(&mut self) -> StateHash {
        self.plain.step();
        let digest = self.plain.digest();
        let events = self.plain.events().clone();
        check(&self.plain, &"a tick");
        for (way, world) in &mut self.others {
            world.step();
            let differing = world.digest().differing(&digest);
            assert!(differing.is_empty(), "{way:?}, tick {}: {differing:?}", world.tick());
            assert_eq!(world.events(), &events, "{way:?}, tick {}: events", world.tick());
        }
        digest.state_hash()
    }
}

/// A state, and what followed it.
struct Rollback {
    save: Snapshot,
    ticks: Vec<(Vec<Command>, StateHash, Events)>,
}

impl Rollback {
    /// Returns to the state, in a world whose caches are those of the end, and plays the same again.
    fn repeat(self, mut world: World) {
        world.restore(&self.save);
        for (commands, hash, events) in &self.ticks {
            for command in commands {
                let _ = world.execute(command);
            }
            world.step();
            assert_eq!(world.state_hash(), *hash, "rolled back, tick {}", world.tick());
            assert_eq!(world.events(), events, "rolled back, tick {}: events", world.tick());
        }
    }
}

/// Holds a world to its invariants.
fn check(world: &World, after: &dyn std::fmt::Debug) {
    if let Err(violation) = world.validate() {
        panic!("{violation}, after {after:?}");
    }
    let pairs: Vec<_> =
        world.contacts().map(|contact| (contact.shape_a.index(), contact.shape_b.index())).collect();
    assert!(pairs.is_sorted_by(|a, b| a < b), "contacts are not sorted");
    assert!(pairs.iter().all(|(a, b)| a < b), "a contact is the wrong way round");
    let events = world.events();
    let sorted = events.contact_begin.is_sorted() && events.contact_end.is_sorted();
    assert!(sorted, "contact events are not sorted");
    let sorted = events.sensor_begin.is_sorted() && events.sensor_end.is_sorted();
    assert!(sorted, "sensor events are not sorted");
    assert!(events.moved.is_sorted_by_key(|event| event.body.index()), "movements are not sorted");
    assert!(events.joints.is_sorted_by_key(|event| event.joint.index()), "joint events are not sorted");
}

static TOTAL: Mutex<Total> =
    Mutex::new(Total { runs: 0, long: 0, full: 0, touching: 0, ticks: 0, calm: 0, faulty: [0; 2] });

/// Sums over the runs of a process.
struct Total {
    runs: u64,
    /// Runs of 60 ticks or more.
    long: u64,
    /// Those of them with ten or more contacts that touch at one time.
    full: u64,
    touching: u64,
    ticks: u64,
    calm: u64,
    /// Runs with faults: wild ones, calm ones.
    faulty: [u64; 2],
}

/// Adds a run to the figures that are printed now and then when `FUZZ_FIGURES` is set.
pub fn count(seen: Seen) {
    let Ok(mut total) = TOTAL.lock() else { return };
    total.runs += 1;
    total.long += u64::from(seen.ticks >= 60);
    total.full += u64::from(seen.ticks >= 60 && seen.most_touching >= 10);
    total.touching += seen.touching;
    total.ticks += seen.ticks;
    total.calm += u64::from(seen.calm);
    total.faulty[usize::from(seen.calm)] += u64::from(seen.faults > 0);
    let Total { runs, long, full, touching, ticks, calm, faulty } = &*total;
    if runs.is_multiple_of(100) && std::env::var_os("FUZZ_FIGURES").is_some() {
        eprintln!(
            "{runs} runs, {long} of 60 ticks or more, {full} of them with 10 touching contacts or more: {} ticks and {} touching contacts each; {} of {calm} calm and {} of {} wild ones with faults",
            ticks / runs,
            touching / runs,
            faulty[1],
            faulty[0],
            runs - calm
        );
    }
}
