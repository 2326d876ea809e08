//! Scenes are what they are said to be.

use alloc::vec::Vec;

use super::{ALL, Scene};
use crate::body::{BodyDef, Geometry, Handle, Polygon, ShapeDef};
use crate::collision::{PosedShape, collide, collide_near, may_meet};
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
        assert_eq!(Scene::find(scene.name).map(|found| found.about), Some(scene.about), "a name for each");
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

/// The script alone, without time: ragdolls come complete and whole, and old ones go.
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

/// What the narrow phase of a tick has to do with: shapes where they are, and those whose fat boxes overlap.
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

    /// Number of contact points, with the box reject.
    #[inline(never)]
    fn with_reject(&self, margin: Length) -> usize {
        self.pairs
            .iter()
            .map(|&(a, b)| collide(&self.shapes[a], &self.shapes[b], margin).points().len())
            .sum()
    }

    /// Number of contact points, without the box reject.
    #[inline(never)]
    fn without(&self, margin: Length) -> usize {
        let points =
            |&(a, b): &(usize, usize)| collide_near(&self.shapes[a], &self.shapes[b], margin).points().len();
        self.pairs.iter().map(points).sum()
    }

    /// Number of pairs that the box reject keeps from the separating axis test.
    fn rejected(&self, margin: Length) -> usize {
        let meets = |&(a, b): &(usize, usize)| may_meet(self.shapes[a].bounds, self.shapes[b].bounds, margin);
        self.pairs.iter().filter(|pair| !meets(pair)).count()
    }
}

/// What the box reject saves on the pairs that the hundred polygons have. Under `valgrind --tool=callgrind` two functions
/// of [`Near`] tell by how many instructions.
#[test]
fn reject_spares_a_hundred_polygons_many_tests() {
    let mut game = open("hundred_polygons");
    let margin = narrow(game.world().config().speculative_distance);
    let ticks: Vec<Near> = (0..300)
        .map(|_| {
            game.world_mut().step();
            Near::of(game.world())
        })
        .collect();
    let fast: usize = ticks.iter().map(|near| near.with_reject(margin)).sum();
    let plain: usize = ticks.iter().map(|near| near.without(margin)).sum();
    assert_eq!(fast, plain, "the reject changes no result");
    let pairs: usize = ticks.iter().map(|near| near.pairs.len()).sum();
    let rejected: usize = ticks.iter().map(|near| near.rejected(margin)).sum();
    assert!(fast > 10_000 && rejected * 4 > pairs, "{fast} points, {rejected} of {pairs} pairs rejected");
}

/// Boxes, hinges, motors and rolling: what contacts push is what their impulses amount to, but for the
/// rounding of some twenty changes of each row.
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
        assert!(worst <= 100, "{name}: {worst} units apart");
        assert!(most > 10_000, "{name}: contacts push at {most} units");
    }
}

/// A box that cannot move along x is pushed along x by the ball that leans on it: what its lock takes away again is no
/// push that is missing.
#[test]
fn pushes_are_known_of_what_is_locked() {
    let mut world = World::default();
    let floor = Polygon::rectangle(fx!(10), fx!(1)).unwrap();
    world.spawn(&BodyDef::fixed().position(fx!(0), fx!(-1)), &[ShapeDef::new(floor)]).unwrap();
    let mut locked = BodyDef::dynamic().position(fx!(0), fx!(0.5));
    locked.settings.locks.x = true;
    world.spawn(&locked, &[ShapeDef::new(Polygon::square(fx!(0.5)).unwrap())]).unwrap();
    let ball = BodyDef::dynamic().position(fx!(-1.2), fx!(0.5)).velocity(fx!(3), fx!(0));
    world.spawn(&ball, &[ShapeDef::new(Geometry::circle(fx!(0.5)).unwrap())]).unwrap();
    let (mut worst, mut most) = (0, 0);
    for _ in 0..30 {
        world.step();
        let (error, largest) = world.push_error();
        (worst, most) = (worst.max(error), most.max(largest));
    }
    assert!(worst <= 100 && most > 100_000, "{worst} units apart at {most} units");
}
