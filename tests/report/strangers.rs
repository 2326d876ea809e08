//! Untrusted files: the work of a search is limited, and games of different setups are played separately.

use std::cell::Cell;

use lockstep2d::body::{BodyDef, BodyId, Geometry, ShapeDef, WorldError};
use lockstep2d::fx;
use lockstep2d::hash::StateHash;
use lockstep2d::lockstep::{Game, History, RulesId, SetupError, StartError};
use lockstep2d::math::{Fx, Vec2};
use lockstep2d::replay::{Limits, RawReplay, Recorder, Recording};
use lockstep2d::report::{Comparison, Desync, DesyncReport, Evidence, Stage, bisect};
use lockstep2d::world::{Config, Explosion, Snapshot, World};
use serde::{Deserialize, Serialize};

thread_local! {
    static LOADS: Cell<u64> = const { Cell::new(0) };
}

/// The setup, which is not part of the state.
#[derive(Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
struct Rules {
    players: u32,
    /// The tick in which the first ball is kicked.
    kick: u64,
    /// Work units that the creation of the game reports.
    work: u64,
}

const PLAIN: Rules = Rules { players: 2, kick: u64::MAX, work: 0 };

/// Balls that do not touch. An input is a number of explosions that reach all of them.
struct Field {
    world: World,
    first: BodyId,
    rules: Rules,
}

impl Field {
    fn build(rules: Rules) -> Result<Self, WorldError> {
        let mut world = World::new(Config { gravity: Vec2::ZERO, ..Config::default() })?;
        let ball = ShapeDef::new(Geometry::circle(fx!(0.4))?);
        let mut bodies = Vec::new();
        for at in 0..40 {
            let body = BodyDef::dynamic().position((Fx::from_num(at) * 2, fx!(0)));
            bodies.push(world.spawn(&body, &[ball])?);
        }
        Ok(Field { world, first: bodies[0], rules })
    }
}

impl Game for Field {
    type Setup = Rules;
    type Input = u16;
    type Save = Snapshot;

    const RULES: RulesId = RulesId { name: "field", version: 1 };

    fn new(rules: &Rules) -> Result<Self, SetupError> {
        Field::build(*rules).map_err(|error| SetupError { why: error.to_string() })
    }

    fn new_within(rules: &Rules, _: u64) -> Result<(Self, u64), StartError> {
        Self::new(rules).map(|game| (game, rules.work)).map_err(StartError::Refused)
    }

    fn players(&self) -> u32 {
        self.rules.players
    }

    fn tick_rate(&self) -> u32 {
        60
    }

    fn step(&mut self, inputs: &[u16]) {
        assert_eq!(inputs.len(), self.rules.players as usize, "one input for each player");
        if self.world.tick() == self.rules.kick {
            let _ = self.world.set_velocity(self.first, Vec2::new(fx!(0), fx!(3)), fx!(0));
        }
        let far = Explosion { radius: fx!(1000), ..Explosion::new(Vec2::new(fx!(0), fx!(-50)), fx!(0.01)) };
        for _ in 0..inputs[0] {
            let _ = self.world.explode(&far);
        }
        self.world.step();
    }

    fn state_hash(&self) -> StateHash {
        self.world.state_hash()
    }

    fn save(&self) -> Snapshot {
        self.world.save()
    }

    fn load(&mut self, save: &Snapshot) {
        LOADS.set(LOADS.get() + 1);
        self.world.restore(save);
    }

    fn work(&self, _: &[u16]) -> u64 {
        self.world.work(0, 0)
    }

    fn world_mut(&mut self) -> Option<&mut World> {
        Some(&mut self.world)
    }
}

/// Bisects an untrusted report whose last hash belongs to no state. Returns the numbers of loads and of work units.
fn search(rules: Rules, inputs_at: impl Fn(u64) -> [u16; 2]) -> (u64, u64) {
    let (mut recorder, mut game) = Recorder::<Field>::start(&rules, 60).unwrap();
    let mut history = History::<Field>::of_ticks(20);
    for tick in 1..=10 {
        game.step(recorder.record(&inputs_at(tick)).unwrap());
        let hash = if tick == 10 { StateHash(7) } else { game.state_hash() };
        history.push(tick, game.save(), hash);
    }
    let replay = recorder.so_far(game.state_hash());
    let found = Desync { players: 2, tick: 10, known: 10, seats: Vec::new(), hashes: Vec::new() };
    let report = DesyncReport::new(&found, &history, replay.clone());
    let evidence = Evidence::read(report.to_bytes(), &Limits::default()).unwrap();
    LOADS.set(0);
    let found = bisect::<Field>(&evidence, None, &Limits::default()).unwrap();
    assert_eq!((found.first_different, found.explanation), (Some(10), None));
    let mut raw = RawReplay::<Field>::open(&replay, &Limits::default()).unwrap();
    (0..10).for_each(|_| assert!(raw.step().is_ok()));
    (LOADS.get(), raw.work() - rules.work)
}

/// The rerun of the 10 ticks and the search may together cost as much as 25 ticks (two and a half times the replay: see
/// `Effort::Bounded`), so 15 ticks are left for the search. A load is charged as half a tick. The tick after a load costs
/// up to three times as much as other ticks, because the broad phase searches all pairs again.
#[test]
fn work_within_a_step_is_charged_to_the_search() {
    let (loads, work) = search(PLAIN, |_| [0, 0]);
    assert!((5..40).contains(&loads), "{loads} loads for {work} units");
    // The world counts the work of explosions only within the step.
    let (loads, with_explosions) = search(PLAIN, |tick| if tick == 10 { [5000, 0] } else { [0, 0] });
    assert!(with_explosions > 10 * work, "{with_explosions} units instead of {work}");
    assert!(loads <= 5, "{loads} loads for {with_explosions} units");
}

#[test]
fn the_work_of_a_setup_is_no_budget_for_the_search() {
    let (loads, _) = search(PLAIN, |_| [0, 0]);
    assert_eq!(search(Rules { work: 50_000_000, ..PLAIN }, |_| [0, 0]).0, loads);
}

fn recorded(rules: Rules) -> Evidence {
    let mut recording = Recording::<Field>::start(&rules, 5).unwrap();
    let inputs = vec![0; rules.players as usize];
    (0..20).for_each(|_| recording.step(&inputs).unwrap());
    Evidence::read(recording.finish().unwrap(), &Limits::default()).unwrap()
}

fn compared(a: Rules, b: Rules) -> Comparison {
    bisect::<Field>(&recorded(a), Some(&recorded(b)), &Limits::default()).unwrap()
}

/// Games with different setups or numbers of players may reach different states from the same start and inputs.
#[test]
fn games_of_different_setups_are_both_simulated() {
    for players in [2, 3] {
        let other = Rules { kick: 7, players, ..PLAIN };
        let found = compared(Rules { kick: 12, ..PLAIN }, other);
        assert_eq!((found.last_equal, found.first_different), (Some(7), Some(8)), "{found:?}");
        assert_eq!(found.stage, Some(Stage::BeforeStep), "{found:?}");
        assert!(found.subjects[0].path.ends_with("body 0v0"), "{found:?}");
        let found = compared(PLAIN, Rules { work: 1, players, ..PLAIN });
        assert_eq!((found.last_equal, found.first_different), (Some(20), None), "{found:?}");
    }
}
