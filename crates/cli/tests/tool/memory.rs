//! Memory of all tools for files that are made to be large, against the table of docs/VERIFYING.md.

use std::process::{Command, Stdio};
use std::time::Duration;
use std::{fs, thread};

use lockstep2d::body::{BodyDef, Polygon, ShapeDef};
use lockstep2d::fx;
use lockstep2d::lockstep::{Sandbox, SandboxSetup};
use lockstep2d::math::{Angle, Fx, Vec2};
use lockstep2d::replay::Recording;
use lockstep2d::world::{BodyPose, Command as Edit, Config};

use crate::{Folder, golden, sweep};

/// Peak resident memory in KiB of the tool as its own process, so that memory of other tests does not count.
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

/// A replay of ten ticks without commands of a world with one square at each place.
fn squares(places: impl Iterator<Item = (Fx, Fx)>) -> Vec<u8> {
    let pose = |(x, y)| BodyPose { position: Vec2::new(x, y), angle: Angle::ZERO };
    let square = ShapeDef::new(Polygon::square(fx!(0.5)).unwrap());
    let body = BodyDef::dynamic();
    let commands = vec![Edit::SpawnEach { body, shapes: vec![square], places: places.map(pose).collect() }];
    let setup = SandboxSetup { config: Config::default(), commands };
    let mut recording = Recording::<Sandbox>::start(&setup, 5).unwrap();
    for _ in 0..10 {
        recording.step(&[Vec::new()]).unwrap();
    }
    recording.finish().unwrap()
}

/// Memory in KB that the tool takes by itself without optimisation, because its code is larger.
const UNOPTIMISED: u64 = if cfg!(debug_assertions) { 3_000 } else { 0 };

/// A file of the table, and the memory in KB that its row allows `verify`. The other tools may take a multiple of it.
#[test]
fn no_tool_takes_more_memory_than_is_documented() {
    let folder = Folder::new("memory");
    let [pile, field, output] = ["pile.replay", "field.replay", "output"].map(|name| folder.path(name));
    fs::write(&pile, squares((0..400).map(|_| (fx!(0), fx!(0))))).unwrap();
    fs::write(&field, squares((0..50_000).map(|at| (fx!(2) * (at % 200), fx!(2) * (at / 200))))).unwrap();
    let (honest, mut wrong) = (golden("box_stack"), Vec::new());
    // Some tools take seconds for the field.
    let files = sweep::sample([(&pile, 250_000), (&field, 130_000), (&honest, 10_000)], 2);
    for (file, most) in files {
        for (times, arguments) in [
            (1, &["verify"][..]),
            (1, &["inspect"]),
            (1, &["inspect", "--tick", "5"]),
            (1, &["stats"]),
            (1, &["bisect"]),
            (2, &["seek", "--tick", "5"]),
            (2, &["trim", "--force", "-o", &output]),
            (2, &["fork", "--tick", "5", "--force", "-o", &output]),
            (2, &["trace", "--to", "5", "--ticks", "1", "--force", "-o", &output]),
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
