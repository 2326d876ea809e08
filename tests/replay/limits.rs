//! A replay may reach each limit, but not exceed it by one. Memory use depends on the size of the file, and not on its
//! length fields.

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

use lockstep2d::body::{BodyDef, Polygon, ShapeDef};
use lockstep2d::fx;
use lockstep2d::lockstep::{Sandbox, SandboxSetup};
use lockstep2d::math::{Angle, Fx, Vec2};
use lockstep2d::replay::{LimitKind, Limits, RawReplay, Recording, Step, Verdict, verify};
use lockstep2d::world::{BodyPose, Command, Config};

use crate::counter::{Counter, add, inputs_at};
use crate::forge::{Forged, forge};
use crate::record;

fn verdict(file: &[u8], limits: &Limits) -> Verdict {
    verify::<Counter>(file, limits)
}

/// Checks that a limit equal to the needed value suffices, and that a limit smaller by one does not.
fn assert_exact(file: &[u8], limit: LimitKind, needed: u64, set: impl Fn(&mut Limits, u64)) {
    let mut limits = Limits::default();
    set(&mut limits, needed);
    assert!(verdict(file, &limits).is_match(), "{}: {}", limit.name(), verdict(file, &limits));
    set(&mut limits, needed - 1);
    let expected = Verdict::LimitExceeded { limit, value: needed, max: needed - 1 };
    assert_eq!(verdict(file, &limits), expected);
}

#[test]
fn each_limit_is_exact() {
    let narrow = |value: u64| u32::try_from(value).unwrap();
    // A tick costs |-3| + |1| + 1 units.
    let file = record(35, 10, |_| add(-3, 1));
    let length = file.len() as u64;
    assert_exact(&file, LimitKind::FileBytes, length, |limits, max| limits.file_bytes = max);
    assert_exact(&file, LimitKind::SetupBytes, 13, |limits, max| limits.setup_bytes = narrow(max));
    assert_exact(&file, LimitKind::Players, 2, |limits, max| limits.players = narrow(max));
    assert_exact(&file, LimitKind::BlockTicks, 10, |limits, max| limits.block_ticks = narrow(max));
    assert_exact(&file, LimitKind::Ticks, 35, |limits, max| limits.ticks = max);
    assert_exact(&file, LimitKind::TickWork, 5, |limits, max| limits.tick_work = max);
    assert_exact(&file, LimitKind::TotalWork, 175, |limits, max| limits.total_work = max);
    let trailer = 24 + 16 + 1 + 13 + 12;
    assert_exact(&file, LimitKind::BlockBytes, trailer, |limits, max| limits.block_bytes = narrow(max));
}

#[test]
fn a_replay_beyond_a_limit_stays_where_it_is() {
    // Each tick costs 5 units of work. The 20th exceeds the limit.
    let file = record(35, 10, |_| add(-3, 1));
    let limits = Limits { total_work: 99, ..Limits::default() };
    let mut replay = RawReplay::<Counter>::open(&file, &limits).unwrap();
    let expected = Verdict::LimitExceeded { limit: LimitKind::TotalWork, value: 100, max: 99 };
    assert!((0..19).all(|_| replay.step() == Ok(Step::Ticked)));
    assert_eq!([replay.step(), replay.step()], [Err(expected.clone()), Err(expected)]);
    assert_eq!(replay.tick(), 19);
}

#[test]
fn limits_come_before_the_rest_of_the_file() {
    // The file ends after the length and the kind of the first block. The length exceeds the limit.
    let file = record(35, 10, inputs_at);
    let head = 40 + 7 + 13 + 16 + 8;
    let mut cut = file[..head].to_vec();
    cut.extend([0xff, 0xff, 0xff, 0xff, 1]);
    let (value, max) = (u64::from(u32::MAX), u64::from(Limits::default().block_bytes));
    let limit = LimitKind::BlockBytes;
    assert_eq!(verdict(&cut, &Limits::default()), Verdict::LimitExceeded { limit, value, max });
    let mut huge_setup = file[..40].to_vec();
    huge_setup[36..40].fill(0xff);
    let (limit, max) = (LimitKind::SetupBytes, u64::from(Limits::default().setup_bytes));
    assert_eq!(verdict(&huge_setup, &Limits::default()), Verdict::LimitExceeded { limit, value, max });
}

/// An allocator that counts the bytes that this thread holds, and their peak.
struct Counting;

