//! A game for two players with bodies that come and go, a sensor, and bodies that fall asleep.

use lockstep2d::body::{BodyDef, BodyId, Geometry, Polygon, ShapeDef, WorldError};
use lockstep2d::hash::StateHash;
use lockstep2d::lockstep::{Game, RulesId, SetupError};
use lockstep2d::math::{Fx, Vec2};
use lockstep2d::world::{Snapshot, World};
use lockstep2d::{fx, math::fx_mul};
use serde::{Deserialize, Serialize};

pub const LEFT: u8 = 1;
pub const RIGHT: u8 = 2;
pub const JUMP: u8 = 4;
pub const SHOOT: u8 = 8;

/// Lifetime of a shot.
const SHOT_TICKS: u64 = 45;

#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Setup {
    pub boxes: u32,
}

#[derive(Clone, Debug)]
pub struct Arena {
    world: World,
    players: [BodyId; 2],
    /// Shots with the tick at which they disappear, oldest first.
    shots: Vec<(BodyId, u64)>,
}

#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Save {
    world: Snapshot,
    shots: Vec<(BodyId, u64)>,
}

impl Arena {
    fn build(setup: &Setup) -> Result<Self, WorldError> {
        let mut world = World::default();
        let solid = |x, y| Polygon::rectangle(x, y).map(ShapeDef::new);
        world.spawn(&BodyDef::fixed().position((fx!(0), fx!(-1))), &[solid(fx!(12), fx!(1))?])?;
        for x in [fx!(-12), fx!(12)] {
            world.spawn(&BodyDef::fixed().position((x, fx!(4))), &[solid(fx!(0.5), fx!(6))?])?;
        }
        let gate = ShapeDef::new(Polygon::square(fx!(1))?).sensor();
        world.spawn(&BodyDef::fixed().position((fx!(0), fx!(1))), &[gate])?;
        let ball = ShapeDef::new(Geometry::circle(fx!(0.5))?);
        let mut player = |x| world.spawn(&BodyDef::dynamic().position((x, fx!(0.6))).never_sleeps(), &[ball]);
        let players = [player(fx!(-4))?, player(fx!(4))?];
        for index in 0..setup.boxes.max(6) {
            let (column, row) = (Fx::from_num(index % 8), Fx::from_num(index / 8));
            let place = (fx_mul(column - fx!(3.5), fx!(1.1)), fx!(2) + row);
            world.spawn(&BodyDef::dynamic().position(place), &[solid(fx!(0.4), fx!(0.4))?])?;
        }
        Ok(Arena { world, players, shots: Vec::new() })
    }

    fn act(&mut self, player: usize, pad: u8) -> Result<(), WorldError> {
        let body = self.players[player];
        let Some(state) = self.world.body(body) else { return Ok(()) };
        let (place, mass) = (state.position(), state.mass());
        let way = [(LEFT, fx!(-20)), (RIGHT, fx!(20))].into_iter().filter(|(bit, _)| pad & bit != 0);
        let force = way.fold(fx!(0), |sum, (_, force)| sum + force);
        self.world.apply_force_to_centre(body, Vec2::new(fx_mul(force, mass), fx!(0)))?;
        if pad & JUMP != 0 && place.y < fx!(1) {
            self.world.apply_impulse_to_centre(body, Vec2::new(fx!(0), fx_mul(fx!(5), mass)))?;
        }
        if pad & SHOOT != 0 && self.shots.len() < 20 {
            let ahead = if pad & LEFT != 0 { fx!(-1) } else { fx!(1) };
            let def = BodyDef::dynamic()
                .position(place + Vec2::new(ahead, fx!(0.5)))
                .velocity((fx_mul(ahead, fx!(12)), fx!(2)))
                .user_data(player as u64 + 1);
            let shot = self.world.spawn(&def, &[ShapeDef::new(Geometry::circle(fx!(0.15))?)])?;
            self.shots.push((shot, self.world.tick() + SHOT_TICKS));
        }
        Ok(())
    }
}

impl Game for Arena {
    type Setup = Setup;
    type Input = u8;
    type Save = Save;

    const RULES: RulesId = RulesId { name: "arena", version: 1 };

    fn new(setup: &Setup) -> Result<Self, SetupError> {
        Self::build(setup).map_err(|error| SetupError { why: error.to_string() })
    }

    fn players(&self) -> u32 {
        2
    }

    fn tick_rate(&self) -> u32 {
        self.world.config().tick_rate
    }

    fn step(&mut self, inputs: &[u8]) {
        let now = self.world.tick();
        while let Some(&(shot, _)) = self.shots.first().filter(|(_, end)| *end <= now) {
            let _ = self.world.despawn(shot);
            self.shots.remove(0);
        }
        for (player, pad) in inputs.iter().take(2).enumerate() {
            let _ = self.act(player, *pad);
        }
        // The user data of a shot changes in every tick.
        for (shot, end) in &self.shots {
            let _ = self.world.set_user_data(*shot, end - now);
        }
        self.world.step();
    }

    fn state_hash(&self) -> StateHash {
        StateHash::of_digests([self.world.state_hash(), StateHash::of(&self.shots)])
    }

    fn save(&self) -> Save {
        Save { world: self.world.save(), shots: self.shots.clone() }
    }

    fn load(&mut self, save: &Save) {
        self.world.restore(&save.world);
        self.shots.clone_from(&save.shots);
    }

    fn work(&self, _: &[u8]) -> u64 {
        self.world.work(2, 2)
    }

    fn world(&self) -> Option<&World> {
        Some(&self.world)
    }
}

/// The buttons of a player in a tick. The direction changes every 15 ticks, and shots and jumps come now and then.
pub fn pad_at(seed: u64, tick: u64) -> u8 {
    let mix = |n: u64| {
        let n = n.wrapping_add(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        (n ^ n >> 31).wrapping_mul(0x94d0_49bb_1331_11eb) >> 40
    };
    let way = [0, LEFT, RIGHT, RIGHT][(mix(tick / 15) % 4) as usize];
    let shoot = if mix(tick ^ 0x5555) % 23 == 0 { SHOOT } else { 0 };
    let jump = if mix(tick ^ 0xaaaa) % 37 == 0 { JUMP } else { 0 };
    way | shoot | jump
}
