//! What there is to see in a world, as plain data.

use alloc::vec::Vec;

use crate::body::{Body, BodyId, BodyKind, JointId, ShapeId};
use crate::collision::{Link, ManifoldPoint, Outline, PosedShape};
use crate::fx;
use crate::math::{Aabb, Fx, Unit, Vec2, fx_mul, widen};
use crate::world::{ContactView, World};

/// A velocity is drawn as the way that the body makes in this time, in seconds: at 10 m/s one metre, the size of
/// a typical body. Longer ones hide the scene, shorter ones cannot be told from a point.
const VELOCITY_TIME: Fx = fx!(0.1);

/// What to draw.
///
/// ```
/// use lockstep2d::draw::Layers;
/// let with_arrows = Layers { velocities: true, ..Layers::default() };
/// let only_joints = Layers { joints: true, ..Layers::NONE };
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Layers {
    /// The shapes of all bodies.
    pub outlines: bool,
    /// The fat boxes that the broad phase sees.
    pub fat_boxes: bool,
    /// Where shapes touch or are about to.
    pub contact_points: bool,
    /// In which direction they push, from the contact points.
    pub contact_normals: bool,
    /// Anchors of joints, the gap between them, and lines to the bodies that they hold.
    pub joints: bool,
    /// Centres of mass of the bodies that can move.
    pub centres_of_mass: bool,
    /// Velocities of the centres of mass.
    pub velocities: bool,
}

impl Layers {
    /// Nothing.
    pub const NONE: Self = Layers {
        outlines: false,
        fat_boxes: false,
        contact_points: false,
        contact_normals: false,
        joints: false,
        centres_of_mass: false,
        velocities: false,
    };

    /// Everything.
    pub const ALL: Self = Layers {
        outlines: true,
        fat_boxes: true,
        contact_points: true,
        contact_normals: true,
        joints: true,
        centres_of_mass: true,
        velocities: true,
    };
}

impl Default for Layers {
    /// Everything but velocities.
    fn default() -> Self {
        Layers { velocities: false, ..Self::ALL }
    }
}

/// A thing to draw.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Primitive {
    /// What it means; the renderer has the colours.
    pub style: Style,
    /// What it belongs to, for picking and highlighting.
    pub subject: Subject,
    /// What it looks like.
    pub form: Form,
}

/// What a primitive means.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Style {
    /// The outline of a shape, or the radius that shows how a circle is turned.
    Outline(BodyKind),
    /// The box that the broad phase sees of a shape.
    FatBox,
    /// A contact point.
    ContactPoint(Proximity),
    /// The direction in which a contact pushes its shape B.
    ContactNormal(Proximity),
    /// From a joint's anchor to the centre of mass of the body that it holds there.
    JointArm,
    /// An anchor of a joint.
    JointAnchor,
    /// From one anchor of a joint to the other, where both should be in one place.
    JointGap,
    /// The centre of mass of a body.
    CentreOfMass,
    /// From the centre of mass to where the body would be in a tenth of a second.
    Velocity,
}

/// Whether a contact point pushes yet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Proximity {
    /// No further apart than a quarter of the speculative distance, as contact events have it.
    Touching,
    /// Further apart: it is there so that fast shapes do not pass through each other.
    Speculative,
}

/// What a primitive belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Subject {
    /// A body.
    Body(BodyId),
    /// A shape of a body.
    Shape(ShapeId),
    /// A contact between two shapes.
    Contact(ShapeId, ShapeId),
    /// A joint.
    Joint(JointId),
}

/// What a primitive looks like, in world coordinates in metres.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Form {
    /// A mark of the renderer's size and shape.
    Point(Vec2<Fx>),
    /// A straight line.
    Line {
        /// One end.
        from: Vec2<Fx>,
        /// The other end.
        to: Vec2<Fx>,
    },
    /// A line of the renderer's length, so that it can be seen at any scale.
    Direction {
        /// Where it starts.
        from: Vec2<Fx>,
        /// Where it points, of length 1.
        direction: Vec2<Unit>,
    },
    /// An axis-aligned box.
    Box(Aabb),
    /// A circle.
    Circle {
        /// Its centre.
        centre: Vec2<Fx>,
        /// Its radius.
        radius: Fx,
    },
    /// A convex polygon, or a line with a radius if it has two vertices.
    Polygon {
        /// Counter-clockwise.
        vertices: Vec<Vec2<Fx>>,
        /// How far the outline lies outside of the edges, with round corners about the vertices.
        radius: Fx,
    },
}

