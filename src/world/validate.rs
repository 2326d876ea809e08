//! The invariants of the state, checked one by one: in tests after every tick, and of every state that comes from
//! outside.

use alloc::format;
use alloc::string::String;
use alloc::vec::Vec;
use core::fmt;

use super::World;
use super::change::{fat_box, mass_of, reach_max};
use super::state::State;
use crate::body::{Body, BodyId, BodyKind, Handle, Pose, SHAPES_PER_BODY_MAX, SPEED_MAX, WORLD_EXTENT_MAX};
use crate::collision::Contact;
use crate::math::{Fx, Vec2};

/// A broken invariant.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Violation {
    /// What is wrong, and where.
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
    /// Checks every invariant of the state.
    ///
    /// # Errors
    /// The first [`Violation`]. A world that was changed only through its methods has none.
    pub fn validate(&self) -> Result<(), Violation> {
        self.state.validate()
    }
}

impl State {
    pub(super) fn validate(&self) -> Result<(), Violation> {
        let state = self;
        state.config.validate().map_err(|error| Violation { what: format!("{error}") })?;
        let State { bodies, shapes, joints, config, .. } = state;
        check(bodies.is_consistent(), || "the free list of bodies".into())?;
        check(shapes.is_consistent(), || "the free list of shapes".into())?;
        check(joints.is_consistent(), || "the free list of joints".into())?;
        check(bodies.len() <= config.body_limit as usize, || "more bodies than allowed".into())?;
        check(shapes.len() <= config.shape_limit as usize, || "more shapes than allowed".into())?;
        check(joints.len() <= config.joint_limit as usize, || "more joints than allowed".into())?;
        check_shapes(state)?;
        for (id, body) in bodies.iter() {
            check_body(state, id, body)?;
        }
        check_islands(state)?;
        check_joints(state)?;
        check_contacts(state, &state.contacts)?;
        check_contacts(state, &state.resting)?;
        let resting = |contact: &Contact| {
            state.resting.binary_search_by_key(&contact.shapes, |other| other.shapes).is_ok()
        };
        check(!state.contacts.iter().any(resting), || "a contact that rests and does not".into())
    }
}

fn check_body(state: &State, id: BodyId, body: &Body) -> Result<(), Violation> {
    let at = |what: &str| format!("body {id}: {what}");
    let inside = |v: Vec2<Fx>| {
        let range = -WORLD_EXTENT_MAX..=WORLD_EXTENT_MAX;
        range.contains(&v.x) && range.contains(&v.y)
    };
    // The centre of mass may be outside the origin's range by the distance between the two.
    let reach = Vec2::new(crate::body::REACH_MAX * 8, crate::body::REACH_MAX * 8);
    check(inside(body.centre.max(-body.centre) - reach), || at("outside the world"))?;
    let speed = -SPEED_MAX..=SPEED_MAX;
    let slow = [body.velocity.x, body.velocity.y, body.spin].iter().all(|v| speed.contains(v));
    check(slow, || at("faster than the kernels allow"))?;
    let at_rest = body.velocity == Vec2::ZERO && body.spin == 0;
    check(body.kind != BodyKind::Fixed || at_rest, || at("fixed and moving"))?;
    let free = body.force == Vec2::ZERO && body.torque == Fx::ZERO;
    check(body.is_dynamic() || free, || at("a force on a body that is not dynamic"))?;
    body.settings.validate().map_err(|error| Violation { what: at(&format!("{error}")) })?;
    let sleepiest = match body.kind {
        BodyKind::Fixed => 0,
        BodyKind::Kinematic => 1,
        BodyKind::Dynamic => state.config.ticks_to_sleep(),
    };
    check(body.rest_ticks <= sleepiest, || at("too sleepy to be awake"))?;
    // It is seen where it stops only if it has not been at rest before.
    let rests = body.kind == BodyKind::Kinematic && body.rest_ticks != 0;
    check(!(rests && body.is_moving()), || at("at rest and moving"))?;
    let locks = body.settings.locks;
    let held = !(locks.x && body.velocity.x != 0 || locks.y && body.velocity.y != 0);
    check(held, || at("moves along a locked axis"))?;
    let reachable = |target: &Pose| body.kind == BodyKind::Kinematic && inside(target.centre);
    check(body.target.as_deref().is_none_or(reachable), || at("a target that it cannot have"))?;
    let shapes = body.shapes.iter().map(|shape| state.shapes.at(shape.slot()).def());
    let mass = mass_of(body.kind, *body.mass_source, &body.settings, shapes)
        .map_err(|error| Violation { what: at(&format!("{error}")) })?;
    check(mass == body.mass, || at("mass does not follow from its shapes"))
}

