//! One scene run in five ways that must not differ: as it is, through bytes, without caches, with another broad
//! phase, and rolled back.

use std::sync::atomic::{AtomicU64, Ordering};

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
}

/// The worlds that must stay equal.
struct Variants {
    plain: World,
    through_bytes: World,
    uncached: World,
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
    let mut variants = Variants { through_bytes: plain.clone(), uncached: plain.clone(), brute_force, plain };
    let mut generator = Generator::new(&mut source);
    let ticks = 30 + source.below(91);
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
        cost += generator::cost(&variants.plain);
        if cost > COST_MAX {
            break;
        }
    }
    seen.faults = variants.plain.faults();
    if let Some(rollback) = rollback {
        rollback.repeat(variants.plain);
    }
    seen
}

impl Variants {
    fn each(&mut self) -> [(&'static str, &mut World); 4] {
        [
            ("plain", &mut self.plain),
            ("through bytes", &mut self.through_bytes),
            ("uncached", &mut self.uncached),
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
            let before = self.plain.state_hash();
            let outcome = self.plain.execute(command);
            match &outcome {
                Ok(_) => seen.done += 1,
                Err(error) => {
                    seen.refused += 1;
                    assert_eq!(
                        self.plain.state_hash(),
                        before,
                        "refused ({error}), yet changed: {command:?}"
                    );
                }
            }
            check(&self.plain, command);
            for (name, world) in &mut self.each()[1..] {
                assert_eq!(world.execute(command), outcome, "{name}: {command:?}");
            }
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
    let Events { contact_begin, contact_end } = world.events();
    assert!(contact_begin.is_sorted() && contact_end.is_sorted(), "events are not sorted");
}

static RUNS: AtomicU64 = AtomicU64::new(0);
static TOUCHING: AtomicU64 = AtomicU64::new(0);
static TICKS: AtomicU64 = AtomicU64::new(0);
static FAULTY: AtomicU64 = AtomicU64::new(0);

/// Adds a run to the figures that are printed now and then when `FUZZ_FIGURES` is set.
pub fn count(seen: Seen) {
    let runs = RUNS.fetch_add(1, Ordering::Relaxed) + 1;
    let touching = TOUCHING.fetch_add(seen.touching, Ordering::Relaxed) + seen.touching;
    let ticks = TICKS.fetch_add(seen.ticks, Ordering::Relaxed) + seen.ticks;
    let faulty = FAULTY.fetch_add(u64::from(seen.faults > 0), Ordering::Relaxed);
    if runs.is_multiple_of(1000) && std::env::var_os("FUZZ_FIGURES").is_some() {
        eprintln!(
            "{runs} runs: {} ticks and {} touching contacts each, {faulty} with faults",
            ticks / runs,
            touching / runs
        );
    }
}
