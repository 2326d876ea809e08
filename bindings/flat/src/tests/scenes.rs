//! The scenes of the library, built and played through the flat API, have the hashes that they have without it: with
//! the structs of definitions, with encoded commands, in recordings, and through snapshots.

use lockstep2d::codec;
use lockstep2d::lockstep::{Game, Sandbox};
use lockstep2d::world::{BodyPose, Command};
use lockstep2d_scenes::{ALL, Scene};

use super::{done, hash_of, list_of, take};
use crate::*;

const SEED: u64 = 1;
const TICKS: u64 = 60;

fn game(scene: &Scene) -> Sandbox {
    Sandbox::new(&scene.setup(SEED)).unwrap()
}

/// Executes a command by the function with its structs, if there is one.
fn edit(target: u32, command: &Command) {
    let id = Out::null;
    match command {
        Command::Spawn { body, shapes } => {
            let shapes: Vec<RawShapeDef> = shapes.iter().map(RawShapeDef::of).collect();
            let body = RawBodyDef::of(body);
            done(ls2d_spawn(target, In::of(&body), In::all(&shapes), shapes.len(), id()));
        }
        Command::SpawnEach { body, shapes, places } => {
            for &BodyPose { position, angle } in places {
                let body = lockstep2d::body::BodyDef { position, angle, ..*body };
                edit(target, &Command::Spawn { body, shapes: shapes.clone() });
            }
        }
        Command::AddShape { body, shape } => {
            let shape = RawShapeDef::of(shape);
            done(ls2d_add_shape(target, RawBody::of(*body), In::of(&shape), Out::null()));
        }
        Command::AddJoint { joint } => {
            done(ls2d_add_joint(target, In::of(&RawJointDef::of(joint)), Out::null()));
        }
        Command::AddJointEach { joint, ends } => {
            for &(body_a, body_b) in ends {
                let joint = lockstep2d::solver::JointDef { body_a, body_b, ..*joint };
                edit(target, &Command::AddJoint { joint });
            }
        }
        Command::SetVelocity { body, velocity, angular_velocity } => {
            let (x, y) = (RawFx::of(velocity.x), RawFx::of(velocity.y));
            done(ls2d_set_velocity(target, RawBody::of(*body), x, y, RawFx::of(*angular_velocity)));
        }
        other => {
            let list = list_of(&codec::encode(&vec![other.clone()]));
            let mut refused = 0;
            done(ls2d_world_execute(target, list, Out::of(&mut refused)));
            assert_eq!(refused, 0, "{other:?}");
            done(ls2d_free(list));
        }
    }
}

/// A world that the structs of definitions build.
fn build(scene: &Scene) -> u32 {
    let setup = scene.setup(SEED);
    let mut world = 0;
    done(ls2d_world_new(In::of(&RawConfig::of(&setup.config)), Out::of(&mut world)));
    setup.commands.iter().for_each(|command| edit(world, command));
    world
}

#[test]
fn scenes_built_from_structs_have_the_same_hashes() {
    for scene in ALL {
        let mut game = game(scene);
        if game.world().shape_count() > 2000 {
            continue;
        }
        let world = build(scene);
        assert_eq!(hash_of(world), game.world().state_hash(), "{} at its start", scene.name);
        for tick in 0..TICKS {
            let commands = scene.commands(tick, &game);
            commands.iter().for_each(|command| edit(world, command));
            done(ls2d_world_step(world));
            game.step(&[commands]);
        }
        assert_eq!(hash_of(world), game.world().state_hash(), "{} after {TICKS} ticks", scene.name);
        done(ls2d_free(world));
    }
}

#[test]
fn a_recorded_scene_verifies_and_rolls_back() {
    let scene = Scene::find("character").unwrap();
    let setup = scene.setup(SEED);
    let (mut recording, mut bytes) = (0, 0);
    let commands = list_of(&codec::encode(&setup.commands));
    let config = RawConfig::of(&setup.config);
    done(ls2d_recording_new(In::of(&config), commands, 60, Out::of(&mut recording)));
    let mut game = game(scene);
    for tick in 0..TICKS {
        let input = scene.commands(tick, &game);
        let list = list_of(&codec::encode(&input));
        done(ls2d_recording_step(recording, list));
        done(ls2d_free(list));
        game.step(&[input]);
    }
    done(ls2d_recording_finish(recording, Out::of(&mut bytes)));
    let file = take(bytes);
    let mut verdict = RawVerdict { kind: 9, reserved: 0, ticks: 0, hash: RawHash { low: 0, high: 0 } };
    done(ls2d_replay_verify(In::all(&file), file.len(), In::null(), Out::of(&mut verdict)));
    assert_eq!((verdict.kind, verdict.ticks, verdict.hash.hash()), (MATCH, TICKS, game.state_hash()));

    let mut world = 0;
    assert_eq!(ls2d_recording_world(recording, Out::of(&mut world)), Status::Record as i32, "it is finished");
    [recording, commands].into_iter().for_each(|handle| done(ls2d_free(handle)));
}

#[test]
fn definitions_survive_the_way_there_and_back() {
    for scene in ALL {
        for command in scene.setup(SEED).commands {
            match command {
                Command::Spawn { body, shapes } => {
                    assert_eq!(RawBodyDef::of(&body).def(), Ok(body));
                    shapes.iter().for_each(|shape| assert_eq!(RawShapeDef::of(shape).def(), Ok(*shape)));
                }
                Command::AddJoint { joint } => assert_eq!(RawJointDef::of(&joint).def(), Ok(joint)),
                Command::SetConfig { config } => assert_eq!(RawConfig::of(&config).config(), Ok(config)),
                _ => {}
            }
        }
    }
}
