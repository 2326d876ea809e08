//! Verifies replays of small scenes (as recorded, with changed bytes, or forged), and arbitrary bytes.

use lockstep2d::lockstep::{Sandbox, SandboxSetup};
use lockstep2d::replay::{Limits, Recording, Verdict, verify};
use lockstep2d::world::World;

use crate::forge::{Forged, mutate};
use crate::generator::{self, Generator};
use crate::source::Source;

/// Limits that keep the verification of a file well below a second.
#[must_use]
pub fn limits() -> Limits {
    Limits {
        file_bytes: 64 << 10,
        setup_bytes: 32 << 10,
        players: 4,
        block_bytes: 32 << 10,
        block_ticks: 600,
        ticks: 600,
        bodies: 1 << 20,
        tick_work: 40_000,
        total_work: 400_000,
    }
}

/// Verifies the file that the bytes describe.
///
/// # Panics
/// When the verdict on a changed file is `Match`, or the verdict on an unchanged file is neither `Match` nor
/// `LimitExceeded`.
pub fn run(bytes: &[u8]) -> Verdict {
    let mut source = Source::new(bytes);
    let way = source.below(8);
    if way == 7 {
        return verify::<Sandbox>(source.rest(), &limits());
    }
    let original = record(&mut source);
    let mut file = original.clone();
    match way {
        0 | 1 => mutate(&mut source, &mut file),
        2..=5 => {
            let mut forged = Forged::take_apart(&original);
            for _ in 0..=source.below(3) {
                forged.change(&mut source);
            }
            file = forged.put_together();
        }
        _ => {}
    }
    let verdict = verify::<Sandbox>(&file, &limits());
    if file == original {
        let good = matches!(verdict, Verdict::Match { .. } | Verdict::LimitExceeded { .. });
        assert!(good, "a recorder's own file must match: {verdict}");
    } else {
        assert!(!verdict.is_match(), "a changed file must not match");
    }
    verdict
}

/// A small scene, and the generator of its commands.
pub fn scene(source: &mut Source<'_>) -> (SandboxSetup, Generator) {
    let config = generator::config(source);
    let config = World::new(config).map(|_| config).unwrap_or_default();
    let mut generator = Generator::new(source);
    // Commands that fail are left out, because a setup with a failing command would be refused.
    let mut world = World::new(config).expect("checked");
    let mut commands = generator.setup(source);
    commands.retain(|command| world.execute(command).is_ok());
    commands.truncate(24);
    (SandboxSetup { config, commands }, generator)
}

fn record(source: &mut Source<'_>) -> Vec<u8> {
    let (setup, mut generator) = scene(source);
    let interval = 1 + source.below(9) as u32;
    let mut recording = Recording::<Sandbox>::start(&setup, interval).expect("a valid setup");
    let mut inputs = Vec::new();
    let mut cost = 0;
    for _ in 0..source.below(20) {
        if source.one_in(2) {
            inputs = generator.tick(source, recording.game().world());
        }
        recording.step(std::slice::from_ref(&inputs)).expect("inputs that can be recorded");
        cost += generator::cost(recording.game().world());
        if cost > 50_000 {
            break;
        }
    }
    recording.finish().expect("the sandbox has no claims")
}
