use alloc::vec::Vec;

use super::{check_speeds, velocity_to};
use crate::body::{BodyKind, IslandId, SPEED_MAX, WorldError};
use crate::math::{Fx, Speed, Vec2, div_round, fx_mul, saturate, saturate_wide};
use crate::solver::{IMPULSE_MAX, SolverSettings};
use crate::world::World;
use crate::world::config::{Config, check_gravity};
use crate::world::islands::wake_island;

impl World {
    /// Replaces the settings of the world: change a copy of [`World::config`]. The limits of bodies, shapes, joints and
    /// pairs cannot be changed.
    ///
    /// Wakes all bodies if a setting that affects the balance of forces changes: gravity, the tick rate, sub-steps,
    /// iterations, the tuning of contacts and joints, or [`Config::sleeping`] when it is switched off. Stored impulses
    /// of contacts and joints are converted to the new length of a sub-step, so that bodies at rest stay at rest.
    ///
    /// The tick rate must stay the same in a networked match and in a recording.
    ///
    /// A lower [speed limit](SolverSettings::speed_max), which may follow from a lower tick rate, slows dynamic bodies
    /// down in the next tick. Kinematic bodies keep the velocities that [`World::set_velocity`] gave them. Therefore
    /// the settings are refused if a kinematic body is faster than the new limit, or if the target of a kinematic body
    /// is out of reach at the new tick rate: see [`World::move_to`].
    ///
    /// ```
    /// use lockstep2d::{fx, world::{Config, World}};
    /// let mut world = World::default();
    /// let mut config = *world.config();
    /// config.solver.restitution_threshold = fx!(0.2);
    /// config.solver.sub_steps = 8;
    /// world.set_config(&config)?;
    /// assert!(world.set_config(&Config { body_limit: 5, ..config }).is_err());
    /// # Ok::<(), lockstep2d::body::WorldError>(())
    /// ```
    ///
    /// # Errors
    /// [`WorldError::Setting`] or [`WorldError::CountSetting`] if a setting is out of range,
    /// [`WorldError::FixedSetting`] if a limit changes, [`WorldError::SpeedOutOfRange`] if a kinematic body is too fast
    /// for the new settings.
    #[doc(alias = "sub_steps")]
    #[doc(alias = "integration parameters")]
    pub fn set_config(&mut self, config: &Config) -> Result<(), WorldError> {
        config.validate()?;
        let old = self.state.config;
        if let Some(name) = old.first_changed_limit(config) {
            return Err(WorldError::FixedSetting { name });
        }
        self.check_kinematic_speeds(config)?;
        if is_disturbed(&old, config) {
            self.wake_all();
        }
        let rate = |config: &Config| config.tick_rate.saturating_mul(config.solver.sub_steps);
        self.convert_impulses(rate(&old), rate(config));
        self.convert_targets(old.tick_rate, config.tick_rate);
        self.state.config = *config;
        // The cached surface of a pair includes the world's restitution threshold.
        self.scratch.contacts.invalidate_surfaces();
        Ok(())
    }

    /// Replaces the world's gravity, in m/s². Wakes all bodies.
    ///
    /// # Errors
    /// [`WorldError::Setting`] if a component is not within ±100 000.
    pub fn set_gravity(&mut self, gravity: impl Into<Vec2<Fx>>) -> Result<(), WorldError> {
        let gravity = gravity.into();
        check_gravity(gravity)?;
        self.wake_all();
        self.state.config.gravity = gravity;
        Ok(())
    }

    /// Checks the velocities of kinematic bodies, which ticks do not limit, against new settings.
    fn check_kinematic_speeds(&self, config: &Config) -> Result<(), WorldError> {
        let max = config.solver.speed_limit(config.tick_rate);
        let is_lower = max < self.speed_limit();
        let has_other_rate = config.tick_rate != self.state.config.tick_rate;
        if !(is_lower || has_other_rate) {
            return Ok(());
        }
        // Stored velocities are rounded, so a velocity at the limit may be stored as one unit more.
        let max_stored = max + Fx::from(Speed::DELTA);
        for (_, body) in self.state.bodies.iter().filter(|(_, body)| body.kind() == BodyKind::Kinematic) {
            match body.target.as_deref() {
                Some(target) => {
                    let (velocity, angular) = velocity_to(body, target, config.tick_rate);
                    let turning = fx_mul(angular.saturating_abs(), body.radius_of_gyration());
                    check_speeds([velocity.length(), turning], max)?;
                }
                None if is_lower => {
                    let speeds = [body.velocity().length(), Fx::from(body.spin).saturating_abs()];
                    if speeds.into_iter().any(|speed| speed > max_stored) {
                        check_speeds(speeds, max)?;
                    }
                }
                None => {}
            }
        }
        Ok(())
    }

