//! Bodies and explosions.

use lockstep2d::body::{
    Body, BodyDef, BodyId, BodyKind, BodySettings, Continuous, MassSource, MotionLocks, Name,
};
use lockstep2d::math::{Fx, Vec2};
use lockstep2d::world::{BodyPose, Explosion, MoveEvent};

use super::{check_flags, check_reserved, check_size, flag, has, size};
use crate::describe::{constants, records};
use crate::numbers::{RawAngle, RawBody, RawFx, RawVec2};
use crate::status::{Failure, Outcome, Status, value};

constants! {
    /// Kind of a body: does not move.
    FIXED = 0, "LS2D_FIXED";
    /// Kind of a body: moves at its velocity, which forces and contacts do not change.
    KINEMATIC = 1, "LS2D_KINEMATIC";
    /// Kind of a body: moved by forces, contacts and joints.
    DYNAMIC = 2, "LS2D_DYNAMIC";
    /// Flag of a body: takes part in the simulation.
    BODY_ENABLED = 1, "LS2D_BODY_ENABLED";
    /// Flag of a body: asleep.
    BODY_ASLEEP = 2, "LS2D_BODY_ASLEEP";
    /// Flag of a body: does not move along the x axis of the world.
    BODY_LOCK_X = 4, "LS2D_BODY_LOCK_X";
    /// Flag of a body: does not move along the y axis of the world.
    BODY_LOCK_Y = 8, "LS2D_BODY_LOCK_Y";
    /// Flag of a body: does not turn.
    BODY_LOCK_ROTATION = 16, "LS2D_BODY_LOCK_ROTATION";
    /// Flag of a body: may fall asleep.
    BODY_MAY_SLEEP = 32, "LS2D_BODY_MAY_SLEEP";
    /// Flag of a body: the fields `mass`, `mass_centre` and `mass_gyration` give its mass. Without this flag, its mass
    /// is computed from its shapes.
    BODY_GIVEN_MASS = 64, "LS2D_BODY_GIVEN_MASS";
    /// `ls2d_body_def.continuous`: no continuous collision detection.
    SWEEP_OFF = 0, "LS2D_SWEEP_OFF";
    /// `ls2d_body_def.continuous`: the body is swept against fixed bodies.
    SWEEP_FIXED = 1, "LS2D_SWEEP_FIXED";
    /// `ls2d_body_def.continuous`: the body is swept against all bodies except bullets.
    SWEEP_BULLET = 2, "LS2D_SWEEP_BULLET";
    /// `ls2d_body_def.continuous`: the body is swept against fixed and kinematic bodies.
    SWEEP_KINEMATIC = 3, "LS2D_SWEEP_KINEMATIC";
}

const FLAGS: u32 = BODY_ENABLED
    | BODY_ASLEEP
    | BODY_LOCK_X
    | BODY_LOCK_Y
    | BODY_LOCK_ROTATION
    | BODY_MAY_SLEEP
    | BODY_GIVEN_MASS;

