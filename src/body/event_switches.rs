//! Event switches.

use serde::{Deserialize, Serialize};

/// Switches for the events in which a shape takes part.
///
/// ```
/// # use lockstep2d::{body::{BodyDef, EventSwitches, Polygon, ShapeDef}, fx, world::World};
/// # let mut world = World::default();
/// let square = ShapeDef::new(Polygon::square(fx!(0.5))?);
/// let goal = world.spawn(&BodyDef::fixed(), &[square.sensor()])?;
/// // Debris does not count as a visitor of the goal.
/// let unseen = EventSwitches { sensor: false, ..EventSwitches::default() };
/// world.spawn(&BodyDef::dynamic(), &[square.events(unseen)])?;
/// world.spawn(&BodyDef::dynamic(), &[square])?;
/// world.step();
/// assert_eq!(world.events().sensor_begin.len(), 1);
/// # let _ = goal;
/// # Ok::<(), lockstep2d::body::WorldError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct EventSwitches {
    /// Begin and end of contacts. A pair reports them if either shape enables them.
    pub contact: bool,
    /// Hits: contacts of shapes that approach each other at [`crate::world::Config::hit_speed`] or faster. A pair
    /// reports them if either shape enables them.
    pub hit: bool,
    /// Detection of this shape by sensors.
    #[doc(alias = "trigger")]
    pub sensor: bool,
    /// Detection of other sensors by this sensor. The `sensor` switch of the other sensor must be on too.
    pub detect_sensors: bool,
}

impl Default for EventSwitches {
    /// Contact and sensor events on, others off.
    fn default() -> Self {
        EventSwitches { contact: true, hit: false, sensor: true, detect_sensors: false }
    }
}
