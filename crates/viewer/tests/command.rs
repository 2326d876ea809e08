//! Command-line behaviour before a window is opened: `--list` and error messages.
#![expect(clippy::unwrap_used, reason = "a failed unwrap fails the test")]

use std::path::PathBuf;
use std::process::{Command, Output};

fn viewer(args: &[&str]) -> (Option<i32>, String, String) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_lockstep2d-viewer"));
    // Without a display, a command that would open a window fails, so no test opens one.
    command.env_remove("DISPLAY").env_remove("WAYLAND_DISPLAY").args(args);
    let Output { status, stdout, stderr } = command.output().unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    (status.code(), text(stdout), text(stderr))
}

fn file(name: &str, bytes: &[u8]) -> String {
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    std::fs::write(&path, bytes).unwrap();
    path.to_str().unwrap().to_owned()
}

#[test]
fn it_lists_its_scenes() {
    let (code, scenes, errors) = viewer(&["--list"]);
    assert_eq!((code, errors.as_str()), (Some(0), ""));
    assert_eq!(scenes.lines().count(), lockstep2d_scenes::ALL.len());
    assert!(scenes.lines().any(|line| line.starts_with("pyramid ")));
}

#[test]
#[cfg(target_os = "linux")]
fn it_says_that_nobody_answers() {
    for display in [":4711", "unix:4711.0", "/nowhere"] {
        let mut command = Command::new(env!("CARGO_BIN_EXE_lockstep2d-viewer"));
        let output = command.env_remove("WAYLAND_DISPLAY").env("DISPLAY", display).output().unwrap();
        let errors = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{errors}");
        assert!(
            errors.contains(&format!("no X server accepts connections at DISPLAY={display}")),
            "{errors}"
        );
    }
}

#[test]
fn it_says_what_is_wrong() {
    let garbage = file("garbage.replay", b"no replay at all");
    let script = file("bad-script.txt", b"frames 3\n\njump 5\n");
    let cases: [(&[&str], &str); 8] = [
        (&["--scene", "nowhere"], "--list shows the names"),
        (&["no such file"], "no such file: "),
        (&[&garbage], "garbage.replay: neither a report nor a replay nor a snapshot"),
        (&["--script", &script], "bad-script.txt: line 3: there is no instruction \"jump\""),
        (&["--size", "9x9"], "should be a width and a height"),
        (&["--frobnicate"], "unexpected argument"),
        (&["--seed", "1", &garbage], "--seed is for scenes"),
        (&["--scene", "pyramid"], "no display"),
    ];
    for (args, expected) in cases {
        // Only Linux needs an environment variable for a window.
        if expected == "no display" && !cfg!(target_os = "linux") {
            continue;
        }
        let (code, _, errors) = viewer(args);
        assert_eq!(code, Some(2), "{args:?}: {errors}");
        assert!(errors.contains(expected), "{args:?}: {errors}");
    }
}
