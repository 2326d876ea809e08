//! Optional parts of joints.

use lockstep2d::math::Fx;
use lockstep2d::solver::{
    Distance, Drive, Gear, JointKind, JointLimit, LinearDrive, Motor, Prismatic, Pull, Pulley, Rack,
    Revolute, Soft, Spring, Weld, Wheel,
};

use super::joint::*;
use super::{check_flags, flag, has};
use crate::numbers::{RawFx, RawVec2};
use crate::status::{Outcome, value};

/// Flags that all kinds of joints allow.
const COMMON: u32 = JOINT_COLLIDE
    | JOINT_ENABLED
    | JOINT_SOFTNESS
    | JOINT_THRESHOLD_FORCE
    | JOINT_THRESHOLD_TORQUE
    | JOINT_BREAKS;
/// Further flags that revolute, prismatic, distance and wheel joints allow.
const DRIVEN: u32 = JOINT_LIMIT | JOINT_MOTOR | JOINT_SPRING;

/// Options of revolute, prismatic, wheel and distance joints.
struct Options {
    limit: Option<JointLimit>,
    motor: Option<Drive>,
    spring: Option<Spring>,
}

impl RawJointDef {
    pub(super) fn put_kind(&mut self, kind: JointKind) {
        self.kind = match kind {
            JointKind::Revolute(Revolute { limit, motor, spring }) => {
                self.put_options(limit, motor, spring);
                REVOLUTE
            }
            JointKind::Prismatic(Prismatic { limit, motor, spring }) => {
                self.put_options(limit, motor, spring);
                PRISMATIC
            }
            JointKind::Wheel(Wheel { limit, motor, spring }) => {
                self.put_options(limit, motor, spring);
                WHEEL
            }
            JointKind::Distance(Distance { rod, limit, motor, spring, spring_force }) => {
                self.put_options(limit, motor, spring);
                self.flags |=
                    flag(rod.is_some(), JOINT_ROD) | flag(spring_force.is_some(), JOINT_SPRING_FORCE);
                self.length = RawFx::of(rod.unwrap_or_default());
                if let Some(JointLimit { lower, upper }) = spring_force {
                    (self.spring_force_lower, self.spring_force_upper) = (RawFx::of(lower), RawFx::of(upper));
                }
                DISTANCE
            }
            JointKind::Weld(Weld { linear, angular }) => {
                let pull = |soft: Soft| Pull { soft, max: Fx::ZERO };
                self.put_springs(linear.map(pull), angular.map(pull));
                WELD
            }
            JointKind::Motor(Motor { linear, angular, linear_spring, angular_spring }) => {
                self.put_options(None, angular, None);
                self.put_springs(linear_spring, angular_spring);
                if let Some(LinearDrive { velocity, max_force }) = linear {
                    self.flags |= JOINT_LINEAR_MOTOR;
                    (self.linear_velocity, self.linear_motor_max) =
                        (RawVec2::of(velocity), RawFx::of(max_force));
                }
                MOTOR
            }
            JointKind::Filter => FILTER,
            JointKind::Gear(Gear { teeth_a, teeth_b }) => {
                (self.teeth_a, self.teeth_b) = (teeth_a, teeth_b);
                GEAR
            }
            JointKind::Rack(Rack { radius }) => {
                self.radius = RawFx::of(radius);
                RACK
            }
            JointKind::Pulley(Pulley { wheel_a, wheel_b, length, ratio }) => {
                (self.wheel_a, self.wheel_b) = (RawVec2::of(wheel_a), RawVec2::of(wheel_b));
                (self.length, self.ratio) = (RawFx::of(length), RawFx::of(ratio));
                PULLEY
            }
        };
    }

    fn put_options(&mut self, limit: Option<JointLimit>, motor: Option<Drive>, spring: Option<Spring>) {
        if let Some(JointLimit { lower, upper }) = limit {
            self.flags |= JOINT_LIMIT;
            (self.limit_lower, self.limit_upper) = (RawFx::of(lower), RawFx::of(upper));
        }
        if let Some(Drive { speed, max }) = motor {
            self.flags |= JOINT_MOTOR;
            (self.motor_speed, self.motor_max) = (RawFx::of(speed), RawFx::of(max));
        }
        if let Some(Spring { hertz, damping_ratio, target }) = spring {
            self.flags |= JOINT_SPRING;
            (self.spring_hertz, self.spring_damping_ratio) = (RawFx::of(hertz), RawFx::of(damping_ratio));
            self.spring_target = RawFx::of(target);
        }
    }

