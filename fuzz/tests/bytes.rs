//! Runs the fuzz targets whose input is a file or packets. Tests that random inputs give each target several different
//! results, and prints the number of runs per second.

use std::collections::BTreeMap;

use lockstep2d::math::Rng;
use lockstep2d_fuzz::bytes::{replay, report, session, snapshot};

fn inputs(count: u64) -> impl Iterator<Item = Vec<u8>> {
    (0..count).map(|seed| {
        let mut rng = Rng::new(seed);
        (0..1 + rng.below(100)).map(|_| rng.next_u32() as u8).collect()
    })
}

/// Counts the occurrences of each result.
fn answers<T: Ord + std::fmt::Debug>(count: u64, run: impl Fn(&[u8]) -> T) -> BTreeMap<T, u64> {
    let start = std::time::Instant::now();
    let mut answers = BTreeMap::new();
    for input in inputs(count) {
        *answers.entry(run(&input)).or_insert(0) += 1;
    }
    println!("{answers:?}, {} a second", count * 1_000_000 / start.elapsed().as_micros().max(1) as u64);
    answers
}

#[test]
fn replays_are_judged() {
    let answers = answers(20_000, replay::run);
    assert!(answers.len() >= 5, "{answers:?}");
    for file in replay::originals() {
        let plain = [&[0], file.as_slice()].concat();
        let repaired = [&[1], file.as_slice()].concat();
        assert_eq!(replay::run(&plain), replay::run(&repaired), "repairing a valid file does not change it");
    }
}

#[test]
fn snapshots_are_judged() {
    let answers = answers(20_000, snapshot::run);
    assert!(answers[&true] > 20, "{answers:?}");
    for file in snapshot::originals() {
        assert!(snapshot::run(&[&[0], file.as_slice()].concat()));
        assert!(snapshot::run(&[&[1], file.as_slice()].concat()));
    }
}

#[test]
fn reports_are_judged() {
    let answers = answers(20_000, report::run);
    assert!(answers.len() >= 4, "{answers:?}");
    let judged = report::originals().iter().map(|file| report::run(&[&[64], file.as_slice()].concat()));
    assert_eq!(judged.collect::<Vec<_>>(), ["nobody", "blamed", "not compared", "not compared"]);
    let judged = report::originals().iter().map(|file| report::run(&[&[0], file.as_slice()].concat()));
    assert_eq!(judged.collect::<Vec<_>>(), ["not compared", "not compared", "nobody", "blamed"]);
}

#[test]
fn sessions_mostly_survive() {
    let answers = answers(300, session::run);
    assert!(answers[&true] > 20, "{answers:?}");
}

/// Writes the initial seeds of the fuzzer: `cargo test --test bytes -- --ignored`.
#[test]
#[ignore = "writes into the tree"]
fn write_seeds() {
    let seeds = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("seeds");
    let write = |target: &str, name: &str, bytes: &[u8]| {
        let folder = seeds.join(target);
        std::fs::create_dir_all(&folder).expect("the folder can be created");
        std::fs::write(folder.join(name), bytes).expect("the file can be written");
    };
    let targets = [
        ("replay_bytes", replay::originals()),
        ("snapshot_bytes", snapshot::originals()),
        ("report_bytes", report::originals()),
    ];
    for (target, originals) in targets {
        for (at, file) in originals.iter().enumerate() {
            write(target, &format!("whole_{at}"), &[&[0], file.as_slice()].concat());
            write(target, &format!("repaired_{at}"), &[&[1 | 64], file.as_slice()].concat());
            for way in [2, 3] {
                let mode = way | (at as u8) << 2;
                write(target, &format!("changed_{at}_{way}"), &[mode, 2, 0, 9, 1, 200, 7, 3, 50]);
            }
        }
    }
    for (at, input) in inputs(40).enumerate() {
        write("session", &format!("attack_{at}"), &input);
        write("matches", &format!("attack_{at}"), &input);
    }
}