/// Every shape is valid and on the list of its body, once. Before the bodies, whose masses are sums over shapes.
fn check_shapes(state: &State) -> Result<(), Violation> {
    let mut listed = alloc::vec![false; state.shapes.slot_count()];
    for (id, body) in state.bodies.iter() {
        check(body.shapes.len() <= SHAPES_PER_BODY_MAX as usize, || format!("body {id}: too many shapes"))?;
        for shape in &body.shapes {
            let own = state.shapes.get(*shape).is_some_and(|shape| shape.body == id);
            let first = own && !core::mem::replace(&mut listed[shape.slot() as usize], true);
            check(first, || format!("body {id}: lists shape {shape}, which is not its own, or twice"))?;
        }
    }
    for (id, shape) in state.shapes.iter() {
        check(listed[id.slot() as usize], || format!("shape {id}: not on the list of its body"))?;
        let body = state.bodies.at(shape.body.slot());
        let valid = shape.def.validate(reach_max(body.kind()));
        valid.map_err(|error| Violation { what: format!("shape {id}: {error}") })?;
        check(shape.fat.is_valid(), || format!("shape {id}: a fat box with its corners exchanged"))?;
        let expected = || fat_box(&shape.def, body, &state.config);
        check(body.kind() != BodyKind::Fixed || shape.fat == expected(), || {
            format!("shape {id}: the fat box of a fixed shape is somewhere else")
        })?;
    }
    Ok(())
}

/// Every sleeping body is at rest and on the list of its island, and nobody else is.
fn check_islands(state: &State) -> Result<(), Violation> {
    check(state.islands.is_consistent(), || "the free list of islands".into())?;
    let mut listed = 0;
    for (id, island) in state.islands.iter() {
        check(!island.bodies.is_empty(), || format!("island {id}: nobody there"))?;
        check(island.bodies.is_sorted_by(|a, b| a < b), || format!("island {id}: out of order"))?;
        for &slot in &island.bodies {
            let own = state.bodies.get_slot(slot).is_some_and(|body| body.island == Some(id));
            check(own, || format!("island {id}: body slot {slot} is not its own"))?;
        }
        listed += island.bodies.len();
    }
    let sleeping: Vec<_> = state.bodies.iter().filter(|(_, body)| body.is_asleep()).collect();
    check(sleeping.len() == listed, || "a body sleeps in an island that does not know it".into())?;
    for (id, body) in sleeping {
        let able = body.is_dynamic() && body.enabled && state.config.sleeping;
        let still = !body.is_moving() && body.force == Vec2::ZERO && body.torque == Fx::ZERO;
        check(able && still && body.rest_ticks == 0, || format!("body {id}: asleep and not at rest"))?;
    }
    Ok(())
}

fn check_joints(state: &State) -> Result<(), Violation> {
    for (id, joint) in state.joints.iter() {
        joint.def.validate().map_err(|error| Violation { what: format!("joint {id}: {error}") })?;
        let (a, b) = joint.def.bodies();
        let dynamic = |body: BodyId| state.bodies.get(body).map(Body::is_dynamic);
        let held = matches!((dynamic(a), dynamic(b)), (Some(a), Some(b)) if a || b);
        check(held, || format!("joint {id}: its bodies"))?;
        let (body_a, body_b) = (state.bodies.at(a.slot()), state.bodies.at(b.slot()));
        let both = body_a.is_dynamic() && body_b.is_dynamic() && body_a.enabled && body_b.enabled;
        let together = !joint.is_solved() || !both || body_a.island == body_b.island;
        check(together, || format!("joint {id}: its bodies do not sleep together"))?;
        let limit = crate::solver::IMPULSE_MAX;
        let bounded = joint.impulses.0.iter().all(|p| (-limit..=limit).contains(p));
        check(bounded, || format!("joint {id}: its impulse"))?;
    }
    Ok(())
}

fn check_contacts(state: &State, contacts: &[Contact]) -> Result<(), Violation> {
    let pairs: Vec<_> = contacts.iter().map(|contact| contact.shapes).collect();
    check(pairs.is_sorted_by(|a, b| a < b), || "contacts are not sorted by pair".into())?;
    for contact in contacts {
        let (a, b) = contact.shapes;
        let at = |what: &str| format!("contact of shapes {a} and {b}: {what}");
        check(a < b, || at("out of order"))?;
        let (Some(shape_a), Some(shape_b)) = (state.shapes.get_slot(a), state.shapes.get_slot(b)) else {
            return Err(Violation { what: at("a shape is gone") });
        };
        check(shape_a.body != shape_b.body, || at("of the same body"))?;
        let (body_a, body_b) = state.bodies_of(contact.shapes);
        check(body_a.enabled && body_b.enabled, || at("of a disabled body"))?;
        let solid = state.sensor_of(contact.shapes).is_none();
        check(solid || contact.count == 0, || at("a sensor that pushes"))?;
        check(contact.count <= 2, || at("more than 2 points"))?;
        let limit = crate::solver::IMPULSE_MAX;
        for point in contact.points() {
            let pushes = point.normal >= 0 && point.normal <= limit;
            check(pushes && (-limit..=limit).contains(&point.tangent), || at("an impossible impulse"))?;
        }
        check((-limit..=limit).contains(&contact.rolling), || at("an impossible impulse against rolling"))?;
        let unused = &contact.points[usize::from(contact.count)..];
        check(unused.iter().all(|point| *point == Default::default()), || at("an impulse of no point"))?;
    }
    Ok(())
}
