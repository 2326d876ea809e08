//! Generates settings of bodies.

use lockstep2d::body::{BodyKind, BodySettings, Continuous, MassSource, MotionLocks, Name};
use lockstep2d::fx;
use lockstep2d::math::{Fx, Vec2};

use crate::source::Source;

/// Settings of a body, valid or not.
pub fn settings(source: &mut Source<'_>) -> BodySettings {
    let mut settings = BodySettings::default();
    if source.one_in(4) {
        settings.linear_damping = source.mostly(0, 10_000);
        settings.angular_damping = source.mostly(0, 10_000);
        settings.gravity_scale = source.mostly(-2000, 2000);
    }
    gentle(source, &mut settings);
    if source.one_in(4) {
        settings.sleep_speed = source.mostly(0, 3000);
    }
    settings
}

/// Typical settings of a game.
pub fn ordinary_settings(source: &mut Source<'_>) -> BodySettings {
    let mut settings = BodySettings::default();
    if source.one_in(4) {
        settings.linear_damping = source.thousandths(0, 1000);
        settings.gravity_scale = source.pick(&[fx!(1), fx!(0), fx!(0.5)]);
    }
    gentle(source, &mut settings);
    settings
}

fn gentle(source: &mut Source<'_>, settings: &mut BodySettings) {
    if source.one_in(4) {
        let (x, y, rotation) = (source.one_in(3), source.one_in(3), source.one_in(2));
        settings.locks = MotionLocks { x, y, rotation };
    }
    settings.continuous =
        source.pick(&[Continuous::Fixed, Continuous::Kinematic, Continuous::Bullet, Continuous::Off]);
    settings.may_sleep = !source.one_in(8);
}

/// A body kind, mostly dynamic.
pub fn kind(source: &mut Source<'_>) -> BodyKind {
    source.pick(&[
        BodyKind::Dynamic,
        BodyKind::Dynamic,
        BodyKind::Dynamic,
        BodyKind::Kinematic,
        BodyKind::Fixed,
    ])
}

/// A given mass, valid or not.
pub fn mass(source: &mut Source<'_>) -> MassSource {
    let masses = [fx!(1), fx!(0.00001), fx!(1073741824), fx!(1000), fx!(0.01)];
    let radii = [fx!(0.3), fx!(0.002), fx!(512), fx!(0.05)];
    MassSource::Given {
        mass: if source.one_in(8) { source.edge() } else { source.pick(&masses) },
        centre: if source.one_in(3) { source.mostly_vec(-2000, 2000) } else { Vec2::ZERO },
        gyration: if source.one_in(8) { source.edge() } else { source.pick(&radii) },
    }
}

/// A moderate mass, centred near the origin, or the mass of the body's shapes.
pub fn ordinary_mass(source: &mut Source<'_>) -> MassSource {
    if source.one_in(3) {
        return MassSource::Shapes;
    }
    let centre = Vec2::new(source.thousandths(-100, 100), source.thousandths(-100, 100));
    MassSource::Given {
        mass: source.thousandths(200, 3000),
        centre,
        gyration: source.thousandths(150, 600).max(Fx::DELTA),
    }
}

/// A name, or none.
pub fn name(source: &mut Source<'_>) -> Option<Name> {
    Name::new(source.pick(&["a", "ball", "player-1", "sixteen_letters_", ""])).ok()
}
