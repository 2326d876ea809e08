//! Tests that the scenes have the documented sizes, and tests of the engine that need these scenes.

use alloc::vec::Vec;

use super::{ALL, Scene};
use crate::body::{BodyDef, Geometry, Handle, Polygon, ShapeDef};
use crate::collision::{CachedAxis, PosedShape, SatCounters, collide, collide_near};
use crate::fx;
use crate::lockstep::{Game, Sandbox};
use crate::math::{Length, narrow};
use crate::world::World;

fn open(name: &str) -> Sandbox {
    Sandbox::new(&Scene::find(name).unwrap().setup(1)).unwrap()
}

fn counts(world: &World) -> (usize, usize, usize) {
    (world.body_count(), world.shape_count(), world.joint_count())
}

#[test]
fn every_scene_starts_and_has_a_setup_that_fits_a_replay() {
    for scene in ALL {
        let setup = scene.setup(1);
        let bytes = crate::codec::encode(&setup).len();
        assert!(bytes < 1 << 20, "{}: a setup of {bytes} bytes", scene.name);
        assert!(Sandbox::new(&setup).is_ok(), "{}", scene.name);
        assert_eq!(Scene::find(scene.name).map(|found| found.about), Some(scene.about), "names are unique");
    }
}

#[test]
fn benchmarks_have_the_size_that_they_have_elsewhere() {
    for (name, size) in [
        ("large_pyramid", (5051, 5051, 0)),
        ("many_pyramids", (22001, 22020, 0)),
        ("joint_grid", (10000, 10000, 19794)),
        ("smash", (9601, 9601, 0)),
        ("spinner", (6078, 6437, 1)),
        ("tumbler", (2027, 2029, 1)),
        ("washer", (8101, 8140, 0)),
        ("junkyard", (8002, 8262, 0)),
        ("compounds", (3001, 6282, 0)),
    ] {
        assert_eq!(counts(open(name).world()), size, "{name}");
    }
}

/// Executes the script without stepping: complete ragdolls are added, and old ones are removed.
#[test]
fn forty_columns_of_ragdolls_stand_at_a_time() {
    let mut game = open("rain");
    let scene = Scene::find("rain").unwrap();
    for tick in 0..=8 * 42 {
        for command in scene.commands(tick, &game) {
            game.world_mut().execute(&command).unwrap();
        }
        let world = game.world();
        let columns = usize::try_from(tick / 8 + 1).unwrap().min(40);
        if tick % 8 == 0 {
            assert_eq!(counts(world), (1 + 275 * columns, 2505 + 325 * columns, 250 * columns));
            assert!(world.bodies().all(|(_, body)| body.is_enabled()));
        }
    }
    let world = game.world();
    for (id, _) in world.joints() {
        let (a, b) = world.joint_anchors(id).unwrap();
        assert!(a.distance(b) < crate::fx!(0.000001), "joint {id}: {a:?} {b:?}");
    }
    assert_eq!(world.faults(), 0);
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

    /// Number of contact points, computed with the box reject and a cached separating axis for every pair.
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

    /// Number of contact points, computed without the box reject and without cached axes.
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

/// Measures how many axis searches the cached axis and the box reject save on the pairs of the hundred polygons. The
/// instruction counts of the two functions of [`Near`] can be measured with `valgrind --tool=callgrind`.
#[test]
fn reject_and_axis_spare_a_hundred_polygons_most_searches() {
    let mut game = open("hundred_polygons");
    let margin = narrow(game.world().config().speculative_distance);
    let ticks: Vec<Near> = (0..300)
        .map(|_| {
            game.world_mut().step();
            Near::of(game.world())
        })
        .collect();
    let mut cached_axes = alloc::vec![CachedAxis::default(); ticks[0].shapes.len().pow(2)];
    let mut counters = SatCounters::default();
    let fast: usize =
        ticks.iter().map(|near| near.with_reject_and_axis(margin, &mut cached_axes, &mut counters)).sum();
    let plain: usize = ticks.iter().map(|near| near.without(margin)).sum();
    assert_eq!(fast, plain, "the box reject and the cached axis do not change the result");
    let pairs: usize = ticks.iter().map(|near| near.pairs.len()).sum();
    // A pair has at most two points. Most searches of pairs without contact must be saved.
    let (searches, touching) = (counters.searches as usize, fast.div_ceil(2));
    let spared = fast > 10_000 && (searches - touching) * 2 < pairs - touching;
    assert!(spared, "{fast} points, {pairs} pairs, {counters:?}");
}

/// Boxes, hinges, motors and rolling: the accumulated velocity change of the contacts equals the sum of their impulses,
/// except for the rounding of about twenty changes per row.
#[test]
fn pushes_are_what_the_impulses_amount_to() {
    for (name, ticks) in [("pyramid", 30), ("bridge", 120), ("ragdoll", 90), ("drum", 120), ("slope", 60)] {
        let scene = Scene::find(name).expect("a scene");
        let mut game = open(name);
        let (mut worst, mut most) = (0, 0);
        for tick in 0..ticks {
            let commands = scene.commands(tick, &game);
            game.step(&[commands]);
            let (error, largest) = game.world().push_error();
            (worst, most) = (worst.max(error), most.max(largest));
        }
        assert!(worst <= 100, "{name}: the velocity change differs from the impulses by {worst} units");
        assert!(most > 10_000, "{name}: the largest velocity change is only {most} units");
    }
}

/// A box that is locked along x is pushed along x by a ball that leans on it. The velocity that the lock removes again
/// must not count as a missing velocity change.
#[test]
fn pushes_are_known_of_what_is_locked() {
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
        let (error, largest) = world.push_error();
        (worst, most) = (worst.max(error), most.max(largest));
    }
    assert!(
        worst <= 100 && most > 100_000,
        "the velocity change of {most} units differs from the impulses by {worst} units"
    );
}
