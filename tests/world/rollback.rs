//! A restore brings back the saved state, regardless of what happened since then and of the data that snapshots share.

use lockstep2d::codec;
use lockstep2d::collision::BroadPhaseKind;
use lockstep2d::fx;
use lockstep2d::lockstep::{Game, Sandbox, SandboxSave, SandboxSetup};
use lockstep2d::math::{Rng, Vec2};
use lockstep2d::world::{Command, Snapshot, World};

use super::churn::Churn;
use super::sweep;
use super::{ball, rectangle, shape_of, spawn, square, weightless, world_with_floor};
use lockstep2d::body::{BodyDef, Filter};
use lockstep2d::solver::{JointDef, JointKind};

/// Copy of a world that computes its digest without caches.
fn recomputed(world: &World) -> World {
    World::from_bytes(&world.to_bytes()).expect("its own bytes")
}

fn assert_is(world: &World, saved: &(Snapshot, Vec<u8>), what: &str) {
    let (snapshot, bytes) = saved;
    assert_eq!(world.state_hash(), snapshot.state_hash(), "{what}");
    assert!(world.to_bytes() == *bytes, "{what}: the encoded bytes differ");
    assert_eq!(world.validate(), Ok(()), "{what}");
}

/// Compares the cached digest with a recomputed one after every command, refused or not, and every step.
#[test]
fn what_is_known_of_a_world_follows_every_change() {
    sweep::for_each((100..108).collect(), |seed| {
        let mut churn = Churn::new(seed);
        let mut world = churn.world();
        for tick in 0..150 {
            for command in churn.commands(&world) {
                let _refused_or_not = world.execute(&command);
                let expected = recomputed(&world).digest();
                let differing = world.digest().differing(&expected);
                assert!(differing.is_empty(), "seed {seed}, tick {tick}, {command:?}: {differing:?}");
            }
            world.step();
            let differing = world.digest().differing(&recomputed(&world).digest());
            assert!(differing.is_empty(), "seed {seed}, tick {tick}: {differing:?}");
        }
    });
}

/// Restores earlier and later snapshots at random, and repeats the following ticks with equal results.
#[test]
fn a_world_jumps_between_its_snapshots() {
    sweep::for_each(sweep::sample(200..216, 3), |seed| {
        let mut churn = Churn::new(seed);
        let mut world = churn.world();
        let mut rng = Rng::new(seed);
        let mut saves: Vec<(Snapshot, Vec<u8>)> = Vec::new();
        let mut scripts: Vec<Vec<Command>> = Vec::new();
        for _ in 0..120 {
            saves.push((world.save(), world.to_bytes()));
            let mut commands = churn.commands(&world);
            commands.extend(churn.commands(&world));
            for command in &commands {
                let _refused_or_not = world.execute(command);
            }
            scripts.push(commands);
            world.step();
        }
        for _ in 0..60 {
            let from = rng.below(110) as usize;
            world.restore(&saves[from].0);
            assert_is(&world, &saves[from], "restored");
            let to = from + rng.below(9) as usize;
            for tick in from..to {
                for command in &scripts[tick] {
                    let _refused_or_not = world.execute(command);
                }
                world.step();
                assert_is(&world, &saves[tick + 1], &format!("seed {seed}, {from} to {tick}"));
            }
        }
        // The snapshot is restored into a world with another history.
        let mut other = world_with_floor().0;
        other.restore(&saves[70].0);
        assert_is(&other, &saves[70], "another world");
        assert_eq!(other.save(), saves[70].0);
    });
}

/// Shapes whose filters exclude each other are not searched for pairs. A change of filters or a restore brings the
/// pairs back.
#[test]
fn crowds_that_leave_each_other_out_come_back_together() {
    let mut world = weightless();
    let ids: Vec<_> = (0..40)
        .map(|i| {
            let place = BodyDef::dynamic().position((fx!(0.8) * i, fx!(0)));
            let body = spawn(&mut world, place, ball(fx!(0.5)));
            shape_of(&world, body)
        })
        .collect();
    let together = Filter::default();
    let same_category = Filter { category: 2, mask: !2, group: 0 };
    let same_group = Filter { group: -7, ..together };
    let set = |world: &mut World, filter: Filter| {
        ids.iter().for_each(|&id| world.set_filter(id, filter).expect("there"));
    };
    let filters = [(together, 39), (same_category, 0), (together, 39), (same_group, 0), (same_category, 0)];
    let saves = filters.map(|(filter, pairs)| {
        set(&mut world, filter);
        (world.save(), pairs)
    });
    for kind in [BroadPhaseKind::BruteForce, BroadPhaseKind::Tree] {
        world.set_broad_phase(kind);
        for (from, _) in &saves {
            for (to, pairs) in &saves {
                world.restore(from);
                world.step();
                world.restore(to);
                world.step();
                assert_eq!(world.pair_count(), *pairs, "{kind:?}");
            }
        }
    }
    // One shape with the default filter collides with both of its neighbours.
    world.set_filter(ids[20], together).expect("there");
    world.step();
    assert_eq!(world.pair_count(), 2);
}

#[test]
fn a_reused_snapshot_is_as_good_as_new() {
    let mut churn = Churn::new(7);
    let mut world = churn.world();
    let mut ring = vec![Snapshot::default(); 9];
    for tick in 0..200_usize {
        for command in churn.commands(&world) {
            let _refused_or_not = world.execute(&command);
        }
        world.save_into(&mut ring[tick % 9]);
        assert_eq!(ring[tick % 9], world.save(), "tick {tick}");
        if tick % 20 == 19 {
            let hash = world.state_hash();
            world.restore(&ring[(tick + 1) % 9]);
            assert_eq!(usize::try_from(world.tick()), Ok(tick - 8));
            world.restore(&ring[tick % 9]);
            assert_eq!(world.state_hash(), hash);
        }
        world.step();
    }
}

