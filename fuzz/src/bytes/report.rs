//! Report files for the comparison.

use std::sync::LazyLock;

use lockstep2d::lockstep::{Game, History, Sandbox};
use lockstep2d::replay::Recorder;
use lockstep2d::report::{Blame, Desync, DesyncReport, Evidence, Side, compare};
use lockstep2d::world::BodyField;

use super::attempt;
use super::replay::{LIMITS, ball};
use crate::memory::Memory;
use crate::snapshots::repair;

/// Four reports: of [`Memory`] and then of [`Sandbox`], a correct one and one of a peer that diverged after two ticks.
static ORIGINALS: LazyLock<Vec<Vec<u8>>> = LazyLock::new(|| {
    let memory = |fail: bool| {
        report::<Memory>(&(), &[[1, 2, 3], [1, 2, 3], [4, 5, 6], [0, 255, 0]], |game, tick| {
            if fail && tick == 2 {
                game.load(&7);
            }
        })
    };
    let (setup, inputs) = ball();
    let sandbox = |fail: bool| {
        report::<Sandbox>(&setup, &inputs, |game, tick| {
            let world = game.world_mut();
            if fail
                && tick == 2
                && let Some(body) = { world.bodies().map(|(id, _)| id).nth(1) }
            {
                world.flip_bit(body, BodyField::ALL[0], 20).expect("the body exists");
            }
        })
    };
    vec![memory(false), memory(true), sandbox(false), sandbox(true)]
});

/// The correct reports of [`Memory`] and of [`Sandbox`].
static RIGHT: LazyLock<[Evidence; 2]> = LazyLock::new(|| {
    [0, 2].map(|at: usize| {
        Evidence::read(ORIGINALS[at].clone(), &LIMITS).expect("a peer's own report is valid")
    })
});

fn report<G: Game>(
    setup: &G::Setup,
    ticks: &[impl AsRef<[G::Input]>],
    mut fail: impl FnMut(&mut G, u64),
) -> Vec<u8> {
    let (mut recorder, mut game) = Recorder::<G>::start(setup, 2).expect("a valid setup");
    let mut history = History::<G>::of_ticks(2);
    history.push(0, game.save(), game.state_hash());
    for (tick, inputs) in (0..).zip(ticks) {
        fail(&mut game, tick);
        game.step(recorder.record(inputs.as_ref()).expect("inputs that can be recorded"));
        let hash = game.state_hash();
        if recorder.is_checkpoint_due() {
            recorder.checkpoint(hash);
        }
        history.push(tick + 1, game.save(), hash);
    }
    let tick = ticks.len() as u64;
    let desync = Desync { players: game.players(), tick, known: tick, seats: vec![0], hashes: vec![] };
    let replay = recorder.so_far(game.state_hash());
    DesyncReport::within(4000, &desync, &history, replay).to_bytes()
}

/// Reads a file, compares it with a correct report, and returns the result as one word.
///
/// # Panics
/// If a decoded report encodes to other bytes, or if the comparison blames the side of the correct report.
pub fn run(bytes: &[u8]) -> &'static str {
    let attempt = attempt(bytes, &ORIGINALS, |file| repair(file));
    if let Ok(report) = DesyncReport::from_bytes(&attempt.file, &LIMITS) {
        assert_eq!(report.to_bytes(), attempt.file, "a report has one encoding");
    }
    let Ok(left) = Evidence::read(attempt.file, &LIMITS) else { return "refused" };
    let dear = bytes.first().is_some_and(|mode| mode >> 6 == 0);
    let blame = if dear { judge::<Sandbox>(&left, &RIGHT[1]) } else { judge::<Memory>(&left, &RIGHT[0]) };
    match blame {
        None => "not compared",
        Some(Blame::Nobody) => "nobody",
        Some(Blame::Side(_)) => "blamed",
        Some(_) => "unknown",
    }
}

fn judge<G: Game>(left: &Evidence, right: &Evidence) -> Option<Blame> {
    let found = compare::<G>(left, right, &LIMITS).ok()?;
    assert!(!matches!(found.blame, Blame::Side(Side::B) | Blame::Both), "{found:?}");
    Some(found.blame)
}

/// The valid files, from which the tests write seeds.
pub fn originals() -> &'static [Vec<u8>] {
    &ORIGINALS
}
