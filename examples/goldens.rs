//! Plays the golden scenes on every backend of this machine and compares hashes: `goldens short|goldens|all`. The
//! program reads no files, because `tests/cross/run` runs it on other processors.

use std::collections::{BTreeMap, BTreeSet};
use std::process::ExitCode;

use lockstep2d::lockstep::{Game, Sandbox};
use lockstep2d::replay::{Limits, Verdict, verify};
use lockstep2d::world::Backend;
use lockstep2d_scenes::Scene;

const GOLDENS: &str = include_str!("../tests/goldens.txt");
const BACKENDS: &str = include_str!("../tests/backends.txt");
const SHORT: &str = include_str!("../tests/cross/short.txt");

/// Committed replays, which must verify and end in the first golden of their scene.
const REPLAYS: [(&str, &[u8]); 3] = [
    ("bridge", include_bytes!("../replays/bridge.replay")),
    ("game", include_bytes!("../replays/game.replay")),
    ("ragdoll", include_bytes!("../replays/ragdoll.replay")),
];

/// Seed of the golden scenes.
const SEED: u64 = 1;

/// For each scene, pairs of a number of ticks and the expected hash after these ticks.
type Hashes<'a> = BTreeMap<&'a str, BTreeSet<(u64, &'a str)>>;

fn main() -> ExitCode {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let known = match words.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        ["short"] => SHORT.to_owned(),
        ["goldens"] => [GOLDENS, SHORT].concat(),
        ["all"] => [GOLDENS, SHORT, BACKENDS].concat(),
        _ => {
            eprintln!("usage: goldens short|goldens|all");
            return ExitCode::from(2);
        }
    };
    let hashes = hashes(&known);
    let mut all_equal = !hashes.is_empty();
    for backend in Backend::available() {
        for (name, hashes) in &hashes {
            all_equal &= play(name, backend, hashes);
        }
    }
    for (name, replay) in REPLAYS {
        all_equal &= check(name, replay);
    }
    if all_equal { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

/// Parses the lines of the current semantics.
fn hashes(text: &str) -> Hashes<'_> {
    let mut hashes = Hashes::new();
    for line in text.lines() {
        if let [semantics, scene, ticks, hash] = line.split(' ').collect::<Vec<_>>()[..]
            && let (Ok(lockstep2d::SEMANTICS), Ok(ticks)) = (semantics.parse(), ticks.parse())
        {
            hashes.entry(scene).or_default().insert((ticks, hash));
        }
    }
    hashes
}

/// Plays a scene and compares its states.
fn play(name: &str, backend: Backend, hashes: &BTreeSet<(u64, &str)>) -> bool {
    let scene = Scene::find(name).expect("a scene of this crate");
    let mut game = Sandbox::new(&scene.setup(SEED)).expect("the scenes of this crate are valid");
    assert!(game.world_mut().set_backend(backend), "a backend of this machine");
    let mut equal = true;
    for &(ticks, hash) in hashes {
        for tick in game.world().tick()..ticks {
            let commands = scene.commands(tick, &game);
            game.step(&[commands]);
        }
        equal &= compare(&format!("{backend:?}"), name, ticks, hash, &game.state_hash().to_string());
    }
    equal
}

fn check(name: &str, replay: &[u8]) -> bool {
    let golden = hashes(GOLDENS)[name].first().copied().expect("a golden for each replay");
    let (ticks, end) = match verify::<Sandbox>(replay, &Limits::default()) {
        Verdict::Match { ticks, hash } => (ticks, hash.to_string()),
        other => (0, other.to_string()),
    };
    (ticks == golden.0) & compare("replay", name, ticks, golden.1, &end)
}

fn compare(how: &str, name: &str, ticks: u64, known: &str, found: &str) -> bool {
    let verdict = if known == found { "equal" } else { "DIFFERENT" };
    println!("{how:<8} {name:<16} {ticks:>4} {found} {verdict}");
    known == found
}