    fn put_springs(&mut self, linear: Option<Pull>, angular: Option<Pull>) {
        if let Some(Pull { soft, max }) = linear {
            self.flags |= JOINT_LINEAR_SPRING;
            (self.linear_hertz, self.linear_damping_ratio) =
                (RawFx::of(soft.hertz), RawFx::of(soft.damping_ratio));
            self.linear_max = RawFx::of(max);
        }
        if let Some(Pull { soft, max }) = angular {
            self.flags |= JOINT_ANGULAR_SPRING;
            (self.angular_hertz, self.angular_damping_ratio) =
                (RawFx::of(soft.hertz), RawFx::of(soft.damping_ratio));
            self.angular_max = RawFx::of(max);
        }
    }

    pub(super) fn if_has<T>(&self, part: u32, of: impl FnOnce() -> T) -> Option<T> {
        has(self.flags, part).then(of)
    }

    fn options(&self) -> Options {
        Options {
            limit: self.if_has(JOINT_LIMIT, || JointLimit {
                lower: self.limit_lower.fx(),
                upper: self.limit_upper.fx(),
            }),
            motor: self
                .if_has(JOINT_MOTOR, || Drive { speed: self.motor_speed.fx(), max: self.motor_max.fx() }),
            spring: self.if_has(JOINT_SPRING, || Spring {
                hertz: self.spring_hertz.fx(),
                damping_ratio: self.spring_damping_ratio.fx(),
                target: self.spring_target.fx(),
            }),
        }
    }

    fn springs(&self) -> [Option<Pull>; 2] {
        let pull = |hertz: RawFx, ratio: RawFx, max: RawFx| Pull {
            soft: Soft { hertz: hertz.fx(), damping_ratio: ratio.fx() },
            max: max.fx(),
        };
        let linear = || pull(self.linear_hertz, self.linear_damping_ratio, self.linear_max);
        let angular = || pull(self.angular_hertz, self.angular_damping_ratio, self.angular_max);
        [self.if_has(JOINT_LINEAR_SPRING, linear), self.if_has(JOINT_ANGULAR_SPRING, angular)]
    }

    /// Flags that the kind of this joint allows.
    fn allowed(&self) -> Outcome<u32> {
        Ok(COMMON
            | match self.kind {
                REVOLUTE | PRISMATIC | WHEEL => DRIVEN,
                DISTANCE => DRIVEN | JOINT_SPRING_FORCE | JOINT_ROD,
                WELD => JOINT_LINEAR_SPRING | JOINT_ANGULAR_SPRING,
                MOTOR => JOINT_MOTOR | JOINT_LINEAR_MOTOR | JOINT_LINEAR_SPRING | JOINT_ANGULAR_SPRING,
                FILTER | GEAR | RACK | PULLEY => 0,
                other => return Err(value("the kind of a joint", other)),
            })
    }

    pub(super) fn joint_kind(&self) -> Outcome<JointKind> {
        check_flags("the flags of a joint of this kind", self.flags, self.allowed()?)?;
        let Options { limit, motor, spring } = self.options();
        let [linear_spring, angular_spring] = self.springs();
        Ok(match self.kind {
            REVOLUTE => JointKind::Revolute(Revolute { limit, motor, spring }),
            PRISMATIC => JointKind::Prismatic(Prismatic { limit, motor, spring }),
            WHEEL => JointKind::Wheel(Wheel { limit, motor, spring }),
            DISTANCE => JointKind::Distance(Distance {
                rod: self.if_has(JOINT_ROD, || self.length.fx()),
                limit,
                motor,
                spring,
                spring_force: self.if_has(JOINT_SPRING_FORCE, || JointLimit {
                    lower: self.spring_force_lower.fx(),
                    upper: self.spring_force_upper.fx(),
                }),
            }),
            WELD => {
                let [linear, angular] =
                    [linear_spring, angular_spring].map(|pull| pull.map(|pull| pull.soft));
                JointKind::Weld(Weld { linear, angular })
            }
            MOTOR => JointKind::Motor(Motor {
                linear: self.if_has(JOINT_LINEAR_MOTOR, || LinearDrive {
                    velocity: self.linear_velocity.vec(),
                    max_force: self.linear_motor_max.fx(),
                }),
                angular: motor,
                linear_spring,
                angular_spring,
            }),
            GEAR => JointKind::Gear(Gear { teeth_a: self.teeth_a, teeth_b: self.teeth_b }),
            RACK => JointKind::Rack(Rack { radius: self.radius.fx() }),
            PULLEY => JointKind::Pulley(Pulley {
                wheel_a: self.wheel_a.vec(),
                wheel_b: self.wheel_b.vec(),
                length: self.length.fx(),
                ratio: self.ratio.fx(),
            }),
            _ => JointKind::Filter,
        })
    }
}
