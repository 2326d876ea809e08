//! Bytes of worlds that no world has written.

use lockstep2d::hash::StateHash;
use lockstep2d::world::World;

use crate::forge::mutate;
use crate::generator::{self, Generator};
use crate::source::Source;

/// Magic, format, semantics, length.
const HEADER_BYTES: usize = 24;
const HASH_BYTES: usize = 16;

/// Reads what the bytes describe: bytes as they are, or those of a small scene, changed and repaired.
///
/// # Panics
/// When a world that was accepted breaks an invariant or differs from itself within ten ticks.
pub fn run(bytes: &[u8]) -> bool {
    let mut source = Source::new(bytes);
    if source.one_in(16) {
        return accept(source.rest());
    }
    let mut snapshot = small_scene(&mut source).to_bytes();
    for _ in 0..=source.below(4) {
        mutate_state(&mut source, &mut snapshot);
    }
    if !source.one_in(16) {
        repair(&mut snapshot);
    }
    accept(&snapshot)
}

fn small_scene(source: &mut Source<'_>) -> World {
    let mut world = World::new(generator::config(source)).unwrap_or_default();
    let mut generator = Generator::new(source);
    let mut commands = generator.setup(source);
    commands.truncate(12);
    for _ in 0..1 + source.below(6) {
        for command in &commands {
            let _ = world.execute(command);
        }
        world.step();
        commands = generator.tick(source, &world);
        commands.truncate(4);
    }
    world
}

fn mutate_state(source: &mut Source<'_>, snapshot: &mut Vec<u8>) {
    let end = snapshot.len() - HASH_BYTES;
    if source.one_in(32) {
        return mutate(source, snapshot);
    }
    let mut state = snapshot[HEADER_BYTES..end].to_vec();
    mutate(source, &mut state);
    snapshot.splice(HEADER_BYTES..end, state);
}

/// Makes length and hash fit the rest.
fn repair(snapshot: &mut [u8]) {
    if snapshot.len() < HEADER_BYTES + HASH_BYTES {
        return;
    }
    let end = snapshot.len() - HASH_BYTES;
    let length = (end - HEADER_BYTES) as u64;
    snapshot[16..24].copy_from_slice(&length.to_le_bytes());
    let hash = StateHash::of_bytes(&snapshot[..end]);
    snapshot[end..].copy_from_slice(&hash.0.to_le_bytes());
}

/// Whether the bytes are a world; if so it has to live on like any other.
fn accept(bytes: &[u8]) -> bool {
    let Ok(mut world) = World::from_bytes(bytes) else { return false };
    assert_eq!(world.validate(), Ok(()), "an accepted world is valid");
    assert_eq!(world.to_bytes(), bytes, "a state has one encoding");
    let mut bare = world.clone();
    for _ in 0..10 {
        if generator::cost(&world) > 100_000 {
            break;
        }
        world.step();
        bare.clear_scratch();
        bare.step();
        assert_eq!(world.validate(), Ok(()), "a valid world stays valid");
        let differing = world.digest().differing(&bare.digest());
        assert!(differing.is_empty(), "{differing:?} depend on caches");
        let again = World::from_bytes(&world.to_bytes()).expect("a world's own bytes");
        assert_eq!(again.state_hash(), world.state_hash());
    }
    true
}
