//! Commands that write a file lose no data if the disk is full, if their process is killed, or if two processes write
//! the same file.
#![cfg(unix)]

use std::fs;
use std::io::Read;
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::time::Duration;

use crate::{Folder, golden};

pub(crate) const TOOL: &str = env!("CARGO_BIN_EXE_lockstep2d");

/// Contents of a file that existed before the command.
pub(crate) const OLD: &[u8] = b"what was there before";

/// Commands that write more than 512 bytes to the file `to`.
fn writers(to: &str) -> Vec<Vec<String>> {
    let stack = golden("box_stack");
    [
        vec!["record", "box_stack", "--ticks", "200", "-o", to],
        vec!["trim", &stack, "--ticks", "120", "-o", to],
        vec!["fork", &stack, "--tick", "120", "--idle", "5", "-o", to],
        vec!["trace", &stack, "--to", "60", "--ticks", "10", "-o", to],
        vec!["seek", &stack, "--tick", "30", "-o", to],
        vec!["export", &stack, "--tick", "10", "--svg", "-o", to],
        vec!["export", &stack, "--to", "5", "--json", "-o", to],
        vec!["export", &stack, "--to", "5", "--gif", "--width", "200", "-o", to],
    ]
    .into_iter()
    .map(|arguments| arguments.into_iter().map(String::from).collect())
    .collect()
}

fn tool(arguments: &[String]) -> Output {
    Command::new(TOOL).args(arguments).output().unwrap()
}

fn forced(arguments: &[String]) -> Vec<String> {
    [arguments, &["--force".into()]].concat()
}

