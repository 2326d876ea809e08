//! Runs one scene in two worlds and checks that they never differ. The plain world is rolled back at most once. The
//! other world uses another broad phase, is reloaded from its own bytes between ticks, or loses its caches between
//! ticks.

use std::sync::Mutex;

use lockstep2d::collision::BroadPhaseKind;
use lockstep2d::hash::StateHash;
use lockstep2d::world::{Backend, BodyField, Command, Events, Snapshot, World};

use crate::generator::{self, Generator};
use crate::source::Source;

/// A run ends early when the sum of [`generator::cost`] over its ticks exceeds this number.
const COST_MAX: u64 = 60_000;
/// Maximum depth of the rollback, in ticks.
const ROLLBACK_MAX: usize = 30;
/// Interval of the invariant checks, in ticks. In small worlds, most of the time goes to these checks.
const CHECK_INTERVAL: u64 = 8;

/// Statistics of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Seen {
    /// Ticks simulated.
    pub ticks: u64,
    /// Number of touching contacts at the end of a tick, summed over the ticks.
    pub touching: u64,
    /// Maximum number of touching contacts at the end of a tick.
    pub most_touching: u64,
    /// Commands executed.
    pub done: u64,
    /// Commands refused.
    pub refused: u64,
    /// Number of [`faults`](World::faults).
    pub faults: u64,
    /// Bodies that fell asleep.
    pub slept: u64,
    /// Number of events that report a shape entering a sensor.
    pub noticed: u64,
    /// Number of hit events plus events that report a joint above its threshold of force or torque.
    pub hits: u64,
    /// Whether the scene is ordinary. Hardly any ordinary scene has faults (see [`crate::ordinary`]).
    pub ordinary: bool,
}

/// Configuration of the other world, which must not change any result. [`BroadPhaseKind::BruteForce`] also selects the
/// scalar backend, which uses no vector instructions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Variant {
    broad_phase: BroadPhaseKind,
    disturbance: Disturbance,
}

/// A disturbance of the other world between ticks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Disturbance {
    None,
    ThroughBytes,
    ClearedScratch,
}

const VARIANTS: [Variant; 8] = {
    use BroadPhaseKind::{BruteForce, SweepAndPrune, Tree};
    use Disturbance::{ClearedScratch, None, ThroughBytes};
    const fn variant(broad_phase: BroadPhaseKind, disturbance: Disturbance) -> Variant {
        Variant { broad_phase, disturbance }
    }
    [
        variant(Tree, ThroughBytes),
        variant(Tree, ClearedScratch),
        variant(SweepAndPrune, None),
        variant(BruteForce, None),
        variant(SweepAndPrune, ThroughBytes),
        variant(BruteForce, ThroughBytes),
        variant(SweepAndPrune, ClearedScratch),
        variant(BruteForce, ClearedScratch),
    ]
};

struct Variants {
    plain: World,
    variant: Variant,
    other: World,
}

/// Runs the scene that the bytes describe.
///
/// # Panics
/// When the worlds differ, an invariant is broken, or a refused command has changed the world.
pub fn run(bytes: &[u8]) -> Seen {
    play(bytes, |_| ())
}

/// Runs the scene like [`run`]. In addition, flips a bit of the eighth body of the other world before each tick, if
/// more than 12 contacts touch at that time.
///
/// # Panics
/// Like [`run`]. In particular, when the eighth body accepts a flip, because the worlds then differ.
pub fn run_with_a_fault(bytes: &[u8]) {
    play(bytes, |variants| {
        let touching = variants.plain.contacts().filter(|contact| contact.touching).count();
        let other = &mut variants.other;
        let bodies: Vec<_> = other.bodies().map(|(id, _)| id).collect();
        if touching > 12
            && let Some(&body) = bodies.get(7)
        {
            // The flip is refused if the body is asleep, disabled, locked or not dynamic.
            let _ = other.flip_bit(body, BodyField::ALL[0], 0);
        }
    });
}

fn play(bytes: &[u8], mut meddle: impl FnMut(&mut Variants)) -> Seen {
    let mut source = Source::new(bytes);
    let config = generator::config(&mut source);
    let plain = World::new(config).unwrap_or_default();
    let variant = source.pick(&VARIANTS);
    let mut variants = Variants { other: variant.begin(&plain), variant, plain };
    let mut generator = Generator::new(&mut source);
    let ticks = source.pick(&[60, 60, 60, 60, 60, 60, 60, 120]);
    let rollback_at = source.below(ticks);
    let depth = 1 + source.below(ROLLBACK_MAX);
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
        variants.variant.perturb(&mut source, &mut variants.other);
        variants.execute(&commands, &mut seen);
        meddle(&mut variants);
        let hash = variants.step();
        if let Some(rollback) = &mut rollback {
            rollback.ticks.push((commands, hash, variants.plain.events().clone()));
        }
        if let Some(due) = rollback.take_if(|rollback| rollback.ticks.len() == depth) {
            due.repeat(&mut variants.plain);
        }
        seen.see(&variants.plain);
        cost += generator::cost(&variants.plain);
        if cost > COST_MAX {
            break;
        }
    }
    check(&variants.plain, &"the last tick");
    seen.faults = variants.plain.faults();
    seen.ordinary = source.is_ordinary();
    if let Some(rollback) = rollback {
        rollback.repeat(&mut variants.plain);
    }
    seen
}

