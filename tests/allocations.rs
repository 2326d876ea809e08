//! A step allocates nothing once the buffers of the world have grown.

use lockstep2d::body::{BodyDef, Geometry, ShapeDef};
use lockstep2d::fx;
use lockstep2d::lockstep::{Game, Sandbox, SandboxSetup};
use lockstep2d::math::Fx;
use lockstep2d::replay::{Limits, Recording, Timeline, TimelineOptions};
use lockstep2d::solver::{JointDef, Revolute, Threshold};
use lockstep2d::world::{Config, Snapshot, World};
use lockstep2d_scenes::Scene;

/// Counts allocations and bytes for each thread.
mod counting {
    #![expect(unsafe_code, reason = "the trait of allocators is unsafe")]

    use std::alloc::{GlobalAlloc, Layout, System};
    use std::cell::Cell;

    struct Counting;

    #[global_allocator]
    static ALLOCATOR: Counting = Counting;

    thread_local! {
        static COUNT: Cell<usize> = const { Cell::new(0) };
        static BYTES: Cell<usize> = const { Cell::new(0) };
    }

    fn add(bytes: usize) {
        COUNT.set(COUNT.get() + 1);
        BYTES.set(BYTES.get() + bytes);
    }

    pub(super) fn count() -> usize {
        COUNT.get()
    }

    pub(super) fn bytes() -> usize {
        BYTES.get()
    }

    // SAFETY: forwards to the system allocator.
    unsafe impl GlobalAlloc for Counting {
        unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
            add(layout.size());
            // SAFETY: the caller upholds the contract of `alloc`.
            unsafe { System.alloc(layout) }
        }

        unsafe fn dealloc(&self, memory: *mut u8, layout: Layout) {
            // SAFETY: the caller upholds the contract of `dealloc`.
            unsafe { System.dealloc(memory, layout) }
        }

        unsafe fn realloc(&self, memory: *mut u8, layout: Layout, size: usize) -> *mut u8 {
            add(size);
            // SAFETY: the caller upholds the contract of `realloc`.
            unsafe { System.realloc(memory, layout, size) }
        }
    }
}

/// Number of allocations in `ticks` steps after `warm_up` steps.
fn allocations(world: &mut World, warm_up: u64, ticks: u64) -> usize {
    (0..warm_up).for_each(|_| world.step());
    let before = counting::count();
    (0..ticks).for_each(|_| world.step());
    counting::count() - before
}

/// The initial world of a scene. The tests step it without the commands of the scene.
fn world_of(name: &str) -> World {
    let scene = Scene::find(name).expect("a scene of this crate");
    let mut game =
        Sandbox::new(&scene.setup(lockstep2d_tests::SEED)).expect("the scenes of this crate are valid");
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
    // The hundred polygons fall asleep after 4.8 s.
    for (name, warm_up) in
        [("pyramid", 60), ("large_pyramid", 60), ("joint_grid", 60), ("hundred_polygons", 264)]
    {
        assert_eq!(allocations(&mut world_of(name), warm_up, 20), 0, "{name}");
    }
}

/// Every tick compares the loads of the joints of a hanging chain with their thresholds.
#[test]
fn joints_with_thresholds_allocate_nothing() {
    let config = Config { sleeping: false, ..Config::default() };
    let mut world = World::new(config).expect("a valid configuration");
    let disc = ShapeDef::new(Geometry::circle(fx!(0.4)).expect("a valid radius"));
    let mut above = world.spawn(&BodyDef::fixed(), &[disc]).expect("a valid body");
    let threshold = Threshold { force: Some(fx!(100000)), ..Threshold::NONE };
    for link in 1..=20 {
        let body = BodyDef::dynamic().position((fx!(0), Fx::from_num(-link)));
        let body = world.spawn(&body, &[disc]).expect("a valid body");
        let joint =
            JointDef::new(above, body, Revolute::default()).anchor_a((fx!(0), fx!(-1))).threshold(threshold);
        world.add_joint(&joint).expect("a valid joint");
        above = body;
    }
    assert_eq!(allocations(&mut world, 60, 60), 0);
}

/// `save_into` packs the data that ticks change (52 bytes for a body with one shape) into the memory of the snapshot
/// that it replaces. It allocates only lists of digests: 16 bytes for each page of 32 bodies, shapes or joints.
#[test]
fn saving_every_tick_allocates_no_room_for_bodies() {
    // `large_pyramid` has bodies at rest, nearly all bodies of `smash` are asleep, and `joint_grid` has hinges.
    for (name, warm_up) in [("large_pyramid", 60), ("smash", 20), ("joint_grid", 60)] {
        let mut world = world_of(name);
        (0..warm_up).for_each(|_| world.step());
        let mut ring: [Snapshot; 4] = std::array::from_fn(|_| world.save());
        for tick in 0..28 {
            let before = counting::count();
            world.step();
            let (stepped, bytes) = (counting::count(), counting::bytes());
            world.save_into(&mut ring[tick % 4]);
            let per_body = (counting::bytes() - bytes) / world.body_count();
            if tick >= 8 {
                assert_eq!(stepped - before, 0, "{name}, tick {tick}");
                // Debug builds allocate more: they pack sleeping contacts a second time, for comparison.
                let is_lean = cfg!(debug_assertions) || per_body < 5;
                assert!(is_lean, "{per_body} bytes per body of {name}, tick {tick}");
            }
        }
    }
}

/// In a changing scene, a buffer allocates only when it needs more room than ever before.
#[test]
fn a_drum_allocates_only_for_new_records() {
    let growths = allocations(&mut world_of("drum"), 120, 240);
    assert!(growths < 30, "{growths} allocations in 240 ticks");
}

/// A file may have a keyframe for every tick. The timeline drops keyframes beyond its budget while it reads the file,
/// not afterwards.
#[test]
fn keyframes_from_a_file_take_no_more_memory_than_their_budget() {
    let ticks = 2000;
    let mut recording = Recording::<Sandbox>::start(&SandboxSetup::default(), 1).expect("a setup");
    (0..ticks).for_each(|_| recording.step(&[Vec::new()]).expect("one input"));
    let file = recording.finish().expect("no claims");
    let open = |bytes| {
        let options = TimelineOptions { interval: 1, bytes };
        Timeline::<Sandbox>::open(&file, &options, &Limits::default()).expect("a replay")
    };
    let mut timeline = open(64 << 20);
    timeline.play_all().expect("a valid replay");
    let keyframes = timeline.keyframes_to_bytes();
    let mut narrow = open(64 << 10);
    let before = counting::bytes();
    narrow.use_keyframes(&keyframes).expect("of this replay");
    let used = counting::bytes() - before;
    let (all, few) = (timeline.keyframes().count(), narrow.keyframes().count());
    println!("{few} of {all} keyframes: {used} bytes for a file of {} bytes", keyframes.len());
    assert!(all == 2001 && few < 100);
    // Decoding the file takes about as much memory as the file itself. All else must take less than that again.
    assert!(used < 2 * keyframes.len(), "{used} bytes for a file of {} bytes", keyframes.len());
}
