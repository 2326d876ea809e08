//! The effect of areas on a body within a tick.
//!
//! Drag is solved implicitly with the damping of the body. Against a medium of velocity `u`:
//!
//! ```text
//! v' = v + h a - h c (v' - u)   =>   v' = (v + h (a + c u)) / (1 + h c)
//! ```

use super::super::limits::units;
use super::super::settings::Tuning;
use super::MovingBody;
use crate::body::{Body, BodySettings};
use crate::math::{Fx, Vec2, fx_mul, narrow};

#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct AreaEffect {
    /// Acceleration in m/s², in addition to gravity. Includes `c u` of drag.
    pub(crate) acceleration: Vec2<Fx>,
    /// Angular acceleration in rad/s² by drag.
    pub(crate) angular_acceleration: Fx,
    /// Force in N.
    pub(crate) force: Vec2<Fx>,
    /// Torque about the centre of mass in N m.
    pub(crate) torque: Fx,
    /// Decay rate of the velocity per second.
    pub(crate) linear_drag: Fx,
    /// Decay rate of the angular velocity per second.
    pub(crate) angular_drag: Fx,
}

impl MovingBody {
    pub(in crate::solver) fn in_areas(index: u32, body: &Body, effect: &AreaEffect, tuning: &Tuning) -> Self {
        let AreaEffect { acceleration, angular_acceleration, force, torque, linear_drag, angular_drag } =
            *effect;
        let ([x, y], mut spin_step) = body.step_with(force, torque, tuning.rate);
        let per_step = |acceleration: Fx| acceleration / i64::from(tuning.rate);
        let with = |step: i64, acceleration: Fx| step.saturating_add(units(per_step(acceleration)));
        let step = [with(x, acceleration.x), with(y, acceleration.y)];
        if body.turns() {
            let turn = per_step(fx_mul(angular_acceleration, body.radius_of_gyration()));
            spin_step = spin_step.saturating_add(narrow(turn));
        }
        let mut settings: BodySettings = *body.settings();
        settings.linear_damping = settings.linear_damping.saturating_add(linear_drag);
        settings.angular_damping = settings.angular_damping.saturating_add(angular_drag);
        MovingBody::dynamic(index, step, spin_step, &settings, tuning)
    }
}
