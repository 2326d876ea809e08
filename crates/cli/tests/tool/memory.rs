//! Peak memory of the commands, compared with the table of docs/VERIFYING.md.

use std::process::{Command, Stdio};
use std::time::Duration;
use std::{fs, thread};

use lockstep2d::body::{BodyDef, BodyId, Polygon, ShapeDef};
use lockstep2d::codec;
use lockstep2d::fx;
use lockstep2d::lockstep::{Sandbox, SandboxSetup};
use lockstep2d::math::{Angle, Fx, Vec2};
use lockstep2d::replay::Recording;
use lockstep2d::solver::{JointDef, JointKind, Motor, Weld};
use lockstep2d::world::{BodyPose, Command as Edit, Config};

use crate::{Folder, golden, sweep};

/// Runs the tool as its own process. Returns the peak resident memory of this process in KiB.
pub(crate) fn peak(arguments: &[&str]) -> u64 {
    let mut child = Command::new(env!("CARGO_BIN_EXE_lockstep2d"))
        .args(arguments)
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let mut peak = 0;
    while child.try_wait().unwrap().is_none() {
        peak = peak_so_far(child.id()).unwrap_or(0).max(peak);
        thread::sleep(Duration::from_millis(2));
    }
    peak
}

fn peak_so_far(pid: u32) -> Option<u64> {
    let status = fs::read_to_string(format!("/proc/{pid}/status")).ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
    line.split_whitespace().nth(1)?.parse().ok()
}

/// Edits that add a body with one square at each position.
fn squares(positions: impl Iterator<Item = (Fx, Fx)>) -> Vec<Edit> {
    let pose = |(x, y)| BodyPose { position: Vec2::new(x, y), angle: Angle::ZERO };
    let square = ShapeDef::new(Polygon::square(fx!(0.5)).unwrap());
    let body = BodyDef::dynamic();
    vec![Edit::SpawnEach { body, shapes: vec![square], poses: positions.map(pose).collect() }]
}

/// A pile of squares on one spot, which all touch each other.
fn pile(count: usize) -> Vec<Edit> {
    squares(std::iter::repeat_n((fx!(0), fx!(0)), count))
}

/// Squares that do not touch.
fn field(count: i64) -> Vec<Edit> {
    squares((0..count).map(|at| (fx!(2) * (at % 1000), fx!(2) * (at / 1000))))
}

/// Two bodies with `count` joints of one kind between them.
fn joints(count: usize, kind: impl Into<JointKind>) -> Vec<Edit> {
    let body = |slot: u32| codec::decode::<BodyId>(&u64::from(slot).to_le_bytes()).unwrap();
    let ends = vec![(body(0), body(1)); count];
    let joint = JointDef::new(body(0), body(1), kind);
    let mut commands = squares([(fx!(0), fx!(0)), (fx!(9), fx!(0))].into_iter());
    commands.push(Edit::AddJointEach { joint, ends });
    commands
}

/// A motor joint without springs. The solver never solves joints of this kind in blocks, so they need no memory for
/// blocks.
fn motor() -> Motor {
    Motor::new().linear(Vec2::ZERO, fx!(1)).angular(fx!(0), fx!(1))
}

/// A replay of a world with these commands in its setup. The ticks have no commands.
fn replay_of(commands: Vec<Edit>, ticks: u32) -> Vec<u8> {
    let setup = SandboxSetup { config: Config::default(), commands };
    let mut recording = Recording::<Sandbox>::start(&setup, 5).unwrap();
    for _ in 0..ticks {
        recording.step(&[Vec::new()]).unwrap();
    }
    recording.finish().unwrap()
}

/// Measures the rows of the table in docs/VERIFYING.md: all of them with `LOCKSTEP2D_LONG=1`, otherwise only the first.
#[test]
fn verify_takes_no_more_memory_than_is_documented() {
    type Row = (&'static str, fn() -> Vec<Edit>, u32, &'static str, u64);
    const DEFAULT: &str = "10000000";
    // The columns are a name, the commands of the setup, the number of ticks, the limit of work units for a tick, and
    // the memory in KB. Some rows have one tick, because a tick of a million joints is slow to record.
    let rows: [Row; 8] = [
        ("200 squares on one spot", || pile(200), 10, "110000", 25_000),
        ("20 000 separate bodies", || field(20_000), 10, DEFAULT, 70_000),
        ("400 squares on one spot", || pile(400), 10, "500000", 75_000),
        ("800 squares on one spot", || pile(800), 10, "2000000", 190_000),
        ("800 000 separate bodies", || field(800_000), 1, DEFAULT, 1_700_000),
        ("a million motors", || joints(1_000_000, motor()), 1, DEFAULT, 1_300_000),
        ("a million welds", || joints(1_000_000, Weld::rigid()), 1, DEFAULT, 1_200_000),
        ("2800 squares on one spot", || pile(2800), 2, DEFAULT, 190_000),
    ];
    let folder = Folder::new("memory-rows");
    let file = folder.path("file.replay");
    let mut wrong = Vec::new();
    for &(name, commands, ticks, tick_work, most) in &rows[..sweep::size(rows.len(), 1)] {
        fs::write(&file, replay_of(commands(), ticks)).unwrap();
        let peak = peak(&["verify", "--max-tick-work", tick_work, &file]) * 1024 / 1000;
        println!("{peak} KB of {most}: {name}");
        if peak > most + UNOPTIMISED {
            wrong.push((name, peak, most));
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

/// Additional memory of unoptimised code, in KB.
const UNOPTIMISED: u64 = if cfg!(debug_assertions) { 3_000 } else { 0 };

/// Each command takes at most `times` the memory that the table states for `verify`. `most` is this memory in KB.
#[test]
fn no_tool_takes_more_memory_than_is_documented() {
    let folder = Folder::new("memory");
    let [dense, wide, output] = ["pile.replay", "field.replay", "output"].map(|name| folder.path(name));
    fs::write(&dense, replay_of(pile(400), 10)).unwrap();
    fs::write(&wide, replay_of(field(20_000), 10)).unwrap();
    let (honest, mut wrong) = (golden("box_stack"), Vec::new());
    // Only some files are measured in each run, because some commands take seconds for the many bodies of `wide`.
    let files = sweep::sample([(&dense, 75_000), (&wide, 70_000), (&honest, 10_000)], 2);
    for (file, most) in files {
        for (times, arguments) in [
            (1, &["verify"][..]),
            (1, &["inspect"]),
            (5, &["inspect", "--tick", "5"]),
            (1, &["stats"]),
            (1, &["bisect"]),
            (2, &["seek", "--tick", "5"]),
            (2, &["trim", "--force", "-o", &output]),
            (2, &["fork", "--tick", "5", "--force", "-o", &output]),
            (3, &["trace", "--to", "5", "--force", "-o", &output]),
            (6, &["stress-saves", "--to", "5"]),
        ] {
            let peak = peak(&[arguments, &[file]].concat()) * 1024 / 1000;
            println!("{peak} KB: {} {file}", arguments[0]);
            if peak > times * most + UNOPTIMISED {
                wrong.push((arguments[0], file, peak, times * most));
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}
