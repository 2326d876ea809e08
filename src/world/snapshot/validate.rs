//! The invariants of the state. [`World::from_bytes`] checks them, and games and tests may check them at any time.

use alloc::format;
use alloc::string::String;
use alloc::vec::Vec;
use core::fmt;

use crate::body::{
    Body, BodyId, BodyKind, Handle, Pose, REACH_MAX, RestTicks, SHAPES_PER_BODY_MAX, SPEED_MAX,
    WORLD_EXTENT_MAX,
};
use crate::collision::Contact;
use crate::math::{Fx, Vec2};
use crate::world::World;
use crate::world::derived::{FAT_GRID_SHIFT, fat_box, mass_of, offset_max};
use crate::world::state::State;

/// A broken invariant.
///
/// ```
/// use lockstep2d::world::{Violation, World};
/// // A test of a game can check the invariants after every tick.
/// let mut world = World::default();
/// world.step();
/// let result: Result<(), Violation> = world.validate();
/// assert!(result.is_ok(), "{}", result.unwrap_err());
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Violation {
    /// Description of the broken invariant and of the object that breaks it.
    pub what: String,
}

impl fmt::Display for Violation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.what)
    }
}

impl core::error::Error for Violation {}

fn check(holds: bool, what: impl FnOnce() -> String) -> Result<(), Violation> {
    if holds { Ok(()) } else { Err(Violation { what: what() }) }
}

impl World {
    /// Checks the invariants of the state.
    ///
    /// # Errors
    /// The first [`Violation`] found.
    pub fn validate(&self) -> Result<(), Violation> {
        self.state.validate()
    }
}

impl State {
    pub(super) fn validate(&self) -> Result<(), Violation> {
        let state = self;
        state.config.validate().map_err(|error| Violation { what: format!("{error}") })?;
        let State { bodies, shapes, joints, config, .. } = state;
        check(bodies.is_consistent(), || "the free list of bodies is inconsistent".into())?;
        check(shapes.is_consistent(), || "the free list of shapes is inconsistent".into())?;
        check(joints.is_consistent(), || "the free list of joints is inconsistent".into())?;
        check(bodies.len() <= config.body_limit as usize, || {
            format!("{} bodies, at most {}", bodies.len(), config.body_limit)
        })?;
        check(shapes.len() <= config.shape_limit as usize, || {
            format!("{} shapes, at most {}", shapes.len(), config.shape_limit)
        })?;
        check(joints.len() <= config.joint_limit as usize, || {
            format!("{} joints, at most {}", joints.len(), config.joint_limit)
        })?;
        check_shapes(state)?;
        for (id, body) in bodies.iter() {
            check_body(state, id, body)?;
        }
        check_islands(state)?;
        check_joints(state)?;
        check_contacts(state, &state.contacts)?;
        check_contacts(state, &state.sleeping_contacts)?;
        let sleeping_contacts = |contact: &Contact| {
            state.sleeping_contacts.binary_search_by_key(&contact.shapes, |other| other.shapes).is_ok()
        };
        check(!state.contacts.iter().any(sleeping_contacts), || {
            "a contact is both active and sleeping".into()
        })
    }
}

