//! Matches between processes over UDP: all peers end in the same state, and their replays verify. A whole match takes
//! its real time, on a machine that is fast enough for all processes, so only `.ci/run` runs whole matches.

#![expect(clippy::unwrap_used, reason = "a failed unwrap fails the test")]

use std::fs;
use std::net::UdpSocket;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::thread;
use std::time::Duration;

use lockstep2d::replay::{Limits, Part, Reader, Verdict, verify};
use lockstep2d_shove::{Pad, Shove};
use lockstep2d_tests::sweep;

/// Seconds that peers wait for a silent player. This is long enough for a process that gets no CPU time for a while.
const PATIENCE: &str = "8";

/// A folder that is removed on drop.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let folder = std::env::temp_dir().join(format!("shove-play-{}-{name}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        Folder(folder)
    }

    fn file(&self, name: impl AsRef<Path>) -> PathBuf {
        self.0.join(name)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// An address with a free port.
fn free_address() -> String {
    UdpSocket::bind("127.0.0.1:0").unwrap().local_addr().unwrap().to_string()
}

fn play(arguments: &[&str], replay: &Path) -> Child {
    let seed: &[&str] = if arguments.contains(&"--seed") { &[] } else { &["--seed", "5"] };
    Command::new(env!("CARGO_BIN_EXE_shove"))
        .args(["play", "--json", "--patience", PATIENCE])
        .args(seed)
        .args(arguments)
        .arg("--output")
        .arg(replay)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap()
}

fn text(output: &Output) -> String {
    format!("{}{}", String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr))
}

fn events(output: &Output) -> Vec<serde_json::Value> {
    let lines = output.stdout.split(|byte| *byte == b'\n').filter(|line| !line.is_empty());
    lines.map(|line| serde_json::from_slice(line).unwrap_or_else(|_| panic!("{}", text(output)))).collect()
}

fn hash_of(output: &Output) -> String {
    let end = events(output).pop().unwrap_or_else(|| panic!("{}", text(output)));
    assert_eq!(end["event"], "end", "{}", text(output));
    end["hash"].as_str().unwrap_or_else(|| panic!("{}", text(output))).to_owned()
}

/// Starts a host and three joining players.
fn four(folder: &Folder, modes: &[&str], ticks: &str) -> Vec<Child> {
    let address = free_address();
    let common = [modes, &["--players", "4", "--ticks", ticks]].concat();
    let mut children = vec![play(&[&["--host", &address], &common[..]].concat(), &folder.file("0"))];
    for at in ["1", "2", "3"] {
        children.push(play(&[&["--join", &address], &common[..]].concat(), &folder.file(at)));
    }
    children
}

/// Pads of each tick of a replay, which may be truncated.
fn pads(replay: &[u8]) -> Vec<Vec<u8>> {
    let mut pads = Vec::new();
    let mut reader = Reader::open(replay, &Limits::default()).unwrap();
    while let Some(Part::Inputs(block)) = reader.next_part().unwrap() {
        let mut runs = block.runs();
        while let Some(run) = runs.next_run().unwrap() {
            pads.extend(std::iter::repeat_n(run.encoded.to_vec(), run.ticks as usize));
        }
    }
    pads
}

/// Waits until a replay that is being written has at least `ticks` ticks.
fn wait_for_ticks(replay: &Path, ticks: usize) {
    let has_them =
        |replay: Vec<u8>| Reader::open(&replay, &Limits::default()).is_ok() && pads(&replay).len() >= ticks;
    let done = (0..1200).any(|_| {
        thread::sleep(Duration::from_millis(100));
        fs::read(replay).is_ok_and(has_them)
    });
    assert!(done, "the replay should have {ticks} ticks within two minutes");
}

#[test]
#[ignore = "plays in real time: run by .ci/run"]
fn four_processes_end_alike_and_their_replays_verify() {
    sweep::at_once([("lockstep", &["--lockstep"][..]), ("rollback", &[])], |(name, modes)| {
        let folder = Folder::new(name);
        let outputs: Vec<_> =
            four(&folder, modes, "400").into_iter().map(|child| child.wait_with_output().unwrap()).collect();
        for output in &outputs {
            assert!(output.status.success(), "{name}: {}", text(output));
            assert_eq!(hash_of(output), hash_of(&outputs[0]));
        }
        let replays: Vec<_> = ["0", "1", "2", "3"].map(|at| fs::read(folder.file(at)).unwrap()).into();
        for replay in &replays {
            let verdict = verify::<Shove>(replay, &Limits::default());
            let Verdict::Match { ticks: 400, hash } = verdict else { panic!("{name}: {verdict}") };
            assert_eq!(hash.to_string(), hash_of(&outputs[0]));
            assert_eq!(pads(replay), pads(&replays[0]));
        }
    });
}

