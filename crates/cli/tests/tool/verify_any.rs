//! The script `docs/verify-any` passes files that the newest program cannot verify to older programs.

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

#[test]
fn what_another_program_can_verify_goes_there() {
    if Command::new("jq").arg("--version").output().is_err() {
        return;
    }
    let folder = Folder::new("any");
    let (good, older) = replays();
    folder.write("in/a.replay", &older);
    folder.write("in/b.replay", &good);
    let verify_any = |more: &[&str]| {
        let mut command = Command::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/verify-any"));
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

    // The older program accepts only its file, and only with the same flags.
    let program = r#"#!/bin/sh
[ "$*" = "verify --json $3 --max-ticks 100000" ] || exit 2
printf '{"file":"%s","verdict":"match"}\n' "$3"
"#;
    let program = folder.write("verifiers/sandbox-2-1", program.as_bytes());
    fs::set_permissions(&program, fs::Permissions::from_mode(0o755)).unwrap();
    assert_eq!(verify_any(&["--max-ticks", "100000"]), (expect("match"), Some(0)));

    folder.write("in/c.replay", b"no replay");
    let (verdicts, code) = verify_any(&["--max-ticks", "100000"]);
    assert_eq!((verdicts.len(), code), (3, Some(1)));
}
