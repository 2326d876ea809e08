use alloc::vec::Vec;

use crate::body::{BodyDef, BodyId, Geometry, Handle, Polygon, ShapeDef};
use crate::collision::{CachedAxis, PosedShape, SatCounters, collide, collide_near};
use crate::fx;
use crate::math::{Fx, Length, Rng, Rot, Vec2, narrow};
use crate::solver::{JointDef, Revolute, Weld};
use crate::world::World;

impl World {
    /// `Solver::contact_velocity_error` of the last tick.
    pub(crate) fn contact_velocity_error(&self) -> (i32, i32) {
        let super::Config { solver, gravity, tick_rate, .. } = &self.state.get().config;
        self.scratch
            .solver
            .clone()
            .contact_velocity_error(&crate::solver::Tuning::new(solver, *gravity, *tick_rate))
    }
}

fn rectangle(half_width: Fx, half_height: Fx) -> ShapeDef {
    ShapeDef::new(Polygon::rectangle(half_width, half_height).unwrap())
}

fn pit() -> World {
    let mut world = World::default();
    let parts = [
        rectangle(fx!(12), fx!(1)).offset((fx!(0), fx!(-1))),
        rectangle(fx!(1), fx!(10)).offset((fx!(-11), fx!(10))),
        rectangle(fx!(1), fx!(10)).offset((fx!(11), fx!(10))),
    ];
    world.spawn(&BodyDef::fixed(), &parts).unwrap();
    world
}

fn spawn(world: &mut World, x: Fx, y: Fx, shape: ShapeDef) -> BodyId {
    world.spawn(&BodyDef::dynamic().position((x, y)), &[shape]).unwrap()
}

/// A pit with 100 convex hulls of up to 8 random points.
fn hundred_polygons() -> World {
    let (mut world, mut rng) = (pit(), Rng::new(1));
    for i in 0..100 {
        let hull = loop {
            let count = rng.below(6) + 3;
            let mut point = || {
                let direction = Rot::from_angle(rng.angle());
                direction.apply_wide(Vec2::new(rng.range(fx!(0.3), fx!(0.9)), Fx::ZERO))
            };
            let points: Vec<_> = (0..count).map(|_| point()).collect();
            if let Ok(hull) = Polygon::hull(&points) {
                break hull;
            }
        };
        let x = Fx::from_num(i % 8 - 4) * 2 + fx!(1) + rng.range(fx!(-0.2), fx!(0.2));
        spawn(&mut world, x, Fx::from_num(i / 8) * 2 + fx!(2), ShapeDef::new(hull));
    }
    world
}

/// Input of the narrow phase in a tick: posed shapes, and the pairs whose fat boxes overlap.
struct Near {
    shapes: Vec<PosedShape>,
    pairs: Vec<(usize, usize)>,
}

impl Near {
    fn of(world: &World) -> Self {
        let shapes: Vec<_> = world.shapes().map(|(_, shape)| shape).collect();
        let near = |a: usize, b: usize| {
            let (a, b) = (shapes[a], shapes[b]);
            a.body().slot() != b.body().slot() && a.fat_aabb().overlaps(b.fat_aabb())
        };
        let all = (0..shapes.len()).flat_map(|a| (a + 1..shapes.len()).map(move |b| (a, b)));
        let pairs = all.filter(|&(a, b)| near(a, b)).collect();
        let posed = shapes.iter().map(|shape| {
            let body = world.body(shape.body()).unwrap();
            PosedShape::new(&shape.def, body, body.rotation())
        });
        Near { shapes: posed.collect(), pairs }
    }

    /// Number of contact points found with the AABB test and with cached separating axes.
    #[inline(never)]
    fn with_reject_and_axis(
        &self,
        margin: Length,
        cached_axes: &mut [CachedAxis],
        counters: &mut SatCounters,
    ) -> usize {
        let count = self.shapes.len();
        let points = self.pairs.iter().map(|&(a, b)| {
            let cached_axis = &mut cached_axes[a * count + b];
            collide(&self.shapes[a], &self.shapes[b], margin, cached_axis, counters).points().len()
        });
        points.sum()
    }

    /// Number of contact points found without the AABB test and without cached axes.
    #[inline(never)]
    fn without(&self, margin: Length) -> usize {
        let points = self.pairs.iter().map(|&(a, b)| {
            let (mut cached_axis, mut counters) = (CachedAxis::default(), SatCounters::default());
            collide_near(&self.shapes[a], &self.shapes[b], margin, &mut cached_axis, &mut counters)
                .points()
                .len()
        });
        points.sum()
    }
}

/// To measure how much the AABB test and the cached axes save, run this test in `valgrind --tool=callgrind`, and
/// compare the instruction counts of `with_reject_and_axis` and `without`.
#[test]
fn reject_and_axis_spare_a_hundred_polygons_most_searches() {
    let mut world = hundred_polygons();
    let margin = narrow(world.config().speculative_distance);
    let ticks: Vec<Near> = (0..300)
        .map(|_| {
            world.step();
            Near::of(&world)
        })
        .collect();
    let mut cached_axes = alloc::vec![CachedAxis::default(); ticks[0].shapes.len().pow(2)];
    let mut counters = SatCounters::default();
    let fast: usize =
        ticks.iter().map(|near| near.with_reject_and_axis(margin, &mut cached_axes, &mut counters)).sum();
    let plain: usize = ticks.iter().map(|near| near.without(margin)).sum();
    assert_eq!(fast, plain, "the box reject and the cached axis do not change the result");
    let pairs: usize = ticks.iter().map(|near| near.pairs.len()).sum();
    // A pair has at most two points, so the number of touching pairs is at least half the number of points.
    let (searches, touching) = (counters.searches as usize, fast.div_ceil(2));
    let spared = fast > 10_000 && (searches - touching) * 2 < pairs - touching;
    assert!(spared, "{fast} points, {pairs} pairs, {counters:?}");
}