/// Everything that some layers show of a world: body by body, then contacts, then joints, each in slot order.
#[must_use]
pub fn primitives(world: &World, layers: Layers) -> Vec<Primitive> {
    let mut found = Vec::new();
    for (id, body) in world.bodies() {
        add_body(world, (id, body), layers, &mut found);
    }
    if layers.contact_points || layers.contact_normals {
        // The threshold at which a contact event begins.
        let touching_distance = world.config().touching_distance();
        for contact in world.contacts() {
            add_contact(&contact, touching_distance, layers, &mut found);
        }
    }
    if layers.joints {
        for (id, _) in world.joints() {
            add_joint(world, id, &mut found);
        }
    }
    found
}

fn add_body(world: &World, (id, body): (BodyId, &Body), layers: Layers, found: &mut Vec<Primitive>) {
    let subject = Subject::Body(id);
    if layers.outlines {
        add_outlines(world, (id, body), found);
    }
    if layers.fat_boxes {
        for &id in body.shapes() {
            let Some(shape) = world.shape(id) else { continue };
            let form = Form::Box(shape.fat_aabb());
            found.push(Primitive { style: Style::FatBox, subject: Subject::Shape(id), form });
        }
    }
    if body.kind() == BodyKind::Fixed {
        return;
    }
    let centre = body.centre_of_mass();
    if layers.centres_of_mass {
        found.push(Primitive { style: Style::CentreOfMass, subject, form: Form::Point(centre) });
    }
    let velocity = body.velocity();
    if layers.velocities && velocity != Vec2::ZERO {
        let way = Vec2::new(fx_mul(velocity.x, VELOCITY_TIME), fx_mul(velocity.y, VELOCITY_TIME));
        let form = Form::Line { from: centre, to: centre + way };
        found.push(Primitive { style: Style::Velocity, subject, form });
    }
}

fn add_outlines(world: &World, (id, body): (BodyId, &Body), found: &mut Vec<Primitive>) {
    let (style, subject) = (Style::Outline(body.kind()), Subject::Body(id));
    let rotation = body.rotation();
    let mut add = |form| found.push(Primitive { style, subject, form });
    for shape in body.shapes().iter().filter_map(|&id| world.shape(id)) {
        // What collision detection sees, so that a picture cannot hide a fault of the pose.
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

fn add_contact(contact: &ContactView<'_>, touching_distance: Fx, layers: Layers, found: &mut Vec<Primitive>) {
    let subject = Subject::Contact(contact.shape_a, contact.shape_b);
    let manifold = contact.manifold;
    for &ManifoldPoint { anchor, separation, .. } in manifold.points() {
        let place = manifold.origin + anchor.widen();
        let touching = widen(separation) <= touching_distance;
        let proximity = if touching { Proximity::Touching } else { Proximity::Speculative };
        if layers.contact_normals {
            let form = Form::Direction { from: place, direction: manifold.normal };
            found.push(Primitive { style: Style::ContactNormal(proximity), subject, form });
        }
        if layers.contact_points {
            found.push(Primitive {
                style: Style::ContactPoint(proximity),
                subject,
                form: Form::Point(place),
            });
        }
    }
}

fn add_joint(world: &World, id: JointId, found: &mut Vec<Primitive>) {
    let (Some(joint), Some((anchor_a, anchor_b))) = (world.joint(id), world.joint_anchors(id)) else {
        return;
    };
    let mut add = |style, form| found.push(Primitive { style, subject: Subject::Joint(id), form });
    let (body_a, body_b) = joint.def().bodies();
    for (body, anchor) in [(body_a, anchor_a), (body_b, anchor_b)] {
        // Where the centre of a fixed body is means nothing: often all of them share one body, and their arms
        // would meet in a point at the other end of the scene.
        if let Some(body) = world.body(body).filter(|body| body.kind() != BodyKind::Fixed) {
            add(Style::JointArm, Form::Line { from: anchor, to: body.centre_of_mass() });
        }
        add(Style::JointAnchor, Form::Point(anchor));
    }
    add(Style::JointGap, Form::Line { from: anchor_a, to: anchor_b });
}
