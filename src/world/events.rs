//! Events of a tick. They are not part of the state.

use alloc::vec::Vec;

use serde::{Deserialize, Serialize};

use crate::body::{BodyId, JointId, ShapeId};
use crate::math::{Angle, Fx, Unit, Vec2};

/// Two shapes that began or ceased to touch.
///
/// ```
/// # use std::collections::BTreeSet;
/// # use lockstep2d::{body::{BodyDef, Polygon, ShapeDef}, fx, world::World};
/// use lockstep2d::world::ContactEvent;
/// # let mut world = World::default();
/// # let square = ShapeDef::new(Polygon::square(fx!(0.5))?);
/// let lava = world.spawn(&BodyDef::fixed().position((fx!(0), fx!(-1))), &[square])?;
/// let victim = world.spawn(&BodyDef::dynamic(), &[square, square])?;
/// world.step();
/// // Removes every body that touches the lava. All events are read before the first removal. They are read into a
/// // set, because several shapes of one body may touch the lava.
/// let other = |event: &ContactEvent| {
///     let pair = event.shapes().map(|shape| world.body_of(shape));
///     let is_lava = |body: &_| *body == Some(lava);
///     if pair.iter().any(is_lava) { pair.into_iter().find(|body| !is_lava(body))? } else { None }
/// };
/// let burnt: BTreeSet<_> = world.events().contact_begin.iter().filter_map(other).collect();
/// burnt.into_iter().try_for_each(|body| world.despawn(body))?;
/// assert!(world.body(victim).is_none() && world.body(lava).is_some());
/// # Ok::<(), lockstep2d::body::WorldError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct ContactEvent {
    /// The shape in the smaller slot. Its handle is stale if the shape was removed.
    pub shape_a: ShapeId,
    /// The shape in the larger slot. Its handle is stale if the shape was removed.
    pub shape_b: ShapeId,
}

impl ContactEvent {
    /// Both shapes.
    #[must_use]
    pub const fn shapes(&self) -> [ShapeId; 2] {
        [self.shape_a, self.shape_b]
    }
}

/// Two shapes that hit each other: see [`super::Config::hit_speed`].
///
/// ```
/// # use lockstep2d::{fx, math::Fx, world::World};
/// use lockstep2d::world::HitEvent;
/// /// Volume of the sound of a hit in percent: silent at 1 m/s, full at 10 m/s.
/// fn volume(hit: &HitEvent) -> i32 {
///     let share = (hit.approach_speed - fx!(1)) / 9;
///     (share.clamp(Fx::ZERO, Fx::ONE) * 100).to_num()
/// }
/// # let mut world = World::default();
/// # use lockstep2d::body::{BodyDef, EventSwitches, Polygon, ShapeDef};
/// # let square = ShapeDef::new(Polygon::square(fx!(0.5))?);
/// # world.spawn(&BodyDef::fixed().position((fx!(0), fx!(-0.5))), &[square])?;
/// // A box that falls at 5.6 m/s, half a millimetre above the floor.
/// # let hitting = square.events(EventSwitches { hit: true, ..EventSwitches::default() });
/// # let falling = BodyDef::dynamic().position((fx!(0), fx!(0.5005))).velocity((fx!(0), fx!(-5.6)));
/// # world.spawn(&falling, &[hitting])?;
/// world.step();
/// assert_eq!(world.events().hits.iter().map(volume).collect::<Vec<_>>(), [51]);
/// # Ok::<(), lockstep2d::body::WorldError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct HitEvent {
    /// The shape in the smaller slot.
    pub shape_a: ShapeId,
    /// The shape in the larger slot.
    pub shape_b: ShapeId,
    /// The contact point with the fastest approach, in the world, in metres.
    pub point: Vec2<Fx>,
    /// Unit vector from A to B.
    pub normal: Vec2<Unit>,
    /// Approach speed along the normal at the start of the tick, in m/s.
    pub approach_speed: Fx,
    /// Impulse along the normal in N s: the sum over all points and the whole tick, including restitution, at most 1024
    /// m/s times the reduced mass. An impact that takes several ticks continues in the
    /// [forces](super::ContactView::forces) of the following ticks.
    pub impulse: Fx,
}

impl HitEvent {
    /// Both shapes.
    #[must_use]
    pub const fn shapes(&self) -> [ShapeId; 2] {
        [self.shape_a, self.shape_b]
    }
}

