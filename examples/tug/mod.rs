//! The game of several examples: two players push one ball. A replay claims the x coordinate of the ball at the end, in
//! whole metres.

use lockstep2d::body::{BodyDef, BodyId, Geometry, ShapeDef, WorldError};
use lockstep2d::fx;
use lockstep2d::hash::StateHash;
use lockstep2d::lockstep::{Game, RulesId, SetupError};
use lockstep2d::math::{Fx, Vec2};
use lockstep2d::world::{Config, Snapshot, World};

pub(crate) struct Tug {
    world: World,
    ball: BodyId,
}

impl Tug {
    fn build() -> Result<Self, WorldError> {
        let mut world = World::new(Config { gravity: Vec2::ZERO, ..Config::default() })?;
        let ball = ShapeDef::new(Geometry::circle(fx!(0.5))?);
        let ball = world.spawn(&BodyDef::dynamic().linear_damping(fx!(0.5)), &[ball])?;
        Ok(Tug { world, ball })
    }

    pub(crate) fn position(&self) -> Vec2<Fx> {
        self.world.body(self.ball).map_or(Vec2::ZERO, |body| body.position())
    }
}

impl Game for Tug {
    type Setup = ();
    /// Force to the right in N.
    type Input = i8;
    type Save = Snapshot;

    const RULES: RulesId = RulesId { name: "tug", version: 1 };

    fn new((): &()) -> Result<Self, SetupError> {
        Tug::build().map_err(|error| SetupError { why: error.to_string() })
    }

    fn players(&self) -> u32 {
        2
    }

    fn tick_rate(&self) -> u32 {
        60
    }

    fn step(&mut self, inputs: &[i8]) {
        let force = inputs.iter().map(|&push| Fx::from(push)).sum();
        // The ball always exists.
        let _ = self.world.apply_force(self.ball, Vec2::new(force, fx!(0)), self.position());
        self.world.step();
    }

    /// The hash of the world is sufficient, because the handle `ball` never changes.
    fn state_hash(&self) -> StateHash {
        self.world.state_hash()
    }

    fn save(&self) -> Snapshot {
        self.world.save()
    }

    fn load(&mut self, save: &Snapshot) {
        self.world.restore(save);
    }

    fn work(&self, _: &[i8]) -> u64 {
        1
    }

    fn claims(&self) -> Vec<(String, i64)> {
        vec![("metres".into(), self.position().x.to_num())]
    }
}
