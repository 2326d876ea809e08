//! [`DragPlugin`]: bodies of a [`Sandbox`] follow the pointer.

use bevy::app::{App, Plugin, RunFixedMainLoop, RunFixedMainLoopSystems};
use bevy::math::Vec2 as FloatVec2;
use bevy::prelude::{
    IntoScheduleConfigs, Local, Reflect, ReflectResource, Res, ResMut, Resource, resource_exists,
};
use lockstep2d::body::BodyId;
use lockstep2d::fx;
use lockstep2d::lockstep::Sandbox;
use lockstep2d::math::{Fx, Vec2, fx_mul};
use lockstep2d::world::{Command, World};

use crate::inputs::Inputs;
use crate::lockstep::Lockstep;
use crate::plugin::{LockstepSettings, LockstepSystems};

/// Drags the bodies of a [`Sandbox`] with a [`DragHand`]. The pull is a command in the input of a player, so it is
/// recorded.
///
/// A system of the game passes the position of its pointer to the [`DragHand`]. With the feature `picking`,
/// `PointerDragPlugin` passes the positions of mouse and touch.
#[derive(Clone, Copy, Debug, Default)]
pub struct DragPlugin;

/// The pointer that drags bodies. Positions are in units of `Transform`.
#[derive(Resource, Reflect, Clone, Copy, Debug, Default)]
#[reflect(Resource)]
pub struct DragHand {
    at: Option<FloatVec2>,
    /// Body that is held until the pointer is released. While it is `None`, the first dynamic body that the pointer
    /// reaches becomes the target.
    #[reflect(ignore)]
    target: Option<BodyId>,
    #[reflect(ignore)]
    held: Option<Held>,
}

#[derive(Clone, Copy, Debug)]
struct Held {
    body: BodyId,
    /// The grabbed point in the body's frame, in metres.
    grip: Vec2<Fx>,
}

impl DragHand {
    /// Presses the pointer at a position, in units of `Transform`. Holds the first dynamic body there until
    /// [`DragHand::release`]. If there is none, holds the first dynamic body that the pointer reaches later.
    pub fn hold(&mut self, at: FloatVec2) {
        self.at = Some(at);
    }

    /// Presses the pointer at a position, and holds `body` at this point until [`DragHand::release`].
    pub fn hold_body(&mut self, body: BodyId, at: FloatVec2) {
        *self = DragHand { at: Some(at), target: Some(body), held: None };
    }

    /// Moves the pointer, if it is pressed.
    pub fn move_to(&mut self, at: FloatVec2) {
        self.at = self.at.and(Some(at));
    }

    /// Releases the pointer.
    pub fn release(&mut self) {
        *self = DragHand::default();
    }

    /// The body that is held.
    #[must_use]
    pub fn body(&self) -> Option<BodyId> {
        self.held.map(|held| held.body)
    }
}

impl Plugin for DragPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<DragHand>().register_type::<DragHand>().add_systems(
            RunFixedMainLoop,
            (
                let_go
                    .in_set(RunFixedMainLoopSystems::FixedMainLoop)
                    .before(LockstepSystems::Inputs)
                    .run_if(resource_exists::<Lockstep<Sandbox>>),
                pull.in_set(LockstepSystems::Inputs).run_if(resource_exists::<Lockstep<Sandbox>>),
            ),
        );
    }
}

/// Converts units of `Transform` to metres, saturating at the range of [`Fx`]. A coordinate that is not finite becomes
/// 0.
pub fn to_metres(at: FloatVec2, settings: &LockstepSettings) -> Vec2<Fx> {
    let metres = |value: f32| Fx::saturating_from_num(if value.is_finite() { value } else { 0.0 });
    let at = at / settings.pixels_per_metre;
    Vec2::new(metres(at.x), metres(at.y))
}

/// Releases the pointer when another game begins: there, another body may have the id of the body that was held.
fn let_go(lockstep: Res<Lockstep<Sandbox>>, mut hand: ResMut<DragHand>, mut game: Local<Option<u64>>) {
    let former = game.replace(lockstep.number());
    if former.is_some_and(|former| former != lockstep.number()) && hand.target.is_some() {
        hand.release();
    }
}

/// Adds the command that pulls the held body to the next input of player 0. `pulled` is the command that the last call
/// added.
pub(crate) fn pull(
    mut hand: ResMut<DragHand>,
    lockstep: Res<Lockstep<Sandbox>>,
    settings: Res<LockstepSettings>,
    mut inputs: ResMut<Inputs<Sandbox>>,
    mut pulled: Local<Option<Command>>,
) {
    // If no tick has used the last command, for example during a pause, it is still in the input. It is removed here,
    // so that the input has at most one pull.
    if let (Some(last), Some(once)) = (pulled.take(), inputs.pending(0)) {
        once.retain(|command| *command != last);
    }
    let (Some(at), Some(world)) = (hand.at, lockstep.world()) else { return };
    let at = to_metres(at, &settings);
    if hand.held.is_none_or(|held| world.body(held.body).is_none()) {
        hand.held = match hand.target {
            Some(body) => grip(world, body, at),
            None => grab(world, at),
        };
        // If the body is despawned, the pointer holds no other body until it is released.
        hand.target = hand.target.or(hand.held.map(|held| held.body));
    }
    let Some(command) = hand.held.and_then(|held| pull_command(world, held, at)) else { return };
    // In a frame with two ticks, only the first tick applies the force.
    inputs.once(0).push(command.clone());
    *pulled = Some(command);
}

/// The first dynamic body at a point.
fn grab(world: &World, at: Vec2<Fx>) -> Option<Held> {
    let shapes = world.overlap_point(at, Default::default());
    let mut bodies = shapes.into_iter().filter_map(|shape| world.shape(shape)).map(|shape| shape.body());
    bodies.find_map(|body| grip(world, body, at))
}

fn grip(world: &World, id: BodyId, at: Vec2<Fx>) -> Option<Held> {
    let body = world.body(id).filter(|body| body.is_dynamic())?;
    Some(Held { body: id, grip: body.transform().apply_inverse(at) })
}

/// Stiffness per mass in 1/s2: a spring of 2 Hz.
const STIFFNESS: Fx = fx!(158);
/// Damping per mass in 1/s: the spring is critically damped.
const DAMPING: Fx = fx!(25);
/// Largest acceleration along each axis, in m/s2.
const ACCELERATION_MAX: Fx = fx!(500);

/// Command that pulls the grabbed point to the pointer, with the force of a damped spring. `None` if the body no longer
/// exists or is not dynamic. The spring is stretched by at most 10 m along each axis.
fn pull_command(world: &World, held: Held, at: Vec2<Fx>) -> Option<Command> {
    let body = world.body(held.body).filter(|body| body.is_dynamic())?;
    let grip = body.transform().apply(held.grip);
    let (way, velocity) = (at - grip, body.velocity_at(grip));
    let pull = |way: Fx, velocity: Fx| {
        let acceleration = fx_mul(way.clamp(fx!(-10), fx!(10)), STIFFNESS) - fx_mul(velocity, DAMPING);
        fx_mul(acceleration.clamp(-ACCELERATION_MAX, ACCELERATION_MAX), body.mass())
    };
    let force = Vec2::new(pull(way.x, velocity.x), pull(way.y, velocity.y));
    Some(Command::ApplyForce { body: held.body, force, point: grip })
}
