//! Scenes of a few bodies with known results.

use super::Scene;
use super::builder::{build, floor, rectangle, weightless};
use lockstep2d::body::{BodyDef, Geometry, ShapeDef};
use lockstep2d::fx;
use lockstep2d::math::{Angle, Vec2};
use lockstep2d::world::Config;

pub(super) const FREE_FALL: Scene =
    Scene::new("free_fall", 600, "a ball falls for 10 s: semi-implicit Euler to the last bit", |_| {
        build(Config::default(), |scene| {
            let ball = ShapeDef::new(Geometry::circle(fx!(0.5))?);
            scene.spawn(BodyDef::dynamic(), &[ball])?;
            Ok(())
        })
    });

pub(super) const BOUNCING_BALL: Scene = Scene::new(
    "bouncing_ball",
    900,
    "a ball of restitution 0.8 dropped from 10 m: no rebound is higher than the one before",
    |_| {
        build(Config::default(), |scene| {
            floor(scene, fx!(20))?;
            let ball = ShapeDef::new(Geometry::circle(fx!(0.5))?).restitution(fx!(0.8));
            scene.spawn(BodyDef::dynamic().position((fx!(0), fx!(10.5))), &[ball])?;
            Ok(())
        })
    },
);

pub(super) const HEAD_ON: Scene = Scene::new(
    "head_on",
    120,
    "two balls meet head-on, one three times as heavy: momentum and energy are conserved",
    |_| {
        build(weightless(), |scene| {
            let ball = ShapeDef::new(Geometry::circle(fx!(0.5))?).restitution(fx!(1));
            scene
                .spawn(BodyDef::dynamic().position((fx!(-3), fx!(0))).velocity((fx!(4), fx!(0))), &[ball])?;
            let heavy = ball.density(fx!(3));
            scene
                .spawn(BodyDef::dynamic().position((fx!(3), fx!(0))).velocity((fx!(-2), fx!(0))), &[heavy])?;
            Ok(())
        })
    },
);

pub(super) const OBLIQUE: Scene = Scene::new(
    "oblique",
    120,
    "a spinning box hits another off centre: linear and angular momentum are conserved",
    |_| {
        build(weightless(), |scene| {
            let square = rectangle(fx!(0.5), fx!(0.5))?.restitution(fx!(0.5));
            let thrown = BodyDef::dynamic().position((fx!(-3), fx!(0.4))).velocity((fx!(6), fx!(-0.5)));
            scene.spawn(thrown.angular_velocity(fx!(2)), &[square])?;
            let turned = BodyDef::dynamic().position((fx!(1), fx!(0))).angle(Angle::from_degrees(fx!(30)));
            scene.spawn(turned, &[square])?;
            Ok(())
        })
    },
);

pub(super) const SLOPE: Scene = Scene::new(
    "slope",
    300,
    "on a slope of 25 degrees a box of friction 0.6 stays and one of 0.3 slides",
    |_| {
        build(Config::default(), |scene| {
            let angle = Angle::from_degrees(fx!(25));
            let (sin, cos) = (lockstep2d::math::widen(angle.sin()), lockstep2d::math::widen(angle.cos()));
            let ramp = rectangle(fx!(100), fx!(0.5))?.friction(fx!(1));
            scene.spawn(BodyDef::fixed().angle(angle), &[ramp])?;
            for (along, friction) in [(fx!(60), fx!(0.36)), (fx!(80), fx!(0.09))] {
                // The friction of a contact is the geometric mean of the two coefficients: sqrt(1 x 0.36) = 0.6 and
                // sqrt(1 x 0.09) = 0.3.
                let square = rectangle(fx!(0.5), fx!(0.5))?.friction(friction);
                let up = Vec2::new(-sin, cos);
                let place = Vec2::new(cos, sin).scale(along) + up;
                scene.spawn(BodyDef::dynamic().position(place).angle(angle), &[square])?;
            }
            Ok(())
        })
    },
);

pub(super) const BALL_IN_BOX: Scene = Scene::new(
    "ball_in_box",
    240,
    "balls that start inside a block are pushed out of the nearest side",
    |_| {
        build(weightless(), |scene| {
            scene.spawn(BodyDef::fixed(), &[rectangle(fx!(3), fx!(1))?])?;
            let ball = ShapeDef::new(Geometry::circle(fx!(0.25))?);
            for (x, y) in
                [(fx!(-1), fx!(0.6)), (fx!(1), fx!(-0.7)), (fx!(2.8), fx!(0.1)), (fx!(0), fx!(0.01))]
            {
                scene.spawn(BodyDef::dynamic().position((x, y)), &[ball])?;
            }
            Ok(())
        })
    },
);
