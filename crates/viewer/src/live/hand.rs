//! [`Hand`]: turns user actions into commands.
//!
//! A dragged body is connected by a spring joint to an anchor, like Box2D's mouse joint. The anchor is a kinematic body
//! without shapes that follows the pointer. A command returns no handle. So the anchor is found by its user data one
//! tick later, and the joint is added then.
//!
//! A seek to an earlier tick forgets the held body. Anchors may then be left in the world. The next live tick (a tick
//! that is not replayed from the recording) removes them.

use lockstep2d::body::{Body, BodyDef, BodyId, BodyKind};
use lockstep2d::fx;
use lockstep2d::math::{Angle, Fx, Rng, Vec2, fx_mul};
use lockstep2d::solver::{JointDef, Motor};
use lockstep2d::world::{Command, World};

use super::act::{Act, Aim, Held};
use super::pick::pick;
use super::spawn::spawn;

/// Upper half of the user data of anchors and their joints. The lower half is the number of the grab.
const MARK: u64 = 0x6861_6e64 << 32;
/// Frequency of the drag spring, in Hz.
const HERTZ: Fx = fx!(5);
/// Damping ratio of the drag spring.
const DAMPING_RATIO: Fx = fx!(1);
/// Largest force of the drag spring per kilogram of the body, in m/s².
const STRENGTH: i64 = 1000;
/// Friction torque against the rotation of a dragged body, per kilogram of mass and metre of radius of gyration, in
/// m/s². This is the torque of a quarter of the body's weight at the radius of gyration.
const GRIP: Fx = fx!(2.5);

#[derive(Debug)]
pub(super) struct Hand {
    hold: Hold,
    /// Number of grabs so far.
    grabs: u32,
    /// Whether the world may contain anchors that are no longer held.
    litter: bool,
    rng: Rng,
}

#[derive(Clone, Copy, Debug)]
enum Hold {
    Nothing,
    /// The spawn command of the anchor has been issued.
    Reaching(Grab),
    /// The anchor exists, and the command of its joint has been issued.
    Holding(Grab, BodyId),
}

#[derive(Clone, Copy, Debug)]
struct Grab {
    body: BodyId,
    /// Grabbed point, in the body's frame, in metres.
    point: Vec2<Fx>,
    /// Target point of the pointer, in world coordinates, in metres.
    towards: Vec2<Fx>,
    /// User data of the anchor and its joint.
    mark: u64,
}

impl Hand {
    pub(super) fn new(seed: u64) -> Self {
        Hand { hold: Hold::Nothing, grabs: 0, litter: false, rng: Rng::new(seed) }
    }

    pub(super) fn held(&self) -> Option<Held> {
        match self.hold {
            Hold::Holding(grab, _) => {
                Some(Held { body: grab.body, point: grab.point, towards: grab.towards })
            }
            _ => None,
        }
    }

    /// Forgets the held body without issuing a command. Called after a seek backwards and after commands were dropped.
    pub(super) fn forget(&mut self) {
        self.hold = Hold::Nothing;
        self.litter = true;
    }

    pub(super) fn act(&mut self, act: Act, world: &World, commands: &mut Vec<Command>) {
        match act {
            Act::Grab(aim) => {
                self.release(commands);
                self.grab(aim, world, commands);
            }
            Act::DragTo(towards) => {
                if let Hold::Reaching(grab) | Hold::Holding(grab, _) = &mut self.hold {
                    grab.towards = towards;
                }
            }
            Act::Release => self.release(commands),
            Act::Spawn { form, at, to } => commands.extend(spawn(form, at, to, &mut self.rng)),
            Act::Delete(aim) => {
                let picked = pick(world, aim, |_| true);
                commands.extend(picked.map(|picked| Command::Despawn { body: picked.body }));
            }
            Act::Gravity(gravity) => commands.push(Command::SetGravity { gravity }),
            Act::Explode(explosion) => commands.push(Command::Explode { explosion }),
        }
    }