thread_local! {
    static HELD: Cell<usize> = const { Cell::new(0) };
    static MOST: Cell<usize> = const { Cell::new(0) };
}

#[expect(
    unsafe_code,
    reason = "the trait of allocators is unsafe; this one counts and forwards to the system's"
)]
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        let held = HELD.get().wrapping_add(layout.size());
        HELD.set(held);
        MOST.set(MOST.get().max(held));
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        HELD.set(HELD.get().wrapping_sub(layout.size()));
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Largest number of bytes that `work` holds at a time.
fn most_held(work: impl FnOnce()) -> usize {
    let before = HELD.get();
    MOST.set(before);
    work();
    MOST.get() - before
}

#[test]
fn memory_follows_the_file_and_not_its_length_fields() {
    let file = record(35, 10, inputs_at);
    assert!(most_held(|| drop(vec![0_u8; 5000])) >= 5000, "expected the allocator to count");
    let bound = 16 * 1024;
    let honest = most_held(|| assert!(verdict(&file, &Limits::default()).is_match()));
    assert!(honest < bound, "a valid file of {} bytes took {honest} bytes", file.len());
    let assert_small = |damaged: &[u8], what: &str| {
        let took = most_held(|| drop(verdict(damaged, &Limits::default())));
        assert!(took < bound, "{took} bytes for {what}");
    };
    // Writes a huge number at every byte offset, without and with repaired checksums.
    for high in [0x7f, 0x3f, 0x00] {
        let huge = [0xff, 0xff, 0xff, high];
        for at in 0..file.len() - 4 {
            let mut damaged = file.clone();
            damaged[at..at + 4].copy_from_slice(&huge);
            assert_small(&damaged, &format!("a number at byte {at}"));
        }
        let intact = Forged::take_apart(&file);
        for index in 0..intact.blocks.len() {
            for at in 0..intact.blocks[index].1.len() - 4 {
                let mut forged = intact.clone();
                forged.payload(index)[at..at + 4].copy_from_slice(&huge);
                assert_small(&forged.put_together(), &format!("a number in block {index} at {at}"));
            }
        }
    }
    let setup = 40 + "counter".len();
    for length in [1 << 20, 1 << 40, i64::MAX as u64, u64::MAX] {
        let damaged = forge(&file, |forged| {
            forged.header[setup + 4..setup + 12].copy_from_slice(&length.to_le_bytes());
        });
        assert_small(&damaged, &format!("a string that claims {length} bytes"));
    }
}

/// A limit may be reached in the middle of a command. The verifier then discards the world, and does not step it.
#[test]
fn a_limit_within_a_command_is_a_verdict() {
    let square = || vec![ShapeDef::new(Polygon::square(fx!(0.5)).unwrap())];
    let pose = |number: i32| BodyPose {
        position: Vec2::new(Fx::from(number % 20), Fx::from(number / 20)),
        angle: Angle::ZERO,
    };
    let commands = vec![Command::SpawnEach {
        body: BodyDef::dynamic(),
        shapes: square(),
        poses: (0..400).map(pose).collect(),
    }];
    let config = Config { gravity: Vec2::ZERO, ..Config::default() };
    let setup = SandboxSetup { config, commands };
    for sleeps in [false, true] {
        let mut recording = Recording::<Sandbox>::start(&setup, 60).unwrap();
        let bodies: Vec<_> = recording.game().world().bodies().map(|(body, _)| body).collect();
        for tick in 0..12 {
            let commands = match tick {
                4 if sleeps => vec![Command::Sleep { body: bodies[0] }],
                8 => bodies[40..60].iter().map(|&body| Command::Despawn { body }).collect(),
                _ => vec![],
            };
            recording.step(&[commands]).unwrap();
        }
        let file = recording.finish().unwrap();
        let mut replay = RawReplay::<Sandbox>::open(&file, &Limits::default()).unwrap();
        let (mut works, mut before) = (vec![], replay.work());
        while replay.step() == Ok(Step::Ticked) {
            works.push(replay.work() - before);
            before = replay.work();
        }
        for limit in works[8].saturating_sub(400)..works[8] {
            let limits = Limits { tick_work: limit, ..Limits::default() };
            let verdict = verify::<Sandbox>(&file, &limits);
            assert!(matches!(verdict, Verdict::LimitExceeded { .. }), "{limit} of {works:?}: {verdict}");
        }
    }
}
