//! Scenes, a replay, definitions, a character, joints and masses, mostly compared with the Rust API.

use lockstep2d::body::{Geometry, MassProperties, Polygon, ShapeDef};
use lockstep2d::lockstep::{Game, Sandbox};
use lockstep2d::math::Fx;
use lockstep2d::world::{BodyPose, Command};
use lockstep2d::{codec, fx};
use lockstep2d_scenes::{ALL, Scene};

use super::{done, hash_of, list_of, take};
use crate::*;

const SEED: u64 = 1;
const TICKS: u64 = 60;

fn game(scene: &Scene) -> Sandbox {
    Sandbox::new(&scene.setup(SEED)).unwrap()
}

/// Executes a command. Common commands go through their own function, other commands through a list that is decoded
/// from bytes.
fn edit(target: u32, command: &Command) {
    let id = Out::null;
    match command {
        Command::Spawn { body, shapes } => {
            let shapes: Vec<RawShapeDef> = shapes.iter().map(RawShapeDef::of).collect();
            let body = RawBodyDef::of(body);
            done(ls2d_spawn(target, In::of(&body), In::all(&shapes), shapes.len(), id()));
        }
        Command::SpawnEach { body, shapes, poses } => {
            let shapes: Vec<RawShapeDef> = shapes.iter().map(RawShapeDef::of).collect();
            let body = RawBodyDef::of(body);
            let raw = |pose: &BodyPose| {
                let position = RawVec2 { x: RawFx::of(pose.position.x), y: RawFx::of(pose.position.y) };
                RawPose { body: RawBody(0), position, angle: RawAngle::of(pose.angle), flags: 0 }
            };
            let poses: Vec<RawPose> = poses.iter().map(raw).collect();
            let (shape_count, pose_count) = (shapes.len(), poses.len());
            let (shapes, poses) = (In::all(&shapes), In::all(&poses));
            done(ls2d_spawn_each(target, In::of(&body), shapes, shape_count, poses, pose_count, id(), 0));
        }
        Command::AddShape { body, shape } => {
            let shape = RawShapeDef::of(shape);
            done(ls2d_add_shape(target, RawBody::of(*body), In::of(&shape), Out::null()));
        }
        Command::AddJoint { joint } => {
            done(ls2d_add_joint(target, In::of(&RawJointDef::of(joint)), Out::null()));
        }
        Command::AddJointEach { joint, ends } => {
            let ends: Vec<RawBody> = ends.iter().flat_map(|&(a, b)| [a, b]).map(RawBody::of).collect();
            let joint = RawJointDef::of(joint);
            done(ls2d_add_joint_each(target, In::of(&joint), In::all(&ends), ends.len(), Out::null(), 0));
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

    seek(&file, &game);
    let mut world = 0;
    assert_eq!(ls2d_recording_world(recording, Out::of(&mut world)), Status::Record as i32, "it is finished");
    [recording, commands].into_iter().for_each(|handle| done(ls2d_free(handle)));
}

fn seek(file: &[u8], end: &Sandbox) {
    let (mut timeline, mut verdict) =
        (0, RawVerdict { kind: 9, reserved: 0, ticks: 0, hash: RawHash { low: 0, high: 0 } });
    let cut =
        ls2d_timeline_open(In::all(file), 40, In::null(), Out::of(&mut timeline), Out::of(&mut verdict));
    assert_eq!((cut, verdict.kind, timeline), (Status::Record as i32, MALFORMED, 0));
    done(ls2d_timeline_open(In::all(file), file.len(), In::null(), Out::of(&mut timeline), Out::null()));
    let state = || {
        let mut world = 0;
        done(ls2d_timeline_world(timeline, Out::of(&mut world)));
        let hash = hash_of(world);
        done(ls2d_free(world));
        hash
    };
    let mut hashes = vec![state()];
    while ls2d_timeline_step(timeline) == 0 {
        hashes.push(state());
    }
    let (mut tick, mut ticks) = (0, 0);
    done(ls2d_timeline_ticks(timeline, Out::of(&mut tick), Out::of(&mut ticks)));
    assert_eq!((tick, ticks, state()), (TICKS, TICKS, end.world().state_hash()));
    for (tick, hash) in hashes.iter().enumerate().rev().skip(1) {
        done(ls2d_timeline_step_back(timeline));
        assert_eq!(state(), *hash, "tick {tick}");
    }
    assert_eq!(ls2d_timeline_step_back(timeline), Status::None as i32);
    done(ls2d_timeline_seek(timeline, TICKS / 2));
    assert_eq!(state(), hashes[usize::try_from(TICKS / 2).unwrap()]);
    assert_eq!(ls2d_timeline_seek(timeline, TICKS + 1), Status::Value as i32);
    done(ls2d_free(timeline));
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

#[test]
fn a_character_moves_as_in_rust() {
    use lockstep2d::body::{BodyDef, Polygon, ShapeDef};
    use lockstep2d::fx;
    use lockstep2d::math::{Angle, Vec2};
    use lockstep2d::world::{Mover, MoverState, QueryFilter, World};

    let mut world = 0;
    done(ls2d_world_new(In::null(), Out::of(&mut world)));
    let mut same = World::default();
    let rectangle = |x, y| ShapeDef::new(Polygon::rectangle(x, y).unwrap());
    let lift = BodyDef::kinematic().position((fx!(0), fx!(-1))).velocity((fx!(0), fx!(1)));
    for (body, shape) in [
        (lift, rectangle(fx!(3), fx!(1))),
        (BodyDef::fixed().position((fx!(6), fx!(0))), rectangle(fx!(3), fx!(1.2))),
        (BodyDef::fixed().position((fx!(9.5), fx!(0))), rectangle(fx!(1), fx!(9))),
    ] {
        edit(world, &Command::Spawn { body, shapes: vec![shape] });
        same.spawn(&body, &[shape]).unwrap();
    }

    let mut mover = RawMover::of_kind(CIRCLE);
    mover.shape.radius = RawFx::of(fx!(0.5));
    mover.step_height = RawFx::of(fx!(0.3));
    mover.slope_max = RawAngle::of(Angle::from_degrees(fx!(50)));
    let circle = lockstep2d::body::Geometry::circle(fx!(0.5)).unwrap();
    let like = Mover::new(circle).unwrap().step_height(fx!(0.3)).slope_max(Angle::from_degrees(fx!(50)));
    let mut state = RawMoverState::at(Vec2::ZERO);
    done(ls2d_mover_state_init(RawFx(0), RawFx::of(fx!(0.6)), Out::of(&mut state)));
    let mut expected = MoverState::at(Vec2::new(fx!(0), fx!(0.6)));
    let (mut planes, mut most, mut on_ground) = ([RawMoverPlane::NONE; 16], 0, 0);
    for _ in 0..240 {
        done(ls2d_world_step(world));
        same.step();
        (state.velocity.x, state.velocity.y) =
            (RawFx::of(fx!(3)), RawFx(state.velocity.y.0 - fx!(0.16).to_bits()));
        expected.velocity = Vec2::new(fx!(3), expected.velocity.y - fx!(0.16));
        let (from, mut count) = (state, 0);
        let (planes, to) = (Out::all(&mut planes), Out::of(&mut state));
        done(ls2d_move_character(
            world,
            In::of(&mover),
            In::of(&from),
            In::null(),
            to,
            planes,
            16,
            Out::of(&mut count),
        ));
        let moved = same.move_character(&like, &expected, QueryFilter::default());
        expected = moved.state;
        assert_eq!(state.state(), Ok(expected));
        assert_eq!(count, moved.met.len());
        most = most.max(count);
        on_ground += u32::from(state.flags & MOVER_ON_GROUND != 0);
    }
    assert!(state.position.x.fx() > fx!(7.9) && most >= 1 && on_ground > 200, "{state:?}");
    done(ls2d_free(world));
}

#[test]
fn the_state_of_a_character_has_the_shapes_that_it_passes() {
    use lockstep2d::body::{BodyDef, Polygon, ShapeDef};
    use lockstep2d::fx;
    use lockstep2d::math::Vec2;
    use lockstep2d::world::{MoverState, World};

    let mut world = World::default();
    let square = ShapeDef::new(Polygon::square(fx!(1)).unwrap());
    let body = world.spawn(&BodyDef::fixed(), &[square; 3]).unwrap();
    let mut state = MoverState { has_landed: true, ..MoverState::at(Vec2::ZERO) };
    for (i, &shape) in world.shapes_of(body).iter().enumerate() {
        state.passing[i] = Some(shape);
        let raw = RawMoverState::of(&state, false);
        assert_eq!((raw.flags, raw.state()), (MOVER_LANDED, Ok(state)));
    }
    let mut raw = RawMoverState::of(&state, false);
    assert_eq!(raw.passing_count, 3);
    raw.passing_count = 9;
    assert!(raw.state().is_err());
    assert!(RawMoverState { passing_count: 0, reserved: 1, ..raw }.state().is_err());
}

/// A call whose buffer is too short, or in which one body is wrong, adds nothing.
#[test]
fn bodies_and_joints_are_added_together_or_not_at_all() {
    let mut world = 0;
    done(ls2d_world_new(In::null(), Out::of(&mut world)));
    let mut body = RawBodyDef::of(&lockstep2d::body::BodyDef::dynamic());
    body.user_data = 7;
    let pose = |x: i64| {
        let position = RawVec2 { x: RawFx(x << 32), y: RawFx(0) };
        RawPose { body: RawBody(9), position, angle: RawAngle(1 << 30), flags: 9 }
    };
    let poses = [pose(0), pose(2), pose(4)];
    let mut ids = [RawBody(u64::MAX); 3];
    let mut spawn = |capacity| {
        let (poses, ids) = (In::all(&poses), Out::all(&mut ids));
        ls2d_spawn_each(world, In::of(&body), In::null(), 0, poses, 3, ids, capacity)
    };
    assert_eq!(spawn(2), Status::Buffer as i32);
    done(spawn(3));
    let count = |world| {
        let mut poses = [pose(0); 8];
        let mut count = 0;
        done(ls2d_world_poses(world, Out::all(&mut poses), 8, Out::of(&mut count)));
        (count, poses)
    };
    let (bodies, found) = count(world);
    assert_eq!(bodies, 3);
    for (index, pose) in found[..3].iter().enumerate() {
        assert_eq!(
            (pose.body, pose.position, pose.angle),
            (ids[index], poses[index].position, poses[index].angle)
        );
    }
    let mut joint = RawJointDef::of_kind(0).unwrap();
    let mut joints = [RawJoint(u64::MAX); 2];
    let mut join = |ends: &[RawBody], capacity| {
        let ids = Out::all(&mut joints);
        ls2d_add_joint_each(world, In::of(&joint), In::all(ends), ends.len(), ids, capacity)
    };
    assert_eq!(join(&[ids[0], ids[1], ids[1]], 2), Status::Value as i32, "an odd number of ends");
    assert_ne!(join(&[ids[0], ids[1], ids[1], ids[1]], 2), Status::Ok as i32, "a body with itself");
    assert_eq!(join(&[ids[0], ids[1], ids[1], ids[2]], 1), Status::Buffer as i32);
    done(join(&[ids[0], ids[1], ids[1], ids[2]], 2));
    for (id, ends) in joints.iter().zip([[ids[0], ids[1]], [ids[1], ids[2]]]) {
        done(ls2d_joint_get(world, *id, Out::of(&mut joint)));
        assert_eq!([joint.body_a, joint.body_b], ends);
    }
    done(ls2d_free(world));
}

#[test]
fn the_mass_of_shapes_is_that_in_rust() {
    let half = fx!(0.5);
    let shapes =
        [Geometry::from(Polygon::rectangle(half, fx!(0.9)).unwrap()), Geometry::circle(half).unwrap()];
    let shapes = shapes.map(ShapeDef::new);
    let expected = MassProperties::of_shapes(&shapes).unwrap();
    let shapes = shapes.map(|shape| RawShapeDef::of(&shape));
    let (mut mass, mut centre, mut gyration) = (RawFx(0), RawVec2 { x: RawFx(9), y: RawFx(9) }, RawFx(0));
    let outs = (Out::of(&mut mass), Out::of(&mut centre), Out::of(&mut gyration));
    done(ls2d_shapes_mass(In::all(&shapes), 2, outs.0, outs.1, outs.2));
    let bits = |number: lockstep2d::math::Fx| RawFx(number.to_bits());
    assert_eq!((mass, gyration), (bits(expected.mass()), bits(expected.radius_of_gyration())));
    assert_eq!((centre.x, centre.y), (bits(expected.centre_of_mass().x), bits(expected.centre_of_mass().y)));
    let none = ls2d_shapes_mass(In::null(), 0, Out::null(), Out::null(), Out::null());
    assert_ne!(none, Status::Ok as i32, "no mass");
}

#[test]
fn a_chain_takes_the_properties_of_a_link() {
    let points = [0, 1, 2].map(|x| RawVec2 { x: RawFx::of(Fx::from_num(x)), y: RawFx::of(fx!(0)) });
    let chain = |base: &RawShapeDef| {
        let (mut links, mut count) = ([*base; 2], 0);
        let (made, counted) = (Out::all(&mut links), Out::of(&mut count));
        done(ls2d_chain_links(In::of(base), In::all(&points), points.len(), 0, 1, made, 2, counted));
        links
    };
    let mut base = RawShapeDef::of(&ShapeDef::new(Geometry::circle(fx!(1)).unwrap()).sensor());
    let links = chain(&base);
    base = links[0];
    assert_eq!(base.kind, LINK);
    assert_eq!(chain(&base), links);
}
