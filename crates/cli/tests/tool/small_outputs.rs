//! Keys, signature files and cache entries lose no data if the disk is full, if a process is killed, or if two
//! processes write the same file.
#![cfg(unix)]
#![expect(clippy::disallowed_types, reason = "a run is timed, so that kills hit random moments of it")]

use std::fs;
use std::io::Read;
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

use lockstep2d_cli::signature::{SecretKey, Signatures};

use crate::outputs::{OLD, TOOL, message, names};
use crate::{Folder, golden, sweep};

fn tool(arguments: &[&str]) -> Output {
    Command::new(TOOL).args(arguments).output().unwrap()
}

fn start(arguments: &[&str]) -> Child {
    let mut command = Command::new(TOOL);
    command.args(arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
}

/// Runs the tool with a file size limit of 0 bytes, so that writes fail as on a full disk.
fn tool_without_space(arguments: &[&str]) -> Output {
    let script = "trap '' XFSZ; ulimit -f 0; exec \"$@\"";
    Command::new("sh").args(["-c", script, "sh", TOOL]).args(arguments).output().unwrap()
}

/// Starts the tool and kills it after some microseconds, unless it has already ended.
fn kill_after(microseconds: u64, arguments: &[&str]) {
    let mut child = start(arguments);
    std::thread::sleep(Duration::from_micros(microseconds));
    let _ = child.kill();
    child.wait().unwrap();
}

/// Pseudorandom number below `range` for each `round`.
fn shuffled(round: u64, range: u64) -> u64 {
    round * 7919 % range
}

/// Kills the tool at random moments, at least `rounds` times, until some runs left the old output and some the new one.
/// `prepare` restores the old output.
fn kill_often(arguments: &[&str], rounds: u64, prepare: impl Fn(), is_new: impl Fn() -> bool) {
    let start = Instant::now();
    prepare();
    assert_eq!(tool(arguments).status.code(), Some(0));
    let whole = u64::try_from(start.elapsed().as_micros()).unwrap();
    let (mut old, mut new) = (0, 0);
    for round in 0..20 * rounds {
        prepare();
        kill_after(shuffled(round, 2 * whole), arguments);
        if is_new() {
            new += 1
        } else {
            old += 1
        }
        if round >= rounds && old > 0 && new > 0 {
            return;
        }
    }
    panic!("{old} kills before and {new} after the output was written");
}

/// A folder with one replay, `a.replay`, and with a key for each owner.
fn keys(test: &str, owners: &[&str]) -> Folder {
    let folder = Folder::new(test);
    folder.write("a.replay", &fs::read(golden("box_stack")).unwrap());
    for owner in owners {
        let made = tool(&["keygen", "--name", owner, "-o", &folder.path(owner)]);
        assert_eq!(made.status.code(), Some(0), "{}", message(&made));
    }
    folder
}

fn signatures(folder: &Folder) -> Signatures {
    fs::read_to_string(folder.path("a.replay.sig")).unwrap().parse().unwrap()
}

#[test]
fn a_key_replaces_another_one_only_as_a_whole() {
    let folder = Folder::new("small-keys");
    let to = folder.write("key", OLD);
    let (plain, forced) =
        (["keygen", "--name", "alice", "-o", &to], ["keygen", "--name", "alice", "-o", &to, "--force"]);
    let refused = tool(&plain);
    assert_eq!(refused.status.code(), Some(2));
    assert!(message(&refused).contains("it exists; --force replaces it"), "{}", message(&refused));
    let failed = tool_without_space(&forced);
    assert_eq!(failed.status.code(), Some(2));
    assert!(message(&failed).contains("cannot write"), "{}", message(&failed));
    assert!(failed.stdout.is_empty(), "a public key whose secret key is not on the disk is not printed");
    assert_eq!((fs::read(&to).unwrap(), names(&folder)), (OLD.to_vec(), vec!["key".to_string()]));

    let restore = || fs::write(&to, OLD).unwrap();
    kill_often(&forced, sweep::size(200, 30), restore, || {
        let found = fs::read(&to).unwrap();
        let is_new = found != OLD;
        if is_new {
            String::from_utf8(found).unwrap().parse::<SecretKey>().unwrap();
        }
        is_new
    });
}

#[test]
fn of_two_key_makers_one_succeeds_and_prints_the_key_of_the_file() {
    let folder = Folder::new("small-key-race");
    for round in 0..sweep::size(50u32, 8) {
        let to = folder.path(&round.to_string());
        let makers: Vec<Child> = (0..4).map(|_| start(&["keygen", "--name", "alice", "-o", &to])).collect();
        let outputs = makers.into_iter().map(|maker| maker.wait_with_output().unwrap());
        let (made, told): (Vec<Output>, Vec<Output>) = outputs.partition(|output| output.status.success());
        assert_eq!(made.len(), 1);
        for told in told {
            let message = message(&told);
            assert!(message.contains("it exists") || message.contains("another process"), "{message}");
        }
        let secret: SecretKey = fs::read_to_string(&to).unwrap().parse().unwrap();
        assert_eq!(String::from_utf8_lossy(&made[0].stdout), format!("{} alice\n", secret.public_key()));
    }
}

#[test]
fn no_signature_is_lost() {
    let folder = keys("small-signatures", &["alice", "bob"]);
    let [file, alice, bob, sig] = ["a.replay", "alice", "bob", "a.replay.sig"].map(|name| folder.path(name));
    assert_eq!(tool(&["sign", &file, "--key", &alice]).status.code(), Some(0));
    let by_alice = fs::read(&sig).unwrap();
    let failed = tool_without_space(&["sign", &file, "--key", &bob]);
    assert_eq!(failed.status.code(), Some(2));
    assert!(message(&failed).contains("cannot write"), "{}", message(&failed));
    assert_eq!(fs::read(&sig).unwrap(), by_alice);
    assert_eq!(names(&folder), ["a.replay", "a.replay.sig", "alice", "bob"]);

    assert_eq!(tool(&["sign", &file, "--key", &bob]).status.code(), Some(0));
    let by_both = fs::read(&sig).unwrap();
    let restore = || fs::write(&sig, &by_alice).unwrap();
    kill_often(&["sign", &file, "--key", &bob], sweep::size(200, 30), restore, || {
        let found = fs::read(&sig).unwrap();
        assert!(found == by_alice || found == by_both, "{}", String::from_utf8_lossy(&found));
        found == by_both
    });
}

#[test]
fn whoever_signs_at_the_same_time_is_in_the_file_or_is_told() {
    let owners = ["a", "b", "c", "d", "e", "f"];
    let folder = keys("small-signers", &owners);
    let (file, sig) = (folder.path("a.replay"), folder.path("a.replay.sig"));
    let mut told = 0;
    for _ in 0..sweep::size(50, 10) {
        let _ = fs::remove_file(&sig);
        let signers: Vec<(&str, Child)> = owners
            .into_iter()
            .map(|owner| (owner, start(&["sign", &file, "--key", &folder.path(owner)])))
            .collect();
        let mut signed = Vec::new();
        for (owner, signer) in signers {
            let output = signer.wait_with_output().unwrap();
            if output.status.success() {
                let key: SecretKey = fs::read_to_string(folder.path(owner)).unwrap().parse().unwrap();
                signed.push(key.public_key());
            } else {
                assert!(message(&output).contains("another process is writing it"), "{}", message(&output));
                told += 1;
            }
        }
        let mut found: Vec<_> = signatures(&folder).all().iter().map(|signature| signature.key).collect();
        found.sort();
        signed.sort();
        assert_eq!(found, signed);
    }
    assert!(told > 0, "no signer has found the file locked by another");
}

/// Lines of `verify --json` with every `cached` set to false, and the standard error.
fn verify(output: &Output) -> (Vec<String>, String) {
    let lines = String::from_utf8(output.stdout.clone()).unwrap();
    (lines.lines().map(|line| line.replace("\"cached\":true", "\"cached\":false")).collect(), message(output))
}

/// Writes 24 files, most of which are replays that match. Returns the path of their folder.
fn uploads(folder: &Folder) -> String {
    let bytes = fs::read(golden("box_stack")).unwrap();
    for number in 0..24 {
        let length = bytes.len() - if number % 3 == 0 { number } else { 0 };
        let name = format!("in/{number}.replay");
        match number % 4 {
            0 => folder.write(&name, &bytes[..length]),
            1 => folder.write(&name, &fs::read(golden("pendulum")).unwrap()),
            2 => folder.write(&name, &fs::read(golden("free_fall")).unwrap()),
            _ => folder.write(&name, format!("no replay {number}").as_bytes()),
        };
    }
    folder.path("in")
}

#[test]
fn a_cache_without_space_changes_no_verdict_and_leaves_no_file() {
    let folder = Folder::new("small-cache-full");
    let (uploads, cache) = (uploads(&folder), folder.path("cache"));
    let expected = verify(&tool(&["verify", "--json", &uploads])).0;
    let (lines, told) = verify(&tool_without_space(&["verify", "--json", "--cache", &cache, &uploads]));
    assert_eq!(lines, expected);
    assert_eq!(told.matches("warning: verdicts cannot be cached: ").count(), 1, "{told}");
    assert_eq!(fs::read_dir(&cache).unwrap().count(), 0, "part of an entry is left");
}

#[test]
fn kills_and_other_writers_leave_whole_entries_in_a_cache() {
    let folder = Folder::new("small-cache-kills");
    let (uploads, cache) = (uploads(&folder), folder.path("cache"));
    let expected = verify(&tool(&["verify", "--json", &uploads])).0;
    let arguments = ["verify", "--json", "--cache", &cache, &uploads];
    for round in 0..sweep::size(60, 8) {
        let mut writers = [start(&arguments), start(&arguments), start(&arguments)];
        std::thread::sleep(Duration::from_micros(shuffled(round, 30_000)));
        for victim in &mut writers[..2] {
            let _ = victim.kill();
            victim.wait().unwrap();
        }
        let [.., survivor] = writers;
        assert_eq!(verify(&survivor.wait_with_output().unwrap()).0, expected);
        // The second run shows that every file has an entry: a file without an entry would not be marked as cached.
        let again = tool(&arguments);
        assert_eq!(verify(&again).0, expected);
        assert_eq!(String::from_utf8_lossy(&again.stdout).matches("\"cached\":true").count(), expected.len());
        fs::remove_dir_all(&cache).unwrap();
    }
}

#[test]
fn the_shortest_failing_replay_is_written_as_a_whole() {
    let folder = Folder::new("small-stress");
    let (stack, to) = (golden("box_stack"), folder.write("out", OLD));
    let refused = tool(&["stress-saves", &stack, "-o", &to]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(message(&refused).contains("it exists; --force replaces it"), "{}", message(&refused));
    // Nothing fails, so nothing is written.
    let held = tool(&["stress-saves", &stack, "--to", "20", "-o", &to, "--force"]);
    assert_eq!(held.status.code(), Some(0), "{}", message(&held));
    assert_eq!((fs::read(&to).unwrap(), names(&folder)), (OLD.to_vec(), vec!["out".to_string()]));

    let busy = ["stress-saves", &stack, "-o", &to, "--force"];
    for _ in 0..20 {
        let mut first = start(&["stress-saves", &golden("rain"), "-o", &to, "--force"]);
        while !names(&folder).contains(&"out.unfinished".to_string()) {
            std::thread::sleep(Duration::from_millis(1));
        }
        let second = tool(&busy);
        let is_refused = second.status.code() == Some(2);
        if is_refused {
            assert!(message(&second).contains("another process is writing it"), "{}", message(&second));
            first.kill().unwrap();
        }
        let mut told = String::new();
        first.stderr.take().unwrap().read_to_string(&mut told).unwrap();
        first.wait().unwrap();
        assert_eq!(fs::read(&to).unwrap(), OLD);
        if is_refused {
            assert_eq!(told, "");
            return;
        }
        // The first process creates the file and then locks it. Between these two steps, the second process locked the
        // file.
        assert!(told.contains("another process is writing it"), "{told}");
    }
    panic!("the first process should usually lock the file first");
}
