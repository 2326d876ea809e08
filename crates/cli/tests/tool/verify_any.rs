//! The script `docs/verify-any` runs the newest program, and then, for files that it cannot verify, older programs.

use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::process::Command;

use lockstep2d::hash::StateHash;
use serde_json::Value;

use crate::Folder;

/// A replay of the sandbox, and the header of this replay with other semantics. Another program is needed to verify the
/// second file.
fn replays() -> (Vec<u8>, Vec<u8>) {
    let good = fs::read(concat!(env!("CARGO_MANIFEST_DIR"), "/../../replays/free_fall.replay")).unwrap();
    let length = |at: usize| u32::from_le_bytes(good[at..at + 4].try_into().unwrap()) as usize;
    let end = 40 + length(32) + length(36) + 16;
    let mut older = good[..end + 8].to_vec();
    older[12] = 2;
    let checksum = StateHash::of_bytes(&older[..end]).0.to_le_bytes();
    older[end..].copy_from_slice(&checksum[..8]);
    (good, older)
}

fn has_jq() -> bool {
    Command::new("jq").arg("--version").output().is_ok()
}

fn verify_any() -> Command {
    Command::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/verify-any"))
}

/// Writes a shell script, and returns its path.
fn program(folder: &Folder, name: &str, lines: &str) -> String {
    let path = folder.write(name, format!("#!/bin/sh\n{lines}").as_bytes());
    fs::set_permissions(&path, fs::Permissions::from_mode(0o755)).unwrap();
    path
}

/// An older program, which accepts only one file, and only with one flag.
const OLDER: &str = r#"
[ "$*" = "verify --json $3 --max-ticks 100000" ] || exit 2
[ "$3" != - ] || [ "$(wc -c)" -gt 100 ] || exit 2
printf '{"file":"%s","verdict":"match"}\n' "$3"
"#;

#[test]
fn what_another_program_can_verify_goes_there() {
    if !has_jq() {
        return;
    }
    let folder = Folder::new("any");
    let (good, older) = replays();
    folder.write("in/a.replay", &older);
    folder.write("in/b.replay", &good);
    let verify_any = |more: &[&str]| {
        let mut command = verify_any();
        command.arg(env!("CARGO_BIN_EXE_lockstep2d")).args([folder.path("verifiers"), folder.path("in")]);
        let output = command.args(more).output().unwrap();
        let lines = String::from_utf8(output.stdout).unwrap();
        let lines: Vec<Value> = lines.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
        let of = |line: &Value, field: &str| line[field].as_str().unwrap().to_string();
        let verdicts: Vec<_> = lines.iter().map(|line| (of(line, "file"), of(line, "verdict"))).collect();
        (verdicts, output.status.code())
    };
    let expect = |older: &str| {
        let good = (folder.path("in/b.replay"), "match".to_string());
        vec![good, (folder.path("in/a.replay"), older.to_string())]
    };
    assert_eq!(verify_any(&[]), (expect("unverifiable"), Some(1)));

    program(&folder, "verifiers/sandbox-2-1", OLDER);
    assert_eq!(verify_any(&["--max-ticks", "100000"]), (expect("match"), Some(0)));

    folder.write("in/c.replay", b"no replay");
    let (verdicts, code) = verify_any(&["--max-ticks", "100000"]);
    assert_eq!((verdicts.len(), code), (3, Some(1)));
}

#[test]
fn standard_input_goes_to_another_program_too() {
    if !has_jq() {
        return;
    }
    let folder = Folder::new("any_stdin");
    let older = folder.write("older.replay", &replays().1);
    program(&folder, "verifiers/sandbox-2-1", OLDER);
    let mut command = verify_any();
    command.arg(env!("CARGO_BIN_EXE_lockstep2d")).args([
        &folder.path("verifiers"),
        "-",
        "--max-ticks",
        "100000",
    ]);
    let output = command.stdin(fs::File::open(older).unwrap()).output().unwrap();
    let line = "{\"file\":\"-\",\"verdict\":\"match\"}\n";
    assert_eq!((String::from_utf8(output.stdout).unwrap().as_str(), output.status.code()), (line, Some(0)));
}

/// Lines are printed byte by byte: large numbers and escaped characters stay as they are.
#[test]
fn complete_lines_of_a_program_that_is_killed_are_printed() {
    if !has_jq() {
        return;
    }
    let folder = Folder::new("any_killed");
    let file = r#""\u200b\"verdict\":\"unverifiable\"""#;
    let accepted = format!(r#"{{"file":{file},"verdict":"match","claims":{{"score":9007199254740993}}}}"#);
    let older =
        r#"{"file":"old","verdict":"unverifiable","needs":{"rules":"a","rules_version":1,"semantics":2}}"#;
    let newest = format!("cat <<'END'\n{accepted}\n{older}\nEND\nprintf '{{\"file\":\"cut'\nkill -9 $$\n");
    let newest = program(&folder, "newest", &newest);
    program(&folder, "verifiers/a-2-1", OLDER);
    let arguments = [newest, folder.path("verifiers"), "in".into(), "--max-ticks".into(), "100000".into()];
    let output = verify_any().args(arguments).output().unwrap();
    let lines = format!("{accepted}\n{{\"file\":\"old\",\"verdict\":\"match\"}}\n");
    assert_eq!((String::from_utf8(output.stdout).unwrap(), output.status.code()), (lines, Some(128 + 9)));
}
