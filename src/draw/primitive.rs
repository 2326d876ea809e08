use alloc::string::String;
use alloc::vec::Vec;

use crate::body::{BodyId, JointId, ShapeId};
use crate::math::{Aabb, Fx, Unit, Vec2};

/// The kinds of objects to draw.
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
    /// Outlines in the colour of their island, whose bodies fall asleep together.
    pub islands: bool,
    /// Fat boxes, as stored in the broad phase.
    pub fat_boxes: bool,
    /// Boxes of the inner nodes of the broad phase.
    pub broad_phase: bool,
    /// Contact points, touching or speculative.
    pub contact_points: bool,
    /// Contact normals, drawn from the contact points.
    pub contact_normals: bool,
    /// Normal and friction forces at the contact points.
    pub contact_forces: bool,
    /// Contact points in the colours of the solver's graph colouring.
    pub solver_colours: bool,
    /// Enabled joints: their anchors, their errors, and lines to the bodies that they connect.
    pub joints: bool,
    /// Sizes of the joint errors, as text.
    pub joint_errors: bool,
    /// Centres of mass of bodies that can move.
    pub centres_of_mass: bool,
    /// Velocities of the centres of mass.
    pub velocities: bool,
    /// Ids and names of bodies, as text.
    pub ids: bool,
}

impl Layers {
    /// No layers.
    pub const NONE: Self = Self::each(false);

    /// All layers.
    pub const ALL: Self = Self::each(true);

    const fn each(shown: bool) -> Self {
        Layers {
            outlines: shown,
            islands: shown,
            fat_boxes: shown,
            broad_phase: shown,
            contact_points: shown,
            contact_normals: shown,
            contact_forces: shown,
            solver_colours: shown,
            joints: shown,
            joint_errors: shown,
            centres_of_mass: shown,
            velocities: shown,
            ids: shown,
        }
    }

    /// Each layer with its field name, in the order in which a menu lists the layers.
    #[must_use]
    pub fn named(&mut self) -> [(&'static str, &mut bool); 13] {
        [
            ("outlines", &mut self.outlines),
            ("islands", &mut self.islands),
            ("broad_phase", &mut self.broad_phase),
            ("fat_boxes", &mut self.fat_boxes),
            ("joints", &mut self.joints),
            ("joint_errors", &mut self.joint_errors),
            ("contact_normals", &mut self.contact_normals),
            ("contact_points", &mut self.contact_points),
            ("contact_forces", &mut self.contact_forces),
            ("solver_colours", &mut self.solver_colours),
            ("centres_of_mass", &mut self.centres_of_mass),
            ("velocities", &mut self.velocities),
            ("ids", &mut self.ids),
        ]
    }

    /// Splits the layers into groups in painting order: each group is painted over the one before it.
    #[must_use]
    pub fn stacked(self) -> [Layers; 5] {
        let Layers { outlines, islands, broad_phase, fat_boxes, joints, joint_errors, .. } = self;
        let Layers { contact_normals, contact_points, contact_forces, solver_colours, .. } = self;
        let Layers { velocities, centres_of_mass, ids, .. } = self;
        [
            Layers { outlines, ..Self::NONE },
            Layers { islands, broad_phase, fat_boxes, ..Self::NONE },
            Layers { contact_normals, contact_points, contact_forces, solver_colours, ..Self::NONE },
            Layers { joints, joint_errors, ..Self::NONE },
            Layers { velocities, centres_of_mass, ids, ..Self::NONE },
        ]
    }
}

impl Default for Layers {
    /// Outlines, fat boxes, contact points and normals, joints and centres of mass.
    fn default() -> Self {
        Layers {
            outlines: true,
            fat_boxes: true,
            contact_points: true,
            contact_normals: true,
            joints: true,
            centres_of_mass: true,
            ..Self::NONE
        }
    }
}

/// A primitive to draw.
///
/// ```
/// use lockstep2d::draw::{Form, Layers, Primitive, Subject, primitives};
/// # use lockstep2d::{body::{BodyDef, Geometry, ShapeDef}, fx, math::Vec2, world::World};
/// # let mut world = World::default();
/// world.spawn(&BodyDef::dynamic(), &[ShapeDef::new(Geometry::circle(fx!(1))?)])?;
/// // A game's renderer, which supports three forms and highlights the body that was clicked.
/// let clicked = world.overlap_point(Vec2::ZERO, Default::default());
/// let clicked = clicked.first().and_then(|&shape| Some(world.shape(shape)?.body()));
/// let mut highlighted = 0;
/// for Primitive { form, subject, .. } in primitives(&world, Layers { outlines: true, ..Layers::NONE }) {
///     let is_clicked = matches!(subject, Subject::Body(body) if clicked == Some(body));
///     match form {
///         Form::Circle { .. } | Form::Line { .. } | Form::Polygon { .. } => highlighted += i32::from(is_clicked),
///         _ => {}
///     }
/// }
/// assert_eq!(highlighted, 2, "the circle and its radius");
/// # Ok::<(), lockstep2d::body::WorldError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Primitive {
    /// Meaning of the primitive. The renderer chooses the colours.
    pub style: Style,
    /// The object that the primitive belongs to, for picking.
    pub subject: Subject,
    /// Geometry of the primitive.
    pub form: Form,
}

