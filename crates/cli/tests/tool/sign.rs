//! `keygen`, `sign` and `verify --keys`: a signature holds for one game, however its replay is encoded.

use std::fs;

use lockstep2d::lockstep::Sandbox;
use lockstep2d::replay::{Limits, Recording, Verdict};
use lockstep2d_cli::Exit;
use lockstep2d_cli::signature::{AllowedKeys, Flaw, GameDigest, LineError, PublicKey, SecretKey, Signatures};
use serde_json::{Value, json};

use crate::counter::{Counter, inputs_at, setup};
use crate::{Folder, golden, replay, run};

/// A folder with a key for each name, and a file `keys` with their public keys.
fn keys(test: &str, names: &[&str]) -> Folder {
    let folder = Folder::new(test);
    let mut lines = String::from("# players\n\n");
    for name in names {
        let made = run(&["keygen", "--name", name, "-o", &folder.path(name)]);
        assert_eq!((made.exit, made.err.as_str()), (Exit::Success, ""));
        lines += &made.out;
    }
    folder.write("keys", lines.as_bytes());
    folder
}

fn sign(folder: &Folder, file: &str, name: &str) {
    let signed = run(&["sign", &folder.path(file), "--key", &folder.path(name)]);
    assert_eq!((signed.exit, signed.err.as_str()), (Exit::Success, ""), "{}", signed.out);
}

/// Exit code and lines of `verify --keys`.
fn check(folder: &Folder, path: &str, more: &[&str]) -> (Exit, Vec<Value>) {
    let (path, keys) = (folder.path(path), folder.path("keys"));
    let checked = run(&[&["verify", "--json", &path, "--keys", &keys], more].concat());
    (checked.exit, checked.out.lines().map(|line| serde_json::from_str(line).unwrap()).collect())
}

/// Runs `verify --keys` for one file. Returns the exit code, the state of the file's signatures, and the names that
/// have signed it.
fn signers(folder: &Folder, file: &str, more: &[&str]) -> (Exit, String, Vec<String>) {
    let (exit, lines) = check(folder, file, more);
    let names = lines[0]["signed_by"].as_array().unwrap().iter().map(|name| name.as_str().unwrap().into());
    (exit, lines[0]["signature"].as_str().unwrap().into(), names.collect())
}

/// The result of [`signers`] for a file that matches.
fn valid(names: &[&str]) -> (Exit, String, Vec<String>) {
    (Exit::Success, "valid".into(), names.iter().map(ToString::to_string).collect())
}

fn not_valid(state: &str, names: &[&str]) -> (Exit, String, Vec<String>) {
    (Exit::Unsigned, state.into(), names.iter().map(ToString::to_string).collect())
}

/// A replay of the same game as `replay(ticks)`, with another checkpoint interval.
fn with_interval(ticks: u64, interval: u32) -> Vec<u8> {
    let mut recording = Recording::<Counter>::start(&setup(), interval).unwrap();
    for tick in 0..ticks {
        recording.step(&inputs_at(tick)).unwrap();
    }
    recording.finish().unwrap()
}

#[test]
fn a_file_of_keys_has_a_limit() {
    let folder = keys("keys-limit", &["alice"]);
    // A sparse file that is larger than the limit.
    fs::File::create(folder.path("keys")).unwrap().set_len(1 << 25).unwrap();
    let file = folder.write("game.replay", &fs::read(golden("free_fall")).unwrap());
    let refused = run(&["verify", &file, "--keys", &folder.path("keys")]);
    assert!(refused.exit == Exit::Trouble && refused.err.contains("too large"), "{}", refused.err);
}

#[test]
fn a_signature_holds_for_the_same_game_in_another_encoding_only() {
    let folder = keys("sign", &["alice"]);
    folder.write("a.replay", &replay(35));
    assert_eq!(signers(&folder, "a.replay", &[]), not_valid("missing", &[]));
    sign(&folder, "a.replay", "alice");
    assert_eq!(signers(&folder, "a.replay", &[]), valid(&["alice"]));

    folder.write("a.replay", &with_interval(35, 7));
    assert_eq!(signers(&folder, "a.replay", &[]), valid(&["alice"]), "other blocks and checkpoints");
    folder.write("a.replay", &replay(36));
    assert_eq!(signers(&folder, "a.replay", &[]), not_valid("forged", &[]), "one more tick");
    let mut other = Recording::<Counter>::start(&setup(), 10).unwrap();
    (0..35).for_each(|tick| other.step(&inputs_at(if tick == 20 { 30 } else { tick })).unwrap());
    folder.write("a.replay", &other.finish().unwrap());
    assert_eq!(signers(&folder, "a.replay", &[]), not_valid("forged", &[]), "another input");
    sign(&folder, "a.replay", "alice");
    assert_eq!(signers(&folder, "a.replay", &[]), valid(&["alice"]), "the stale signature is replaced");
}

