use alloc::vec::Vec;

use super::joint;
use super::primitive::{ContactProximity, Form, Hue, Layers, Primitive, Style, Subject};
use crate::body::{Body, BodyId, BodyKind};
use crate::collision::{Link, ManifoldPoint, Outline, PosedShape};
use crate::fx;
use crate::math::{Fx, Unit, Vec2, fx_mul, widen};
use crate::world::{ContactView, SolverColour, World};

/// A velocity is drawn as the displacement in this time in seconds: 1 m at 10 m/s. Longer lines hide the scene, and
/// shorter ones are hard to tell from points.
const VELOCITY_TIME: Fx = fx!(0.1);

/// Drawn length in metres of a force that accelerates its body by [`FORCE_UNIT`]. It is shorter than typical bodies.
const FORCE_LENGTH: Fx = fx!(0.2);
/// Unit of drawn accelerations in m/s².
const FORCE_UNIT: i64 = 10;

/// The primitives of the given layers of a world: the boxes of the broad phase, then the bodies, islands, contacts and
/// joints. Bodies and joints are in slot order.
#[must_use]
pub fn primitives(world: &World, layers: Layers) -> Vec<Primitive> {
    let mut found = Vec::new();
    each_primitive(world, layers, &mut |primitive| found.push(primitive));
    found
}

/// [`primitives`], but passes each primitive to `found` instead of collecting all of them: a large world has about a
/// hundred thousand.
pub fn each_primitive(world: &World, layers: Layers, found: Sink<'_>) {
    if layers.broad_phase {
        for (aabb, _) in world.broad_phase_boxes() {
            found(primitive(Style::BroadPhase, Subject::World, Form::Box(aabb)));
        }
    }
    for (id, body) in world.bodies() {
        add_body(world, (id, body), layers, found);
    }
    if layers.islands {
        add_islands(world, found);
    }
    if layers.contact_points || layers.contact_normals || layers.contact_forces || layers.solver_colours {
        let touching_distance = world.config().touching_distance();
        for contact in world.contacts() {
            add_contact(&contact, touching_distance, layers, found);
        }
    }
    if layers.joints || layers.joint_errors {
        for (id, _) in world.joints().filter(|(_, joint)| joint.def().enabled) {
            joint::add(world, id, layers, found);
        }
    }
}

pub(super) type Sink<'a> = &'a mut dyn FnMut(Primitive);

pub(super) fn primitive(style: Style, subject: Subject, form: Form) -> Primitive {
    Primitive { style, subject, form }
}

fn add_body(world: &World, (id, body): (BodyId, &Body), layers: Layers, found: Sink<'_>) {
    let subject = Subject::Body(id);
    if layers.outlines {
        add_outlines(world, (id, body), style_of(body), found);
    }
    if layers.fat_boxes {
        for &id in body.shapes() {
            let Some(shape) = world.shape(id) else { continue };
            found(primitive(Style::FatBox, Subject::Shape(id), Form::Box(shape.fat_aabb())));
        }
    }
    let centre = body.centre_of_mass();
    if layers.ids {
        found(primitive(Style::Id, subject, Form::Label { at: centre, text: world.body_label(id) }));
    }
    if body.kind() == BodyKind::Fixed {
        return;
    }
    if layers.centres_of_mass {
        found(primitive(Style::CentreOfMass, subject, Form::Point(centre)));
    }
    let velocity = body.velocity();
    if layers.velocities && velocity != Vec2::ZERO {
        let form = Form::Line { from: centre, to: centre + stretched(velocity, VELOCITY_TIME) };
        found(primitive(Style::Velocity, subject, form));
    }
}

fn style_of(body: &Body) -> Style {
    match body.kind() {
        BodyKind::Fixed => Style::Fixed,
        BodyKind::Kinematic => Style::Kinematic,
        BodyKind::Dynamic if body.is_asleep() => Style::Asleep,
        BodyKind::Dynamic => Style::Dynamic,
    }
}

