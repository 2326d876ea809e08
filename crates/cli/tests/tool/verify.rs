//! `verify`: one line for each file, the summary, and the exit code.

use std::fs;

use lockstep2d::lockstep::{Game, RulesId, SetupError};
use lockstep2d::replay::{Limits, Recorder, Recording};
use lockstep2d_cli::{Exit, Judge, Tool};
use serde_json::{Value, json};

use crate::counter::{Counter, Input, Setup, inputs_at, like_its_counter, setup};
use crate::{Folder, replay, run, run_tool};

/// The JSON lines that `verify --json` prints, and its exit.
fn verify_json(paths: &[&str]) -> (Vec<Value>, Exit) {
    let arguments: Vec<&str> = [&["verify", "--json"], paths].concat();
    let outcome = run(&arguments);
    let lines = outcome.out.lines().map(|line| serde_json::from_str(line).unwrap());
    (lines.collect(), outcome.exit)
}

#[test]
fn a_match_is_a_line_a_summary_and_success() {
    let folder = Folder::new("match");
    let file = folder.write("good.replay", &replay(35));
    let outcome = run(&["verify", &file]);
    let lines: Vec<&str> = outcome.out.lines().collect();
    assert_eq!(lines.len(), 2);
    assert!(lines[0].starts_with(&format!("{file}: match: 35 ticks, final hash ")), "{}", lines[0]);
    assert!(lines[1].starts_with("1 of 1 files match; 35 ticks in "), "{}", lines[1]);
    assert!(lines[1].ends_with(" ticks per second"), "{}", lines[1]);
    assert_eq!((outcome.exit, outcome.err.as_str()), (Exit::Success, ""));
}

/// A worker reads only the beginning of a file that is too large, but knows the digest of the whole file.
#[test]
fn a_part_of_a_large_file_has_the_digest_of_the_file() {
    let bytes = replay(35);
    let digest = blake3::hash(&bytes);
    let judge = Judge::<Counter>::new(Limits { file_bytes: 100, ..Limits::default() });
    let judged = judge.judge_part("a.replay", &bytes[..101], digest.as_bytes()).unwrap();
    let line: Value = serde_json::from_str(&judged.line).unwrap();
    assert_eq!((judged.verdict.as_str(), &line["blake3"]), ("limit_exceeded", &json!(digest.to_string())));
    assert_eq!(line["bytes"], json!(101));
    let whole = Judge::<Counter>::new(Limits::default());
    assert_eq!(whole.judge_part("a", &bytes, digest.as_bytes()), whole.judge("a", &bytes));
}

#[test]
fn a_folder_is_searched_at_any_depth_in_order() {
    let folder = Folder::new("folder");
    let good = replay(5);
    for name in ["b.replay", "a/z.replay", "c.replay", "a/b/x.replay"] {
        folder.write(name, &good);
    }
    folder.write("readme.md", b"not a replay, and not asked for");
    folder.write("a/replay", b"neither is this");
    let (lines, exit) = verify_json(&[&folder.path("")]);
    let files: Vec<&str> = lines.iter().map(|line| line["file"].as_str().unwrap()).collect();
    let expected = ["a/b/x.replay", "a/z.replay", "b.replay", "c.replay"].map(|name| folder.path(name));
    assert_eq!(files, expected);
    assert_eq!(exit, Exit::Success);
}

#[test]
fn a_file_that_is_named_is_verified_whatever_its_name() {
    let folder = Folder::new("named");
    let file = folder.write("upload.bin", &replay(5));
    assert_eq!(run(&["verify", &file]).exit, Exit::Success);
}

