//! Machines that turn and churn what is in them.

use alloc::vec::Vec;

use super::Scene;
use super::builder::{build, rectangle};
use super::drum::plate;
use super::yards::grid;
use crate::body::{BodyDef, EventSwitches, ShapeDef, WorldError};
use crate::fx;
use crate::math::{Fx, Vec2};
use crate::world::Config;

/// 25 degrees per second, in rad/s.
const TURNING: Fx = fx!(0.436332312999);

pub(super) const WASHER: Scene =
    Scene::new("washer", 500, "a drum with paddles washes 8100 boxes that report their hits", |_| {
        build(Config::default(), |scene| {
            let drum = BodyDef::kinematic().position(fx!(0), fx!(10));
            let drum = drum.velocity(fx!(0.001), fx!(-0.002)).angular_velocity(TURNING);
            scene.spawn(drum, &washer_shapes()?)?;
            let events = EventSwitches { hit: true, ..EventSwitches::default() };
            let square = rectangle(fx!(0.1), fx!(0.1))?.events(events);
            let (origin, apart) = (Vec2::new(fx!(-9.9), fx!(0.1)), Vec2::new(fx!(0.21), fx!(0.21)));
            scene.spawn_each(BodyDef::dynamic(), &[square], grid(90, 90, origin, apart))?;
            Ok(())
        })
    });

/// A ring of 36 plates between 16 and 18 m that overlap by a degree at both ends, and 4 paddles inside.
fn washer_shapes() -> Result<Vec<ShapeDef>, WorldError> {
    let mut shapes = Vec::new();
    for i in 0..36 {
        let (from, to) = (Fx::from_num(10 * i), Fx::from_num(10 * i + 10));
        shapes.push(plate((from - fx!(1), to + fx!(1)), (fx!(16), fx!(18)))?);
        if i % 9 == 0 {
            shapes.push(plate((from, to), (fx!(14), fx!(16)))?);
        }
    }
    Ok(shapes)
}
