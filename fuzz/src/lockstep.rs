//! One scene run in six ways that must not differ: as it is, through bytes, without caches, with the other broad
//! phases, and rolled back.

use std::sync::Mutex;

use lockstep2d::collision::BroadPhaseKind;
use lockstep2d::hash::StateHash;
use lockstep2d::world::{Command, Events, Snapshot, World};

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

/// The worlds that must stay equal.
struct Variants {
    plain: World,
    through_bytes: World,
    uncached: World,
    sweep_and_prune: World,
    brute_force: World,
}

/// Runs the scene that the bytes describe.
///
/// # Panics
/// When the variants differ, an invariant breaks, or a refused command has changed something.
pub fn run(bytes: &[u8]) -> Seen {
    let mut source = Source::new(bytes);
    let config = generator::config(&mut source);
    let plain = World::new(config).unwrap_or_default();
    let mut brute_force = plain.clone();
    brute_force.set_broad_phase(BroadPhaseKind::BruteForce);
    let mut sweep_and_prune = plain.clone();
    sweep_and_prune.set_broad_phase(BroadPhaseKind::SweepAndPrune);
    let (through_bytes, uncached) = (plain.clone(), plain.clone());
    let mut variants = Variants { plain, through_bytes, uncached, sweep_and_prune, brute_force };
    let mut generator = Generator::new(&mut source);
    let ticks = 60 + source.below(61);
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
        let hash = variants.step();
        if let Some(rollback) = &mut rollback {
            rollback.ticks.push((commands, hash, variants.plain.events().clone()));
        }
        seen.ticks += 1;
        seen.touching += variants.plain.contacts().filter(|contact| contact.touching).count() as u64;
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

impl Variants {
    fn each(&mut self) -> [(&'static str, &mut World); 5] {
        [
            ("plain", &mut self.plain),
            ("through bytes", &mut self.through_bytes),
            ("uncached", &mut self.uncached),
            ("sweep and prune", &mut self.sweep_and_prune),
            ("brute force", &mut self.brute_force),
        ]
    }

    /// What must not make a difference.
    fn disturb(&mut self, source: &mut Source<'_>) {
        if source.below(4) == 0 {
            let bytes = self.through_bytes.to_bytes();
            self.through_bytes = World::from_bytes(&bytes).expect("a world's own bytes");
        }
        if source.below(2) == 0 {
            self.uncached.clear_scratch();
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
                    let changed = self.plain.digest().differing(&self.brute_force.digest());
                    assert!(changed.is_empty(), "refused ({error}), yet changed {changed:?}: {command:?}");
                }
            }
            for (name, world) in &mut self.each()[1..] {
                assert_eq!(world.execute(command), outcome, "{name}: {command:?}");
            }
        }
        if !commands.is_empty() {
            check(&self.plain, &commands);
        }
    }

    fn step(&mut self) -> StateHash {
        for (_, world) in self.each() {
            world.step();
        }
        let digest = self.plain.digest();
        let events = self.plain.events().clone();
        check(&self.plain, &"a tick");
        for (name, world) in &mut self.each()[1..] {
            let differing = world.digest().differing(&digest);
            assert!(differing.is_empty(), "{name}, tick {}: {differing:?}", world.tick());
            assert_eq!(world.events(), &events, "{name}, tick {}: events", world.tick());
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
    Mutex::new(Total { runs: 0, long: 0, touching: 0, ticks: 0, calm: 0, faulty: [0; 2] });

/// Sums over the runs of a process.
struct Total {
    runs: u64,
    /// Runs of 60 ticks or more.
    long: u64,
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
    total.touching += seen.touching;
    total.ticks += seen.ticks;
    total.calm += u64::from(seen.calm);
    total.faulty[usize::from(seen.calm)] += u64::from(seen.faults > 0);
    let Total { runs, long, touching, ticks, calm, faulty } = &*total;
    if runs.is_multiple_of(1000) && std::env::var_os("FUZZ_FIGURES").is_some() {
        eprintln!(
            "{runs} runs, {long} of 60 ticks or more: {} ticks and {} touching contacts each; {} of {calm} calm and {} of {} wild ones with faults",
            ticks / runs,
            touching / runs,
            faulty[1],
            faulty[0],
            runs - calm
        );
    }
}