#[test]
fn players_sign_the_same_file_and_a_number_of_them_is_required() {
    let folder = keys("require", &["alice", "bob", "server"]);
    folder.write("a.replay", &replay(12));
    for name in ["server", "alice", "server"] {
        sign(&folder, "a.replay", name);
    }
    let text = fs::read_to_string(folder.path("a.replay.sig")).unwrap();
    assert_eq!(text.lines().count(), 2, "one line for each key");
    assert_eq!(signers(&folder, "a.replay", &["--require", "2"]), valid(&["alice", "server"]));
    let too_few = not_valid("missing", &["alice", "server"]);
    assert_eq!(signers(&folder, "a.replay", &["--require", "3"]), too_few);

    // Two keys of the same owner count as one name.
    let keys = fs::read_to_string(folder.path("keys")).unwrap();
    folder.write("keys", keys.replace(" server\n", " alice\n").as_bytes());
    assert_eq!(signers(&folder, "a.replay", &["--require", "2"]), not_valid("missing", &["alice"]));
    let (exit, lines) = check(&folder, "a.replay", &["--require", "3"]);
    assert_eq!((exit, lines), (Exit::Trouble, vec![]), "there are two names only");

    // A signature by a key that is not in the file is ignored.
    folder.write("keys", keys.replace(" server\n", " bob\n").replacen(" alice\n", " x\n", 1).as_bytes());
    let only_bob: Vec<&str> = keys.lines().filter(|line| line.ends_with(" bob")).collect();
    folder.write("keys", only_bob.concat().as_bytes());
    assert_eq!(signers(&folder, "a.replay", &[]), not_valid("missing", &[]));
}

#[test]
fn verdicts_and_signatures_are_apart_and_a_cached_verdict_is_checked_again() {
    let folder = keys("apart", &["alice"]);
    folder.write("in/good.replay", &replay(20));
    folder.write("in/stolen.replay", &replay(21));
    folder.write("in/cut.replay", &replay(22)[..100]);
    sign(&folder, "in/good.replay", "alice");
    fs::copy(folder.path("in/good.replay.sig"), folder.path("in/stolen.replay.sig")).unwrap();
    let cache = folder.path("cache");
    for cached in [false, true] {
        let (exit, lines) = check(&folder, "in", &["--cache", &cache]);
        assert_eq!(exit, Exit::NoMatch, "a verdict counts more than a signature");
        let fields: Vec<_> = lines
            .iter()
            .map(|line| [&line["verdict"], &line["cached"], &line["signature"], &line["forged"]])
            .collect();
        let cut = lines[0]["verdict"].clone();
        assert_ne!(cut, "match");
        assert_eq!(
            fields,
            [
                [&cut, &json!(cached), &json!("missing"), &Value::Null],
                [&json!("match"), &json!(cached), &json!("valid"), &Value::Null],
                [&json!("match"), &json!(cached), &json!("forged"), &json!(["alice"])],
            ]
        );
    }
    fs::remove_file(folder.path("in/good.replay.sig")).unwrap();
    let state = signers(&folder, "in/good.replay", &["--cache", &cache]);
    assert_eq!(state, not_valid("missing", &[]), "the verdict is cached, the signature is not");

    let [path, keys] = ["in/stolen.replay", "keys"].map(|name| folder.path(name));
    let shown = run(&["verify", &path, "--keys", &keys]);
    assert_eq!((shown.exit, shown.exit.code()), (Exit::Unsigned, 3));
    assert!(shown.out.contains("stolen.replay: match: "), "{}", shown.out);
    assert!(shown.out.contains("; forged signature of alice\n"), "{}", shown.out);
    assert!(shown.out.contains("1 of 1 files match; 1 not signed as required; "), "{}", shown.out);
    let input = run(&["verify", "-", "--keys", &keys]);
    assert_eq!(input.exit, Exit::Trouble, "the standard input has nothing beside it");
}

