//! Two players push each other off a platform: the game of the example `versus` and of the page in `crates/bevy/web`.

use bevy::prelude::*;
use bevy_lockstep2d::prelude::*;
use lockstep2d::body::{BodyDef, BodyId, Geometry, Polygon, ShapeDef, WorldError};
use lockstep2d::fx;
use lockstep2d::hash::StateHash;
use lockstep2d::lockstep::{Game, RulesId, SetupError};
use lockstep2d::math::{Fx, Vec2 as FixedVec2, fx_mul};
use lockstep2d::world::{Snapshot, World as Physics};

/// The game. The input of a player is a direction: -1, 0 or 1.
pub struct Versus {
    world: Physics,
    players: [BodyId; 2],
}

impl Versus {
    fn build() -> Result<Self, WorldError> {
        let mut world = Physics::default();
        let plate = ShapeDef::new(Polygon::rectangle(fx!(6), fx!(0.5))?);
        world.spawn(&BodyDef::fixed().position((fx!(0), fx!(-0.5))), &[plate])?;
        let ball = ShapeDef::new(Geometry::circle(fx!(0.6))?);
        let mut player = |x| world.spawn(&BodyDef::dynamic().position((x, fx!(0.7))).never_sleeps(), &[ball]);
        let players = [player(fx!(-3))?, player(fx!(3))?];
        Ok(Versus { world, players })
    }

    fn push(&mut self, player: BodyId, pad: i8) -> Result<(), WorldError> {
        let Some(body) = self.world.body(player) else { return Ok(()) };
        if body.position().y < fx!(-8) {
            self.world.set_velocity(player, FixedVec2::ZERO, fx!(0))?;
            return self.world.set_transform(player, FixedVec2::new(fx!(0), fx!(5)), Default::default());
        }
        let force = fx_mul(Fx::from_num(pad.clamp(-1, 1)) * 15, body.mass());
        self.world.apply_force_to_centre(player, FixedVec2::new(force, fx!(0)))
    }
}

impl Game for Versus {
    type Setup = ();
    type Input = i8;
    type Save = Snapshot;
    const RULES: RulesId = RulesId { name: "versus", version: 1 };

    fn new((): &()) -> Result<Self, SetupError> {
        Self::build().map_err(|error| SetupError { why: error.to_string() })
    }
    fn players(&self) -> u32 {
        2
    }
    fn tick_rate(&self) -> u32 {
        self.world.config().tick_rate
    }
    fn step(&mut self, inputs: &[i8]) {
        for (player, pad) in self.players.into_iter().zip(inputs) {
            // A push that the world refuses has no effect.
            let _ = self.push(player, *pad);
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
        self.world.restore(save);
    }
    fn work(&self, _: &[i8]) -> u64 {
        self.world.work(0, 0)
    }
    fn world(&self) -> Option<&Physics> {
        Some(&self.world)
    }
    fn world_mut(&mut self) -> Option<&mut Physics> {
        Some(&mut self.world)
    }
}

/// The input of a bot.
pub const fn bot_pad(tick: u64) -> i8 {
    if tick % 90 < 50 { -1 } else { 1 }
}

/// Reads the arrow keys for the first player of this machine.
pub fn press(keys: Res<ButtonInput<KeyCode>>, mut inputs: ResMut<Inputs<Versus>>) {
    let pressed = |key| i8::from(keys.pressed(key));
    *inputs.held(0) = pressed(KeyCode::ArrowRight) - pressed(KeyCode::ArrowLeft);
}
