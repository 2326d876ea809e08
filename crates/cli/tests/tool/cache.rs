//! `verify --cache`: a file with a cached verdict is not played again, and a damaged entry is never used.

use std::fs;
use std::path::PathBuf;
use std::thread;

use lockstep2d::replay::Limits;
use lockstep2d_cli::{Exit, Tool};
use serde_json::{Value, json};

use crate::batch::{fuse, run_bomb};
use crate::counter::Counter;
use crate::{Folder, Outcome, replay, run, run_tool};

/// The lines without their field `cached`, and the number of lines in which this field was true.
fn uncached(outcome: &Outcome) -> (Vec<Value>, usize) {
    let mut lines: Vec<Value> = outcome.out.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let taken = lines.iter_mut().map(|line| line.as_object_mut().unwrap().remove("cached").unwrap());
    let cached = taken.filter(|cached| *cached == json!(true)).count();
    (lines, cached)
}

fn entries(folder: &Folder) -> Vec<PathBuf> {
    let mut entries: Vec<PathBuf> =
        fs::read_dir(folder.path("cache")).unwrap().map(|entry| entry.unwrap().path()).collect();
    entries.sort();
    entries
}

/// Writes five files, with several different verdicts.
fn files(folder: &Folder) {
    let good = replay(35);
    folder.write("in/good.replay", &good);
    folder.write("in/same.replay", &good);
    folder.write("in/cut.replay", &good[..good.len() - 1]);
    folder.write("in/garbage.replay", b"no replay");
    let mut other = good.clone();
    other[8] = 7;
    folder.write("in/other.replay", &other);
}

#[test]
fn a_second_run_knows_what_the_first_has_found() {
    let folder = Folder::new("cache");
    files(&folder);
    let (path, cache) = (folder.path("in"), folder.path("deep/cache"));
    let plain = run(&["verify", "--json", &path]);
    let arguments = ["verify", "--json", "--jobs", "1", "--cache", &cache, &path];
    let (first, second) = (run(&arguments), run(&arguments));
    assert_eq!(uncached(&plain).1, 0);
    assert_eq!(uncached(&first), (uncached(&plain).0, 1), "two files have the same bytes");
    assert_eq!(uncached(&second), (uncached(&plain).0, 5));
    assert_eq!((first.exit, second.exit), (Exit::NoMatch, Exit::NoMatch));
    assert!(second.err.contains("; 5 known from the cache; 0 ticks in "), "{}", second.err);
    let count = fs::read_dir(&cache).unwrap().count();
    assert_eq!(count, 4, "one entry for each distinct content, and no other file");

    let for_people = |arguments: &[&str]| {
        let outcome = run(arguments);
        outcome.out.lines().take(5).map(String::from).collect::<Vec<_>>()
    };
    assert_eq!(for_people(&["verify", "--cache", &cache, &path]), for_people(&["verify", &path]));
}

#[test]
fn a_damaged_entry_is_ignored_and_written_anew() {
    let folder = Folder::new("corrupt");
    files(&folder);
    let (path, cache) = (folder.path("in"), folder.path("cache"));
    let arguments = ["verify", "--json", "--cache", &cache, &path];
    let plain = uncached(&run(&["verify", "--json", &path])).0;
    run(&arguments);
    let whole: Vec<(PathBuf, Vec<u8>)> =
        entries(&folder).into_iter().map(|path| (path.clone(), fs::read(path).unwrap())).collect();
    let restored = || whole.iter().all(|(path, bytes)| fs::read(path).unwrap() == *bytes);

    // Flips every fifth bit of one entry, one at a time. Then cuts or replaces the entry.
    let (victim, bytes) = &whole[0];
    for bit in (0..bytes.len() * 8).step_by(5) {
        let mut damaged = bytes.clone();
        damaged[bit / 8] ^= 1 << (bit % 8);
        fs::write(victim, &damaged).unwrap();
        assert_eq!(uncached(&run(&arguments)).0, plain, "bit {bit}");
        assert!(restored(), "bit {bit}");
    }
    for damaged in [&bytes[..0], &bytes[..bytes.len() / 2], b"\xff\xfe", b"{}", b"null"] {
        fs::write(victim, damaged).unwrap();
        assert_eq!(uncached(&run(&arguments)).0, plain);
        assert!(restored());
    }
    // Copies another entry over `victim`. Then replaces `victim` by a folder.
    fs::copy(&whole[1].0, victim).unwrap();
    assert_eq!(uncached(&run(&arguments)).0, plain);
    assert!(restored());
    fs::remove_file(victim).unwrap();
    fs::create_dir(victim).unwrap();
    let outcome = run(&arguments);
    assert_eq!(uncached(&outcome).0, plain);
    assert!(outcome.err.starts_with("warning: verdicts cannot be cached: "), "{}", outcome.err);
}

