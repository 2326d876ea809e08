//! The command `view` passes its arguments to the viewer. Errors of the viewer become exit code 2.

use std::path::Path;
use std::process::{Command, Output};

fn view(arguments: &[&str]) -> Output {
    let program = Command::new(env!("CARGO_BIN_EXE_lockstep2d")).arg("view").args(arguments).output();
    program.expect("the program runs")
}

#[test]
fn options_are_those_of_the_viewer() {
    let list = view(&["--list"]);
    assert!(list.status.success());
    assert!(String::from_utf8_lossy(&list.stdout).contains("ragdoll"));
    let help = view(&["--help"]);
    assert!(help.status.success());
    assert!(String::from_utf8_lossy(&help.stdout).contains("--script"));
}

#[test]
fn errors_of_the_viewer_are_exit_code_2() {
    for arguments in [&["missing.replay"][..], &["--no-such-option"]] {
        let output = view(arguments);
        assert_eq!(output.status.code(), Some(2));
        assert!(!output.stderr.is_empty());
    }
}

/// Needs a screen, so only `crates/viewer/test-window` runs it.
#[test]
#[ignore = "opens a window"]
fn a_replay_is_shown_in_a_window() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR"));
    let (script, picture) = (folder.join("view.script"), folder.join("view.png"));
    let lines = format!("frames 30\nscreenshot {}\nreport\nquit\n", picture.display());
    std::fs::write(&script, lines).expect("a script");
    let replay = root.join("../../replays/box_stack.replay");
    let output = view(&["--script", &script.to_string_lossy(), &replay.to_string_lossy()]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(String::from_utf8_lossy(&output.stdout).contains("box_stack"));
    let decoder =
        png::Decoder::new(std::io::BufReader::new(std::fs::File::open(&picture).expect("a picture")));
    let mut reader = decoder.read_info().expect("a picture");
    let mut pixels = vec![0; reader.output_buffer_size().expect("a size")];
    let frame = reader.next_frame(&mut pixels).expect("a picture");
    let used = pixels[..frame.buffer_size()].chunks(frame.color_type.samples());
    let colours: std::collections::BTreeSet<_> = used.collect();
    assert!(colours.len() > 4, "only {} colours", colours.len());
}
