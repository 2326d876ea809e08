//! Reads snapshots with changed fields or bytes, and arbitrary bytes.

use lockstep2d::collision::BroadPhaseKind;
use lockstep2d::hash::StateHash;
use lockstep2d::world::World;

use crate::forge::mutate;
use crate::generator::{self, Generator};
use crate::mirror::State;
use crate::source::Source;

/// Size of the header: magic, format, semantics, length.
const HEADER_BYTES: usize = 24;
const HASH_BYTES: usize = 16;
/// A world is simulated only while [`generator::cost`] is at most this number.
const COST_MAX: u64 = 30_000;

/// Reads a snapshot, and returns whether it is accepted. In one of 32 runs, the snapshot is the rest of `bytes`.
/// Otherwise it is that of a small scene, with changed fields or bytes and, in most cases, a corrected hash.
///
/// # Panics
/// When an accepted world does not encode to the bytes from which it was decoded. Also when it breaks an invariant
/// within ten ticks, or when its state or events then depend on its caches or its broad phase.
pub fn run(bytes: &[u8]) -> bool {
    let mut source = Source::new(bytes);
    if source.one_in(32) {
        return accept(source.rest(), None);
    }
    let (world, mut generator) = small_scene(&mut source);
    let mut snapshot = world.to_bytes();
    if source.one_in(4) {
        for _ in 0..=source.below(2) {
            mutate_state(&mut source, &mut snapshot);
        }
    } else {
        let mut state = State::of(&world);
        for _ in 0..=source.below(8) {
            state.alter(&mut source);
        }
        let end = snapshot.len() - HASH_BYTES;
        snapshot.splice(HEADER_BYTES..end, state.encode());
    }
    if !source.one_in(32) {
        repair(&mut snapshot);
    }
    accept(&snapshot, Some((&mut source, &mut generator)))
}

fn small_scene(source: &mut Source<'_>) -> (World, Generator) {
    let mut world = World::new(generator::config(source)).unwrap_or_default();
    let mut generator = Generator::new(source);
    let mut commands = generator.setup(source);
    commands.truncate(16);
    for _ in 0..1 + source.below(12) {
        for command in &commands {
            let _ = world.execute(command);
        }
        world.step();
        commands = generator.tick(source, &world);
        commands.truncate(4);
    }
    (world, generator)
}

fn mutate_state(source: &mut Source<'_>, snapshot: &mut Vec<u8>) {
    if source.one_in(32) || snapshot.len() < HEADER_BYTES + HASH_BYTES {
        return mutate(source, snapshot);
    }
    let end = snapshot.len() - HASH_BYTES;
    let mut state = snapshot[HEADER_BYTES..end].to_vec();
    mutate(source, &mut state);
    snapshot.splice(HEADER_BYTES..end, state);
}

/// Corrects length and hash of a snapshot or a report.
pub(crate) fn repair(snapshot: &mut [u8]) {
    if snapshot.len() < HEADER_BYTES + HASH_BYTES {
        return;
    }
    let end = snapshot.len() - HASH_BYTES;
    let length = (end - HEADER_BYTES) as u64;
    snapshot[16..24].copy_from_slice(&length.to_le_bytes());
    let hash = StateHash::of_bytes(&snapshot[..end]);
    snapshot[end..].copy_from_slice(&hash.0.to_le_bytes());
}

/// Checks that a world read from the bytes stays valid and independent of its caches. Returns whether it is accepted.
fn accept(bytes: &[u8], mut player: Option<(&mut Source<'_>, &mut Generator)>) -> bool {
    let Ok(mut world) = World::from_bytes(bytes) else { return false };
    assert_eq!(world.validate(), Ok(()), "an accepted world is valid");
    assert_eq!(world.to_bytes(), bytes, "a state has one encoding");
    let mut bare = world.clone();
    bare.set_broad_phase(BroadPhaseKind::BruteForce);
    for tick in 0..10 {
        if generator::cost(&world) > COST_MAX {
            break;
        }
        if let Some((source, generator)) = player.as_mut().filter(|_| tick % 4 == 2) {
            for command in generator.tick(source, &world) {
                assert_eq!(world.execute(&command), bare.execute(&command), "{command:?}");
            }
        }
        world.step();
        bare.clear_scratch();
        bare.step();
        assert_eq!(world.validate(), Ok(()), "a valid world stays valid");
        let differing = world.digest().differing(&bare.digest());
        assert!(differing.is_empty(), "{differing:?} depend on caches or the broad phase");
        assert_eq!(world.events(), bare.events(), "events depend on caches or the broad phase");
        if tick % 5 == 0 {
            let again = World::from_bytes(&world.to_bytes()).expect("a world's own bytes");
            assert_eq!(again.state_hash(), world.state_hash());
        }
    }
    true
}
