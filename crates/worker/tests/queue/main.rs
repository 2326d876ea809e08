//! The queue with a real server. Every file has one result, which is equal to the line of `verify --json`, even if
//! workers or the server are killed.
//!
//! `LOCKSTEP2D_WORKER_FILES` is the number of files in the largest test, 300 by default.
#![cfg(unix)]
#![expect(clippy::unwrap_used, reason = "a failure in a helper fails the test")]

mod bucket;
mod objects;
mod server;
mod signals;

use std::fs;
use std::io::{Read, Write};
use std::net::TcpStream;
use std::path::PathBuf;
use std::time::{Duration, Instant};

use lockstep2d::body::{BodyDef, Polygon, ShapeDef};
use lockstep2d::fx;
use lockstep2d::lockstep::{Sandbox, SandboxSetup};
use lockstep2d::math::{Fx, Vec2};
use lockstep2d::replay::Recording;
use lockstep2d::world::{Command, Config};
use lockstep2d_cli::Tool;
use serde_json::{Value, json};

use server::{Folder, PATIENCE, Process, Program, Server, free_port, wait_until};

/// Number of workers that are killed and started again.
const WORKERS: usize = 4;

/// SplitMix64.
fn random(state: &mut u64) -> u64 {
    *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let value = (*state ^ (*state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    value ^ (value >> 27)
}

/// A replay of squares that fall on the ground. Replays with different `number` have different bytes.
fn replay(number: u64, squares: i64, ticks: u64) -> Vec<u8> {
    let square = |side: Fx| ShapeDef::new(Polygon::square(side).unwrap());
    let aside = fx!(0.0001) * i64::try_from(number).unwrap();
    let fall = (0..squares).map(|index| Vec2::new(aside, fx!(1) + fx!(0.6) * index));
    let spawn = |body: BodyDef, side| Command::Spawn { body, shapes: vec![square(side)] };
    let ground = spawn(BodyDef::fixed().position((fx!(0), fx!(-8))), fx!(8));
    let commands = fall.map(|place| spawn(BodyDef::dynamic().position(place), fx!(0.25)));
    record(std::iter::once(ground).chain(commands).collect(), ticks)
}

fn record(commands: Vec<Command>, ticks: u64) -> Vec<u8> {
    let setup = SandboxSetup { config: Config::default(), commands };
    let mut recording = Recording::<Sandbox>::start(&setup, 60).unwrap();
    for _ in 0..ticks {
        recording.step(&[Vec::new()]).unwrap();
    }
    recording.finish().unwrap()
}

/// Writes `count` files. Of eleven files, one is damaged and one is truncated.
fn write_files(folder: &Folder, count: u64) {
    for number in 0..count {
        let (squares, ticks) = if number % 20 == 0 { (50, 120) } else { (1, number % 97) };
        let mut bytes = replay(number, squares, ticks);
        let middle = bytes.len() / 2;
        match number % 11 {
            3 => bytes[middle] ^= 1,
            5 => bytes.truncate(bytes.len() - 20),
            _ => {}
        }
        folder.write(&format!("in/{number:05}.replay"), &bytes);
    }
}

/// Sorted lines of `verify --json`.
fn verified(folder: &Folder) -> Vec<String> {
    let (mut out, mut err) = (Vec::new(), Vec::new());
    let path = folder.0.join("in");
    let arguments = ["verify", "--json"].map(String::from);
    let arguments = ["lockstep2d".into()].into_iter().chain(arguments).chain([path.display().to_string()]);
    Tool::<Sandbox>::new().run_with(arguments, &mut out, &mut err);
    // In the results, paths are relative to the folder.
    let below = format!("{}/", folder.0.display());
    let mut lines: Vec<String> =
        String::from_utf8(out).unwrap().lines().map(|line| line.replacen(&below, "", 1)).collect();
    lines.sort();
    lines
}

fn worker(server: &Server, folder: &Folder) -> Program {
    let path = PathBuf::from(env!("CARGO_BIN_EXE_lockstep2d-worker"));
    Program { path, url: server.url(), folder: folder.0.clone(), variables: Vec::new() }
}

/// Answer of a worker's metrics server; empty if the server does not listen yet.
fn get(address: &str, path: &str) -> String {
    let Ok(mut stream) = TcpStream::connect(address) else { return String::new() };
    write!(stream, "GET {path} HTTP/1.1\r\n\r\n").unwrap();
    let mut text = String::new();
    stream.read_to_string(&mut text).unwrap();
    text
}

fn files() -> u64 {
    std::env::var("LOCKSTEP2D_WORKER_FILES").map_or(300, |count| count.parse().unwrap())
}

#[test]
fn every_file_has_one_result_though_workers_and_the_server_are_killed() {
    let folder = Folder::new("killed");
    let Some(mut server) = Server::start(&folder) else { return };
    let count = files();
    write_files(&folder, count);
    let expected = verified(&folder);
    let program = worker(&server, &folder);
    let submitted = program.submit(&["in"]);
    assert_eq!(submitted.len() as u64, count);
    assert!(submitted.iter().all(|line| line.ends_with("\"queued\":true}")), "{}", submitted[0]);

    // Workers are killed at random, so many deliveries are allowed.
    let arguments = ["--ack-seconds", "1", "--max-deliver", "1000"];
    let mut workers: Vec<Process> = (0..WORKERS).map(|_| program.work(&arguments)).collect();
    let (mut state, mut kills, mut restarts) = (7, 0, 0);
    wait_until("all results are there", || {
        let found = program.results().len() as u64;
        if restarts < 2 && found * 3 > count * (restarts + 1) {
            server.restart();
            restarts += 1;
        }
        // Kills a worker after every 30 results, except after the last result.
        while kills < found / 30 && found < count {
            let victim = usize::try_from(random(&mut state) % WORKERS as u64).unwrap();
            workers[victim].kill();
            workers[victim] = program.work(&arguments);
            kills += 1;
        }
        found >= count
    });
    assert_eq!(restarts, 2, "the server was restarted while there was work");
    assert!(kills > count / 60, "only {kills} workers were killed");
    for worker in &mut workers {
        assert_eq!(worker.terminate(), Some(0), "a worker drains and ends");
    }
    assert_eq!(program.results(), expected);
}

/// Time in which this number of workers verifies all submitted files.
fn time_of(workers: usize, program: &Program, queue: &str, count: usize) -> Duration {
    program.submit(&["--queue", queue, "in"]);
    let start = Instant::now();
    let children: Vec<Process> = (0..workers).map(|_| program.work(&["--queue", queue])).collect();
    let results =
        || program.run(&["results", "--queue", queue]).stdout.split(|byte| *byte == b'\n').count() - 1;
    while results() < count {
        assert!(start.elapsed() < PATIENCE, "waited too long for {count} results");
        // Polls rarely, because polling takes processor time from the workers.
        std::thread::sleep(Duration::from_millis(200));
    }
    let time = start.elapsed();
    for mut child in children {
        assert_eq!(child.terminate(), Some(0));
    }
    time
}

#[test]
#[ignore = "measures time: needs two idle processors, and runs in `crates/worker/test long`"]
fn two_workers_do_almost_twice_as_much_as_one() {
    let folder = Folder::new("throughput");
    let Some(server) = Server::start(&folder) else { return };
    let program = worker(&server, &folder);
    let count = 200;
    for number in 0..count {
        folder.write(&format!("in/{number:05}.replay"), &replay(number, 60, 400));
    }
    let count = usize::try_from(count).unwrap();
    let gain = |round: u32| {
        let [one, two] =
            [1, 2].map(|workers| time_of(workers, &program, &format!("round{round}of{workers}"), count));
        println!("{count} files: {one:?} with one worker, {two:?} with two");
        one.as_millis() * 100 / two.as_millis()
    };
    // Takes the best of three, because other programs can only reduce the gain.
    let best = (0..3).map(gain).max().unwrap();
    assert!(best >= 180, "two workers have only {best} % of the throughput of one");
}

/// One file has 400 squares on one spot; docs/VERIFYING.md states that `verify` takes 75 MB for such a file.
#[cfg(target_os = "linux")]
#[test]
fn a_worker_takes_little_more_memory_than_verify() {
    let folder = Folder::new("memory");
    let Some(server) = Server::start(&folder) else { return };
    let program = worker(&server, &folder);
    write_files(&folder, 200);
    let square = ShapeDef::new(Polygon::square(fx!(0.5)).unwrap());
    let pile = vec![Command::Spawn { body: BodyDef::dynamic(), shapes: vec![square] }; 400];
    folder.write("in/pile.replay", &record(pile, 10));
    program.submit(&["in"]);
    let mut child = program.work(&[]);
    wait_until("all results are there", || program.results().len() == 201);
    let status = fs::read_to_string(format!("/proc/{}/status", child.0.id())).unwrap();
    let peak = status.lines().find_map(|line| line.strip_prefix("VmHWM:")).unwrap();
    let peak: u64 = peak.trim().trim_end_matches(" kB").parse().unwrap();
    println!("{peak} KiB");
    assert!((45_000..93_000).contains(&peak), "{peak} KiB");
    assert_eq!(child.terminate(), Some(0));
}

#[test]
fn the_same_bytes_have_one_result_and_are_not_simulated_again() {
    let folder = Folder::new("same");
    let Some(server) = Server::start(&folder) else { return };
    let program = worker(&server, &folder);
    let bytes = replay(1, 1, 30);
    folder.write("in/a.replay", &bytes);
    folder.write("in/b.replay", &bytes);
    let mut submitted: Vec<Value> =
        program.submit(&["in"]).iter().map(|line| serde_json::from_str(line).unwrap()).collect();
    submitted.sort_by_key(|line| line["queued"] == json!(false));
    let queued: Vec<_> = submitted.iter().map(|line| &line["queued"]).collect();
    assert_eq!(queued, [true, false]);
    assert_eq!(submitted[0]["blake3"], submitted[1]["blake3"]);

    // The second worker has other limits, which give another key. It adds no result, because the job has left the
    // queue.
    for (arguments, count) in [(&["--max-ticks", "30"][..], 1), (&["--max-ticks", "29"], 1)] {
        let mut child = program.work(arguments);
        wait_until("there is a result", || program.results().len() == count);
        assert_eq!(child.terminate(), Some(0));
    }
}

#[test]
fn files_of_the_object_store_and_metrics() {
    let folder = Folder::new("objects");
    let Some(server) = Server::start(&folder) else { return };
    write_files(&folder, 12);
    let expected = verified(&folder);
    let program = worker(&server, &folder);
    program.submit(&["--objects", "in"]);
    // The worker runs in a folder without the files.
    let elsewhere = Folder::new("objects-elsewhere");
    let away = Program { folder: elsewhere.0.clone(), ..worker(&server, &folder) };
    let address = format!("127.0.0.1:{}", free_port());
    let mut child = away.work(&["--metrics", &address]);
    wait_until("all results are there", || away.results().len() == 12);
    assert_eq!(away.results(), expected);

    let get = |path: &str| get(&address, path);
    // A worker counts a result only after adding it, so the last one may not be counted yet.
    let counted = "lockstep2d_worker_results_total{verdict=\"match\"} ";
    let matches = expected.iter().filter(|line| line.contains("\"verdict\":\"match\"")).count();
    wait_until("it is counted", || get("/metrics").contains(&format!("{counted}{matches}\n")));
    assert!(get("/metrics").starts_with("HTTP/1.1 200 OK\r\n"));
    assert!(get("/").starts_with("HTTP/1.1 404 "));
    assert_eq!(child.terminate(), Some(0));
}

#[test]
fn a_file_that_cannot_be_read_has_a_result() {
    let folder = Folder::new("unread");
    let Some(server) = Server::start(&folder) else { return };
    let program = worker(&server, &folder);
    folder.write("in/gone.replay", &replay(1, 1, 3));
    folder.write("in/other.replay", &replay(2, 1, 3));
    program.submit(&["in"]);
    fs::remove_file(folder.0.join("in/gone.replay")).unwrap();
    folder.write("in/other.replay", b"replaced");
    let mut child = program.work(&["--max-deliver", "2"]);
    wait_until("all results are there", || program.results().len() == 2);
    assert_eq!(child.terminate(), Some(0));
    let results: Vec<Value> =
        program.results().iter().map(|line| serde_json::from_str(line).unwrap()).collect();
    assert_eq!(results[0]["file"], "in/gone.replay");
    assert_eq!(results[1]["error"], "the file is not the one that was submitted");

    for path in ["../x.replay", "/etc/passwd"] {
        let refused = program.run(&["submit", path]);
        assert_eq!(refused.status.code(), Some(2), "{path}");
    }
}

#[test]
fn a_file_that_kills_workers_has_a_result_and_holds_up_no_other() {
    let folder = Folder::new("fragile");
    let Some(server) = Server::start(&folder) else { return };
    let worker = worker(&server, &folder);
    let path = worker.path.parent().unwrap().join("examples/fragile");
    for input in 10..16 {
        let mut command = std::process::Command::new(&path);
        let made = command.args(["record", &input.to_string()]).env("FRAGILE_RECORDS", "1").output().unwrap();
        folder.write(&format!("in/{input}.replay"), &made.stdout);
    }
    let program = Program { path, ..worker };
    program.submit(&["in"]);
    let arguments = ["--max-deliver", "2", "--ack-seconds", "1"];
    let (mut child, mut deaths) = (program.work(&arguments), 0);
    wait_until("all results are there", || {
        if let Some(status) = child.0.try_wait().unwrap() {
            assert_eq!(status.code(), None, "it is killed by a signal");
            deaths += 1;
            child = program.work(&arguments);
        }
        program.results().len() == 6
    });
    assert_eq!(child.terminate(), Some(0));
    assert_eq!(deaths, 2, "one for each delivery");
    let results: Vec<Value> =
        program.results().iter().map(|line| serde_json::from_str(line).unwrap()).collect();
    let blake3 = blake3::hash(&fs::read(folder.0.join("in/13.replay")).unwrap()).to_string();
    for (number, result) in results.iter().enumerate() {
        match number {
            3 => assert_eq!(
                *result,
                json!({
                    "file": "in/13.replay", "verdict": "crashed", "deliveries": 2, "blake3": blake3, "cached": false,
                })
            ),
            _ => assert_eq!(result["verdict"], "match", "{result}"),
        }
    }
}
