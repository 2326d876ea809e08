//! The game: two players push a ball, each towards the goal of the other.
//!
//! The rules are in `step`. They use fixed-point numbers (`Fx`), so that equal inputs give equal matches on every
//! machine.

use lockstep2d::body::{BodyDef, BodyId, Geometry, Name, Polygon, ShapeDef, WorldError};
use lockstep2d::fx;
use lockstep2d::hash::StateHash;
use lockstep2d::lockstep::{Game, RulesId, SetupError};
use lockstep2d::math::{Fx, Vec2};
use lockstep2d::world::{Config, Snapshot, World};
use serde::{Deserialize, Serialize};

/// Number of goals that wins the match.
const GOALS_TO_WIN: u32 = 5;
/// Half of the length and height of the field, in metres.
const FIELD: (Fx, Fx) = (fx!(8), fx!(4));
/// Driving force of a player, in N.
const FORCE: Fx = fx!(30);

/// The options of a match, from which the state before the first tick is built.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Setup {
    /// Goals of each player at the start.
    pub handicap: [u32; 2],
}

/// Input of a player for a tick: the direction of the force. Each component is -1, 0 or 1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Input {
    /// Positive to the right.
    pub x: i8,
    /// Positive upwards.
    pub y: i8,
}

/// A match.
pub struct MyGame {
    world: World,
    players: [BodyId; 2],
    ball: BodyId,
    rules: Rules,
}

/// The state that is not physics.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Rules {
    /// Goals of each player.
    pub goals: [u32; 2],
}

/// A copy of the state. It does not contain the handles of the bodies, because they never change.
#[derive(Clone, Serialize, Deserialize)]
pub struct Save {
    world: Snapshot,
    rules: Rules,
}

impl MyGame {
    fn build(setup: &Setup) -> Result<Self, WorldError> {
        let mut world = World::new(Config { gravity: Vec2::ZERO, ..Config::default() })?;
        let (length, height) = FIELD;
        for (x, y, half_x, half_y) in [
            (fx!(0), height, length, fx!(0.2)),
            (fx!(0), -height, length, fx!(0.2)),
            (length, fx!(0), fx!(0.2), height),
            (-length, fx!(0), fx!(0.2), height),
        ] {
            let wall = ShapeDef::new(Polygon::rectangle(half_x, half_y)?).restitution(fx!(0.8));
            world.spawn(&BodyDef::fixed().position((x, y)).name(Name::new("wall")?), &[wall])?;
        }
        let mut disc = |x: Fx, radius: Fx, name: &str| -> Result<BodyId, WorldError> {
            let def = BodyDef::dynamic().position((x, fx!(0))).linear_damping(fx!(1)).name(Name::new(name)?);
            world.spawn(&def, &[ShapeDef::new(Geometry::circle(radius)?).restitution(fx!(0.8))])
        };
        let players = [disc(fx!(-4), fx!(0.5), "left")?, disc(fx!(4), fx!(0.5), "right")?];
        let ball = disc(fx!(0), fx!(0.3), "ball")?;
        Ok(MyGame { world, players, ball, rules: Rules { goals: setup.handicap } })
    }

    /// The physics world.
    pub fn world(&self) -> &World {
        &self.world
    }

    /// The bodies of the two players.
    pub fn bodies(&self) -> [BodyId; 2] {
        self.players
    }

    /// The state that is not physics.
    pub fn rules(&self) -> &Rules {
        &self.rules
    }

    /// Whether a player has won. In a match with rollback, the last ticks are predictions, which may show a wrong
    /// winner: see `lockstep2d::peer::Peer::end_at`.
    pub fn is_over(&self) -> bool {
        self.rules.goals.iter().any(|&goals| goals >= GOALS_TO_WIN)
    }

    fn position(&self, id: BodyId) -> Vec2<Fx> {
        self.world.body(id).map_or(Vec2::ZERO, |body| body.position())
    }

    fn push(&mut self, inputs: &[Input]) -> Result<(), WorldError> {
        for (player, input) in self.players.into_iter().zip(inputs) {
            // A replay from an untrusted source may contain other values than -1, 0 and 1.
            let axis = |value: i8| FORCE * Fx::from(value.signum());
            self.world.apply_force_to_centre(player, Vec2::new(axis(input.x), axis(input.y)))?;
        }
        Ok(())
    }

    fn judge(&mut self) -> Result<(), WorldError> {
        let x = self.position(self.ball).x;
        let line = FIELD.0 - fx!(0.6);
        if x < line && x > -line {
            return Ok(());
        }
        let scorer = usize::from(x < Fx::ZERO);
        self.rules.goals[scorer] = self.rules.goals[scorer].saturating_add(1);
        self.world.set_transform(self.ball, Vec2::ZERO, Default::default())?;
        self.world.set_velocity(self.ball, Vec2::ZERO, fx!(0))
    }
}

impl Game for MyGame {
    type Setup = Setup;
    type Input = Input;
    type Save = Save;

    /// Raise the version when you change the rules so that the same inputs lead to other states.
    const RULES: RulesId = RulesId { name: "my game", version: 1 };

    fn new(setup: &Setup) -> Result<Self, SetupError> {
        MyGame::build(setup).map_err(|error| SetupError { why: error.to_string() })
    }

    fn players(&self) -> u32 {
        2
    }

    fn tick_rate(&self) -> u32 {
        self.world.config().tick_rate
    }

    fn step(&mut self, inputs: &[Input]) {
        let pushed = if self.is_over() { Ok(()) } else { self.push(inputs) };
        // The world advances in every tick, even if it has refused a force.
        self.world.step();
        let judged = self.judge();
        // An error is a defect of the rules, or comes from the state of an untrusted save. A release build ignores it
        // and continues, in the same way on every machine.
        if let Err(error) = pushed.and(judged) {
            debug_assert!(false, "tick {}: {error}", self.world.tick());
        }
    }

    fn state_hash(&self) -> StateHash {
        StateHash::of_digests([self.world.state_hash(), StateHash::of(&self.rules)])
    }

    fn save(&self) -> Save {
        Save { world: self.world.save(), rules: self.rules.clone() }
    }

    fn load(&mut self, save: &Save) {
        self.world.restore(&save.world);
        self.rules.clone_from(&save.rules);
    }

    fn work(&self, _: &[Input]) -> u64 {
        self.world.work(0, 0)
    }

    fn world(&self) -> Option<&World> {
        Some(&self.world)
    }

    fn world_mut(&mut self) -> Option<&mut World> {
        Some(&mut self.world)
    }

    fn claims(&self) -> Vec<(String, i64)> {
        let [left, right] = self.rules.goals;
        vec![("goals left".into(), left.into()), ("goals right".into(), right.into())]
    }
}