impl Seen {
    fn see(&mut self, world: &World) {
        let touching = world.contacts().filter(|contact| contact.touching).count() as u64;
        let events = world.events();
        self.ticks += 1;
        self.touching += touching;
        self.most_touching = self.most_touching.max(touching);
        self.slept += events.moved.iter().filter(|event| event.fell_asleep).count() as u64;
        self.noticed += events.sensor_begin.len() as u64;
        self.hits += (events.hits.len() + events.joints.len()) as u64;
    }

    /// Whether the run has 60 ticks or more, and ten or more touching contacts at one time.
    #[must_use]
    pub fn is_full(&self) -> bool {
        self.ticks >= 60 && self.most_touching >= 10
    }
}

impl Variant {
    fn begin(self, plain: &World) -> World {
        let mut world = plain.clone();
        world.set_broad_phase(self.broad_phase);
        if self.broad_phase == BroadPhaseKind::BruteForce {
            world.set_backend(Backend::Scalar);
        }
        world
    }

    fn perturb(self, source: &mut Source<'_>, world: &mut World) {
        match self.disturbance {
            Disturbance::ThroughBytes if source.below(4) == 0 => {
                *world = self.begin(&World::from_bytes(&world.to_bytes()).expect("a world's own bytes"));
            }
            Disturbance::ClearedScratch if source.below(2) == 0 => world.clear_scratch(),
            _ => {}
        }
    }
}

impl Variants {
    fn execute(&mut self, commands: &[Command], seen: &mut Seen) {
        let Variants { plain, variant, other } = self;
        for command in commands {
            let outcome = plain.execute(command);
            match &outcome {
                Ok(_) => seen.done += 1,
                Err(error) => {
                    seen.refused += 1;
                    // The other world has not executed this command yet, so it still has the state before the command.
                    let changed = plain.digest().differing(&other.digest());
                    assert!(
                        changed.is_empty(),
                        "a refused command ({error}) changed {changed:?}: {command:?}"
                    );
                }
            }
            assert_eq!(other.execute(command), outcome, "{variant:?}: {command:?}");
        }
        if !commands.is_empty() {
            check(plain, &commands);
        }
    }

    fn step(&mut self) -> StateHash {
        let Variants { plain, variant, other } = self;
        plain.step();
        other.step();
        let digest = plain.digest();
        let differing = other.digest().differing(&digest);
        assert!(differing.is_empty(), "{variant:?}, tick {}: {differing:?}", plain.tick());
        assert_eq!(other.events(), plain.events(), "{variant:?}, tick {}: events", plain.tick());
        if plain.tick().is_multiple_of(CHECK_INTERVAL) {
            check(plain, &"a tick");
        }
        digest.state_hash()
    }
}

struct Rollback {
    save: Snapshot,
    ticks: Vec<(Vec<Command>, StateHash, Events)>,
}

impl Rollback {
    /// Restores the saved state and plays the ticks again, with the same hashes and events. The caches are not
    /// restored: the world keeps those of a later tick.
    fn repeat(self, world: &mut World) {
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

fn check(world: &World, after: &dyn std::fmt::Debug) {
    if let Err(violation) = world.validate() {
        panic!("{violation}, after {after:?}");
    }
    let pairs: Vec<_> =
        world.contacts().map(|contact| (contact.shape_a.index(), contact.shape_b.index())).collect();
    assert!(pairs.is_sorted_by(|a, b| a < b), "contacts are not sorted");
    assert!(pairs.iter().all(|(a, b)| a < b), "the shapes of a contact are not in ascending order");
    let events = world.events();
    let sorted = events.contact_begin.is_sorted() && events.contact_end.is_sorted();
    assert!(sorted, "contact events are not sorted");
    let sorted = events.sensor_begin.is_sorted() && events.sensor_end.is_sorted();
    assert!(sorted, "sensor events are not sorted");
    assert!(events.moved.is_sorted_by_key(|event| event.body.index()), "movements are not sorted");
    assert!(events.joints.is_sorted_by_key(|event| event.joint.index()), "joint events are not sorted");
}

static TOTAL: Mutex<Total> =
    Mutex::new(Total { runs: 0, long: 0, full: 0, touching: 0, ticks: 0, ordinary: 0, faulty: [0; 2] });

struct Total {
    runs: u64,
    /// Runs of 60 ticks or more.
    long: u64,
    /// Long runs with ten or more touching contacts at one time.
    full: u64,
    touching: u64,
    ticks: u64,
    ordinary: u64,
    /// Number of runs with faults: index 0 counts scenes that are not ordinary, index 1 ordinary scenes.
    faulty: [u64; 2],
}

/// Adds a run to the statistics. If the environment variable `FUZZ_FIGURES` is set, prints them every 100 runs.
pub fn count(seen: Seen) {
    let Ok(mut total) = TOTAL.lock() else { return };
    total.runs += 1;
    total.long += u64::from(seen.ticks >= 60);
    total.full += u64::from(seen.is_full());
    total.touching += seen.touching;
    total.ticks += seen.ticks;
    total.ordinary += u64::from(seen.ordinary);
    total.faulty[usize::from(seen.ordinary)] += u64::from(seen.faults > 0);
    let Total { runs, long, full, touching, ticks, ordinary, faulty } = &*total;
    if runs.is_multiple_of(100) && std::env::var_os("FUZZ_FIGURES").is_some() {
        eprintln!(
            "{runs} runs, {long} of 60 ticks or more, {full} of them with 10 touching contacts or more: {} ticks and {} touching contacts each; {} of {ordinary} ordinary and {} of {} wild ones with faults",
            ticks / runs,
            touching / runs,
            faulty[1],
            faulty[0],
            runs - ordinary
        );
    }
}