fn add_outlines(world: &World, (id, body): (BodyId, &Body), style: Style, found: Sink<'_>) {
    let subject = Subject::Body(id);
    let rotation = body.rotation();
    for shape in body.shapes().iter().filter_map(|&id| world.shape(id)) {
        let style = match style {
            Style::Island(_) => style,
            _ if shape.is_sensor() => Style::Sensor,
            _ => style,
        };
        let mut add = |form| found(primitive(style, subject, form));
        // Draws the outline that collision detection uses, so that a picture cannot hide an error of the pose.
        let PosedShape { centre, outline, .. } = PosedShape::new(&shape.def, body, rotation);
        match outline {
            Outline::Circle { radius } => {
                let radius = widen(radius);
                add(Form::Circle { centre, radius });
                let to = centre + rotation.apply_wide(Vec2::new(radius, Fx::ZERO));
                add(Form::Line { from: centre, to });
            }
            Outline::Segment { a, b } | Outline::Link(Link { a, b, .. }) => {
                add(Form::Line { from: centre + a, to: centre + b })
            }
            Outline::Polygon(hull) => {
                let vertices = hull.vertices().iter().map(|vertex| centre + vertex.widen()).collect();
                add(Form::Polygon { vertices, radius: widen(hull.radius) });
            }
        }
    }
}

/// Adds the outlines of all islands. The colour of an island depends on the slot index of its first body.
fn add_islands(world: &World, found: Sink<'_>) {
    for island in world.islands() {
        let Some(first) = island.first() else { continue };
        let style = Style::Island(Hue::of(first.index() as usize));
        for id in island {
            let Some(body) = world.body(id) else { continue };
            add_outlines(world, (id, body), style, found);
        }
    }
}

fn add_contact(contact: &ContactView<'_>, touching_distance: Fx, layers: Layers, found: Sink<'_>) {
    let subject = Subject::Contact(contact.shape_a, contact.shape_b);
    let manifold = contact.manifold;
    let colour = if layers.solver_colours { contact.solver_colour() } else { None };
    let mut add = |style, form| found(primitive(style, subject, form));
    for &ManifoldPoint { anchor, separation, .. } in manifold.points() {
        let place = manifold.origin + anchor.widen();
        let touching = widen(separation) <= touching_distance;
        let proximity = if touching { ContactProximity::Touching } else { ContactProximity::Speculative };
        if layers.contact_normals {
            let form = Form::Direction { from: place, direction: manifold.normal };
            add(Style::ContactNormal(proximity), form);
        }
        if layers.contact_points {
            add(Style::ContactPoint(proximity), Form::Point(place));
        }
        match colour {
            Some(SolverColour::Group(group)) => {
                add(Style::SolverGroup(Hue::of(group.into())), Form::Point(place));
            }
            Some(SolverColour::Overflow) => add(Style::SolverOverflow, Form::Point(place)),
            None => {}
        }
    }
    if layers.contact_forces {
        add_forces(contact, &mut add);
    }
}

fn add_forces(contact: &ContactView<'_>, add: &mut impl FnMut(Style, Form)) {
    let manifold = contact.manifold;
    for (point, [normal, friction]) in contact.accelerations() {
        let place = manifold.origin + point.anchor.widen();
        let mut arrow = |style, direction: Vec2<Unit>, acceleration| {
            if acceleration != Fx::ZERO {
                let to = place + stretched(direction.widen(), force_length(acceleration));
                add(style, Form::Line { from: place, to });
            }
        };
        arrow(Style::ContactForce, manifold.normal, normal);
        arrow(Style::ContactFriction, manifold.normal.perp(), friction);
    }
}

/// Drawn length of a force in metres, with the sign of the acceleration: see [`Style::ContactForce`].
fn force_length(acceleration: Fx) -> Fx {
    let units = (acceleration / FORCE_UNIT).to_bits();
    let root = Fx::saturating_from_num(units.unsigned_abs().isqrt()) / (1 << (Fx::FRAC_NBITS / 2));
    fx_mul(root, if acceleration < Fx::ZERO { -FORCE_LENGTH } else { FORCE_LENGTH })
}

pub(super) fn stretched(vector: Vec2<Fx>, factor: Fx) -> Vec2<Fx> {
    Vec2::new(fx_mul(vector.x, factor), fx_mul(vector.y, factor))
}