/// A sensor that began or ceased to overlap a shape.
///
/// Overlaps are measured at the end of the tick. A shape that crosses a sensor within a tick has both events in that
/// tick, with any [`Continuous`](crate::body::Continuous) setting, if the overlap exceeds 0.05 mm. The events assume
/// that bodies move along straight lines and rotate at constant speed within a tick. A shape that leaves a sensor and
/// returns within the tick has no events.
///
/// ```
/// # use lockstep2d::{body::{BodyDef, Polygon, ShapeDef}, fx, world::World};
/// use lockstep2d::world::SensorEvent;
/// # let mut world = World::default();
/// # let square = ShapeDef::new(Polygon::square(fx!(0.1))?);
/// let line = ShapeDef::new(Polygon::rectangle(fx!(0.1), fx!(5))?).sensor();
/// world.spawn(&BodyDef::fixed(), &[line])?;
/// let racer = |x, speed| BodyDef::dynamic().position((x, fx!(0))).velocity((speed, fx!(0)));
/// let first = world.spawn(&racer(fx!(-1), fx!(60)), &[square])?;
/// let second = world.spawn(&racer(fx!(-0.9), fx!(50)).position((fx!(-0.9), fx!(2))), &[square])?;
/// world.step();
/// // Both cross the finish line in this tick; the fraction tells who was first.
/// let order = world.events().sensor_begin.iter().map(|event: &SensorEvent| event.visitor);
/// let order: Vec<_> = order.filter_map(|shape| world.body_of(shape)).collect();
/// assert_eq!(order, [first, second]);
/// # Ok::<(), lockstep2d::body::WorldError>(())
/// ```
#[doc(alias = "trigger")]
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct SensorEvent {
    /// Fraction of the tick at which the overlap began or ended, 0 to 1. 0 if the cause is a change between ticks.
    pub fraction: Fx,
    /// The sensor. Its handle may be stale in an end event.
    pub sensor: ShapeId,
    /// The other shape. Its handle may be stale in an end event.
    pub visitor: ShapeId,
}

/// A body that moved or fell asleep.
///
/// ```
/// # use lockstep2d::{body::{BodyDef, Geometry, ShapeDef}, fx, world::World};
/// use lockstep2d::world::MoveEvent;
/// # let mut world = World::default();
/// # world.spawn(&BodyDef::fixed(), &[])?;
/// let ball = world.spawn(&BodyDef::dynamic(), &[ShapeDef::new(Geometry::circle(fx!(0.5))?)])?;
/// world.step();
/// // Only the sprites of bodies that have moved are updated.
/// let mut sprites = vec![None; world.body_count()];
/// for MoveEvent { body, position, angle, .. } in &world.events().moved {
///     sprites[body.index() as usize] = Some((*position, *angle));
/// }
/// assert!(sprites[0].is_none() && sprites[ball.index() as usize].is_some());
/// # Ok::<(), lockstep2d::body::WorldError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MoveEvent {
    /// The body.
    pub body: BodyId,
    /// Position of the body's origin after the tick, in metres.
    pub position: Vec2<Fx>,
    /// Rotation after the tick.
    pub angle: Angle,
    /// Whether the body fell asleep.
    pub fell_asleep: bool,
}

/// A joint whose force or torque exceeded its threshold.
///
/// ```
/// # use lockstep2d::{body::{BodyDef, Polygon, ShapeDef}, fx, world::World};
/// use lockstep2d::solver::{JointDef, Threshold, ThresholdAction, Weld};
/// use lockstep2d::world::JointEvent;
/// # let mut world = World::default();
/// # let square = ShapeDef::new(Polygon::square(fx!(0.5))?);
/// # let wall = world.spawn(&BodyDef::fixed(), &[])?;
/// # let beam = world.spawn(&BodyDef::dynamic(), &[square])?;
/// let weak = Threshold { force: Some(fx!(2)), action: ThresholdAction::Break, ..Threshold::NONE };
/// let joint = world.add_joint(&JointDef::new(wall, beam, Weld::rigid()).threshold(weak))?;
/// let mut broken = vec![];
/// for _ in 0..10 {
///     world.step();
///     for JointEvent { joint, broke, .. } in &world.events().joints {
///         broken.extend(broke.then_some(*joint));
///     }
/// }
/// // The handle is stale, and serves only as a key to the game's own data about the joint.
/// assert_eq!(broken, [joint]);
/// assert!(world.joint(joint).is_none());
/// # Ok::<(), lockstep2d::body::WorldError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct JointEvent {
    /// The joint. Its handle is stale if it broke.
    pub joint: JointId,
    /// Force on body B in N.
    pub force: Vec2<Fx>,
    /// Torque on body B about its anchor in N m.
    pub torque: Fx,
    /// Whether the joint broke and was removed.
    pub broke: bool,
}

