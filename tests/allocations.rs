//! A step allocates nothing once the buffers have grown to the size of the scene.

mod common;

use lockstep2d::body::{BodyDef, Geometry, ShapeDef};
use lockstep2d::fx;
use lockstep2d::lockstep::{Game, Sandbox};
use lockstep2d::math::Fx;
use lockstep2d::scenes::Scene;
use lockstep2d::solver::{JointDef, Revolute, Threshold};
use lockstep2d::world::{Config, World};

/// The system's memory, which counts for each thread what that thread asks for.
mod counting {
    #![expect(unsafe_code, reason = "the trait of allocators is unsafe")]

    use std::alloc::{GlobalAlloc, Layout, System};
    use std::cell::Cell;

    struct Counting;

    #[global_allocator]
    static ALLOCATOR: Counting = Counting;

    thread_local! {
        static COUNT: Cell<usize> = const { Cell::new(0) };
    }

    /// How often this thread has asked for memory.
    pub(super) fn count() -> usize {
        COUNT.get()
    }

    // SAFETY: as the system's, which does it all.
    unsafe impl GlobalAlloc for Counting {
        unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
            COUNT.set(COUNT.get() + 1);
            // SAFETY: as the caller's.
            unsafe { System.alloc(layout) }
        }

        unsafe fn dealloc(&self, memory: *mut u8, layout: Layout) {
            // SAFETY: as the caller's.
            unsafe { System.dealloc(memory, layout) }
        }

        unsafe fn realloc(&self, memory: *mut u8, layout: Layout, size: usize) -> *mut u8 {
            COUNT.set(COUNT.get() + 1);
            // SAFETY: as the caller's.
            unsafe { System.realloc(memory, layout, size) }
        }
    }
}

/// How often the steps of some ticks allocate, after others.
fn allocations(world: &mut World, warm_up: u64, ticks: u64) -> usize {
    (0..warm_up).for_each(|_| world.step());
    let before = counting::count();
    (0..ticks).for_each(|_| world.step());
    counting::count() - before
}

/// A scene in which nobody does anything.
fn world_of(name: &str) -> World {
    let scene = Scene::find(name).expect("a scene of this crate");
    let mut game = Sandbox::new(&scene.setup(common::SEED)).expect("the scenes of this crate are valid");
    std::mem::take(game.world_mut())
}

#[test]
fn the_counter_counts() {
    let before = counting::count();
    let mut list = std::hint::black_box(vec![1]);
    list.reserve(100);
    assert_eq!(counting::count() - before, 2);
}

#[test]
fn piles_and_joints_at_rest_allocate_nothing() {
    // A hundred polygons fall for a while before they rest.
    for (name, warm_up) in
        [("pyramid", 60), ("large_pyramid", 60), ("joint_grid", 60), ("hundred_polygons", 400)]
    {
        assert_eq!(allocations(&mut world_of(name), warm_up, 20), 0, "{name}");
    }
}

/// A hanging chain in which the world asks what each joint bears.
#[test]
fn joints_with_thresholds_allocate_nothing() {
    let config = Config { sleeping: false, ..Config::default() };
    let mut world = World::new(config).expect("a valid configuration");
    let disc = ShapeDef::new(Geometry::circle(fx!(0.4)).expect("a valid radius"));
    let mut above = world.spawn(&BodyDef::fixed(), &[disc]).expect("a valid body");
    let threshold = Threshold { force: Some(fx!(100000)), ..Threshold::NONE };
    for link in 1..=20 {
        let body = BodyDef::dynamic().position(fx!(0), Fx::from_num(-link));
        let body = world.spawn(&body, &[disc]).expect("a valid body");
        let joint =
            JointDef::new(above, body, Revolute::default()).anchor_a(fx!(0), fx!(-1)).threshold(threshold);
        world.add_joint(&joint).expect("a valid joint");
        above = body;
    }
    assert_eq!(allocations(&mut world, 60, 60), 0);
}

/// What churns reaches a new largest number of this or that now and then, ever more rarely.
#[test]
fn a_drum_allocates_only_for_new_records() {
    let growths = allocations(&mut world_of("drum"), 120, 240);
    assert!(growths < 30, "{growths} allocations in 240 ticks");
}