records! {
    /// Definition of a body, and its settings. `ls2d_body_def_init` sets the defaults.
    struct RawBodyDef = "ls2d_body_def" {
        /// Size of this struct in bytes.
        size: u32,
        /// `LS2D_FIXED`, `LS2D_KINEMATIC` or `LS2D_DYNAMIC`.
        kind: u32,
        /// `LS2D_BODY_` flags.
        flags: u32,
        /// `LS2D_SWEEP_OFF` and so on.
        continuous: u32,
        /// Origin in the world, in metres.
        position: RawVec2,
        /// Rotation.
        angle: RawAngle,
        /// Reserved: 0.
        reserved: u32,
        /// Velocity of the centre of mass in m/s.
        velocity: RawVec2,
        /// Angular velocity in rad/s, counter-clockwise.
        angular_velocity: RawFx,
        /// Mass in kg, 1e-5 to 2^30. Read only with `LS2D_BODY_GIVEN_MASS`.
        mass: RawFx,
        /// Centre of mass in the body's frame, in metres. Read only with `LS2D_BODY_GIVEN_MASS`.
        mass_centre: RawVec2,
        /// Radius of gyration about the centre of mass in metres, 0.002 to 512. Read only with `LS2D_BODY_GIVEN_MASS`.
        mass_gyration: RawFx,
        /// Decay rate of the velocity, per second.
        linear_damping: RawFx,
        /// Decay rate of the angular velocity, per second.
        angular_damping: RawFx,
        /// Factor on the world's gravity.
        gravity_scale: RawFx,
        /// Speed in m/s below which the body becomes ready to sleep.
        sleep_speed: RawFx,
        /// A number that the game may choose freely.
        user_data: u64,
        /// Name for reports: 1 to 16 ASCII letters, digits, `-` and `_`, padded with zeros. All zeros mean no name.
        name: [u8; 16],
    }

    /// Properties of a body.
    struct BodyInfo = "ls2d_body_info" {
        /// `LS2D_FIXED`, `LS2D_KINEMATIC` or `LS2D_DYNAMIC`.
        kind: u32,
        /// `LS2D_BODY_` flags, without `LS2D_BODY_GIVEN_MASS`.
        flags: u32,
        /// Origin in the world, in metres.
        position: RawVec2,
        /// Rotation.
        angle: RawAngle,
        /// Number of shapes.
        shapes: u32,
        /// Velocity of the centre of mass in m/s.
        velocity: RawVec2,
        /// Angular velocity in rad/s, counter-clockwise.
        angular_velocity: RawFx,
        /// Centre of mass in the world, in metres.
        centre: RawVec2,
        /// Mass in kg.
        mass: RawFx,
        /// Moment of inertia about the centre of mass in kg m².
        inertia: RawFx,
        /// The number that the game has stored with the body.
        user_data: u64,
        /// Decay rate of the velocity, per second.
        linear_damping: RawFx,
        /// Decay rate of the angular velocity, per second.
        angular_damping: RawFx,
        /// Factor on the world's gravity.
        gravity_scale: RawFx,
        /// Speed in m/s below which the body becomes ready to sleep.
        sleep_speed: RawFx,
        /// `LS2D_SWEEP_OFF` and so on.
        continuous: u32,
        /// Reserved: 0.
        reserved: u32,
    }

    /// Position and rotation of a body.
    struct RawPose = "ls2d_pose" {
        /// The body.
        body: RawBody,
        /// Origin in the world, in metres.
        position: RawVec2,
        /// Rotation.
        angle: RawAngle,
        /// Flags: `LS2D_BODY_ENABLED`, `LS2D_BODY_ASLEEP`.
        flags: u32,
    }

    /// An explosion: impulses away from a point.
    struct RawExplosion = "ls2d_explosion" {
        /// Size of this struct in bytes.
        size: u32,
        /// Reserved: 0.
        reserved: u32,
        /// Centre in the world, in metres.
        centre: RawVec2,
        /// Radius in metres within which the impulse is full.
        radius: RawFx,
        /// Width in metres of the ring outside of the radius in which the impulse falls to 0.
        falloff: RawFx,
        /// Impulse in N s per metre of the width of a shape, as seen from the centre.
        impulse: RawFx,
        /// Categories of shapes that the explosion acts on.
        mask: u64,
    }
}

pub(crate) fn body_kind(kind: u32) -> Outcome<BodyKind> {
    match kind {
        FIXED => Ok(BodyKind::Fixed),
        KINEMATIC => Ok(BodyKind::Kinematic),
        DYNAMIC => Ok(BodyKind::Dynamic),
        other => Err(value("the kind of a body", other)),
    }
}

const fn kind_number(kind: BodyKind) -> u32 {
    match kind {
        BodyKind::Fixed => FIXED,
        BodyKind::Kinematic => KINEMATIC,
        BodyKind::Dynamic => DYNAMIC,
    }
}