#[test]
fn other_limits_are_other_questions() {
    let folder = Folder::new("limits");
    files(&folder);
    let (path, cache) = (folder.path("in"), folder.path("cache"));
    let with = |more: &[&str]| {
        let arguments = [&["verify", "--json", "--cache", &cache, &path], more].concat();
        uncached(&run(&arguments))
    };
    with(&[]);
    let same = entries(&folder).len();
    for (flag, number) in
        [("bytes", "100"), ("ticks", "30"), ("bodies", "1"), ("tick-work", "3"), ("work", "30")]
    {
        let flag = format!("--max-{flag}");
        let (limited, cached) = with(&[&flag, number]);
        assert!(cached <= 2, "{flag}: files share an entry only if the bytes that are read are equal");
        assert_eq!(limited, uncached(&run(&["verify", "--json", &path, &flag, number])).0, "{flag}");
        assert_eq!(with(&[&flag, number]), (limited, 5), "{flag}");
    }
    assert!(entries(&folder).len() > 5 * same - 5);
    // A flag that repeats the default gives the same key. Other limits of the tool give another key.
    let default = Limits::default().ticks.to_string();
    assert_eq!(with(&["--max-ticks", &default]).1, 5);
    let tool = Tool::<Counter>::new().with_limits(Limits { players: 3, ..Limits::default() });
    let outcome = run_tool(&tool, &["verify", "--json", "--cache", &cache, &path]);
    assert!(uncached(&outcome).1 <= 1);
}

#[test]
fn a_panic_is_not_kept() {
    let folder = Folder::new("cached-panic");
    let file = folder.write("fuse.replay", &fuse(3));
    let arguments = ["verify", "--json", "--cache", &folder.path("cache"), &file];
    for _ in 0..2 {
        let outcome = run_bomb(&arguments);
        assert!(outcome.out.contains("\"panicked\""), "{}", outcome.out);
        assert_eq!(uncached(&outcome).1, 0);
    }
    assert!(entries(&folder).is_empty());
}

#[test]
fn a_cache_is_shared() {
    let folder = Folder::new("shared");
    for number in 0..60 {
        folder.write(&format!("in/{number}.replay"), &replay(number / 2));
    }
    let (path, cache) = (folder.path("in"), folder.path("cache"));
    let expected = uncached(&run(&["verify", "--json", &path])).0;
    thread::scope(|scope| {
        for _ in 0..4 {
            scope.spawn(|| {
                let outcome = run(&["verify", "--json", "--jobs", "3", "--cache", &cache, &path]);
                assert_eq!(uncached(&outcome).0, expected);
                assert!(!outcome.err.contains("warning"), "{}", outcome.err);
            });
        }
    });
    assert_eq!(entries(&folder).len(), 30, "no temporary files are left");
}

#[test]
fn a_folder_that_cannot_be_made_is_trouble() {
    let folder = Folder::new("unmakeable");
    let file = folder.write("good.replay", &replay(3));
    let outcome = run(&["verify", "--cache", &format!("{file}/cache"), &file]);
    assert_eq!((outcome.exit, outcome.out.as_str()), (Exit::Trouble, ""));
    assert!(outcome.err.starts_with("error: cannot write "), "{}", outcome.err);
}