/// The events of a tick, one list for each kind.
///
/// ```
/// # use lockstep2d::{body::{BodyDef, Geometry, Polygon, ShapeDef}, fx, math::{Fx, Vec2}, world::World};
/// # let mut world = World::default();
/// # let square = ShapeDef::new(Polygon::square(fx!(0.5))?);
/// # world.spawn(&BodyDef::fixed().position((fx!(0), fx!(-1))), &[square])?;
/// use lockstep2d::{body::EventSwitches, world::Events};
/// // Hits are reported only for shapes that enable hit events.
/// let heard = square.events(EventSwitches { hit: true, ..EventSwitches::default() });
/// let falling = world.spawn(&BodyDef::dynamic().position((fx!(0), fx!(1))), &[heard])?;
/// let mut hits = 0;
/// for _ in 0..120 {
///     world.step();
///     // Events are read right after the step: a restored world has no events until its next tick.
///     let events: &Events = world.events();
///     for hit in &events.hits {
///         assert!(world.shapes_of(falling).contains(&hit.shape_b) && hit.approach_speed > fx!(3));
///         hits += 1;
///     }
/// }
/// assert_eq!(hits, 1);
/// # Ok::<(), lockstep2d::body::WorldError>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Events {
    /// Bodies that the tick moved or put to sleep, in slot order.
    pub moved: Vec<MoveEvent>,
    /// Pairs of solid shapes that began to touch: they were within [`super::Config::touching_distance`] at the start of
    /// the tick, or had a normal impulse in the tick. At least one of the two shapes must enable contact events. Sorted
    /// by shape A, then by shape B.
    pub contact_begin: Vec<ContactEvent>,
    /// Pairs that moved further apart than [`super::Config::speculative_distance`], and pairs that an edit has ended.
    /// Sorted like `contact_begin`.
    pub contact_end: Vec<ContactEvent>,
    /// Pairs that had a normal impulse after an approach at [`super::Config::hit_speed`] or faster. At least one of the
    /// two shapes must enable hit events. Sorted like `contact_begin`.
    pub hits: Vec<HitEvent>,
    /// Shapes that began to overlap a sensor. Sorted by fraction, then by sensor, then by visitor.
    pub sensor_begin: Vec<SensorEvent>,
    /// Shapes that ceased to overlap a sensor, and pairs that an edit has ended. Sorted like `sensor_begin`.
    pub sensor_end: Vec<SensorEvent>,
    /// Joints above their threshold, in slot order.
    pub joints: Vec<JointEvent>,
}

/// A sensor event with its direction; see [`Events::sensor_changes`].
///
/// ```
/// # use lockstep2d::{body::{BodyDef, Geometry, Polygon, ShapeDef}, fx, world::World};
/// use lockstep2d::world::SensorChange;
/// # let mut world = World::default();
/// # let plate = ShapeDef::new(Polygon::square(fx!(1))?).sensor();
/// # world.spawn(&BodyDef::fixed(), &[plate])?;
/// # world.spawn(&BodyDef::dynamic().position((fx!(0), fx!(3))), &[ShapeDef::new(Geometry::circle(fx!(0.5))?)])?;
/// // A pressure plate counts the shapes on it, here while a ball falls through it.
/// let (mut count, mut most) = (0, 0);
/// for _ in 0..120 {
///     world.step();
///     for change in world.events().sensor_changes() {
///         count += match change { SensorChange::Begin(_) => 1, SensorChange::End(_) => -1 };
///         most = most.max(count);
///     }
/// }
/// assert_eq!((most, count), (1, 0));
/// # Ok::<(), lockstep2d::body::WorldError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SensorChange {
    /// The visitor began to overlap the sensor.
    Begin(SensorEvent),
    /// The visitor ceased to overlap the sensor.
    End(SensorEvent),
}

impl Events {
    /// Returns the sensor events of the tick in order. Ends caused by changes between ticks come first. The other
    /// events are sorted by their fraction of the tick, with beginnings first at equal fractions.
    ///
    /// ```
    /// use lockstep2d::{body::{BodyDef, Geometry, ShapeDef}, fx, world::{SensorChange, World}};
    /// let mut world = World::default();
    /// let gate = ShapeDef::new(Geometry::circle(fx!(0.5))?);
    /// let [first, second] = [1, 3].map(|x| BodyDef::fixed().position((lockstep2d::math::Fx::from_num(x), fx!(0))));
    /// world.spawn(&first, &[gate.sensor()])?;
    /// world.spawn(&second, &[gate.sensor()])?;
    /// world.spawn(&BodyDef::dynamic().position((fx!(-1), fx!(0))).velocity((fx!(360), fx!(0))), &[gate])?;
    /// world.step();
    /// let begins: Vec<_> =
    ///     world.events().sensor_changes().map(|change| matches!(change, SensorChange::Begin(_))).collect();
    /// assert_eq!(begins, [true, false, true, false]);
    /// # Ok::<(), lockstep2d::body::WorldError>(())
    /// ```
    pub fn sensor_changes(&self) -> impl Iterator<Item = SensorChange> {
        let (mut begins, mut ends) = (self.sensor_begin.iter().peekable(), self.sensor_end.iter().peekable());
        core::iter::from_fn(move || {
            let is_end = match (begins.peek(), ends.peek()) {
                (Some(begin), Some(end)) => end.fraction == Fx::ZERO || end.fraction < begin.fraction,
                (begin, _) => begin.is_none(),
            };
            let next = if is_end { &mut ends } else { &mut begins }.next().copied();
            next.map(if is_end { SensorChange::End } else { SensorChange::Begin })
        })
    }

    pub(crate) fn clear(&mut self) {
        let Events { moved, contact_begin, contact_end, hits, sensor_begin, sensor_end, joints } = self;
        moved.clear();
        contact_begin.clear();
        contact_end.clear();
        hits.clear();
        sensor_begin.clear();
        sensor_end.clear();
        joints.clear();
    }
}