    /// Continues earlier grabs. Must be called in every live tick, before its acts.
    pub(super) fn follow(&mut self, world: &World, commands: &mut Vec<Command>) {
        match self.hold {
            Hold::Nothing => {}
            Hold::Reaching(grab) => match find_anchor(world, grab.mark) {
                Some(anchor) => self.join(grab, anchor, world, commands),
                // The world had no room for the anchor, so the grab ends.
                None => self.hold = Hold::Nothing,
            },
            // The joint may be gone, for example because its body was removed.
            Hold::Holding(grab, anchor) => {
                if !world.joints().any(|(_, joint)| joint.def().user_data == grab.mark) {
                    self.drop_anchor(anchor, commands);
                }
            }
        }
        if std::mem::take(&mut self.litter) {
            let held = match self.hold {
                Hold::Holding(_, anchor) => Some(anchor),
                _ => None,
            };
            let left = world.bodies().filter(|(id, body)| is_anchor(body) && Some(*id) != held);
            commands.extend(left.map(|(body, _)| Command::Despawn { body }));
        }
    }

    /// Moves the anchor towards the pointer. Must be called in every live tick, after its acts.
    pub(super) fn pull(&self, world: &World, commands: &mut Vec<Command>) {
        let Hold::Holding(grab, id) = self.hold else { return };
        let Some(anchor) = world.body(id) else { return };
        let config = world.config();
        let way = grab.towards - anchor.position();
        // Limits the movement to half of what a kinematic body can move in a tick. This leaves room for rounding.
        let reach = config.solver.speed_max / (2 * i64::from(config.tick_rate));
        let way = match way.normalized_with_length() {
            Some((direction, length)) if length > reach => direction.widen().scale(reach),
            Some(_) => way,
            None => return,
        };
        commands.push(Command::MoveTo { body: id, position: anchor.position() + way, angle: Angle::ZERO });
    }

    fn grab(&mut self, aim: Aim, world: &World, commands: &mut Vec<Command>) {
        let wanted = |body: &Body| body.is_dynamic() && body.is_enabled();
        let Some(picked) = pick(world, aim, wanted) else { return };
        let Some(body) = world.body(picked.body) else { return };
        self.grabs = self.grabs.wrapping_add(1);
        let mark = MARK | u64::from(self.grabs);
        let point = body.transform().apply_inverse(picked.point);
        self.hold = Hold::Reaching(Grab { body: picked.body, point, towards: aim.at, mark });
        let anchor = BodyDef::kinematic().position(picked.point).user_data(mark);
        commands.push(Command::Spawn { body: anchor, shapes: vec![] });
    }

    fn join(&mut self, grab: Grab, anchor: BodyId, world: &World, commands: &mut Vec<Command>) {
        let Some(body) = world.body(grab.body).filter(|body| body.is_dynamic()) else {
            return self.drop_anchor(anchor, commands);
        };
        let strength = body.mass().saturating_mul_int(STRENGTH);
        let friction = fx_mul(fx_mul(body.mass(), body.radius_of_gyration()), GRIP);
        let spring = Motor::new().linear_spring(HERTZ, DAMPING_RATIO, strength).angular(Fx::ZERO, friction);
        let joint = JointDef::new(anchor, grab.body, spring).anchor_b(grab.point).user_data(grab.mark);
        commands.push(Command::AddJoint { joint });
        self.hold = Hold::Holding(grab, anchor);
    }

    fn release(&mut self, commands: &mut Vec<Command>) {
        match std::mem::replace(&mut self.hold, Hold::Nothing) {
            Hold::Nothing => {}
            // The handle of the anchor is not known yet, so `follow` removes the anchor in the next live tick.
            Hold::Reaching(_) => self.litter = true,
            // Removing the anchor removes its joint and wakes the body.
            Hold::Holding(_, anchor) => commands.push(Command::Despawn { body: anchor }),
        }
    }

    fn drop_anchor(&mut self, anchor: BodyId, commands: &mut Vec<Command>) {
        self.hold = Hold::Nothing;
        commands.push(Command::Despawn { body: anchor });
    }
}

fn find_anchor(world: &World, mark: u64) -> Option<BodyId> {
    world.bodies().find(|(_, body)| body.user_data() == mark && is_anchor(body)).map(|(id, _)| id)
}

/// Whether a body is an anchor, made by this hand or by an earlier one.
fn is_anchor(body: &Body) -> bool {
    body.kind() == BodyKind::Kinematic && body.shapes().is_empty() && body.user_data() >> 32 == MARK >> 32
}
