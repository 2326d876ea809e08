//! The `lockstep2d` binary as a process: exit codes and streams.

use std::process::{Command, Output};

use crate::{Folder, replay};

fn lockstep2d(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_lockstep2d")).args(arguments).output().unwrap()
}

#[test]
fn exit_codes_are_those_of_the_documentation() {
    let folder = Folder::new("binary");
    let of_another_game = folder.write("other.replay", &replay(5));
    let garbage = folder.write("garbage.replay", b"no replay");
    for (arguments, code) in [
        (vec!["--help"], 0),
        (vec!["--version"], 0),
        (vec!["verify", &of_another_game], 1),
        (vec!["verify", "--json", &garbage], 1),
        (vec!["verify", &folder.path("missing")], 2),
        (vec!["verify"], 2),
        (vec!["verify", "--colour", &garbage], 2),
        (vec!["dance"], 2),
        (vec![], 2),
    ] {
        let output = lockstep2d(&arguments);
        let err = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(code), "{arguments:?}: {err}");
        assert_eq!(err.is_empty(), code < 2 && !arguments.contains(&"--json"), "{arguments:?}: {err}");
    }
}

#[test]
fn pipes_get_no_colours() {
    let folder = Folder::new("colours");
    let garbage = folder.write("garbage.replay", b"no replay");
    let output = lockstep2d(&["verify", &garbage, &folder.path("missing")]);
    for stream in [output.stdout, output.stderr] {
        assert!(!stream.is_empty());
        assert!(!stream.contains(&0x1b), "an escape sequence");
    }
}