pub(crate) fn message(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// The names of the entries of a folder, sorted.
pub(crate) fn names(folder: &Folder) -> Vec<String> {
    let entries = fs::read_dir(folder.path("")).unwrap();
    let mut names: Vec<String> =
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

#[test]
fn an_existing_file_is_replaced_only_on_request() {
    let folder = Folder::new("outputs-existing");
    let to = folder.path("out");
    for writer in writers(&to) {
        fs::write(&to, OLD).unwrap();
        let refused = tool(&writer);
        assert_eq!(refused.status.code(), Some(2), "{writer:?}");
        assert!(message(&refused).contains("it exists; --force replaces it"), "{}", message(&refused));
        assert_eq!(fs::read(&to).unwrap(), OLD, "{writer:?}");

        let done = tool(&forced(&writer));
        assert_eq!(done.status.code(), Some(0), "{writer:?}: {}", message(&done));
        let replaced = fs::read(&to).unwrap();
        assert!(replaced.len() > 512, "{writer:?}");
        fs::remove_file(&to).unwrap();
        assert_eq!(tool(&writer).status.code(), Some(0), "{writer:?}");
        assert_eq!(fs::read(&to).unwrap(), replaced, "{writer:?}");
        assert_eq!(names(&folder), ["out"], "{writer:?}");
    }
}

#[test]
fn input_and_output_may_be_the_same_file() {
    let folder = Folder::new("outputs-same");
    let bytes = fs::read(golden("box_stack")).unwrap();
    let cut = folder.write("cut.replay", &bytes[..bytes.len() - 20]);
    let link = folder.path("link.replay");
    std::os::unix::fs::symlink(&cut, &link).unwrap();
    for arguments in [["trim", &cut, "-o", &cut, "--force"], ["trim", &cut, "-o", &link, "--force"]] {
        let done = tool(&arguments.map(String::from));
        assert_eq!(done.status.code(), Some(0), "{}", message(&done));
        let verified = tool(&["verify", &cut].map(String::from));
        assert_eq!(verified.status.code(), Some(0), "{}", String::from_utf8_lossy(&verified.stdout));
    }
    assert!(fs::symlink_metadata(&link).unwrap().is_symlink(), "the file behind a link is replaced");
    assert_eq!(names(&folder), ["cut.replay", "link.replay"]);
}

#[test]
fn a_link_to_a_missing_file_creates_the_file() {
    let folder = Folder::new("outputs-dangling");
    let link = folder.path("link.replay");
    std::os::unix::fs::symlink("store.replay", &link).unwrap();
    for force in [false, true] {
        let mut arguments = ["record", "box_stack", "--ticks", "2", "-o", &link].map(String::from).to_vec();
        arguments.extend(force.then(|| "--force".to_string()));
        let done = tool(&arguments);
        assert_eq!(done.status.code(), Some(0), "{}", message(&done));
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
        assert_eq!(names(&folder), ["link.replay", "store.replay"]);
        fs::remove_file(folder.path("store.replay")).unwrap();
    }
}

#[test]
fn a_full_disk_leaves_the_old_file() {
    let folder = Folder::new("outputs-full");
    let to = folder.path("out");
    for writer in writers(&to) {
        for has_old in [true, false] {
            if has_old {
                fs::write(&to, OLD).unwrap();
            }
            // Limits each file to 512 bytes. The signal SIGXFSZ is ignored, so that writes fail as on a full disk.
            let script = "trap '' XFSZ; ulimit -f 1; exec \"$@\"";
            let failed =
                Command::new("sh").args(["-c", script, "sh", TOOL]).args(forced(&writer)).output().unwrap();
            assert_eq!(failed.status.code(), Some(2), "{writer:?}: {}", message(&failed));
            assert!(message(&failed).contains("cannot write"), "{}", message(&failed));
            if has_old {
                assert_eq!(fs::read(&to).unwrap(), OLD, "{writer:?}");
                fs::remove_file(&to).unwrap();
            }
            assert!(names(&folder).is_empty(), "{writer:?} left {:?}", names(&folder));
        }
    }
    // The input file of `trim x -o x` stays unchanged.
    let bytes = fs::read(golden("box_stack")).unwrap();
    let same = folder.write("same.replay", &bytes);
    let script = "trap '' XFSZ; ulimit -f 1; exec \"$0\" trim \"$1\" -o \"$1\" --force";
    let failed = Command::new("sh").args(["-c", script, TOOL, &same]).output().unwrap();
    assert_eq!((failed.status.code(), fs::read(&same).unwrap()), (Some(2), bytes));
}

#[cfg(target_os = "linux")]
#[test]
fn a_device_is_written_directly() {
    let full = tool(&["trim", &golden("box_stack"), "-o", "/dev/full"].map(String::from));
    assert_eq!(full.status.code(), Some(2), "{}", message(&full));
    assert!(message(&full).contains("cannot write /dev/full"), "{}", message(&full));
    assert!(!Path::new("/dev/full.unfinished").exists());
    let piped = tool(
        &["export", &golden("box_stack"), "--tick", "1", "--svg", "-o", "/dev/stdout"].map(String::from),
    );
    assert!(piped.status.success() && piped.stdout.starts_with(b"<svg"), "{}", message(&piped));
}

/// Result lines would damage a file that the command writes to the standard output.
#[cfg(target_os = "linux")]
#[test]
fn a_file_on_the_standard_output_is_nothing_but_the_file() {
    let folder = Folder::new("outputs-stdout");
    let to = folder.path("out");
    for (to_file, to_stdout) in writers(&to).into_iter().zip(writers("/dev/stdout")) {
        let done = tool(&to_file);
        let piped = tool(&to_stdout);
        assert_eq!(piped.status.code(), Some(0), "{to_stdout:?}: {}", message(&piped));
        assert!(piped.stdout == fs::read(&to).unwrap(), "{to_stdout:?}");
        let shown = String::from_utf8(done.stdout).unwrap().replace(&to, "/dev/stdout");
        assert_eq!(message(&piped), shown, "{to_stdout:?}");
        fs::remove_file(&to).unwrap();
    }
    // If the file goes to another device, the result lines stay on the standard output.
    let done = tool(&["trim", &golden("box_stack"), "-o", "/dev/null"].map(String::from));
    assert!(done.stdout.starts_with(b"/dev/null: "), "{}", message(&done));
}

#[cfg(unix)]
#[test]
fn a_redirected_standard_output_is_written_where_it_stands() {
    let folder = Folder::new("outputs-redirected");
    let to = folder.path("out");
    for redirection in ["/dev/stdout", "/dev/fd/1"] {
        for (to_file, to_stdout) in writers(&to).into_iter().zip(writers(redirection)) {
            assert_eq!(tool(&to_file).status.code(), Some(0), "{to_file:?}");
            let expected = [OLD, &fs::read(&to).unwrap()].concat();
            let log = folder.write("log", OLD);
            let script = "log=$1; shift; exec \"$@\" >> \"$log\"";
            let done = Command::new("sh").args(["-c", script, "sh", &log, TOOL]).args(&to_stdout).output();
            let done = done.unwrap();
            assert_eq!(done.status.code(), Some(0), "{to_stdout:?}: {}", message(&done));
            assert!(fs::read(&log).unwrap() == expected, "{to_stdout:?}");
            fs::remove_file(&to).unwrap();
        }
    }
    assert_eq!(names(&folder), ["log"]);
}

/// A process that is killed after it has linked the target to the temporary file leaves the file under both names. The
/// next writer must not write to this file.
#[test]
fn a_published_file_is_no_temporary_file() {
    let folder = Folder::new("outputs-published");
    let whole = fs::read(golden("box_stack")).unwrap();
    let (to, damaged) = (folder.write("x.replay", &whole), folder.write("damaged.replay", b"no replay"));
    let link = || fs::hard_link(&to, format!("{to}.unfinished")).unwrap();
    let trim = |from: &str| tool(&["trim", from, "--ticks", "60", "-o", &to, "--force"].map(String::from));
    link();
    assert_eq!(trim(&damaged).status.code(), Some(1));
    assert!(fs::read(&to).unwrap() == whole, "an existing file changed without success");
    assert_eq!(names(&folder), ["damaged.replay", "x.replay"]);
    link();
    assert_eq!(trim(&golden("box_stack")).status.code(), Some(0));
    assert!(fs::read(&to).unwrap().len() < whole.len());
    assert_eq!(names(&folder), ["damaged.replay", "x.replay"]);
}

/// Starts a long recording, and waits until its temporary file has at least 4000 bytes.
fn long_recorder(to: &str, extra: &[&str]) -> Child {
    let arguments = ["record", "box_stack", "--ticks", "10000000", "-o", to];
    let child = Command::new(TOOL).args(arguments).args(extra).stdout(Stdio::null()).spawn().unwrap();
    let temporary = format!("{to}.unfinished");
    while fs::metadata(&temporary).map_or(0, |metadata| metadata.len()) < 4000 {
        std::thread::sleep(Duration::from_millis(2));
    }
    child
}

#[test]
fn a_killed_process_leaves_the_old_file_and_what_it_recorded() {
    let folder = Folder::new("outputs-killed");
    let to = folder.write("x.replay", OLD);
    let mut child = long_recorder(&to, &["--force"]);
    child.kill().unwrap();
    child.wait().unwrap();
    assert_eq!(fs::read(&to).unwrap(), OLD);
    assert_eq!(names(&folder), ["x.replay", "x.replay.unfinished"]);
    // The temporary file is the intact part of a replay.
    let rescued = folder.path("rescued.replay");
    let trimmed = tool(&["trim", &format!("{to}.unfinished"), "-o", &rescued].map(String::from));
    assert_eq!(trimmed.status.code(), Some(0), "{}", message(&trimmed));
    // The temporary file does not block a later writer.
    let again = tool(&["record", "box_stack", "--ticks", "9", "--force", "-o", &to].map(String::from));
    assert_eq!(again.status.code(), Some(0), "{}", message(&again));
    assert_eq!(names(&folder), ["rescued.replay", "x.replay"]);
}

/// The unfinished file of a killed recorder may be the only recording. So commands must accept it as the input even if
/// their output would use it as the temporary file, as in `trim x.replay.unfinished -o x.replay`.
#[test]
fn an_unfinished_file_is_an_input_like_any_other() {
    let folder = Folder::new("outputs-unfinished");
    let to = folder.path("x.replay");
    let left = format!("{to}.unfinished");
    let whole = fs::read(golden("box_stack")).unwrap();
    let cut = &whole[..whole.len() - 20];
    let moved = format!("{left}.unfinished");
    for command in [
        &["trim", &left] as &[&str],
        &["fork", &left, "--tick", "60"],
        &["trace", &left],
        &["seek", &left, "--tick", "9"],
        &["export", &left, "--to", "5", "--json"],
    ] {
        fs::write(&left, cut).unwrap();
        let arguments: Vec<String> = [command, &["-o", &to]].concat().into_iter().map(String::from).collect();
        let script = "trap '' XFSZ; ulimit -f 1; exec \"$@\"";
        let full = Command::new("sh").args(["-c", script, "sh", TOOL]).args(&arguments).output().unwrap();
        assert_eq!(full.status.code(), Some(2), "{command:?}");
        assert_eq!(fs::read(&left).unwrap(), cut, "{command:?} on a full disk");
        let done = tool(&arguments);
        assert_eq!(done.status.code(), Some(0), "{command:?}: {}", message(&done));
        assert_eq!(fs::read(&left).unwrap(), cut, "{command:?}");
        assert_eq!(names(&folder), ["x.replay", "x.replay.unfinished"], "{command:?}");
        fs::remove_file(&to).unwrap();
    }
    // `trim` can keep no tick of this file.
    fs::write(&left, b"no replay").unwrap();
    assert_eq!(tool(&["trim", &left, "-o", &to].map(String::from)).status.code(), Some(1));
    assert_eq!(fs::read(&left).unwrap(), b"no replay");
    assert!(!Path::new(&moved).exists());

    // While the recorder runs, its file can be read, but its target cannot be written.
    fs::remove_file(&left).unwrap();
    let mut recorder = long_recorder(&to, &[]);
    let busy = tool(&["trim", &left, "-o", &to].map(String::from));
    assert!(message(&busy).contains("another process is writing it"), "{}", message(&busy));
    recorder.kill().unwrap();
    recorder.wait().unwrap();
    assert_eq!(tool(&["trim", &left, "-o", &to].map(String::from)).status.code(), Some(0));
}

#[test]
fn kills_at_any_time_leave_the_old_or_the_new_file() {
    let folder = Folder::new("outputs-kills");
    let to = folder.path("out");
    for (number, writer) in writers(&to).into_iter().enumerate() {
        let done = tool(&writer);
        assert_eq!(done.status.code(), Some(0), "{writer:?}: {}", message(&done));
        let new = fs::read(&to).unwrap();
        for kill in 0..crate::sweep::size(40u64, 6) {
            fs::write(&to, OLD).unwrap();
            let mut child = Command::new(TOOL)
                .args(forced(&writer))
                .stdout(Stdio::null())
                .stderr(Stdio::null())
                .spawn()
                .unwrap();
            let wait = (kill * 7919 + number as u64 * 104_729) % 60_000;
            std::thread::sleep(Duration::from_micros(wait));
            let _ = child.kill();
            child.wait().unwrap();
            let found = fs::read(&to).unwrap();
            assert!(
                found == OLD || found == new,
                "{writer:?} killed after {wait} us left {} bytes",
                found.len()
            );
        }
        let done = tool(&forced(&writer));
        assert_eq!(done.status.code(), Some(0), "{writer:?}: {}", message(&done));
        assert_eq!((fs::read(&to).unwrap(), names(&folder)), (new, vec!["out".to_string()]), "{writer:?}");
        fs::remove_file(&to).unwrap();
    }
}

#[test]
fn a_second_writer_is_told() {
    let folder = Folder::new("outputs-two");
    let to = folder.path("out");
    let mut first = long_recorder(&to, &[]);
    for writer in writers(&to) {
        for arguments in [writer.clone(), forced(&writer)] {
            let second = tool(&arguments);
            assert_eq!(second.status.code(), Some(2), "{arguments:?}");
            assert!(message(&second).contains("another process is writing it"), "{}", message(&second));
        }
    }
    assert_eq!(names(&folder), ["out.unfinished"]);
    first.kill().unwrap();
    first.wait().unwrap();
}

#[test]
fn of_many_writers_one_succeeds_and_all_others_are_told() {
    let folder = Folder::new("outputs-race");
    for round in 0..crate::sweep::size(50, 5) {
        let to = folder.path(&format!("{round}.replay"));
        let children: Vec<Child> = (0..4)
            .map(|seed: u32| {
                Command::new(TOOL)
                    .args(["record", "box_stack", "--ticks", "20", "--seed", &seed.to_string(), "-o", &to])
                    .stdout(Stdio::null())
                    .stderr(Stdio::piped())
                    .spawn()
                    .unwrap()
            })
            .collect();
        let mut successes = 0;
        for mut child in children {
            let mut told = String::new();
            child.stderr.take().unwrap().read_to_string(&mut told).unwrap();
            if child.wait().unwrap().success() {
                successes += 1;
            } else {
                assert!(told.contains("it exists") || told.contains("another process"), "{told}");
            }
        }
        assert_eq!(successes, 1);
        assert_eq!(tool(&["verify".into(), to]).status.code(), Some(0));
    }
    assert!(names(&folder).iter().all(|name| name.ends_with(".replay")), "{:?}", names(&folder));
}