/// A pyramid of boxes, rolling balls, and three chains of planks with a motor at the first hinge.
fn boxes_balls_and_hinges() -> World {
    let (mut world, half) = (pit(), fx!(0.5));
    for (row, column) in (0..6).flat_map(|row| (row..6).map(move |column| (row, column))) {
        let x = Fx::from_num(2 * column - row) / 2 - fx!(8);
        spawn(&mut world, x, Fx::from_num(row) + half, rectangle(half, half));
    }
    let ball =
        ShapeDef::new(Geometry::circle(half).unwrap()).rolling_resistance(fx!(0.05)).restitution(fx!(0.3));
    for i in 0..4 {
        let body = BodyDef::dynamic().position((Fx::from_num(2 * i), fx!(1))).velocity((fx!(-4), fx!(0)));
        world.spawn(&body, &[ball]).unwrap();
    }
    for chain in 0..3 {
        let y = Fx::from_num(2 * chain) + fx!(2);
        let mut before = world.spawn(&BodyDef::fixed().position((fx!(4), y)), &[]).unwrap();
        for i in 0..5 {
            let plank = rectangle(half, fx!(0.1)).density(fx!(2));
            let plank = spawn(&mut world, Fx::from_num(i) + fx!(4.5), y, plank);
            let anchor_a = if i == 0 { fx!(0) } else { half };
            let hinge = if i == 0 { Revolute::new().motor(fx!(2), fx!(40)) } else { Revolute::new() };
            let hinge =
                JointDef::new(before, plank, hinge).anchor_a((anchor_a, fx!(0))).anchor_b((-half, fx!(0)));
            world.add_joint(&hinge).unwrap();
            before = plank;
        }
    }
    world
}

#[test]
fn contact_velocities_are_what_the_impulses_amount_to() {
    for (name, mut world) in [("mixed", boxes_balls_and_hinges()), ("polygons", hundred_polygons())] {
        let (mut worst, mut most) = (0, 0);
        for _ in 0..120 {
            world.step();
            let (error, largest) = world.contact_velocity_error();
            (worst, most) = (worst.max(error), most.max(largest));
        }
        assert!(worst <= 100, "{name}: the velocity change differs from the impulses by {worst} units");
        assert!(most > 10_000, "{name}: the largest velocity change is only {most} units");
    }
}

/// Contact impulses along a locked axis do not change the velocity. The comparison of velocity changes with impulses
/// must not count this as an error.
#[test]
fn contact_velocities_are_known_of_what_is_locked() {
    let mut world = World::default();
    let floor = Polygon::rectangle(fx!(10), fx!(1)).unwrap();
    world.spawn(&BodyDef::fixed().position((fx!(0), fx!(-1))), &[ShapeDef::new(floor)]).unwrap();
    let mut locked = BodyDef::dynamic().position((fx!(0), fx!(0.5)));
    locked.settings.locks.x = true;
    world.spawn(&locked, &[ShapeDef::new(Polygon::square(fx!(0.5)).unwrap())]).unwrap();
    let ball = BodyDef::dynamic().position((fx!(-1.2), fx!(0.5))).velocity((fx!(3), fx!(0)));
    world.spawn(&ball, &[ShapeDef::new(Geometry::circle(fx!(0.5)).unwrap())]).unwrap();
    let (mut worst, mut most) = (0, 0);
    for _ in 0..30 {
        world.step();
        let (error, largest) = world.contact_velocity_error();
        (worst, most) = (worst.max(error), most.max(largest));
    }
    assert!(
        worst <= 100 && most > 100_000,
        "the velocity change of {most} units differs from the impulses by {worst} units"
    );
}

/// A tick skips the sub-steps if the work budget does not cover the joints. It must leave nothing in the caches that
/// changes the ticks after a restore.
#[test]
fn a_world_is_restored_after_a_tick_without_the_budget_for_its_joints() {
    let mut world = pit();
    let bodies: Vec<BodyId> =
        (0..8i64).map(|at| spawn(&mut world, fx!(1) * at, fx!(2), rectangle(fx!(0.5), fx!(0.5)))).collect();
    for pair in bodies.windows(2) {
        let weld = JointDef::new(pair[0], pair[1], Weld::rigid()).anchor_b((fx!(-1), fx!(0)));
        world.add_joint(&weld).unwrap();
    }
    world.set_velocity(bodies[0], Vec2::ZERO, fx!(2)).unwrap();
    let start = world.save();
    (0..5).for_each(|_| world.step());
    let expected = world.state_hash();
    (0..30).for_each(|_| world.step());
    let mut other = World::default();
    other.restore(&world.save());
    other.start_work_meter(0);
    other.step();
    assert!(other.stop_work_meter() > 0, "the joints are in blocks");
    other.restore(&start);
    (0..5).for_each(|_| other.step());
    assert_eq!(other.state_hash(), expected);
}