    /// Wakes all bodies, and restarts their counts of ticks at rest.
    fn wake_all(&mut self) {
        let islands: Vec<IslandId> = self.state.islands.iter().map(|(id, _)| id).collect();
        for island in islands {
            wake_island(&mut self.state, &mut self.scratch, island);
        }
        for (_, body) in self.state.bodies.iter_mut().filter(|(_, body)| body.is_dynamic()) {
            body.rest_ticks.reset();
        }
    }

    /// Converts the velocities of kinematic bodies with a target, so that they reach it in one tick of the new length.
    fn convert_targets(&mut self, old_rate: u32, new_rate: u32) {
        if old_rate == new_rate {
            return;
        }
        let convert = |speed: &mut Speed| *speed = scaled(*speed, new_rate, old_rate, SPEED_MAX);
        for (_, body) in self.state.bodies.iter_mut().filter(|(_, body)| body.target.is_some()) {
            [&mut body.velocity.x, &mut body.velocity.y, &mut body.spin].into_iter().for_each(convert);
        }
    }

    /// Converts impulses to another rate, in sub-steps per second, so that the forces stay the same.
    fn convert_impulses(&mut self, old_rate: u32, new_rate: u32) {
        if old_rate == new_rate {
            return;
        }
        let convert = |impulse: &mut Speed| *impulse = scaled(*impulse, old_rate, new_rate, IMPULSE_MAX);
        let state = &mut *self.state;
        // The work of a command in the sandbox includes active contacts and joints, but not sleeping contacts: they are
        // counted here.
        self.scratch.meter.spend(u64::try_from(state.sleeping_contacts.len()).unwrap_or(u64::MAX));
        for contact in state.contacts.iter_mut().chain(state.sleeping_contacts.iter_mut()) {
            for point in &mut contact.points {
                convert(&mut point.normal);
                convert(&mut point.tangent);
            }
            convert(&mut contact.rolling);
        }
        for (_, joint) in state.joints.iter_mut() {
            joint.impulses.0.iter_mut().for_each(convert);
        }
        state.joints.note_change();
    }
}

/// `value * factor / divisor`, clamped to ±`max`.
fn scaled(value: Speed, factor: u32, divisor: u32, max: Speed) -> Speed {
    let bits = div_round(i128::from(value.to_bits()) * i128::from(factor), divisor.into());
    Speed::from_bits(saturate(saturate_wide(bits))).clamp(-max, max)
}

/// Whether the new settings require that all bodies wake: they could set bodies at rest in motion, or they turn sleeping
/// off.
fn is_disturbed(old: &Config, new: &Config) -> bool {
    // Destructures without `..`, so that a new setting causes a compile error until it is considered here.
    let Config {
        tick_rate,
        gravity,
        solver,
        speculative_distance: _,
        fat_margin: _,
        sleeping,
        continuous: _,
        hit_speed: _,
        body_limit: _,
        shape_limit: _,
        joint_limit: _,
        pair_limit: _,
    } = *new;
    let SolverSettings {
        sub_steps: _,
        iterations: _,
        contact: _,
        joint_hertz: _,
        joint_damping_ratio: _,
        restitution_threshold: _,
        speed_max: _,
    } = solver;
    let of_balance = |solver: SolverSettings| {
        let SolverSettings { restitution_threshold, speed_max, .. } = SolverSettings::default();
        SolverSettings { restitution_threshold, speed_max, ..solver }
    };
    let same =
        (old.tick_rate, old.gravity, of_balance(old.solver)) == (tick_rate, gravity, of_balance(solver));
    !same || (old.sleeping && !sleeping)
}