const fn sweep_number(continuous: Continuous) -> u32 {
    match continuous {
        Continuous::Off => SWEEP_OFF,
        Continuous::Fixed => SWEEP_FIXED,
        Continuous::Bullet => SWEEP_BULLET,
        Continuous::Kinematic => SWEEP_KINEMATIC,
    }
}

fn settings_flags(settings: &BodySettings) -> u32 {
    let MotionLocks { x, y, rotation } = settings.locks;
    flag(x, BODY_LOCK_X)
        | flag(y, BODY_LOCK_Y)
        | flag(rotation, BODY_LOCK_ROTATION)
        | flag(settings.may_sleep, BODY_MAY_SLEEP)
}

/// Reads a name that is padded with zeros. `None` for an empty name.
fn name_of(bytes: &[u8]) -> Outcome<Option<Name>> {
    let length = bytes.iter().rposition(|&byte| byte != 0).map_or(0, |last| last + 1);
    let text = std::str::from_utf8(bytes.get(..length).unwrap_or_default())
        .map_err(|_| Failure::new(Status::Name, "the name of a body is not ASCII"))?;
    if text.is_empty() { Ok(None) } else { Ok(Some(Name::new(text)?)) }
}

fn name_bytes(name: Option<Name>) -> [u8; 16] {
    let mut bytes = [0; 16];
    let name = name.as_ref().map(Name::as_str).unwrap_or_default();
    bytes.iter_mut().zip(name.bytes()).for_each(|(place, byte)| *place = byte);
    bytes
}

impl RawBodyDef {
    pub(crate) fn of(def: &BodyDef) -> Self {
        let BodyDef { kind, position, angle, velocity, angular_velocity, mass, settings, .. } = *def;
        let (given, (mass, centre, gyration)) = match mass {
            MassSource::Shapes => (false, Default::default()),
            MassSource::Given { mass, centre, gyration } => (true, (mass, centre, gyration)),
        };
        let flags = flag(def.enabled, BODY_ENABLED)
            | flag(def.asleep, BODY_ASLEEP)
            | flag(given, BODY_GIVEN_MASS)
            | settings_flags(&settings);
        RawBodyDef {
            size: size::<Self>(),
            kind: kind_number(kind),
            flags,
            continuous: sweep_number(settings.continuous),
            position: RawVec2::of(position),
            angle: RawAngle::of(angle),
            reserved: 0,
            velocity: RawVec2::of(velocity),
            angular_velocity: RawFx::of(angular_velocity),
            mass: RawFx::of(mass),
            mass_centre: RawVec2::of(centre),
            mass_gyration: RawFx::of(gyration),
            linear_damping: RawFx::of(settings.linear_damping),
            angular_damping: RawFx::of(settings.angular_damping),
            gravity_scale: RawFx::of(settings.gravity_scale),
            sleep_speed: RawFx::of(settings.sleep_speed),
            user_data: def.user_data,
            name: name_bytes(def.name),
        }
    }

    pub(crate) fn settings(&self) -> Outcome<BodySettings> {
        check_size::<Self>(self.size)?;
        check_flags("the flags of a body", self.flags, FLAGS)?;
        check_reserved(self.reserved)?;
        Ok(BodySettings {
            linear_damping: self.linear_damping.fx(),
            angular_damping: self.angular_damping.fx(),
            gravity_scale: self.gravity_scale.fx(),
            locks: MotionLocks {
                x: has(self.flags, BODY_LOCK_X),
                y: has(self.flags, BODY_LOCK_Y),
                rotation: has(self.flags, BODY_LOCK_ROTATION),
            },
            continuous: match self.continuous {
                SWEEP_OFF => Continuous::Off,
                SWEEP_FIXED => Continuous::Fixed,
                SWEEP_BULLET => Continuous::Bullet,
                SWEEP_KINEMATIC => Continuous::Kinematic,
                other => return Err(value("`continuous` of a body", other)),
            },
            may_sleep: has(self.flags, BODY_MAY_SLEEP),
            sleep_speed: self.sleep_speed.fx(),
        })
    }