#[test]
fn a_replay_of_another_game_or_a_damaged_one_is_not_signed() {
    let folder = keys("refused", &["alice"]);
    let whole = replay(12);
    let damaged = [&whole[..whole.len() - 1], &[whole[whole.len() - 1] ^ 1]].concat();
    folder.write("damaged.replay", &damaged);
    let key = folder.path("alice");
    for (file, why) in
        [(golden("game"), "made with the rules \"sandbox\""), (folder.path("damaged.replay"), "malformed")]
    {
        let signed = run(&["sign", &file, "--key", &key]);
        assert_eq!(signed.exit, Exit::NoMatch);
        assert!(signed.err.contains(why), "{}", signed.err);
        assert!(!fs::exists(format!("{file}.sig")).unwrap());
    }
    let other = GameDigest::of_replay::<Sandbox>(&whole, &Limits::default());
    assert!(matches!(other, Err(Verdict::Unverifiable { .. })), "{other:?}");

    // A file that is no signature file is not overwritten.
    folder.write("good.replay", &whole);
    folder.write("good.replay.sig", b"a poem\n");
    let signed = run(&["sign", &folder.path("good.replay"), "--key", &key]);
    assert_eq!(signed.exit, Exit::Trouble);
    assert!(signed.err.contains("good.replay.sig: line 1: not \"lockstep2d signature 1\""), "{}", signed.err);
    assert_eq!(fs::read(folder.path("good.replay.sig")).unwrap(), b"a poem\n");
    let (exit, lines) = check(&folder, "good.replay", &[]);
    assert_eq!((exit, &lines[0]["signature"]), (Exit::Unsigned, &json!("malformed")));
    assert!(lines[0]["signature_error"].as_str().unwrap().contains("line 1: "), "{}", lines[0]);

    // The error message contains no part of the key file.
    folder.write("secret", b"lockstep2d secret key 1 12345\n");
    let signed = run(&["sign", &folder.path("good.replay"), "--key", &folder.path("secret")]);
    assert!(signed.exit == Exit::Trouble && !signed.err.contains("12345"), "{}", signed.err);
}

#[test]
fn a_secret_key_is_private_and_never_replaced_by_accident() {
    let folder = keys("private", &["alice"]);
    let path = folder.path("alice");
    let before = fs::read_to_string(&path).unwrap();
    let again = run(&["keygen", "--name", "alice", "-o", &path]);
    assert_eq!((again.exit, again.out.as_str()), (Exit::Trouble, ""));
    assert!(again.err.contains("it exists; --force replaces it"), "{}", again.err);
    assert_eq!(fs::read_to_string(&path).unwrap(), before);
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        let mode = |path: &str| fs::metadata(path).unwrap().permissions().mode() & 0o777;
        assert_eq!(mode(&path), 0o600);
        fs::set_permissions(&path, fs::Permissions::from_mode(0o644)).unwrap();
        // An unfinished file of a killed process may be readable by others.
        folder.write("alice.unfinished", b"");
        let forced = run(&["keygen", "--name", "alice", "-o", &path, "--force", "--json"]);
        assert_eq!((forced.exit, mode(&path)), (Exit::Success, 0o600));
        let secret: SecretKey = fs::read_to_string(&path).unwrap().parse().unwrap();
        let line: Value = serde_json::from_str(&forced.out).unwrap();
        assert_eq!(line, json!({ "file": path, "key": secret.public_key().to_string(), "name": "alice" }));
        assert!(!format!("{secret:?}").contains(fs::read_to_string(&path).unwrap()[24..].trim_end()));
    }
    // `keygen` refuses a name if the printed line would be read back with another name.
    for name in ["a\nb", " ", "alice ", "\u{a0}alice", ""] {
        let named = run(&["keygen", "--name", name, "-o", &folder.path("other")]);
        assert_eq!(named.exit, Exit::Trouble, "{name:?}");
        assert!(!fs::exists(folder.path("other")).unwrap(), "{name:?}");
    }
}

#[cfg(unix)]
#[test]
fn a_pipe_beside_a_replay_does_not_block() {
    let folder = keys("pipe", &["alice"]);
    let path = folder.write("a.replay", &replay(5));
    let made = std::process::Command::new("mkfifo").arg(format!("{path}.sig")).status().unwrap();
    assert!(made.success());
    assert_eq!(signers(&folder, "a.replay", &[]), not_valid("malformed", &[]));
}

