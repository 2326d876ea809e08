//! The game: one player drives a car over hills and fires shells. A bridge breaks under too much load.

use std::collections::BTreeSet;

use lockstep2d::body::{BodyDef, BodyId, Chain, Geometry, Name, Polygon, ShapeDef, WorldError};
use lockstep2d::fx;
use lockstep2d::hash::StateHash;
use lockstep2d::lockstep::{Game, RulesId, SetupError};
use lockstep2d::math::{Angle, Fx, Rng, Vec2};
use lockstep2d::solver::{JointDef, Revolute, Threshold, ThresholdAction, Wheel};
use lockstep2d::world::{Snapshot, World};
use serde::{Deserialize, Serialize};

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Drive {
    /// Direction of the drive: -1, 0 or 1.
    pub(crate) gas: i8,
    pub(crate) fire: bool,
}

pub(crate) struct Hill {
    world: World,
    pub(crate) goals: u32,
    /// Number of ticks until the car can fire again.
    reload: u32,
}

#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Save {
    world: Snapshot,
    goals: u32,
    reload: u32,
}

/// Number of planks of the bridge, each 1 m long.
const PLANKS: i32 = 10;
/// x coordinates of the ends of the bridge, in metres.
const BRIDGE: (i32, i32) = (12, 12 + PLANKS);
/// Force at which a joint of the bridge breaks, in N.
const STRENGTH: Fx = fx!(200);
const RELOAD: u32 = 30;
/// Number of ticks after which a shell is removed.
const SHELL_TIME: u64 = 300;
/// Largest torque at a wheel, in N m.
const TORQUE: Fx = fx!(3);

fn named(def: BodyDef, name: &str) -> Result<BodyDef, WorldError> {
    Ok(def.name(Name::new(name)?))
}

fn at(x: i32, y: i32) -> Vec2<Fx> {
    Vec2::new(Fx::from_num(x), Fx::from_num(y))
}

impl Hill {
    fn build(seed: u64) -> Result<Self, WorldError> {
        let mut world = World::default();
        let ground = add_ground(&mut world, seed)?;
        add_bridge(&mut world, ground)?;
        add_car(&mut world)?;
        for x in [9, 30] {
            let goal = ShapeDef::new(Polygon::rectangle(fx!(0.5), fx!(2))?).sensor();
            world.spawn(&named(BodyDef::fixed().position(at(x, 2)), "goal")?, &[goal])?;
        }
        Ok(Hill { world, goals: 0, reload: 0 })
    }

    pub(crate) fn world(&self) -> &World {
        &self.world
    }

    pub(crate) fn name_of(&self, id: BodyId) -> String {
        let name = self.world.body(id).and_then(|body| body.name());
        name.map_or(String::new(), |name| name.as_str().to_owned())
    }

    fn named<'a>(&'a self, name: &'a str) -> impl Iterator<Item = BodyId> + 'a {
        self.world.bodies().map(|(id, _)| id).filter(move |id| self.name_of(*id) == name)
    }

    /// Number of planks that are still held at both ends.
    pub(crate) fn planks_left(&self) -> usize {
        self.named("plank").filter(|&plank| self.world.joints_of(plank).len() == 2).count()
    }

    fn drive(&mut self, input: Drive) -> Result<(), WorldError> {
        let speed = fx!(-14).saturating_mul_int(i64::from(input.gas.signum()));
        let wheels: Vec<_> = self.named("wheel").flat_map(|wheel| self.world.joints_of(wheel)).collect();
        for joint in wheels {
            self.world.set_joint_motor_speed(joint, speed)?;
        }
        self.reload = self.reload.saturating_sub(1);
        let car = self.named("car").next();
        if let Some(car) = car.filter(|_| input.fire && self.reload == 0) {
            let place = self.world.body(car).map_or(Vec2::ZERO, |body| body.position());
            let shell = ShapeDef::new(Geometry::circle(fx!(0.12))?).density(fx!(8));
            let def = BodyDef::dynamic().position(place + Vec2::new(fx!(0.6), fx!(0.9))).bullet();
            // The user data of a body is state. For a shell, it is the tick at which the shell is removed.
            let def = def.velocity((fx!(16), fx!(6))).user_data(self.world.tick() + SHELL_TIME);
            self.world.spawn(&named(def, "shell")?, &[shell])?;
            self.reload = RELOAD;
        }
        Ok(())
    }

    /// Counts reached goals, and removes old shells and fallen bodies.
    fn judge(&mut self) -> Result<(), WorldError> {
        let reached = self.world.events().sensor_begin.iter().filter(|event| {
            let visitor = self.world.shape(event.visitor).map(|shape| shape.body());
            visitor.is_some_and(|body| self.name_of(body) == "car")
        });
        self.goals = self.goals.saturating_add(u32::try_from(reached.count()).unwrap_or(u32::MAX));
        let now = self.world.tick();
        let old =
            self.named("shell").filter(|&id| self.world.body(id).is_some_and(|body| body.user_data() <= now));
        let lost = self.world.bodies().filter(|(_, body)| body.position().y < fx!(-12)).map(|(id, _)| id);
        let gone: BTreeSet<_> = old.chain(lost).collect();
        gone.into_iter().try_for_each(|id| self.world.despawn(id))
    }
}

