//! Replay files for the verifier.

use std::sync::LazyLock;

use lockstep2d::body::{BodyDef, Geometry, ShapeDef};
use lockstep2d::lockstep::{Game, Sandbox, SandboxSetup};
use lockstep2d::replay::{Limits, RawReplay, Reader, Recording, Step, Verdict, verify};
use lockstep2d::world::{Command, Config};
use lockstep2d::{codec, fx};

use super::attempt;
use crate::forge;
use crate::generator::spawn;
use crate::memory::Memory;

/// Limits so low that a verification takes little time.
pub(super) const LIMITS: Limits = Limits {
    file_bytes: 8 << 10,
    setup_bytes: 4 << 10,
    players: 4,
    block_bytes: 4 << 10,
    block_ticks: 16,
    ticks: 16,
    bodies: 1000,
    tick_work: 2000,
    total_work: 4000,
};

/// A recording of [`Memory`], one of a sandbox with bodies, one of an empty sandbox, and a truncated copy of the
/// second.
static ORIGINALS: LazyLock<Vec<Vec<u8>>> = LazyLock::new(|| {
    let memory = record::<Memory>(&(), 3, &[[1, 2, 3], [1, 2, 3], [4, 5, 6], [0, 255, 0], [9, 9, 9]]);
    let empty = record::<Sandbox>(&SandboxSetup::default(), 2, &[[vec![]], [vec![]], [vec![]]]);
    let (setup, inputs) = ball();
    let sandbox = record::<Sandbox>(&setup, 2, &inputs);
    let cut = sandbox[..sandbox.len() - 60].to_vec();
    vec![memory, sandbox, empty, cut]
});

/// A dynamic ball above a fixed one, and the inputs of five ticks.
pub(super) fn ball() -> (SandboxSetup, [[Vec<Command>; 1]; 5]) {
    let ball = ShapeDef::new(Geometry::circle(fx!(0.5)).expect("a valid radius"));
    let low = spawn(BodyDef::fixed(), &[ball]);
    let high = spawn(BodyDef::dynamic().position((fx!(0.1), fx!(1.01))), &[ball]);
    let push = Command::SetGravity { gravity: lockstep2d::math::Vec2::new(fx!(1), fx!(-20)) };
    let setup = SandboxSetup { config: Config::default(), commands: vec![low, high] };
    (setup, [[vec![]], [vec![]], [vec![push.clone()]], [vec![push]], [vec![]]])
}

pub(super) fn record<G: Game>(setup: &G::Setup, interval: u32, ticks: &[impl AsRef<[G::Input]>]) -> Vec<u8> {
    let mut recording = Recording::<G>::start(setup, interval).expect("a valid setup");
    for inputs in ticks {
        recording.step(inputs.as_ref()).expect("inputs that can be recorded");
    }
    recording.finish().expect("both games have valid claims")
}

/// Verifies a file and returns the name of the verdict.
///
/// # Panics
/// If a changed original matches, or if recording the inputs of a matching file again gives a different file.
pub fn run(bytes: &[u8]) -> &'static str {
    let attempt = attempt(bytes, &ORIGINALS, forge::repair);
    let verdict = match judge::<Memory>(&attempt.file) {
        Verdict::Unverifiable { .. } => judge::<Sandbox>(&attempt.file),
        verdict => verdict,
    };
    // A file that equals an original counts as unchanged: changes of the truncated copy may have completed it again.
    let changed = attempt.original.is_some() && !ORIGINALS.contains(&attempt.file);
    assert!(!changed || !verdict.is_match(), "a changed file must not match");
    verdict.name()
}

fn judge<G: Game>(file: &[u8]) -> Verdict {
    let verdict = verify::<G>(file, &LIMITS);
    if verdict.is_match() {
        assert_eq!(again::<G>(file), file, "a recorder writes a matching file byte for byte");
    }
    verdict
}

/// Records the inputs of a file again, and returns the new file.
fn again<G: Game>(file: &[u8]) -> Vec<u8> {
    let reader = Reader::open(file, &LIMITS).expect("a match");
    let setup: G::Setup = codec::decode(reader.header().setup).expect("a match");
    let mut recording = Recording::<G>::start(&setup, reader.header().checkpoint_interval).expect("a match");
    let mut raw = RawReplay::<G>::open(file, &LIMITS).expect("a match");
    while raw.step().expect("a match") == Step::Ticked {
        recording.step(raw.inputs()).expect("a match");
    }
    recording.finish().expect("a match")
}

/// The original files, from which the tests write seeds. The last one is truncated.
pub fn originals() -> &'static [Vec<u8>] {
    &ORIGINALS
}