#[test]
#[ignore = "plays in real time: run by .ci/run"]
fn a_killed_process_leaves_a_valid_replay_and_the_others_agree_when() {
    sweep::at_once([("kill-lockstep", &["--lockstep"][..]), ("kill-rollback", &[])], |(name, modes)| {
        let folder = Folder::new(name);
        let mut children = four(&folder, modes, "600");
        wait_for_ticks(&folder.file("2"), 120);
        let mut killed = children.remove(2);
        killed.kill().unwrap();
        killed.wait().unwrap();
        let cut = fs::read(folder.file("2")).unwrap();
        let outputs: Vec<_> = children.into_iter().map(|child| child.wait_with_output().unwrap()).collect();
        for output in &outputs {
            assert!(output.status.success(), "{name}: {}", text(output));
            assert_eq!(hash_of(output), hash_of(&outputs[0]));
        }
        let verdict = verify::<Shove>(&cut, &Limits::default());
        let Verdict::Incomplete { .. } = verdict else { panic!("{name}: {verdict}") };
        let replays: Vec<_> = ["0", "1", "3"].map(|at| fs::read(folder.file(at)).unwrap()).into();
        let all = pads(&replays[0]);
        for replay in &replays {
            let verdict = verify::<Shove>(replay, &Limits::default());
            assert!(matches!(verdict, Verdict::Match { ticks: 600, .. }), "{name}: {verdict}");
            assert_eq!(pads(replay), all);
        }
        // The inputs in the replay of the killed process are a prefix of those in the other replays.
        let seen = pads(&cut);
        assert!(seen.len() >= 120 && all.starts_with(&seen), "{name}: {} ticks", seen.len());
        let absent = lockstep2d::codec::encode(&Pad::ABSENT)[0];
        let last = all.last().unwrap();
        assert_eq!(last.iter().filter(|pad| **pad == absent).count(), 1, "{name}: {last:?}");
    });
}

#[test]
fn another_seed_or_number_of_seats_is_another_match() {
    for (option, value, why) in
        [("--seats", "2", "number of seats 2 here and 4 there"), ("--seed", "6", "setup ")]
    {
        let folder = Folder::new(&format!("terms{option}"));
        let address = free_address();
        let mut host = play(&["--host", &address], &folder.file("0"));
        let guest = play(&["--join", &address, option, value], &folder.file("1"));
        let output = guest.wait_with_output().unwrap();
        host.kill().unwrap();
        host.wait().unwrap();
        assert_eq!(output.status.code(), Some(2), "{}", text(&output));
        assert!(text(&output).contains(why), "{}", text(&output));
    }
}

/// A process exits with an error if its seat does not exist or is taken, or if the number of players is impossible.
#[test]
fn wrong_seats_are_refused() {
    let folder = Folder::new("seats");
    let address = free_address();
    let refused = |arguments: &[&str], why: &str| {
        let output = play(arguments, &folder.file("refused")).wait_with_output().unwrap();
        assert_eq!(output.status.code(), Some(2), "{}", text(&output));
        assert!(text(&output).contains(why), "{}", text(&output));
        assert!(!folder.file("refused").exists(), "a match that did not begin leaves a replay");
    };
    refused(&["--join", &address, "--seat", "4"], "there is no seat 4: the match has seats 0 to 3");
    refused(&["--host", &address, "--players", "5"], "--players 5: the match has 4 seats");
    refused(&["--host", &address, "--players", "0"], "--players 0: the match has 4 seats");
    let mut host = play(&["--host", &address, "--seat", "2"], &folder.file("host"));
    refused(&["--join", &address, "--seat", "2"], "seat 2 is taken");
    host.kill().unwrap();
    host.wait().unwrap();
}

/// After an interrupt the other players continue without waiting, and the replay of the interrupted process is
/// complete.
#[cfg(unix)]
#[test]
#[ignore = "plays in real time: run by .ci/run"]
fn an_interrupted_process_leaves_and_its_replay_verifies() {
    let folder = Folder::new("interrupt");
    let mut children = four(&folder, &["--lockstep"], "600");
    wait_for_ticks(&folder.file("2"), 120);
    let leaver = children.remove(2);
    let pid = leaver.id().to_string();
    assert!(Command::new("kill").args(["-INT", &pid]).status().unwrap().success());
    let left = leaver.wait_with_output().unwrap();
    assert!(left.status.success(), "{}", text(&left));
    assert!(events(&left).iter().any(|event| event["status"] == "left"), "{}", text(&left));
    let verdict = verify::<Shove>(&fs::read(folder.file("2")).unwrap(), &Limits::default());
    assert!(verdict.is_match(), "{verdict}");
    let gone = pads(&fs::read(folder.file("2")).unwrap());
    for (child, at) in children.into_iter().zip(["0", "1", "3"]) {
        let output = child.wait_with_output().unwrap();
        assert!(output.status.success(), "{}", text(&output));
        let stall = events(&output).pop().and_then(|end| end["stall_max_ms"].as_u64()).unwrap();
        assert!(stall < 4000, "the others should not wait for the patience: {}", text(&output));
        let replay = fs::read(folder.file(at)).unwrap();
        assert!(verify::<Shove>(&replay, &Limits::default()).is_match());
        assert!(pads(&replay).starts_with(&gone), "one match has one history");
    }
}

/// The process refuses to start, and its error message names the reason.
#[test]
fn an_earlier_replay_is_not_replaced() {
    let folder = Folder::new("earlier");
    let earlier = folder.file("0");
    fs::write(&earlier, b"an earlier match").unwrap();
    let output = play(&["--host", &free_address()], &earlier).wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(2));
    let said = text(&output) + &String::from_utf8_lossy(&output.stderr);
    assert!(said.contains("it exists"), "{said}");
    assert_eq!(fs::read(&earlier).unwrap(), b"an earlier match");
}