/// Users match results with replays by the path in each line. So the line must name the replay, and not its signature
/// file.
#[cfg(unix)]
#[test]
fn a_replay_whose_signatures_cannot_be_read_is_named() {
    let folder = keys("sign-unreadable", &["alice"]);
    let file = folder.write("a.replay", &replay(35));
    std::os::unix::fs::symlink("a.replay.sig", folder.path("a.replay.sig")).unwrap();
    let outcome = run(&["verify", "--json", "--keys", &folder.path("keys"), &file]);
    assert_eq!(outcome.exit, Exit::Trouble);
    let line: Value = serde_json::from_str(&outcome.out).unwrap();
    assert_eq!(line["file"], file);
    assert!(line["error"].as_str().unwrap().starts_with(&format!("{file}.sig: ")), "{line}");
    assert!(outcome.err.contains(&format!("cannot read {file}: {file}.sig: ")), "{}", outcome.err);
}

#[test]
fn keys_that_anybody_could_sign_for_are_refused() {
    let line = |key: [u8; 32]| format!("{} x\n", PublicKey(key));
    let good = SecretKey::generate().unwrap().public_key();
    for (text, line, flaw) in [
        (line([0; 32]), 1, Flaw::InvalidKey),
        (format!("\n#\n{}", line([2; 32])), 3, Flaw::InvalidKey),
        (format!("{good} a\n{good} b\n"), 2, Flaw::KeyTwice),
        (format!("{good}\n"), 1, Flaw::NoAllowedKey),
        (format!("{good} {}\n", "n".repeat(65)), 1, Flaw::Name),
        (format!("{good}0 a\n"), 1, Flaw::NoAllowedKey),
    ] {
        let error = text.parse::<AllowedKeys>().unwrap_err();
        assert_eq!(error, LineError { line, flaw }, "{text}");
    }
}

/// The next pseudorandom number, by SplitMix64 without its last multiplication and last shift.
fn random(state: &mut u64) -> u64 {
    *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let value = (*state ^ (*state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    value ^ (value >> 27)
}

/// Applies one to three random changes to a file.
fn mutate(bytes: &mut Vec<u8>, state: &mut u64) {
    for _ in 0..1 + random(state) % 3 {
        let at = usize::try_from(random(state)).unwrap() % bytes.len().max(1);
        let other = usize::try_from(random(state)).unwrap() % bytes.len().max(1);
        let byte = random(state).to_le_bytes()[0];
        match random(state) % 7 {
            0 if !bytes.is_empty() => bytes[at] ^= 1 << (byte % 8),
            // Writes a hexadecimal digit, so that the line often stays well-formed.
            1 if !bytes.is_empty() => bytes[at] = b"0123456789abcdef"[usize::from(byte % 16)],
            2 if !bytes.is_empty() => drop(bytes.remove(at)),
            3 => bytes.insert(at, byte),
            4 => bytes.truncate(at),
            5 if !bytes.is_empty() => bytes.swap(at, other),
            _ => bytes.extend_from_within(at..),
        }
    }
}

#[test]
fn no_mutated_signature_is_accepted() {
    // Fixed keys make `parsed` and `forged` reproducible.
    let key = |digits: &str| format!("lockstep2d secret key 1 {}", digits.repeat(32)).parse::<SecretKey>();
    let (secret, other) = (key("a1").unwrap(), key("b2").unwrap());
    let game = GameDigest::of_replay::<Counter>(&replay(12), &Limits::default()).unwrap();
    let keys: AllowedKeys = format!("{} alice\n", secret.public_key()).parse().unwrap();
    let mut signatures = Signatures::default();
    signatures.add(secret.sign(&game)).unwrap();
    let line = signatures.to_string();
    signatures.add(other.sign(&game)).unwrap();
    let whole = signatures.to_string();
    assert_eq!(keys.check(&whole.parse().unwrap(), &game).signed_by, ["alice"]);

    let (mut state, mut parsed, mut forged) = (1, 0, 0);
    for number in 0..10_000 {
        let mut bytes = whole.clone().into_bytes();
        mutate(&mut bytes, &mut state);
        let text = String::from_utf8_lossy(&bytes);
        let Ok(signatures) = text.parse::<Signatures>() else { continue };
        assert_eq!(signatures.to_string(), text, "one text for the same signatures");
        parsed += 1;
        let check = keys.check(&signatures, &game);
        forged += check.forged.len();
        let is_kept = text.split_inclusive('\n').any(|kept| kept == line);
        assert_eq!(check.signed_by.len(), usize::from(is_kept), "mutation {number}: {text}");
    }
    assert!(parsed > 1000 && forged > 400, "{parsed} could be parsed, {forged} had a forged signature");
}
