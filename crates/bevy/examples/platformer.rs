//! A platformer: a character, a one-way platform, a lift, and coins. Arrow keys or A, D and W; Space jumps.

use bevy::prelude::*;
use bevy_lockstep2d::prelude::*;
use bevy_lockstep2d_examples::app;
use lockstep2d::body::{BodyDef, BodyId, Geometry, Polygon, ShapeDef, ShapeId, WorldError};
use lockstep2d::fx;
use lockstep2d::hash::StateHash;
use lockstep2d::lockstep::{Game, RulesId, SetupError};
use lockstep2d::math::{Angle, Fx, Vec2 as FixedVec2, fx_mul};
use lockstep2d::world::{Mover, MoverState, QueryFilter, Snapshot, World as Physics};
use serde::{Deserialize, Serialize};

const LEFT: u8 = 1;
const RIGHT: u8 = 2;
const JUMP: u8 = 4;

struct Platformer {
    world: Physics,
    mover: Mover,
    state: State,
}

#[derive(Clone, Serialize, Deserialize)]
struct State {
    hero: BodyId,
    walk: MoverState,
    lift: BodyId,
    coins: Vec<ShapeId>,
    score: u32,
}

impl Platformer {
    fn build() -> Result<Self, WorldError> {
        let mut world = Physics::default();
        let plate = |x, y| Polygon::rectangle(x, y).map(ShapeDef::new);
        for (x, y, wide, high) in [(0, -1, 12, 1), (-12, 4, 1, 6), (12, 4, 1, 6), (8, 2, 3, 0)] {
            let [x, y, wide, high] = [x, y, wide, high].map(Fx::from_num);
            world.spawn(&BodyDef::fixed().position((x, y)), &[plate(wide, high + fx!(0.2))?])?;
        }
        let thin = plate(fx!(2), fx!(0.1))?.one_way(Angle::QUARTER);
        world.spawn(&BodyDef::fixed().position((fx!(-6), fx!(1.5))), &[thin])?;
        let lift = BodyDef::kinematic().position((fx!(1), fx!(0.2))).velocity((fx!(0), fx!(1.5)));
        let lift = world.spawn(&lift, &[plate(fx!(1.5), fx!(0.15))?])?;
        let mut coins = Vec::new();
        for (x, y) in [(-7, 3), (-5, 3), (1, 6), (7, 4), (9, 4), (10, 1)] {
            let place = (Fx::from_num(x), Fx::from_num(y));
            let coin = ShapeDef::new(Geometry::circle(fx!(0.25))?).sensor();
            let coin = world.spawn(&BodyDef::fixed().position(place), &[coin])?;
            coins.extend(world.body(coin).into_iter().flat_map(|coin| coin.shapes()));
        }
        let [low, high] = [fx!(-0.4), fx!(0.4)].map(|y| FixedVec2::new(fx!(0), y));
        let pill = Geometry::capsule(low, high, fx!(0.3))?;
        let start = FixedVec2::new(fx!(-2), fx!(1));
        let hero = BodyDef::kinematic().position((start.x, start.y));
        let hero = world.spawn(&hero, &[ShapeDef::new(pill)])?;
        let mover = Mover::new(pill)?.step_height(fx!(0.3)).snap_distance(fx!(0.3));
        let state = State { hero, walk: MoverState::at(start), lift, coins, score: 0 };
        Ok(Platformer { world, mover, state })
    }

    /// Reverses the lift at both ends of its path.
    fn drive_lift(&mut self) -> Result<(), WorldError> {
        let lift = self.state.lift;
        if let Some(body) = self.world.body(lift) {
            let (height, speed) = (body.position().y, body.velocity().y);
            let turns = (height > fx!(4) && speed > fx!(0)) || (height < fx!(0.2) && speed < fx!(0));
            let speed = if turns { fx!(0) - speed } else { speed };
            self.world.set_velocity(lift, (fx!(0), speed), fx!(0))?;
        }
        Ok(())
    }

    /// Moves the hero, and collects coins.
    fn walk(&mut self, pad: u8) -> Result<(), WorldError> {
        let State { hero, walk, .. } = &mut self.state;
        let way = Fx::from_num(i32::from(pad & RIGHT != 0) - i32::from(pad & LEFT != 0));
        walk.velocity.x = fx_mul(way, fx!(5));
        walk.velocity.y -= fx!(1 / 4);
        if pad & JUMP != 0 && walk.is_on_ground() {
            walk.velocity.y = fx!(8);
        }
        let filter = QueryFilter::default().except(*hero);
        *walk = self.world.move_character(&self.mover, walk, filter).state;
        self.world.move_to(*hero, walk.position, Angle::ZERO)?;
        self.collect()
    }

    /// Removes the coins whose sensors the hero has entered.
    fn collect(&mut self) -> Result<(), WorldError> {
        let taken: Vec<ShapeId> = self.world.events().sensor_begin.iter().map(|event| event.sensor).collect();
        for coin in taken.into_iter().filter(|coin| self.state.coins.contains(coin)) {
            let Some(body) = self.world.shape(coin).map(|coin| coin.body()) else { continue };
            self.world.despawn(body)?;
            self.state.score += 1;
        }
        Ok(())
    }
}

impl Game for Platformer {
    type Setup = ();
    type Input = u8;
    type Save = (Snapshot, State);
    const RULES: RulesId = RulesId { name: "platformer", version: 1 };

    fn new((): &()) -> Result<Self, SetupError> {
        Self::build().map_err(|error| SetupError { why: error.to_string() })
    }
    fn players(&self) -> u32 {
        1
    }
    fn tick_rate(&self) -> u32 {
        self.world.config().tick_rate
    }
    fn step(&mut self, inputs: &[u8]) {
        let driven = self.drive_lift();
        // The world steps even if it has refused to move the lift.
        self.world.step();
        let walked = self.walk(inputs.first().copied().unwrap_or(0));
        if let Err(error) = driven.and(walked) {
            debug_assert!(false, "tick {}: {error}", self.world.tick());
        }
    }
    fn state_hash(&self) -> StateHash {
        StateHash::of_digests([self.world.state_hash(), StateHash::of(&self.state)])
    }
    fn save(&self) -> Self::Save {
        (self.world.save(), self.state.clone())
    }
    fn load(&mut self, (world, state): &Self::Save) {
        self.world.restore(world);
        self.state.clone_from(state);
    }
    fn work(&self, _: &[u8]) -> u64 {
        self.world.work(0, 0)
    }
    fn world(&self) -> Option<&Physics> {
        Some(&self.world)
    }
    fn world_mut(&mut self) -> Option<&mut Physics> {
        Some(&mut self.world)
    }
}

fn press(keys: Res<ButtonInput<KeyCode>>, mut inputs: ResMut<Inputs<Platformer>>) {
    let pad = [(LEFT, KeyCode::ArrowLeft, KeyCode::KeyA), (RIGHT, KeyCode::ArrowRight, KeyCode::KeyD)];
    let held = pad.into_iter().filter(|(_, arrow, letter)| keys.any_pressed([*arrow, *letter]));
    *inputs.held(0) = held.fold(0, |pad, (bit, ..)| pad | bit);
    if keys.any_just_pressed([KeyCode::ArrowUp, KeyCode::KeyW, KeyCode::Space]) {
        *inputs.once(0) |= JUMP;
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    app::<Platformer>("platformer", 27.0, Vec2::new(0.0, 4.0))
        .insert_resource(Lockstep::<Platformer>::local(&())?)
        .add_systems(bevy::app::RunFixedMainLoop, press.in_set(LockstepSystems::Inputs))
        .run();
    Ok(())
}