fn check_body(state: &State, id: BodyId, body: &Body) -> Result<(), Violation> {
    let at = |what: &str| format!("body {id}: {what}");
    let inside = |v: Vec2<Fx>| {
        let range = -WORLD_EXTENT_MAX..=WORLD_EXTENT_MAX;
        range.contains(&v.x) && range.contains(&v.y)
    };
    // Edits keep the origin of a body within the world extent, but not its centre of mass. Ticks keep its centre of
    // mass there, but not its origin. The tolerance is larger than the distance between the two points.
    let reach = Vec2::new(REACH_MAX * 8, REACH_MAX * 8);
    let nearly_inside = |v: Vec2<Fx>| inside(v.max(-v) - reach);
    check(nearly_inside(body.centre), || at("outside the world"))?;
    let speed = -SPEED_MAX..=SPEED_MAX;
    let slow = [body.velocity.x, body.velocity.y, body.spin].iter().all(|v| speed.contains(v));
    check(slow, || at("faster than the solver allows"))?;
    let at_rest = body.velocity == Vec2::ZERO && body.spin == 0;
    check(body.kind != BodyKind::Fixed || at_rest, || at("fixed with a velocity"))?;
    let free = body.force == Vec2::ZERO && body.torque == Fx::ZERO;
    check(body.is_dynamic() || free, || at("a force on a body that is not dynamic"))?;
    body.settings.validate().map_err(|error| Violation { what: at(&format!("{error}")) })?;
    let sleepiest = match body.kind {
        BodyKind::Fixed => 0,
        BodyKind::Kinematic => 1,
        BodyKind::Dynamic => state.config.ticks_to_sleep(),
    };
    check(body.rest_ticks.to_bits() <= sleepiest, || {
        at("more ticks at rest than a body of its kind can have")
    })?;
    // A kinematic body that stops stays active for one more tick, in which it is marked as settled. A moving body
    // must not have this mark, because it would then become inactive without that tick.
    let rests = body.kind == BodyKind::Kinematic && body.rest_ticks.has_settled();
    check(!(rests && body.is_moving()), || at("settled with a velocity"))?;
    check(!(rests && body.target.is_some()), || at("settled with a target"))?;
    let name = body.name().map_or(Ok(()), |name| name.validate());
    name.map_err(|error| Violation { what: at(&format!("{error}")) })?;
    let locks = body.settings.locks;
    let held = !(locks.x && body.velocity.x != 0 || locks.y && body.velocity.y != 0);
    check(held, || at("a velocity along a locked axis"))?;
    // Targets need the same tolerance: a locked axis gives a target the coordinate of the body's centre of mass, which
    // may be outside of the world extent by less than the tolerance.
    let reachable = |target: &Pose| body.kind == BodyKind::Kinematic && nearly_inside(target.centre);
    check(body.target.as_deref().is_none_or(reachable), || {
        at("a target outside the world or of a body that is not kinematic")
    })?;
    let shapes = body.shapes.iter().map(|shape| state.shapes.at(shape.slot()).def());
    let mass = mass_of(body.kind, *body.mass_source, &body.settings, shapes)
        .map_err(|error| Violation { what: at(&format!("{error}")) })?;
    check(mass == body.mass, || at("its mass does not follow from its shapes"))
}

/// Checks the shapes. Must be called before bodies are checked, because their masses are computed from the shapes.
fn check_shapes(state: &State) -> Result<(), Violation> {
    let mut listed = alloc::vec![false; state.shapes.slot_count()];
    for (id, body) in state.bodies.iter() {
        check(body.shapes.len() <= SHAPES_PER_BODY_MAX as usize, || format!("body {id}: too many shapes"))?;
        for shape in &body.shapes {
            let own = state.shapes.get(*shape).is_some_and(|shape| shape.body == id);
            let first = own && !core::mem::replace(&mut listed[shape.slot() as usize], true);
            check(first, || format!("body {id}: lists shape {shape} twice, or it belongs to another body"))?;
        }
    }
    for (id, shape) in state.shapes.iter() {
        check(listed[id.slot() as usize], || format!("shape {id}: not listed by its body"))?;
        let body = state.bodies.at(shape.body.slot());
        let valid = shape.def.validate(offset_max(body.kind()));
        valid.map_err(|error| Violation { what: format!("shape {id}: {error}") })?;
        check(shape.fat.is_valid(), || {
            format!("shape {id}: the upper corner of its fat box is below the lower one")
        })?;
        // This check also rejects the box from the smallest to the largest number, whose upper corner is off the grid.
        // It would overlap `Aabb::NOWHERE`.
        check(shape.fat == shape.fat.rounded_out(FAT_GRID_SHIFT), || {
            format!("shape {id}: a corner of its fat box is off the grid")
        })?;
        let expected = || fat_box(&shape.def, body, &state.config);
        check(body.kind() != BodyKind::Fixed || shape.fat == expected(), || {
            format!("shape {id}: the fat box of a fixed shape does not follow from its geometry")
        })?;
    }
    Ok(())
}

