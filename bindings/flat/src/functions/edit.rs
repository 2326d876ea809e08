//! Edits: commands, executed by a world at once or added to a list.

use lockstep2d::body::Name;
use lockstep2d::codec;
use lockstep2d::math::{Fx, Vec2};
use lockstep2d::world::{self, Command, World};

use super::definitions::shapes_of;
use crate::border::{In, Out, Plain};
use crate::describe::api;
use crate::numbers::{RawAngle, RawBody, RawFx, RawJoint, RawShape};
use crate::records::{RawBodyDef, RawConfig, RawExplosion, RawJointDef, RawPose, RawShapeDef, body_kind};
use crate::status::{Failure, Outcome, Status, value};
use crate::table::{self, Bytes, Commands, Object, with, with_any, with_two};

/// If the target is a world, executes the command and returns its outcome. If the target is a list, adds the command to
/// the list and returns `None`.
fn edit(target: u32, command: Command) -> Outcome<Option<world::Outcome>> {
    with_any(target, |object| match object {
        Object::World(world) => Ok(Some(world.execute(&command)?)),
        Object::Commands(list) => {
            list.0.push(command);
            Ok(None)
        }
        _ => Err(Failure::new(Status::HandleKind, "a world or a list of commands is expected")),
    })
}

/// Checks that the caller's buffer has room for all new handles. Called before the edit, so that an error changes
/// nothing.
fn check_room<T: Plain>(ids: &Out<'_, T>, capacity: usize, needed: usize) -> Outcome {
    if ids.is_null() {
        return Ok(());
    }
    ids.check()?;
    if needed <= capacity {
        return Ok(());
    }
    Err(Failure::new(Status::Buffer, format!("a buffer of {capacity} items, {needed} are needed")))
}

fn set_ids<T: Plain>(mut ids: Out<'_, T>, capacity: usize, made: Vec<T>) -> Outcome {
    let mut count = 0;
    if ids.is_null() { Ok(()) } else { ids.set_all(capacity, &mut Out::of(&mut count), &made) }
}

macro_rules! body_commands {
    ($target:ident, $body:ident, $command:ident) => {
        edit($target, Command::$command { body: $body.id()? }).map(|_| ())
    };
}