/// Hills of a random height before the bridge, and flat ground behind it.
fn add_ground(world: &mut World, seed: u64) -> Result<BodyId, WorldError> {
    let mut rng = Rng::new(seed);
    let mut points = vec![Vec2::new(fx!(-20), fx!(6)), Vec2::new(fx!(-18), fx!(0))];
    for x in (-14..BRIDGE.0 - 4).step_by(4) {
        points.push(Vec2::new(Fx::from_num(x), rng.range(fx!(-1), fx!(1))));
    }
    points.extend([
        at(BRIDGE.0 - 4, 0),
        at(BRIDGE.0, 0),
        at(BRIDGE.0, -8),
        at(BRIDGE.1, -8),
        at(BRIDGE.1, 0),
    ]);
    points.extend([at(40, 0), at(42, 6)]);
    world.spawn(&named(BodyDef::fixed(), "ground")?, &Chain::new(&points).links()?)
}

fn add_bridge(world: &mut World, ground: BodyId) -> Result<(), WorldError> {
    let plank = ShapeDef::new(Polygon::rectangle(fx!(0.5), fx!(0.1))?);
    let threshold = Threshold { force: Some(STRENGTH), action: ThresholdAction::Break, ..Threshold::NONE };
    let mut before = (ground, Vec2::new(Fx::from_num(BRIDGE.0), fx!(-0.1)));
    for number in 0..PLANKS {
        let place = Vec2::new(Fx::from_num(BRIDGE.0 + number) + fx!(0.5), fx!(-0.1));
        let here = world
            .spawn(&named(BodyDef::dynamic().position(place), "plank")?, std::slice::from_ref(&plank))?;
        let joint = JointDef::new(before.0, here, Revolute::new()).threshold(threshold);
        world.add_joint(&joint.anchor_a(before.1).anchor_b((fx!(-0.5), fx!(0))))?;
        before = (here, Vec2::new(fx!(0.5), fx!(0)));
    }
    let last = JointDef::new(before.0, ground, Revolute::new()).threshold(threshold);
    world.add_joint(&last.anchor_a(before.1).anchor_b((Fx::from_num(BRIDGE.1), fx!(-0.1))))?;
    Ok(())
}

fn add_car(world: &mut World) -> Result<(), WorldError> {
    let hull = ShapeDef::new(Polygon::rectangle(fx!(1), fx!(0.25))?);
    let start = Vec2::new(fx!(-16), fx!(2));
    let car = world.spawn(&named(BodyDef::dynamic().position(start).never_sleeps(), "car")?, &[hull])?;
    let tyre = ShapeDef::new(Geometry::circle(fx!(0.4))?).friction(fx!(0.9));
    for x in [fx!(-0.7), fx!(0.7)] {
        let anchor = Vec2::new(x, fx!(-0.5));
        let def = named(BodyDef::dynamic().position(start + anchor), "wheel")?;
        let wheel = world.spawn(&def, std::slice::from_ref(&tyre))?;
        let suspension = Wheel::new().spring(fx!(5), fx!(0.7), fx!(0)).motor(fx!(0), TORQUE);
        world.add_joint(&JointDef::new(car, wheel, suspension).anchor_a(anchor).angle_a(Angle::QUARTER))?;
    }
    Ok(())
}

impl Game for Hill {
    type Setup = u64;
    type Input = Drive;
    type Save = Save;

    const RULES: RulesId = RulesId { name: "hill", version: 1 };

    fn new(seed: &u64) -> Result<Self, SetupError> {
        Hill::build(*seed).map_err(|error| SetupError { why: error.to_string() })
    }

    fn players(&self) -> u32 {
        1
    }

    fn tick_rate(&self) -> u32 {
        60
    }

    fn step(&mut self, inputs: &[Drive]) {
        // A command that the world refuses has no effect.
        let _driven = self.drive(inputs.first().copied().unwrap_or_default());
        self.world.step();
        let _judged = self.judge();
    }

    fn state_hash(&self) -> StateHash {
        StateHash::of_digests([self.world.state_hash(), StateHash::of(&(self.goals, self.reload))])
    }

    fn save(&self) -> Save {
        Save { world: self.world.save(), goals: self.goals, reload: self.reload }
    }

    fn load(&mut self, save: &Save) {
        self.world.restore(&save.world);
        (self.goals, self.reload) = (save.goals, save.reload);
    }

    fn work(&self, _: &[Drive]) -> u64 {
        self.world.work(1, 1)
    }

    fn world(&self) -> Option<&World> {
        Some(&self.world)
    }

    fn world_mut(&mut self) -> Option<&mut World> {
        Some(&mut self.world)
    }
}