/// Meaning of a primitive. Styles are in painting order: small marks are on top.
///
/// ```
/// use lockstep2d::draw::{ContactProximity, Layers, Style, primitives};
/// # use lockstep2d::{body::{BodyDef, Polygon, ShapeDef}, fx, world::World};
/// # let mut world = World::default();
/// # let square = ShapeDef::new(Polygon::square(fx!(0.5))?);
/// # world.spawn(&BodyDef::fixed().position((fx!(0), fx!(-0.5))), &[square])?;
/// # world.spawn(&BodyDef::dynamic().position((fx!(0), fx!(0.5))), &[square])?;
/// // A box on the ground: both corners touch.
/// world.step();
/// let points = primitives(&world, Layers { contact_points: true, ..Layers::NONE });
/// let touching = Style::ContactPoint(ContactProximity::Touching);
/// assert_eq!(points.iter().filter(|point| point.style == touching).count(), 2);
/// # Ok::<(), lockstep2d::body::WorldError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Style {
    /// The outline of a sensor, on a body of any kind.
    Sensor,
    /// The outline of a shape of a fixed body, or the radius that shows the rotation of a circle.
    Fixed,
    /// As [`Style::Fixed`], for a kinematic body.
    Kinematic,
    /// As [`Style::Fixed`], for a dynamic body that is awake.
    Dynamic,
    /// As [`Style::Fixed`], for a dynamic body that is asleep.
    Asleep,
    /// The outline of a shape in the colour of its island.
    Island(Hue),
    /// The box of an inner node of the broad phase.
    BroadPhase,
    /// The fat box of a shape in the broad phase.
    FatBox,
    /// A line from a joint's anchor to the centre of mass of the body, or the part of the distance between the anchors
    /// that the joint allows: a rod, a spring, the travel of a slider, a rope.
    JointArm,
    /// The displacement of the centre of mass in a tenth of a second at constant velocity.
    Velocity,
    /// The centre of mass of a body.
    CentreOfMass,
    /// An anchor of a joint.
    JointAnchor,
    /// The part of the distance between the anchors that violates the joint:
    /// [`World::joint_error`](crate::world::World::joint_error).
    JointGap,
    /// The size of the joint error, as text.
    JointError,
    /// The direction in which a contact pushes its shape B.
    ContactNormal(ContactProximity),
    /// A contact point.
    ContactPoint(ContactProximity),
    /// The normal force on shape B at a contact point, as a line. The length is `0.2 m sqrt(a / 10 m/s²)`, where `a` is
    /// the relative acceleration that the force gives to the centres of mass: 0.2 m for a ball at rest under a gravity
    /// of 10 m/s². The square root keeps the lines of large forces inside the picture.
    ContactForce,
    /// The friction force at a contact point, to the same scale.
    ContactFriction,
    /// A contact point, in the colour of its group in the solver's graph colouring.
    SolverGroup(Hue),
    /// A contact point without a solver colour, because its bodies have too many contacts. The solver solves such
    /// points one by one.
    SolverOverflow,
    /// The id of a body and its name, if it has one.
    Id,
}

/// One of [`Hue::COUNT`] distinguishable colours, for numbered objects such as islands.
///
/// ```
/// use lockstep2d::draw::Hue;
/// // A colour for each team, as long as there are enough colours.
/// let palette = [0x1f77b4, 0xff7f0e, 0x2ca02c, 0xd62728];
/// let colour = |team: usize| palette[usize::from(Hue::of(team).index()) % palette.len()];
/// assert_ne!(colour(0), colour(1));
/// assert_eq!(Hue::of(0), Hue::of(usize::from(Hue::COUNT)));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Hue(u8);

impl Hue {
    /// Number of hues.
    pub const COUNT: u8 = 12;

    /// The hue of a number. Hues repeat: 0 and 12 have the same hue.
    #[must_use]
    pub const fn of(number: usize) -> Self {
        #[expect(clippy::cast_possible_truncation, reason = "less than 12")]
        Hue((number % Self::COUNT as usize) as u8)
    }

    /// Index below [`Hue::COUNT`].
    #[must_use]
    pub const fn index(self) -> u8 {
        self.0
    }
}

/// Whether a contact point is touching or only speculative.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum ContactProximity {
    /// Further apart than the touching distance: a speculative contact, which prevents fast shapes from tunnelling.
    Speculative,
    /// At most [`Config::touching_distance`](crate::world::Config::touching_distance) apart, the distance at which
    /// contact events begin.
    Touching,
}

/// The object that a primitive belongs to.
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
    /// The world as a whole.
    World,
}

/// Geometry of a primitive, in world coordinates in metres.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Form {
    /// A mark whose size and shape the renderer chooses.
    Point(Vec2<Fx>),
    /// A straight line.
    Line {
        /// One end.
        from: Vec2<Fx>,
        /// The other end.
        to: Vec2<Fx>,
    },
    /// A line whose length the renderer chooses.
    Direction {
        /// Start.
        from: Vec2<Fx>,
        /// Unit vector along the line.
        direction: Vec2<Unit>,
    },
    /// Text beside a position. The renderer chooses its size.
    Label {
        /// Position.
        at: Vec2<Fx>,
        /// Text.
        text: String,
    },
    /// An axis-aligned box.
    Box(Aabb),
    /// A circle.
    Circle {
        /// Centre.
        centre: Vec2<Fx>,
        /// Radius.
        radius: Fx,
    },
    /// A convex polygon, or a line with a radius if there are two vertices.
    Polygon {
        /// Vertices in counter-clockwise order.
        vertices: Vec<Vec2<Fx>>,
        /// Distance of the outline from the edges, with round corners around the vertices.
        radius: Fx,
    },
}