api! {
    /// Makes an empty list of commands.
    fn ls2d_commands_new(commands: Out<'_, u32>) {
        let mut commands = commands;
        commands.check()?;
        commands.set(table::add(Commands(Vec::new()))?)
    }

    /// Empties a list of commands.
    fn ls2d_commands_clear(commands: u32) {
        with(commands, |Commands(list)| {
            list.clear();
            Ok(())
        })
    }

    /// Number of commands in a list.
    fn ls2d_commands_count(commands: u32, count: Out<'_, usize>) {
        let mut count = count;
        with(commands, |Commands(list)| count.set(list.len()))
    }

    /// Encodes a list of commands as bytes.
    fn ls2d_commands_encode(commands: u32, bytes: Out<'_, u32>) {
        let mut bytes = bytes;
        bytes.check()?;
        let encoded = with(commands, |Commands(list)| Ok(codec::encode(list)))?;
        bytes.set(table::add(Bytes(encoded))?)
    }

    /// Replaces the contents of a list of commands by the commands in `data`, an encoded list. `data` may come from an
    /// untrusted source.
    fn ls2d_commands_decode(commands: u32, data: In<'_, u8>, size: usize) {
        let decoded: Vec<Command> = codec::decode(data.slice(size)?)?;
        with(commands, |Commands(list)| {
            *list = decoded;
            Ok(())
        })
    }

    /// Executes a list of commands in order. Skips commands that the world refuses. Writes the number of skipped
    /// commands to `refused`, unless this pointer is null.
    fn ls2d_world_execute(world: u32, commands: u32, refused: Out<'_, u32>) {
        let mut refused = refused;
        refused.check_if_wanted()?;
        with_two(world, commands, |world: &mut World, Commands(list)| {
            let count = list.iter().filter(|command| world.execute(command).is_err()).count();
            refused.set_if_wanted(u32::try_from(count).unwrap_or(u32::MAX))
        })
    }

    /// Adds a body with its shapes. Writes the body's handle to `id`, unless `id` is null or the target is a list.
    fn ls2d_spawn(
        target: u32,
        body: In<'_, RawBodyDef>,
        shapes: In<'_, RawShapeDef>,
        shape_count: usize,
        id: Out<'_, RawBody>,
    ) {
        let mut id = id;
        id.check_if_wanted()?;
        let (body, shapes) = (body.get()?.def()?, shapes_of(&shapes, shape_count)?);
        match edit(target, Command::Spawn { body, shapes })? {
            Some(world::Outcome::Body(body)) => id.set_if_wanted(RawBody::of(body)),
            _ => Ok(()),
        }
    }

    /// Adds a body at each of the `poses`, all with the definition `body` and the same shapes. If the world refuses one
    /// of the bodies, it adds none of them. A recording stores the definition only once. The fields `body` and `flags`
    /// of the poses are not read. Writes the handles of the bodies to `ids`, unless `ids` is null or the target is a
    /// list.
    fn ls2d_spawn_each(
        target: u32,
        body: In<'_, RawBodyDef>,
        shapes: In<'_, RawShapeDef>,
        shape_count: usize,
        poses: In<'_, RawPose>,
        pose_count: usize,
        ids: Out<'_, RawBody>,
        capacity: usize,
    ) {
        check_room(&ids, capacity, pose_count)?;
        let (body, shapes) = (body.get()?.def()?, shapes_of(&shapes, shape_count)?);
        let poses = poses.slice(pose_count)?.iter().map(RawPose::pose).collect();
        match edit(target, Command::SpawnEach { body, shapes, poses })? {
            Some(world::Outcome::Bodies(bodies)) => {
                set_ids(ids, capacity, bodies.into_iter().map(RawBody::of).collect())
            }
            _ => Ok(()),
        }
    }

    /// Removes a body with its shapes and joints.
    fn ls2d_despawn(target: u32, body: RawBody) { body_commands!(target, body, Despawn) }

    /// Adds a shape to a body. Writes the shape's handle to `id`, unless `id` is null or the target is a list.
    fn ls2d_add_shape(target: u32, body: RawBody, shape: In<'_, RawShapeDef>, id: Out<'_, RawShape>) {
        let mut id = id;
        id.check_if_wanted()?;
        match edit(target, Command::AddShape { body: body.id()?, shape: shape.get()?.def()? })? {
            Some(world::Outcome::Shape(shape)) => id.set_if_wanted(RawShape::of(shape)),
            _ => Ok(()),
        }
    }

    /// Removes a shape.
    fn ls2d_remove_shape(target: u32, shape: RawShape) {
        edit(target, Command::RemoveShape { shape: shape.id()? }).map(|_| ())
    }

    /// Replaces the definition of a shape.
    fn ls2d_set_shape(target: u32, shape: RawShape, def: In<'_, RawShapeDef>) {
        edit(target, Command::SetShape { shape: shape.id()?, def: def.get()?.def()? }).map(|_| ())
    }

    /// Adds a joint. Writes the joint's handle to `id`, unless `id` is null or the target is a list.
    fn ls2d_add_joint(target: u32, joint: In<'_, RawJointDef>, id: Out<'_, RawJoint>) {
        let mut id = id;
        id.check_if_wanted()?;
        match edit(target, Command::AddJoint { joint: joint.get()?.def()? })? {
            Some(world::Outcome::Joint(joint)) => id.set_if_wanted(RawJoint::of(joint)),
            _ => Ok(()),
        }
    }

    /// Adds a joint between each pair of bodies in `ends`, all with the definition `joint`, whose own bodies are
    /// ignored. If the world refuses one of the joints, it adds none of them. A recording stores the definition only
    /// once. `ends` contains body A and body B of the first joint, then those of the second joint, and so on;
    /// `end_count` is the number of bodies. Writes the handles of the joints to `ids`, unless `ids` is null or the
    /// target is a list.
    fn ls2d_add_joint_each(
        target: u32,
        joint: In<'_, RawJointDef>,
        ends: In<'_, RawBody>,
        end_count: usize,
        ids: Out<'_, RawJoint>,
        capacity: usize,
    ) {
        check_room(&ids, capacity, end_count / 2)?;
        let (pairs, []) = ends.slice(end_count)?.as_chunks() else {
            return Err(value("the number of ends of joints", end_count));
        };
        // The bodies in the definition are ignored. They may be `LS2D_NO_ID`, which `def` would refuse, so they are
        // replaced.
        let [body_a, body_b] = pairs.first().copied().unwrap_or([RawBody(0); 2]);
        let joint = RawJointDef { body_a, body_b, ..joint.get()? }.def()?;
        let pair = |&[a, b]: &[RawBody; 2]| Ok((a.id()?, b.id()?));
        let ends = pairs.iter().map(pair).collect::<Outcome<_>>()?;
        match edit(target, Command::AddJointEach { joint, ends })? {
            Some(world::Outcome::Joints(joints)) => {
                set_ids(ids, capacity, joints.into_iter().map(RawJoint::of).collect())
            }
            _ => Ok(()),
        }
    }

    /// Removes a joint.
    fn ls2d_remove_joint(target: u32, joint: RawJoint) {
        edit(target, Command::RemoveJoint { joint: joint.id()? }).map(|_| ())
    }

    /// Replaces the definition of a joint. The bodies of the joint cannot be changed.
    fn ls2d_set_joint(target: u32, joint: RawJoint, def: In<'_, RawJointDef>) {
        edit(target, Command::SetJoint { joint: joint.id()?, def: def.get()?.def()? }).map(|_| ())
    }

    /// Enables a joint.
    fn ls2d_enable_joint(target: u32, joint: RawJoint) {
        edit(target, Command::EnableJoint { joint: joint.id()? }).map(|_| ())
    }

    /// Disables a joint: it stays in the world and keeps its handle, but has no effect.
    fn ls2d_disable_joint(target: u32, joint: RawJoint) {
        edit(target, Command::DisableJoint { joint: joint.id()? }).map(|_| ())
    }

    /// Applies a force in N to a body during the next tick, at a point of the world in metres.
    fn ls2d_apply_force(target: u32, body: RawBody, force_x: RawFx, force_y: RawFx, x: RawFx, y: RawFx) {
        let (force, point) = (vector(force_x, force_y), vector(x, y));
        edit(target, Command::ApplyForce { body: body.id()?, force, point }).map(|_| ())
    }

    /// Applies a torque in N m to a body during the next tick.
    fn ls2d_apply_torque(target: u32, body: RawBody, torque: RawFx) {
        edit(target, Command::ApplyTorque { body: body.id()?, torque: torque.fx() }).map(|_| ())
    }

    /// Applies an impulse in N s to a body at a point of the world in metres: changes the velocity at once.
    fn ls2d_apply_impulse(target: u32, body: RawBody, impulse_x: RawFx, impulse_y: RawFx, x: RawFx, y: RawFx) {
        let (impulse, point) = (vector(impulse_x, impulse_y), vector(x, y));
        edit(target, Command::ApplyImpulse { body: body.id()?, impulse, point }).map(|_| ())
    }

    /// Applies an angular impulse in N m s to a body: changes the angular velocity at once.
    fn ls2d_apply_angular_impulse(target: u32, body: RawBody, impulse: RawFx) {
        edit(target, Command::ApplyAngularImpulse { body: body.id()?, impulse: impulse.fx() }).map(|_| ())
    }

    /// Sets the velocity of a body's centre of mass in m/s, and its angular velocity in rad/s.
    fn ls2d_set_velocity(target: u32, body: RawBody, x: RawFx, y: RawFx, angular: RawFx) {
        let (velocity, angular_velocity) = (vector(x, y), angular.fx());
        edit(target, Command::SetVelocity { body: body.id()?, velocity, angular_velocity }).map(|_| ())
    }

    /// Sets the position of a body's origin in metres, and its angle.
    fn ls2d_set_transform(target: u32, body: RawBody, x: RawFx, y: RawFx, angle: RawAngle) {
        let (position, angle) = (vector(x, y), angle.angle());
        edit(target, Command::SetTransform { body: body.id()?, position, angle }).map(|_| ())
    }

    /// Moves a kinematic body during the next tick, so that its origin ends at (`x`, `y`) in metres with the rotation
    /// `angle`. After this tick its velocity is 0. The result is `LS2D_WRONG_KIND` for a body that is not kinematic,
    /// and `LS2D_SPEED` if the body cannot reach the pose in one tick at the world's `speed_max`: use
    /// `ls2d_set_transform` for such a distance.
    fn ls2d_move_to(target: u32, body: RawBody, x: RawFx, y: RawFx, angle: RawAngle) {
        let (position, angle) = (vector(x, y), angle.angle());
        edit(target, Command::MoveTo { body: body.id()?, position, angle }).map(|_| ())
    }

    /// Sets all settings of a body: damping, gravity scale, locks, continuous collision detection, sleep. The other
    /// fields of `def` have no effect.
    fn ls2d_set_body(target: u32, body: RawBody, def: In<'_, RawBodyDef>) {
        edit(target, Command::SetBody { body: body.id()?, settings: def.get()?.settings()? }).map(|_| ())
    }

    /// Changes the kind of a body. A body that becomes fixed stops.
    fn ls2d_set_kind(target: u32, body: RawBody, kind: u32) {
        edit(target, Command::SetKind { body: body.id()?, kind: body_kind(kind)? }).map(|_| ())
    }

    /// Sets the mass of a body. If `def` has `LS2D_BODY_GIVEN_MASS`, its three mass fields are used, otherwise the mass
    /// of the body's shapes. The other fields of `def` have no effect.
    fn ls2d_set_mass(target: u32, body: RawBody, def: In<'_, RawBodyDef>) {
        let def = def.get()?;
        def.settings()?;
        edit(target, Command::SetMass { body: body.id()?, mass: def.mass_source() }).map(|_| ())
    }

    /// Sets the number that the game stores with a body.
    fn ls2d_set_user_data(target: u32, body: RawBody, user_data: u64) {
        edit(target, Command::SetUserData { body: body.id()?, user_data }).map(|_| ())
    }

    /// Sets the name of a body. A length of 0 removes the name.
    fn ls2d_set_name(target: u32, body: RawBody, text: In<'_, u8>, length: usize) {
        let text = text.text(length)?;
        let name = if text.is_empty() { None } else { Some(Name::new(text)?) };
        edit(target, Command::SetName { body: body.id()?, name }).map(|_| ())
    }

    /// Enables a body: it takes part in the simulation again.
    fn ls2d_enable(target: u32, body: RawBody) { body_commands!(target, body, Enable) }

    /// Disables a body: it keeps its pose and velocity, collides with nothing, and queries do not find it.
    fn ls2d_disable(target: u32, body: RawBody) { body_commands!(target, body, Disable) }

    /// Wakes a body.
    fn ls2d_wake(target: u32, body: RawBody) { body_commands!(target, body, Wake) }

    /// Puts a dynamic body to sleep, together with the dynamic bodies that are connected to it by contacts and joints.
    fn ls2d_sleep(target: u32, body: RawBody) { body_commands!(target, body, Sleep) }

    /// Sets the gravity in m/s².
    fn ls2d_set_gravity(target: u32, x: RawFx, y: RawFx) {
        edit(target, Command::SetGravity { gravity: vector(x, y) }).map(|_| ())
    }

    /// Replaces the settings of a world. A limit, such as `body_limit`, must be equal to that of the world; otherwise
    /// the result is `LS2D_FIXED_SETTING`, and no setting changes. A recording also refuses a different tick rate.
    fn ls2d_set_config(target: u32, config: In<'_, RawConfig>) {
        edit(target, Command::SetConfig { config: config.get()?.config()? }).map(|_| ())
    }

    /// Applies the impulses of an explosion to dynamic bodies, away from its centre, and wakes these bodies.
    fn ls2d_explode(target: u32, explosion: In<'_, RawExplosion>) {
        edit(target, Command::Explode { explosion: explosion.get()?.explosion()? }).map(|_| ())
    }

    /// Sets the defaults of an explosion: radius and falloff of 1 m, acting on shapes of all categories. The centre is
    /// a point of the world in metres. `impulse` is in N s per metre of the width of a shape.
    fn ls2d_explosion_init(x: RawFx, y: RawFx, impulse: RawFx, explosion: Out<'_, RawExplosion>) {
        let mut explosion = explosion;
        explosion.set(RawExplosion::new(vector(x, y), impulse.fx()))
    }
}

const fn vector(x: RawFx, y: RawFx) -> Vec2<Fx> {
    Vec2::new(x.fx(), y.fx())
}
