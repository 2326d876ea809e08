//! The samples of Box2D and the examples of rapier as small worlds. The table in `docs/SAMPLES.md` names the test of
//! each sample. Expected values follow from mechanics or from the purpose of the sample.

/// A vector of two literals.
macro_rules! at {
    ($x:literal, $y:literal) => {
        lockstep2d::math::Vec2::new(lockstep2d::fx!($x), lockstep2d::fx!($y))
    };
}

mod bodies;
mod continuous;
mod events;
mod joints;
mod machines;
mod queries;
mod rapier;
mod rapier_joints;
mod robustness;
mod shapes;
mod stacking;
mod surfaces;
mod table;
mod worlds;

use lockstep2d::body::{Body, BodyDef, BodyId, Geometry, JointId, Polygon, ShapeDef, ShapeId};
use lockstep2d::fx;
use lockstep2d::lockstep::{Game, Sandbox};
use lockstep2d::math::{Angle, Fx, Vec2, fx_mul};
use lockstep2d::solver::{JointDef, JointKind};
use lockstep2d::world::{Config, World};
use lockstep2d_scenes::Scene;

struct Stage {
    world: World,
}

impl Stage {
    fn new() -> Self {
        Stage { world: World::default() }
    }

    fn weightless() -> Self {
        Self::with_gravity(Vec2::ZERO)
    }

    fn with_gravity(gravity: Vec2<Fx>) -> Self {
        Self::of(Config { gravity, ..Config::default() })
    }

    fn of(config: Config) -> Self {
        Stage { world: World::new(config).expect("valid settings") }
    }

    /// The world of a scene before its first tick.
    fn of_scene(name: &str) -> Self {
        let scene = Scene::find(name).unwrap_or_else(|| panic!("no scene {name}"));
        let game = Sandbox::new(&scene.setup(1)).expect("the scenes of this crate are valid");
        Stage { world: game.world().clone() }
    }

    fn with_floor() -> Self {
        let mut stage = Self::new();
        stage.floor();
        stage
    }

    /// Adds a floor 200 m wide, with its top on the x axis.
    fn floor(&mut self) -> BodyId {
        self.fixed(at!(0, -1), rect(fx!(100), fx!(1)))
    }

    fn spawn(&mut self, def: BodyDef, shapes: &[ShapeDef]) -> BodyId {
        self.world.spawn(&def, shapes).expect("a valid body")
    }

    fn fixed(&mut self, place: Vec2<Fx>, shape: ShapeDef) -> BodyId {
        self.spawn(BodyDef::fixed().position(place), &[shape])
    }

    fn add(&mut self, place: Vec2<Fx>, shape: ShapeDef) -> BodyId {
        self.spawn(BodyDef::dynamic().position(place), &[shape])
    }

    fn throw(&mut self, place: Vec2<Fx>, velocity: Vec2<Fx>, shape: ShapeDef) -> BodyId {
        self.spawn(BodyDef::dynamic().position(place).velocity(velocity), &[shape])
    }

    fn join(&mut self, def: JointDef) -> JointId {
        self.world.add_joint(&def).expect("a valid joint")
    }

    /// Adds a joint with both anchors at one point of the world.
    fn join_at(&mut self, a: BodyId, b: BodyId, kind: impl Into<JointKind>, place: Vec2<Fx>) -> JointId {
        let def = self.world.joint_at(a, b, kind, place).expect("bodies of the world");
        self.join(def)
    }

    fn join_along(
        &mut self,
        (a, b): (BodyId, BodyId),
        kind: impl Into<JointKind>,
        place: Vec2<Fx>,
        axis: Vec2<Fx>,
    ) -> JointId {
        let def = self.world.joint_along(a, b, kind, place, axis).expect("bodies of the world");
        self.join(def)
    }

    /// Simulates ticks, and expects that the solver clamps nothing.
    fn run(&mut self, ticks: u32) {
        self.run_and(ticks, |_| ());
    }

    /// Simulates ticks, and calls `look` after each one.
    fn run_and(&mut self, ticks: u32, mut look: impl FnMut(&mut Stage)) {
        for _ in 0..ticks {
            self.world.step();
            look(self);
        }
        assert_eq!(self.world.faults(), 0, "expected no clamped value");
        assert_eq!(self.world.validate(), Ok(()));
    }

    fn body(&self, id: BodyId) -> &Body {
        self.world.body(id).expect("a body of the world")
    }

    fn place(&self, id: BodyId) -> Vec2<Fx> {
        self.body(id).position()
    }

    fn velocity(&self, id: BodyId) -> Vec2<Fx> {
        self.body(id).velocity()
    }

    /// Angle in radians, from -pi to pi.
    fn angle(&self, id: BodyId) -> Fx {
        self.body(id).angle().to_radians()
    }

    fn shape(&self, id: BodyId) -> ShapeId {
        *self.world.shapes_of(id).first().expect("a shape")
    }

    /// Kinetic and potential energy of the dynamic bodies in J.
    fn energy(&self) -> Fx {
        let gravity = self.world.config().gravity;
        let of =
            |body: &Body| body.kinetic_energy() - fx_mul(body.mass(), gravity.dot(body.centre_of_mass()));
        self.world.bodies().filter(|(_, body)| body.is_dynamic()).map(|(_, body)| of(body)).sum()
    }

    /// Speed of the fastest dynamic body in m/s.
    fn fastest(&self) -> Fx {
        let dynamic = self.world.bodies().filter(|(_, body)| body.is_dynamic());
        dynamic.map(|(_, body)| body.velocity().length()).max().unwrap_or(Fx::ZERO)
    }
}

fn ball(radius: Fx) -> ShapeDef {
    ShapeDef::new(Geometry::circle(radius).expect("a valid circle"))
}

/// A rectangle of given half extents.
fn rect(half_width: Fx, half_height: Fx) -> ShapeDef {
    ShapeDef::new(Polygon::rectangle(half_width, half_height).expect("a valid rectangle"))
}

fn square(half: Fx) -> ShapeDef {
    rect(half, half)
}

/// A rounded rectangle whose half extents include the radius.
fn rounded(half_width: Fx, half_height: Fx, radius: Fx) -> ShapeDef {
    let core = Polygon::rectangle(half_width - radius, half_height - radius);
    ShapeDef::new(core.and_then(|core| core.rounded(radius)).expect("a valid rectangle"))
}

/// A capsule along the x axis, from `-half` to `half`.
fn pill(half: Fx, radius: Fx) -> ShapeDef {
    capsule(Vec2::new(-half, Fx::ZERO), Vec2::new(half, Fx::ZERO), radius)
}

fn capsule(a: Vec2<Fx>, b: Vec2<Fx>, radius: Fx) -> ShapeDef {
    ShapeDef::new(Geometry::capsule(a, b, radius).expect("a valid capsule"))
}

fn line(a: Vec2<Fx>, b: Vec2<Fx>) -> ShapeDef {
    ShapeDef::new(Geometry::segment(a, b).expect("a valid segment"))
}

fn hull(points: &[Vec2<Fx>]) -> ShapeDef {
    ShapeDef::new(Polygon::hull(points).expect("a valid polygon"))
}

fn degrees(angle: i32) -> Angle {
    Angle::from_degrees(Fx::from_num(angle))
}

fn num(value: i32) -> Fx {
    Fx::from_num(value)
}

#[track_caller]
fn near(value: Fx, expected: Fx, tolerance: Fx) {
    assert!((value - expected).abs() <= tolerance, "{value}, expected {expected} up to {tolerance}");
}
