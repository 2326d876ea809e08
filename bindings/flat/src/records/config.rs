//! Settings of a world.

use lockstep2d::solver::{ContactTuning, SolverSettings};
use lockstep2d::world::Config;

use super::{check_flags, check_size, flag, has, size};
use crate::describe::{constants, records};
use crate::numbers::{RawFx, RawVec2};
use crate::status::{Outcome, value};

constants! {
    /// `ls2d_config.flags`: bodies at rest fall asleep.
    SLEEPING = 1, "LS2D_SLEEPING";
    /// `ls2d_config.flags`: fast bodies are swept so that they do not pass through shapes.
    CONTINUOUS = 2, "LS2D_CONTINUOUS";
    /// `ls2d_config.contact`: contacts are soft springs.
    CONTACT_SOFT = 0, "LS2D_CONTACT_SOFT";
    /// `ls2d_config.contact`: contacts correct a share of the overlap in each sub-step.
    CONTACT_BAUMGARTE = 1, "LS2D_CONTACT_BAUMGARTE";
}

records! {
    /// Settings of a world. `ls2d_config_init` sets the defaults.
    struct RawConfig = "ls2d_config" {
        /// Size of this struct in bytes.
        size: u32,
        /// Ticks per second, 10 to 1000.
        tick_rate: u32,
        /// Gravity in m/s², within ±100 000 on each axis.
        gravity: RawVec2,
        /// Number of sub-steps of a tick, 1 to 64. `tick_rate` times `sub_steps` is 60 to 4000.
        sub_steps: u32,
        /// Number of solver iterations of a sub-step, 1 to 16.
        iterations: u32,
        /// `LS2D_CONTACT_SOFT` or `LS2D_CONTACT_BAUMGARTE`.
        contact: u32,
        /// Flags: `LS2D_SLEEPING`, `LS2D_CONTINUOUS`.
        flags: u32,
        /// Stiffness of soft contacts in Hz, 1 to 1000. For Baumgarte contacts, share of the overlap corrected in each
        /// sub-step, 0 to 1.
        contact_stiffness: RawFx,
        /// Damping ratio of soft contacts, 0 to 100. For Baumgarte contacts, overlap in metres that is not corrected, 0
        /// to 1.
        contact_damping: RawFx,
        /// Largest speed in m/s with which contacts push shapes apart, 0 to 400.
        contact_push_speed: RawFx,
        /// Stiffness of joints in Hz, 1 to 1000.
        joint_hertz: RawFx,
        /// Damping ratio of joints, 0 to 100.
        joint_damping_ratio: RawFx,
        /// Approach speed in m/s below which shapes do not bounce, 0 to 400.
        restitution_threshold: RawFx,
        /// Largest speed of a body in m/s, 1 to 400. Below 27 ticks per second, also at most 15 m per tick.
        speed_max: RawFx,
        /// Distance in metres within which shapes get contact points before they touch, 0.001 to 1. The distance is
        /// larger for shapes that approach each other.
        speculative_distance: RawFx,
        /// Largest margin in metres of the bounding boxes in the broad phase, 0.001 to 10.
        fat_margin: RawFx,
        /// Lowest approach speed of a hit event in m/s, 0 to 400.
        hit_speed: RawFx,
        /// Largest number of bodies, at most 2^20.
        body_limit: u32,
        /// Largest number of shapes, at most 2^20.
        shape_limit: u32,
        /// Largest number of joints, at most 2^20.
        joint_limit: u32,
        /// Largest number of pairs of shapes with overlapping fat AABBs in a tick, at most 2^20. A tick with more pairs
        /// ignores those of the shapes in the largest slots, and counts as a fault.
        pair_limit: u32,
    }
}

impl RawConfig {
    pub(crate) fn of(config: &Config) -> Self {
        let Config {
            tick_rate,
            gravity,
            solver,
            speculative_distance,
            fat_margin,
            sleeping,
            continuous,
            hit_speed,
            body_limit,
            shape_limit,
            joint_limit,
            pair_limit,
        } = *config;
        let SolverSettings {
            sub_steps,
            iterations,
            contact,
            joint_hertz,
            joint_damping_ratio,
            restitution_threshold,
            speed_max,
        } = solver;
        let (contact, stiffness, damping, push_speed) = match contact {
            ContactTuning::Soft { hertz, damping_ratio, push_speed } => {
                (CONTACT_SOFT, hertz, damping_ratio, push_speed)
            }
            ContactTuning::Baumgarte { share, slop, push_speed } => {
                (CONTACT_BAUMGARTE, share, slop, push_speed)
            }
        };
        RawConfig {
            size: size::<Self>(),
            tick_rate,
            gravity: RawVec2::of(gravity),
            sub_steps,
            iterations,
            contact,
            flags: flag(sleeping, SLEEPING) | flag(continuous, CONTINUOUS),
            contact_stiffness: RawFx::of(stiffness),
            contact_damping: RawFx::of(damping),
            contact_push_speed: RawFx::of(push_speed),
            joint_hertz: RawFx::of(joint_hertz),
            joint_damping_ratio: RawFx::of(joint_damping_ratio),
            restitution_threshold: RawFx::of(restitution_threshold),
            speed_max: RawFx::of(speed_max),
            speculative_distance: RawFx::of(speculative_distance),
            fat_margin: RawFx::of(fat_margin),
            hit_speed: RawFx::of(hit_speed),
            body_limit,
            shape_limit,
            joint_limit,
            pair_limit,
        }
    }

    pub(crate) fn config(&self) -> Outcome<Config> {
        check_size::<Self>(self.size)?;
        check_flags("the flags of a world", self.flags, SLEEPING | CONTINUOUS)?;
        let [stiffness, damping] = [self.contact_stiffness, self.contact_damping].map(RawFx::fx);
        let push_speed = self.contact_push_speed.fx();
        let contact = match self.contact {
            CONTACT_SOFT => ContactTuning::Soft { hertz: stiffness, damping_ratio: damping, push_speed },
            CONTACT_BAUMGARTE => ContactTuning::Baumgarte { share: stiffness, slop: damping, push_speed },
            other => return Err(value("the kind of contacts", other)),
        };
        Ok(Config {
            tick_rate: self.tick_rate,
            gravity: self.gravity.vec(),
            solver: SolverSettings {
                sub_steps: self.sub_steps,
                iterations: self.iterations,
                contact,
                joint_hertz: self.joint_hertz.fx(),
                joint_damping_ratio: self.joint_damping_ratio.fx(),
                restitution_threshold: self.restitution_threshold.fx(),
                speed_max: self.speed_max.fx(),
            },
            speculative_distance: self.speculative_distance.fx(),
            fat_margin: self.fat_margin.fx(),
            sleeping: has(self.flags, SLEEPING),
            continuous: has(self.flags, CONTINUOUS),
            hit_speed: self.hit_speed.fx(),
            body_limit: self.body_limit,
            shape_limit: self.shape_limit,
            joint_limit: self.joint_limit,
            pair_limit: self.pair_limit,
        })
    }
}