#[test]
fn every_verdict_has_its_json() {
    let folder = Folder::new("json");
    let good = replay(35);
    let hash = {
        let (lines, _) = verify_json(&[&folder.write("match", &good)]);
        lines[0]["hash"].as_str().unwrap().to_string()
    };
    assert_eq!((hash.len(), hash.to_lowercase()), (32, hash.clone()));

    let json_of = |name: &str, bytes: &[u8], expected_exit| {
        let file = folder.write(name, bytes);
        let (mut lines, exit) = verify_json(&[&file]);
        assert_eq!((lines.len(), exit), (1, expected_exit), "{name}");
        let mut line = lines.remove(0);
        let fields = line.as_object_mut().unwrap();
        assert_eq!(fields.remove("file"), Some(json!(file)));
        assert_eq!(fields.remove("bytes"), Some(json!(bytes.len())));
        assert_eq!(fields.remove("cached"), Some(json!(false)));
        assert!(fields.remove("game").is_some());
        assert_eq!(fields.remove("blake3"), Some(json!(blake3::hash(bytes).to_string())));
        line
    };
    let sum = 5
        + (0..35)
            .map(|tick| inputs_at(tick).iter().map(|input| i64::from(input.add)).sum::<i64>())
            .sum::<i64>();
    let claims = json!({"half": sum / 2, "sum": sum});
    let expected = json!({"verdict": "match", "ticks": 35, "hash": hash, "claims": claims});
    assert_eq!(json_of("match", &good, Exit::Success), expected);

    let mut cut = json_of("incomplete", &good[..good.len() - 1], Exit::NoMatch);
    assert_eq!(cut["hash"].take(), json!(hash));
    assert_eq!(cut, json!({"verdict": "incomplete", "ticks": 35, "hash": null}));

    let expected = json!({
        "verdict": "malformed", "ticks": 0, "hash": null,
        "offset": 0, "why": "this is not a replay file",
    });
    assert_eq!(json_of("malformed", b"not a replay", Exit::NoMatch), expected);

    let mut other_format = good.clone();
    other_format[8] = 2;
    let why = "made in version 2 of the file format, this program reads 1";
    let needs = json!({"format": 2, "semantics": null, "rules": null, "rules_version": null});
    let expected = json!({"verdict": "unverifiable", "ticks": 0, "hash": null, "why": why, "needs": needs});
    assert_eq!(json_of("unverifiable", &other_format, Exit::NoMatch), expected);

    let mut huge_setup = good.clone();
    huge_setup[36..40].fill(0xff);
    let expected = json!({
        "verdict": "limit_exceeded", "ticks": 0, "hash": null,
        "limit": "setup_bytes", "value": u32::MAX, "max": Limits::default().setup_bytes,
    });
    assert_eq!(json_of("limit_exceeded", &huge_setup, Exit::NoMatch), expected);
}

#[test]
fn a_file_that_diverges_says_where() {
    // From tick 4 on, the recorded states are wrong, as if the recording machine had diverged.
    let folder = Folder::new("diverged");
    let (mut recorder, mut game) = Recorder::<Counter>::start(&setup(), 2).unwrap();
    for tick in 0..6 {
        let inputs = recorder.record(&inputs_at(tick)).unwrap().to_vec();
        game.step(&inputs);
        game.sum += i64::from(tick == 3);
        recorder.checkpoint(game.state_hash());
    }
    let file = folder.write("diverged", &recorder.finish(&game).unwrap());
    let (lines, exit) = verify_json(&[&file]);
    let expected = json!({
        "game": lines[0]["game"], "file": file, "verdict": "diverged", "ticks": 4, "hash": null, "cached": false,
        "bytes": fs::metadata(&file).unwrap().len(),
        "blake3": blake3::hash(&fs::read(&file).unwrap()).to_string(),
        "last_equal": 2, "first_different": 4,
    });
    assert_eq!((lines, exit), (vec![expected], Exit::NoMatch));
    let outcome = run(&["verify", &file]);
    assert!(outcome.out.contains("diverged: equal at tick 2, different at tick 4"), "{}", outcome.out);
}

/// A [`Counter`] that claims a wrong sum.
struct Liar(Counter);

impl Game for Liar {
    type Setup = Setup;
    type Input = Input;
    type Save = Counter;

    const RULES: RulesId = Counter::RULES;

    fn new(setup: &Setup) -> Result<Self, SetupError> {
        Counter::new(setup).map(Liar)
    }

    like_its_counter!(0);

    fn step(&mut self, inputs: &[Input]) {
        self.0.step(inputs);
    }

    fn claims(&self) -> Vec<(String, i64)> {
        vec![("half".into(), self.0.sum / 2), ("sum".into(), 1_000_000)]
    }
}

#[test]
fn a_wrong_claim_says_which() {
    let folder = Folder::new("claim");
    let recording = Recording::<Liar>::start(&setup(), 60).unwrap();
    let hash = recording.game().state_hash();
    let file = folder.write("boast", &recording.finish().unwrap());
    let (lines, exit) = verify_json(&[&file]);
    let expected = json!({
        "game": lines[0]["game"], "file": file, "verdict": "claim_mismatch", "ticks": 0, "hash": hash.to_string(),
        "claim": "sum", "claimed": 1_000_000, "actual": 5,
        "claims": {"half": 2, "sum": 1_000_000}, "cached": false,
        "bytes": fs::metadata(&file).unwrap().len(),
        "blake3": blake3::hash(&fs::read(&file).unwrap()).to_string(),
    });
    assert_eq!((lines, exit), (vec![expected], Exit::NoMatch));
}

#[test]
fn one_bad_file_is_enough_and_hides_no_other() {
    let folder = Folder::new("mixed");
    let good = replay(5);
    folder.write("a.replay", &good);
    folder.write("b.replay", &good[..good.len() / 2]);
    folder.write("c.replay", &good);
    let outcome = run(&["verify", &folder.path("")]);
    assert_eq!(outcome.out.lines().count(), 4);
    assert!(outcome.out.contains("2 of 3 files match (1 incomplete); 1"), "{}", outcome.out);
    assert_eq!(outcome.exit, Exit::NoMatch);
}

