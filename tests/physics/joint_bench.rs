//! A world with two bodies of given masses and without shapes, to which tests add the joints that they measure.

use lockstep2d::body::{BodyDef, BodyId, JointId, MassSource};
use lockstep2d::fx;
use lockstep2d::math::{Angle, Fx, Vec2};
use lockstep2d::solver::JointDef;
use lockstep2d::world::{Config, World};

pub(crate) struct Bench {
    pub(crate) world: World,
    pub(crate) a: BodyId,
    pub(crate) b: BodyId,
}

/// Kind of body A, which is joined to body B.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Ground {
    Fixed,
    /// Dynamic, with a mass in kg.
    Free(Fx),
}

pub(crate) const RATE: i64 = 240;

impl Bench {
    /// Puts A at the origin and B at `place`, turned by `angle` radians. B has 2 kg and a radius of gyration of 0.5 m.
    /// `gravity` acts along y, in m/s².
    pub(crate) fn new(ground: Ground, gravity: Fx, place: Vec2<Fx>, angle: Fx) -> Self {
        Self::with_mass(ground, gravity, (fx!(2), fx!(0.5)), place, angle)
    }

    pub(crate) fn with_mass(
        ground: Ground,
        gravity: Fx,
        (mass, gyration): (Fx, Fx),
        place: Vec2<Fx>,
        angle: Fx,
    ) -> Self {
        // Bodies do not sleep here, because a body that creeps to its target would fall asleep on the way.
        let config = Config { gravity: Vec2::new(fx!(0), gravity), sleeping: false, ..Config::default() };
        let mut world = World::new(config).expect("valid");
        let given = |mass, gyration| MassSource::Given { mass, centre: Vec2::ZERO, gyration };
        let a = match ground {
            Ground::Fixed => BodyDef::fixed(),
            Ground::Free(mass) => BodyDef::dynamic().mass(given(mass, fx!(0.4))),
        };
        let a = world.spawn(&a, &[]).expect("valid");
        let b = BodyDef::dynamic().mass(given(mass, gyration)).position(place);
        let b = world.spawn(&b.angle(Angle::from_radians(angle)), &[]).expect("valid");
        Bench { world, a, b }
    }

    pub(crate) fn join(&mut self, def: JointDef) -> JointId {
        self.world.add_joint(&def).expect("valid")
    }

    /// Steps, and calls `look` after every tick.
    pub(crate) fn run(&mut self, ticks: u64, mut look: impl FnMut(u64, &World)) {
        for tick in 0..ticks {
            self.world.step();
            look(tick, &self.world);
        }
        assert_eq!(self.world.validate(), Ok(()));
        assert_eq!(self.world.faults(), 0, "expected no clamped or saturated value in the solver");
    }
}

pub(crate) fn close(found: Fx, expected: Fx, within: Fx, what: &str) {
    assert!((found - expected).abs() <= within, "{what}: {found}, expected {expected}");
}

/// Effective mass of two masses: `1 / (1 / a + 1 / b)`.
pub(crate) fn reduced(a: Fx, b: Fx) -> Fx {
    lockstep2d::math::fx_div(lockstep2d::math::fx_mul(a, b), a + b).expect("positive")
}

/// Choices of A, each with the effective mass in kg and the effective inertia in kg m² of A and B together. B has 2 kg
/// and 0.5 kg m².
pub(crate) fn grounds() -> [(Ground, Fx, Fx); 3] {
    let free = |mass: Fx| (Ground::Free(mass), reduced(fx!(2), mass), reduced(fx!(0.5), mass * 4 / 25));
    [(Ground::Fixed, fx!(2), fx!(0.5)), free(fx!(0.02)), free(fx!(200))]
}
