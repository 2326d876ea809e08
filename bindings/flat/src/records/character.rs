//! Characters.

use lockstep2d::body::{Geometry, ShapeDef};
use lockstep2d::math::{Fx, Vec2};
use lockstep2d::world::{Mover, MoverPlane, MoverState};

use super::shape::RawShapeDef;
use super::{check_flags, check_reserved, check_size, flag, has, size};
use crate::describe::{constants, records};
use crate::numbers::{RawAngle, RawBody, RawFx, RawShape, RawVec2};
use crate::status::{Outcome, value};

constants! {
    /// `ls2d_mover_state.flags`: the character stands on ground.
    MOVER_ON_GROUND = 1, "LS2D_MOVER_ON_GROUND";
    /// `ls2d_mover_state.flags`, in results: the character is wedged between two slopes that are too steep to stand on.
    MOVER_WEDGED = 2, "LS2D_MOVER_WEDGED";
    /// `ls2d_mover_state.flags`: the last move has brought the character from the air onto ground.
    MOVER_LANDED = 4, "LS2D_MOVER_LANDED";
}

records! {
    /// Geometry and abilities of a character. `ls2d_mover_init` sets the defaults.
    struct RawMover = "ls2d_mover" {
        /// Size of this struct in bytes.
        size: u32,
        /// Steepest slope that counts as ground, measured from the horizontal.
        slope_max: RawAngle,
        /// Height in metres of steps that the character climbs without a jump, 0 to 100.
        step_height: RawFx,
        /// Largest descent of the ground within a tick that the character follows, in metres, 0 to 100.
        snap_distance: RawFx,
        /// Geometry of the character; other fields of the definition have no effect.
        shape: RawShapeDef,
    }

    /// A surface that a character has met.
    struct RawMoverPlane = "ls2d_mover_plane" {
        /// The shape that the character has met.
        shape: RawShape,
        /// Body of that shape.
        body: RawBody,
        /// Position of the body's origin when the character met the surface, in the world, in metres.
        body_position: RawVec2,
        /// Velocity of the surface in m/s.
        velocity: RawVec2,
        /// Outward normal of the surface.
        normal: RawVec2,
        /// Nearest point on the surface, in the world, in metres.
        point: RawVec2,
        /// Distance of the character from the surface in metres, negative if they overlap.
        separation: RawFx,
        /// Rotation of the body when the character met the surface.
        body_angle: RawAngle,
        /// Reserved: 0.
        reserved: u32,
    }

    /// State of a character, which the game stores. `ls2d_mover_state_init` sets the first state.
    struct RawMoverState = "ls2d_mover_state" {
        /// Size of this struct in bytes.
        size: u32,
        /// `LS2D_MOVER_` flags.
        flags: u32,
        /// Position in the world, in metres, of the origin of the geometry's coordinates.
        position: RawVec2,
        /// Velocity in m/s: relative to the ground while the character stands on ground, otherwise in the world.
        velocity: RawVec2,
        /// With `LS2D_MOVER_ON_GROUND`, the ground on which the character stands; otherwise zeros.
        ground: RawMoverPlane,
        /// Shapes solid from one side that the character overlaps and passes through until it has left them.
        passing: [RawShape; MoverState::PASSING_MAX],
        /// Number of these shapes.
        passing_count: u32,
        /// Reserved: 0.
        reserved: u32,
    }
}

impl RawMover {
    pub(crate) fn of_kind(kind: u32) -> Self {
        let shape = ShapeDef::new(Geometry::Circle { radius: Fx::ZERO });
        RawMover {
            size: size::<Self>(),
            slope_max: RawAngle(1 << 29),
            step_height: RawFx(0),
            snap_distance: RawFx::of(lockstep2d::fx!(0.1)),
            shape: RawShapeDef { kind, ..RawShapeDef::of(&shape) },
        }
    }

    pub(crate) fn mover(&self) -> Outcome<Mover> {
        check_size::<Self>(self.size)?;
        check_reserved(self.shape.reserved)?;
        let mover = Mover::new(self.shape.geometry()?)?;
        let mover = mover.slope_max(self.slope_max.angle()).step_height(self.step_height.fx());
        Ok(mover.snap_distance(self.snap_distance.fx()))
    }
}

impl RawMoverPlane {
    pub(crate) const NONE: Self = RawMoverPlane {
        shape: RawShape(0),
        body: RawBody(0),
        body_position: RawVec2::ZERO,
        velocity: RawVec2::ZERO,
        normal: RawVec2::ZERO,
        point: RawVec2::ZERO,
        separation: RawFx(0),
        body_angle: RawAngle(0),
        reserved: 0,
    };

    pub(crate) fn of(plane: &MoverPlane) -> Self {
        RawMoverPlane {
            shape: RawShape::of(plane.shape),
            body: RawBody::of(plane.body),
            body_position: RawVec2::of(plane.body_position),
            velocity: RawVec2::of(plane.velocity),
            normal: RawVec2::of_units(plane.normal),
            point: RawVec2::of(plane.point),
            separation: RawFx::of(plane.separation),
            body_angle: RawAngle::of(plane.body_angle),
            reserved: 0,
        }
    }

    fn plane(&self) -> Outcome<MoverPlane> {
        check_reserved(self.reserved)?;
        Ok(MoverPlane {
            shape: self.shape.id()?,
            body: self.body.id()?,
            body_position: self.body_position.vec(),
            body_angle: self.body_angle.angle(),
            velocity: self.velocity.vec(),
            normal: self.normal.units(),
            separation: self.separation.fx(),
            point: self.point.vec(),
            push_limit: Fx::MAX,
            push: Fx::ZERO,
        })
    }
}

impl RawMoverState {
    pub(crate) fn at(position: Vec2<Fx>) -> Self {
        RawMoverState::of(&MoverState::at(position), false)
    }

    pub(crate) fn of(state: &MoverState, is_wedged: bool) -> Self {
        let (mut passing, mut passing_count) = ([RawShape(0); MoverState::PASSING_MAX], 0);
        for (place, &shape) in passing.iter_mut().zip(state.passing.iter().flatten()) {
            *place = RawShape::of(shape);
            passing_count += 1;
        }
        RawMoverState {
            size: size::<Self>(),
            flags: flag(state.is_on_ground(), MOVER_ON_GROUND)
                | flag(is_wedged, MOVER_WEDGED)
                | flag(state.has_landed, MOVER_LANDED),
            position: RawVec2::of(state.position),
            velocity: RawVec2::of(state.velocity),
            ground: state.ground.as_ref().map_or(RawMoverPlane::NONE, RawMoverPlane::of),
            passing,
            passing_count,
            reserved: 0,
        }
    }

    pub(crate) fn state(&self) -> Outcome<MoverState> {
        check_size::<Self>(self.size)?;
        check_reserved(self.reserved)?;
        check_flags("the flags of a character", self.flags, MOVER_ON_GROUND | MOVER_WEDGED | MOVER_LANDED)?;
        let count = usize::try_from(self.passing_count).unwrap_or(usize::MAX);
        let listed = self.passing.get(..count).ok_or_else(|| value("the number of passed shapes", count))?;
        let mut passing = [None; MoverState::PASSING_MAX];
        for (place, shape) in passing.iter_mut().zip(listed) {
            *place = Some(shape.id()?);
        }
        Ok(MoverState {
            position: self.position.vec(),
            velocity: self.velocity.vec(),
            ground: has(self.flags, MOVER_ON_GROUND).then(|| self.ground.plane()).transpose()?,
            has_landed: has(self.flags, MOVER_LANDED),
            passing,
        })
    }
}