    pub(crate) fn mass_source(&self) -> MassSource {
        if !has(self.flags, BODY_GIVEN_MASS) {
            return MassSource::Shapes;
        }
        MassSource::Given {
            mass: self.mass.fx(),
            centre: self.mass_centre.vec(),
            gyration: self.mass_gyration.fx(),
        }
    }

    pub(crate) fn def(&self) -> Outcome<BodyDef> {
        let settings = self.settings()?;
        Ok(BodyDef {
            kind: body_kind(self.kind)?,
            position: self.position.vec(),
            angle: self.angle.angle(),
            velocity: self.velocity.vec(),
            angular_velocity: self.angular_velocity.fx(),
            mass: self.mass_source(),
            settings,
            enabled: has(self.flags, BODY_ENABLED),
            asleep: has(self.flags, BODY_ASLEEP),
            user_data: self.user_data,
            name: name_of(&self.name)?,
        })
    }
}

fn state_flags(body: &Body) -> u32 {
    flag(body.is_enabled(), BODY_ENABLED) | flag(body.is_asleep(), BODY_ASLEEP)
}

impl BodyInfo {
    pub(crate) fn of(body: &Body) -> Self {
        let settings = body.settings();
        BodyInfo {
            kind: kind_number(body.kind()),
            flags: state_flags(body) | settings_flags(settings),
            position: RawVec2::of(body.position()),
            angle: RawAngle::of(body.angle()),
            shapes: u32::try_from(body.shapes().len()).unwrap_or(u32::MAX),
            velocity: RawVec2::of(body.velocity()),
            angular_velocity: RawFx::of(body.angular_velocity()),
            centre: RawVec2::of(body.centre_of_mass()),
            mass: RawFx::of(body.mass()),
            inertia: RawFx::of(body.inertia()),
            user_data: body.user_data(),
            linear_damping: RawFx::of(settings.linear_damping),
            angular_damping: RawFx::of(settings.angular_damping),
            gravity_scale: RawFx::of(settings.gravity_scale),
            sleep_speed: RawFx::of(settings.sleep_speed),
            continuous: sweep_number(settings.continuous),
            reserved: 0,
        }
    }
}

impl RawPose {
    pub(crate) fn of(id: BodyId, body: &Body) -> Self {
        RawPose {
            body: RawBody::of(id),
            position: RawVec2::of(body.position()),
            angle: RawAngle::of(body.angle()),
            flags: state_flags(body),
        }
    }

    pub(crate) const fn pose(&self) -> BodyPose {
        BodyPose { position: self.position.vec(), angle: self.angle.angle() }
    }

    pub(crate) fn of_move(event: &MoveEvent) -> Self {
        RawPose {
            body: RawBody::of(event.body),
            position: RawVec2::of(event.position),
            angle: RawAngle::of(event.angle),
            flags: BODY_ENABLED | flag(event.fell_asleep, BODY_ASLEEP),
        }
    }
}

impl RawExplosion {
    pub(crate) fn new(centre: Vec2<Fx>, impulse: Fx) -> Self {
        let Explosion { centre, radius, falloff, impulse_per_length, mask } = Explosion::new(centre, impulse);
        RawExplosion {
            size: size::<Self>(),
            reserved: 0,
            centre: RawVec2::of(centre),
            radius: RawFx::of(radius),
            falloff: RawFx::of(falloff),
            impulse: RawFx::of(impulse_per_length),
            mask,
        }
    }

    pub(crate) fn explosion(&self) -> Outcome<Explosion> {
        check_size::<Self>(self.size)?;
        check_reserved(self.reserved)?;
        Ok(Explosion {
            centre: self.centre.vec(),
            radius: self.radius.fx(),
            falloff: self.falloff.fx(),
            impulse_per_length: self.impulse.fx(),
            mask: self.mask,
        })
    }
}