fn check_islands(state: &State) -> Result<(), Violation> {
    check(state.islands.is_consistent(), || "the free list of islands is inconsistent".into())?;
    let mut listed = 0;
    for (id, island) in state.islands.iter() {
        check(!island.bodies.is_empty(), || format!("island {id}: no bodies"))?;
        check(island.bodies.is_sorted_by(|a, b| a < b), || {
            format!("island {id}: its bodies are not sorted")
        })?;
        for &slot in &island.bodies {
            let own = state.bodies.get_slot(slot).is_some_and(|body| body.island == Some(id));
            check(own, || format!("island {id}: body slot {slot} does not sleep in it"))?;
        }
        listed += island.bodies.len();
    }
    let sleeping: Vec<_> = state.bodies.iter().filter(|(_, body)| body.is_asleep()).collect();
    check(sleeping.len() == listed, || "a body sleeps in an island that does not list it".into())?;
    for (id, body) in sleeping {
        let able = body.is_dynamic() && body.enabled && state.config.sleeping;
        let still = !body.is_moving() && body.force == Vec2::ZERO && body.torque == Fx::ZERO;
        check(able && still && body.rest_ticks == RestTicks::NONE, || {
            format!("body {id}: asleep, but not an enabled dynamic body at rest in a world with sleeping")
        })?;
    }
    Ok(())
}

fn check_joints(state: &State) -> Result<(), Violation> {
    for (id, joint) in state.joints.iter() {
        let (a, b) = joint.def.bodies();
        let (Some(body_a), Some(body_b)) = (state.bodies.get(a), state.bodies.get(b)) else {
            return Err(Violation { what: format!("joint {id}: a body is not in the world") });
        };
        let valid = joint.def.validate([body_a.kind(), body_b.kind()]);
        valid.map_err(|error| Violation { what: format!("joint {id}: {error}") })?;
        let both = body_a.is_dynamic() && body_b.is_dynamic() && body_a.enabled && body_b.enabled;
        let both = both && (body_a.has_mass() || body_b.has_mass());
        let together = !joint.is_solved() || !both || body_a.island == body_b.island;
        check(together, || format!("joint {id}: one of its bodies sleeps without the other"))?;
        let limit = crate::solver::IMPULSE_MAX;
        let bounded = joint.impulses.0.iter().all(|p| (-limit..=limit).contains(p));
        check(bounded, || format!("joint {id}: an impulse is out of range"))?;
    }
    Ok(())
}

fn check_contacts(state: &State, contacts: &[Contact]) -> Result<(), Violation> {
    let pairs: Vec<_> = contacts.iter().map(|contact| contact.shapes).collect();
    check(pairs.is_sorted_by(|a, b| a < b), || "contacts are not sorted by pair".into())?;
    for contact in contacts {
        let (a, b) = contact.shapes;
        let at = |what: &str| format!("contact of shapes {a} and {b}: {what}");
        check(a < b, || at("the smaller slot does not come first"))?;
        let (Some(shape_a), Some(shape_b)) = (state.shapes.get_slot(a), state.shapes.get_slot(b)) else {
            return Err(Violation { what: at("a shape is not in the world") });
        };
        check(shape_a.body != shape_b.body, || at("both shapes belong to the same body"))?;
        let (body_a, body_b) = state.bodies_of(contact.shapes);
        check(body_a.enabled && body_b.enabled, || at("a body is disabled"))?;
        let solid = state.sensor_of(contact.shapes).is_none();
        check(solid || contact.count == 0, || at("impulses at a sensor"))?;
        check(contact.count <= 2, || at("more than 2 points"))?;
        // Impulses are looked up by feature id: two points with the same feature would share one impulse.
        let [first, second] = &contact.points;
        check(contact.count < 2 || first.feature != second.feature, || at("two points with one feature"))?;
        let limit = crate::solver::IMPULSE_MAX;
        for point in contact.points() {
            let pushes = point.normal >= 0 && point.normal <= limit;
            check(pushes && (-limit..=limit).contains(&point.tangent), || at("an impulse is out of range"))?;
        }
        check((-limit..=limit).contains(&contact.rolling), || at("the rolling impulse is out of range"))?;
        check(contact.kept.is_valid(contact.count), || at("the kept manifold is out of range"))?;
        let unused = &contact.points[usize::from(contact.count)..];
        check(unused.iter().all(|point| *point == Default::default()), || at("an impulse without a point"))?;
    }
    Ok(())
}