/// Snapshots have a limited number of bytes per body, pair and joint. After a rollback, eight ticks give equal hashes.
#[test]
fn snapshots_of_every_scene_are_small_and_come_back() {
    sweep::for_each(lockstep2d_scenes::ALL.iter().collect(), |scene| {
        let mut game = Sandbox::new(&scene.setup(1)).expect("the scenes of this crate are valid");
        let step = |game: &mut Sandbox, tick: u64| {
            let commands = scene.commands(tick, game);
            game.step(&[commands]);
        };
        let large = game.world().body_count() > 2000;
        let start = if large { 10 } else { 60 };
        (0..start).for_each(|tick| step(&mut game, tick));
        let world = game.world();
        let snapshot = world.save();
        let dynamic = world.bodies().filter(|(_, body)| body.is_dynamic()).count();
        let limit = 96 * dynamic + 88 * world.pair_count() + 16 * world.joint_count() + 2048;
        let size = snapshot.rollback_bytes();
        assert!(size <= limit, "{}: {size} bytes, at most {limit}", scene.name);
        let run = |game: &mut Sandbox| -> Vec<_> {
            (start..start + 8)
                .map(|tick| {
                    step(game, tick);
                    game.world().state_hash()
                })
                .collect()
        };
        let first = run(&mut game);
        game.world_mut().restore(&snapshot);
        assert!(run(&mut game) == first, "{}", scene.name);
    });
}

#[test]
fn snapshots_go_to_other_threads() {
    fn sent<T: Clone + Send + Sync>(_: &T) {}
    let (world, _) = world_with_floor();
    sent(&world.save());
    sent(&world);
}

/// Drawing a random number changes the hash, and so does a change to a clone. A restore brings the hash back.
#[test]
fn random_numbers_and_clones_are_hashed_as_they_are() {
    let (mut world, _) = world_with_floor();
    let body = spawn(&mut world, BodyDef::dynamic().position((fx!(0), fx!(3))), square(fx!(0.5)));
    let (before, snapshot) = (world.state_hash(), world.save());
    world.rng().next_u32();
    assert_ne!(world.state_hash(), before, "drawing a random number must change the hash");
    let mut twin = world.clone();
    twin.set_user_data(body, 3).expect("there");
    assert_ne!(twin.state_hash(), world.state_hash(), "user data must change the hash");
    twin.set_velocity(body, Vec2::new(fx!(1), fx!(0)), fx!(0)).expect("slow enough");
    twin.restore(&snapshot);
    world.restore(&snapshot);
    assert_eq!((twin.state_hash(), world.state_hash()), (before, before));
}

/// Damaged and truncated bytes are refused.
#[test]
fn snapshots_come_back_from_their_bytes() {
    for name in ["ragdoll", "game", "box_stack"] {
        let scene = lockstep2d_scenes::Scene::find(name).expect("a scene");
        let mut game = Sandbox::new(&scene.setup(1)).expect("a valid scene");
        for tick in 0..60 {
            game.step(&[scene.commands(tick, &game)]);
        }
        let save = game.save();
        assert_eq!(save.world.to_bytes(), game.world().to_bytes(), "{name}");
        let bytes = codec::encode(&save);
        let back: SandboxSave = codec::decode(&bytes).expect("what was written");
        assert_eq!(back, save, "{name}");
        assert_eq!(codec::encode(&back), bytes, "{name}");
        let mut other = Sandbox::new(&SandboxSetup::default()).expect("the default");
        other.load(&back);
        for tick in 60..70 {
            game.step(&[scene.commands(tick, &game)]);
            other.step(&[scene.commands(tick, &other)]);
            assert_eq!(other.state_hash(), game.state_hash(), "{name}, tick {tick}");
        }
        for at in (0..bytes.len() - 8).step_by(bytes.len() / 100) {
            let mut damaged = bytes.clone();
            damaged[at] ^= 1;
            assert!(codec::decode::<SandboxSave>(&damaged).is_err(), "{name}: byte {at} was changed");
            assert!(codec::decode::<SandboxSave>(&bytes[..at]).is_err(), "{name}: truncated to {at} bytes");
        }
    }
}

/// A thin rod moves into a wall during a tick in which no fat AABB changes. A filter joint disables collisions of rod
/// and wall. The worlds into which the snapshot is restored do not have this joint.
#[test]
fn a_restore_brings_back_which_pairs_joints_keep_apart() {
    let mut world = weightless();
    let wall = spawn(&mut world, BodyDef::fixed(), rectangle(fx!(3), fx!(0.5)));
    let def = BodyDef::dynamic().position((fx!(0), fx!(-0.5325))).velocity((fx!(0), fx!(0.6)));
    let rod = spawn(&mut world, def, rectangle(fx!(1), fx!(0.01)));
    let joint = world.add_joint(&JointDef::new(wall, rod, JointKind::Filter)).expect("valid");
    (0..2).for_each(|_| world.step());
    let saved = world.save();
    let mut other = World::default();
    other.restore(&saved);
    let mut back = world.clone();
    back.remove_joint(joint).expect("there");
    back.step();
    back.restore(&saved);
    for tick in 3..8 {
        world.step();
        for (name, restored) in [("another world", &mut other), ("rolled back", &mut back)] {
            restored.step();
            assert_eq!(restored.state_hash(), world.state_hash(), "{name}, tick {tick}");
        }
    }
}
