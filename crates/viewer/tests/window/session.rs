//! Saving a live session from the window.

use std::process::Output;

use lockstep2d::lockstep::Sandbox;
use lockstep2d::replay::{Limits, verify};

use super::run::{command, directory, play};

#[test]
#[ignore = "needs Xvfb: crates/viewer/test-window"]
fn what_one_does_is_saved_and_verifies() {
    let directory = directory("session");
    let script = "frames 30\nmove 480 300\ndown right\nmove 520 330\nup right\nframes 20\n\
                  move 480 420\ndown left\nmove 600 200\nframes 20\nup left\nkey e\nkey g\nframes 60\nreport\n";
    let reports = play(&directory, script, &["--scene", "pyramid", "-o", "session.replay"]);
    let file = std::fs::read(directory.join("session.replay")).unwrap();
    let verdict = verify::<Sandbox>(&file, &Limits::default());
    assert!(verdict.is_match(), "{verdict}");
    let hash = verdict.hash().unwrap().to_string();
    assert!(reports[0].contains(&hash), "{reports:?} and {hash}");
}

#[test]
#[ignore = "needs Xvfb: crates/viewer/test-window"]
fn no_file_is_overwritten_that_nobody_has_named() {
    let directory = directory("again");
    std::fs::write(directory.join("pyramid.replay"), "precious").unwrap();
    let _ = std::fs::remove_file(directory.join("pyramid-2.replay"));
    play(&directory, "frames 5\nkey s\nframes 5\n", &["--scene", "pyramid"]);
    assert_eq!(std::fs::read(directory.join("pyramid.replay")).unwrap(), b"precious");
    let file = std::fs::read(directory.join("pyramid-2.replay")).unwrap();
    assert!(verify::<Sandbox>(&file, &Limits::default()).is_match());
}

#[test]
#[ignore = "needs Xvfb: crates/viewer/test-window"]
fn a_file_that_cannot_be_written_closes_no_window() {
    let script = "frames 5\nkey s\nframes 5\nreport\n";
    let mut command = command(&directory("unwritable"), script, &["--scene", "pyramid"]);
    // No file can be created in /proc.
    let Output { status, stdout, .. } = command.current_dir("/proc").output().unwrap();
    let report = String::from_utf8(stdout).unwrap();
    assert!(status.success() && report.contains("not saved: pyramid.replay: "), "{status} {report}");
}