#[test]
fn what_cannot_be_read_is_trouble_and_hides_no_other() {
    let folder = Folder::new("unreadable");
    let bad = folder.write("bad", b"no replay");
    let good = folder.write("good", &replay(5));
    let missing = folder.path("missing.replay");
    let outcome = run(&["verify", &missing, &bad, &good]);
    assert_eq!(outcome.exit, Exit::Trouble);
    assert!(outcome.err.starts_with(&format!("error: cannot read {missing}: ")), "{}", outcome.err);
    assert_eq!(outcome.out.lines().count(), 3, "the lines of the other two files, and the summary");

    let (lines, exit) = verify_json(&[&missing, &good]);
    assert_eq!((lines.len(), exit), (2, Exit::Trouble));
    assert_eq!(lines[0]["file"], missing.as_str());
    assert!(lines[0]["error"].as_str().unwrap().starts_with("No such file"), "{}", lines[0]);
    assert!(lines[0].get("verdict").is_none(), "{}", lines[0]);
    assert_eq!(lines[1]["verdict"], "match");
}

#[test]
fn nothing_to_verify_is_trouble() {
    let folder = Folder::new("nothing");
    folder.write("readme.md", b"no replay");
    let outcome = run(&["verify", &folder.path("")]);
    assert_eq!((outcome.exit, outcome.out.as_str()), (Exit::Trouble, ""));
    assert!(outcome.err.contains("nothing to verify"), "{}", outcome.err);
}

#[test]
fn a_file_is_read_no_further_than_its_limit() {
    let folder = Folder::new("limit");
    let file = folder.write("long", &replay(1000));
    let limits = Limits { file_bytes: 100, ..Limits::default() };
    let outcome = run_tool(&Tool::new().with_limits(limits), &["verify", &file]);
    assert!(outcome.out.contains("limit exceeded: 101 bytes of the file, at most 100"), "{}", outcome.out);
    assert_eq!(outcome.exit, Exit::NoMatch);
}

#[cfg(unix)]
#[test]
fn links_that_lead_in_circles_are_not_followed() {
    let folder = Folder::new("links");
    let file = folder.write("a/good.replay", &replay(5));
    std::os::unix::fs::symlink(folder.path("a"), folder.path("a/circle")).unwrap();
    std::os::unix::fs::symlink(&file, folder.path("linked.replay")).unwrap();
    let (lines, exit) = verify_json(&[&folder.path("")]);
    let files: Vec<&str> = lines.iter().map(|line| line["file"].as_str().unwrap()).collect();
    assert_eq!(files, [file, folder.path("linked.replay")]);
    assert_eq!(exit, Exit::Success);
}

/// The digest of a game, from `verify --json` and `inspect --json`.
fn game_of(folder: &Folder, bytes: &[u8]) -> Value {
    let file = folder.write("game", bytes);
    let (mut lines, _) = verify_json(&[&file]);
    let inspected: Value =
        serde_json::from_str(&run(&["inspect", "--json", &file]).out).unwrap_or(Value::Null);
    let game = lines.remove(0)["game"].take();
    assert_eq!(inspected["game"], game, "inspect and verify");
    game
}

#[test]
fn the_digest_of_a_game_depends_on_rules_setup_and_inputs_only() {
    let folder = Folder::new("game-digest");
    let recorded = |setup: &Setup, interval: u32, changed: Option<u64>| {
        let mut recording = Recording::<Counter>::start(setup, interval).unwrap();
        for tick in 0..95 {
            let mut inputs = inputs_at(tick);
            inputs[0].wink |= changed == Some(tick);
            recording.step(&inputs).unwrap();
        }
        recording.finish().unwrap()
    };
    let game = game_of(&folder, &recorded(&setup(), 10, None));
    assert_eq!(game.as_str().unwrap().len(), 64);
    for interval in [1, 2, 7, 60, 1000] {
        assert_eq!(game_of(&folder, &recorded(&setup(), interval, None)), game, "{interval}");
    }
    // The digest does not depend on the claims.
    let mut boast = Recording::<Liar>::start(&setup(), 10).unwrap();
    (0..95).for_each(|tick| boast.step(&inputs_at(tick)).unwrap());
    assert_eq!(game_of(&folder, &boast.finish().unwrap()), game);
    let mut others = vec![game];
    for changed in [0, 50, 94] {
        others.push(game_of(&folder, &recorded(&setup(), 10, Some(changed))));
    }
    others.push(game_of(&folder, &recorded(&Setup { start: 6, ..setup() }, 10, None)));
    others.push(game_of(&folder, &replay(94)));
    for (at, one) in others.iter().enumerate() {
        assert!(!others[..at].contains(one), "{at} is the same as another game");
    }
    let mut damaged = replay(94);
    let middle = damaged.len() / 2;
    damaged[middle] ^= 1;
    assert_eq!(game_of(&folder, &damaged), Value::Null);
}
