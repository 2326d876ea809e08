//! Discs in a box, each pushed by the player of a seat.

use std::cell::Cell;

use lockstep2d::body::{BodyDef, BodyId, Geometry, Polygon, ShapeDef, WorldError};
use lockstep2d::fx;
use lockstep2d::hash::StateHash;
use lockstep2d::lockstep::{Game, RulesId, SetupError};
use lockstep2d::math::{Fx, Rng, Vec2};
use lockstep2d::world::{BodyField, Config, Snapshot, World};
use serde::{Deserialize, Serialize};

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Setup {
    pub(crate) players: u32,
    pub(crate) tick_rate: u32,
    pub(crate) seed: u64,
}

impl Default for Setup {
    fn default() -> Self {
        Setup { players: 4, tick_rate: 60, seed: 1 }
    }
}

pub(crate) struct Pushers {
    world: World,
    discs: Vec<BodyId>,
    tick_rate: u32,
    fault: Option<Fault>,
}

/// A planted fault: a bit of a disc's state flips whenever the game has just simulated its `tick`th tick.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Fault {
    pub(crate) tick: u64,
    pub(crate) disc: usize,
    pub(crate) field: BodyField,
    pub(crate) bit: u32,
}

thread_local! {
    /// The fault of the next game that this thread builds.
    pub(crate) static FAULT: Cell<Option<Fault>> = const { Cell::new(None) };
}

/// Input of a seat without a player.
pub(crate) const EMPTY: u8 = 1 << 7;

impl Pushers {
    fn build(setup: &Setup) -> Result<Self, WorldError> {
        let mut world = World::new(Config { gravity: Vec2::ZERO, ..Config::default() })?;
        for (x, y, half_x, half_y) in [(0, 6, 7, 1), (0, -6, 7, 1), (6, 0, 1, 7), (-6, 0, 1, 7)] {
            let wall = Polygon::rectangle(Fx::from_num(half_x), Fx::from_num(half_y))?;
            let at = BodyDef::fixed().position((Fx::from_num(x), Fx::from_num(y)));
            world.spawn(&at, &[ShapeDef::new(wall)])?;
        }
        let mut rng = Rng::new(setup.seed);
        let mut discs = Vec::new();
        for at in 0..setup.players * 3 {
            let place = |n: u32| Fx::from_num(n) * 2 - fx!(3);
            let (x, y) = (place(at % 4), place(at / 4));
            let body = BodyDef::dynamic().position((x, y)).linear_damping(fx!(0.5));
            let velocity = Vec2::new(rng.range(fx!(-2), fx!(2)), rng.range(fx!(-2), fx!(2)));
            let disc = ShapeDef::new(Geometry::circle(fx!(0.6))?).restitution(fx!(0.8));
            discs.push(world.spawn(&body.velocity(velocity), &[disc])?);
        }
        Ok(Pushers { world, discs, tick_rate: setup.tick_rate, fault: FAULT.take() })
    }
}

impl Game for Pushers {
    type Setup = Setup;
    type Input = u8;
    type Save = Snapshot;

    const RULES: RulesId = RulesId { name: "pushers", version: 1 };

    fn new(setup: &Setup) -> Result<Self, SetupError> {
        if !(1..=8).contains(&setup.players) || !(1..=240).contains(&setup.tick_rate) {
            return Err(SetupError { why: "expected 1 to 8 players and 1 to 240 ticks a second".into() });
        }
        Pushers::build(setup).map_err(|error| SetupError { why: error.to_string() })
    }

    fn players(&self) -> u32 {
        u32::try_from(self.discs.len() / 3).unwrap_or(0)
    }

    fn tick_rate(&self) -> u32 {
        self.tick_rate
    }

    fn step(&mut self, inputs: &[u8]) {
        for (disc, input) in self.discs.iter().zip(inputs) {
            let axis = |plus: u8, minus: u8| {
                Fx::from_num(i32::from(input & plus != 0) - i32::from(input & minus != 0)) * 20
            };
            let push = if input & EMPTY != 0 { Vec2::ZERO } else { Vec2::new(axis(1, 2), axis(4, 8)) };
            let at = self.world.body(*disc).map_or(Vec2::ZERO, |body| body.centre_of_mass());
            // This cannot fail, because discs are never despawned.
            let _ = self.world.apply_force(*disc, push, at);
        }
        self.world.step();
        if let Some(fault) = self.fault.filter(|fault| fault.tick == self.world.tick()) {
            let _ = self.world.flip_bit(self.discs[fault.disc], fault.field, fault.bit);
        }
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

    fn work(&self, _: &[u8]) -> u64 {
        100
    }

    fn world_mut(&mut self) -> Option<&mut World> {
        Some(&mut self.world)
    }

    fn absent() -> u8 {
        EMPTY
    }
}

/// Input of a bot, with a new random direction every seven ticks.
pub(crate) fn bot(seat: u32, tick: u64) -> u8 {
    let phase = u32::try_from(tick / 7).unwrap_or(0);
    let mut rng = Rng::with_stream(u64::from(seat), u64::from(phase));
    u8::try_from(rng.below(16)).unwrap_or(0)
}
