//! [`Hand`]: turns what a person does into commands.
//!
//! A dragged body hangs on a spring from an anchor: a kinematic body without shapes that is moved to where the pointer
//! is, as Box2D's mouse joint does. All of it is commands, so that it is in the log. A command does not say what handle
//! its body will get; the anchor is found by its user data a tick later, and only then joined.
//!
//! The hand may forget, for example when someone goes back in time. Anchors that are still there then are litter, and
//! swept up as soon as the world goes on.

use lockstep2d::body::{Body, BodyDef, BodyId, BodyKind};
use lockstep2d::fx;
use lockstep2d::math::{Angle, Fx, Rng, Vec2, fx_mul};
use lockstep2d::solver::{JointDef, Motor};
use lockstep2d::world::{Command, World};

use super::act::{Act, Aim, Held};
use super::pick::pick;
use super::spawn::spawn;

/// In the upper half of the user data of anchors and their joints; a number is in the lower.
const MARK: u64 = 0x6861_6e64 << 32;
/// The spring on which a body hangs: frequency in Hz, damping ratio, and largest force for each kilogram, in m/s².
const HERTZ: Fx = fx!(5);
const DAMPING_RATIO: Fx = fx!(1);
const STRENGTH: i64 = 1000;
/// The torque that keeps a dragged body from spinning about, for each kilogram and metre of its radius of gyration: as
/// much as a quarter of its weight on that radius.
const GRIP: Fx = fx!(2.5);

/// What the pointer does.
#[derive(Debug)]
pub(super) struct Hand {
    hold: Hold,
    /// How often something has been grabbed.
    grabs: u32,
    /// Whether there may be anchors that nobody holds.
    litter: bool,
    rng: Rng,
}

#[derive(Clone, Copy, Debug)]
enum Hold {
    Nothing,
    /// An anchor has been asked for.
    Reaching(Grip),
    /// The anchor is there, and its joint has been asked for.
    Holding(Grip, BodyId),
}

#[derive(Clone, Copy, Debug)]
struct Grip {
    body: BodyId,
    /// Where on the body, in its own frame.
    point: Vec2<Fx>,
    towards: Vec2<Fx>,
    mark: u64,
}

impl Hand {
    pub(super) fn new(seed: u64) -> Self {
        Hand { hold: Hold::Nothing, grabs: 0, litter: false, rng: Rng::new(seed) }
    }

    /// What it has got hold of.
    pub(super) fn held(&self) -> Option<Held> {
        match self.hold {
            Hold::Holding(grip, _) => {
                Some(Held { body: grip.body, point: grip.point, towards: grip.towards })
            }
            _ => None,
        }
    }

    /// Lets go of everything without a command: the world has become another one.
    pub(super) fn forget(&mut self) {
        self.hold = Hold::Nothing;
        self.litter = true;
    }

    /// What is to be done for an act in the next tick.
    pub(super) fn act(&mut self, act: Act, world: &World, commands: &mut Vec<Command>) {
        match act {
            Act::Grab(aim) => {
                self.release(commands);
                self.grab(aim, world, commands);
            }
            Act::DragTo(towards) => {
                if let Hold::Reaching(grip) | Hold::Holding(grip, _) = &mut self.hold {
                    grip.towards = towards;
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

    /// Goes on with what was begun in ticks before. To be asked in every tick, before its acts.
    pub(super) fn follow(&mut self, world: &World, commands: &mut Vec<Command>) {
        match self.hold {
            Hold::Nothing => {}
            Hold::Reaching(grip) => match find_anchor(world, grip.mark) {
                Some(anchor) => self.join(grip, anchor, world, commands),
                // The world had no room for it.
                None => self.hold = Hold::Nothing,
            },
            // The joint goes with the body, and whoever sees it can remove it.
            Hold::Holding(grip, anchor) => {
                if !world.joints().any(|(_, joint)| joint.def().user_data == grip.mark) {
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

    /// Moves the anchor after the pointer. To be asked in every tick, after its acts.
    pub(super) fn pull(&self, world: &World, commands: &mut Vec<Command>) {
        let Hold::Holding(grip, id) = self.hold else { return };
        let Some(anchor) = world.body(id) else { return };
        let config = world.config();
        let way = grip.towards - anchor.position();
        // No further than a kinematic body gets in a tick, with room for rounding.
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
        self.hold = Hold::Reaching(Grip { body: picked.body, point, towards: aim.at, mark });
        let anchor = BodyDef::kinematic().position(picked.point).user_data(mark);
        commands.push(Command::Spawn { body: anchor, shapes: vec![] });
    }

    fn join(&mut self, grip: Grip, anchor: BodyId, world: &World, commands: &mut Vec<Command>) {
        let Some(body) = world.body(grip.body).filter(|body| body.is_dynamic()) else {
            return self.drop_anchor(anchor, commands);
        };
        let strength = body.mass().saturating_mul_int(STRENGTH);
        let friction = fx_mul(fx_mul(body.mass(), body.radius_of_gyration()), GRIP);
        let spring = Motor::new().linear_spring(HERTZ, DAMPING_RATIO, strength).angular(Fx::ZERO, friction);
        let joint = JointDef::new(anchor, grip.body, spring).anchor_b(grip.point).user_data(grip.mark);
        commands.push(Command::AddJoint { joint });
        self.hold = Hold::Holding(grip, anchor);
    }

    fn release(&mut self, commands: &mut Vec<Command>) {
        match std::mem::replace(&mut self.hold, Hold::Nothing) {
            Hold::Nothing => {}
            // It has no handle yet.
            Hold::Reaching(_) => self.litter = true,
            // Its joint goes with it, and the body wakes.
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

/// Whether a body is an anchor of this or of an earlier hand.
fn is_anchor(body: &Body) -> bool {
    body.kind() == BodyKind::Kinematic && body.shapes().is_empty() && body.user_data() >> 32 == MARK >> 32
}
