//! What a picture is made of, as plain data.

use alloc::string::String;
use alloc::vec::Vec;

use crate::body::{BodyId, JointId, ShapeId};
use crate::math::{Aabb, Fx, Unit, Vec2};

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
    /// Bodies that can only fall asleep together, in one colour.
    pub islands: bool,
    /// The fat boxes that the broad phase sees.
    pub fat_boxes: bool,
    /// The boxes in which the broad phase has put those, and those in turn.
    pub broad_phase: bool,
    /// Where shapes touch or are about to.
    pub contact_points: bool,
    /// In which direction they push, from the contact points.
    pub contact_normals: bool,
    /// How hard they push and rub.
    pub contact_forces: bool,
    /// Contact points in the colours of the groups in which they are solved.
    pub solver_colours: bool,
    /// Anchors of joints, the gap between them, and lines to the bodies that they hold.
    pub joints: bool,
    /// How wide the gaps of joints are, as text.
    pub joint_errors: bool,
    /// Centres of mass of the bodies that can move.
    pub centres_of_mass: bool,
    /// Velocities of the centres of mass.
    pub velocities: bool,
    /// Ids of bodies, as text.
    pub ids: bool,
}

impl Layers {
    /// Nothing.
    pub const NONE: Self = Self::each(false);

    /// Everything.
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

    /// Every layer by the name of its field, in the order in which they lie on each other.
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

    /// What is shown, in parts that lie on each other: within one, nothing hides anything.
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
    /// Outlines, fat boxes, contacts with their normals, joints and centres of mass: what nearly every fault shows in.
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

/// What a primitive means. Styles are in the order in which they are painted: what is small and explains the rest lies
/// on top.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Style {
    /// The outline of a shape of a fixed body, or the radius that shows how a circle is turned.
    Fixed,
    /// The same of a kinematic body.
    Kinematic,
    /// The same of a dynamic body that is awake.
    Dynamic,
    /// The same of a dynamic body that sleeps.
    Asleep,
    /// The outline of a shape again, in the colour of its island.
    Island(Hue),
    /// A box of the broad phase around others; of the smallest depth around all.
    BroadPhase,
    /// The box that the broad phase sees of a shape.
    FatBox,
    /// From a joint's anchor to the centre of mass of the body that it holds there.
    JointArm,
    /// From the centre of mass to where the body would be in a tenth of a second.
    Velocity,
    /// The centre of mass of a body.
    CentreOfMass,
    /// An anchor of a joint.
    JointAnchor,
    /// From one anchor of a joint to the other, where both should be in one place.
    JointGap,
    /// How far the anchors of a joint are apart.
    JointError,
    /// The direction in which a contact pushes its shape B.
    ContactNormal(Proximity),
    /// A contact point.
    ContactPoint(Proximity),
    /// How hard a contact point pushes shape B. The length is 0.2 m times the square root of the acceleration that it
    /// gives in units of 10 m/s²: 0.2 m under a box at rest, and not 20 m under a hundred of them.
    ContactForce,
    /// How hard it rubs, to the same scale.
    ContactFriction,
    /// A contact point, in the colour of the group in which it is solved.
    SolverGroup(Hue),
    /// A contact point that is solved by itself, since its bodies have too many contacts.
    SolverOverflow,
    /// The id of a body.
    Id,
}

/// One of [`Hue::COUNT`] colours that can be told apart, for what has a number and no meaning.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Hue(u8);

impl Hue {
    /// How many there are.
    pub const COUNT: u8 = 12;

    /// The colour of a number; those of 0 and of 12 are the same.
    #[must_use]
    pub const fn of(number: usize) -> Self {
        #[expect(clippy::cast_possible_truncation, reason = "less than 12")]
        Hue((number % Self::COUNT as usize) as u8)
    }

    /// Which one it is, less than [`Hue::COUNT`].
    #[must_use]
    pub const fn index(self) -> u8 {
        self.0
    }
}

/// Whether a contact point pushes yet.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Proximity {
    /// Further apart: it is there so that fast shapes do not pass through each other.
    Speculative,
    /// No further apart than a quarter of the speculative distance, as contact events have it.
    Touching,
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
    /// Nothing in particular.
    World,
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
    /// Text of the renderer's size, beside a place.
    Label {
        /// Where it belongs.
        at: Vec2<Fx>,
        /// What it says.
        text: String,
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
