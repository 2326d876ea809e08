//! [`Act`]: what a person does to a live world, with the pointer and with keys.

use lockstep2d::body::BodyId;
use lockstep2d::fx;
use lockstep2d::math::{Fx, Vec2};
use lockstep2d::world::Explosion;

/// What to spawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Form {
    /// A disc.
    #[default]
    Circle,
    /// A rectangle.
    Box,
    /// A convex polygon, another one each time.
    Polygon,
    /// A rod with round ends.
    Capsule,
}

impl Form {
    /// All of them, in the order in which a person goes through them.
    pub const ALL: [Form; 4] = [Form::Circle, Form::Box, Form::Polygon, Form::Capsule];

    /// What a person calls it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Form::Circle => "circle",
            Form::Box => "box",
            Form::Polygon => "polygon",
            Form::Capsule => "capsule",
        }
    }
}

/// A place that a person points at, in metres in the world.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Aim {
    /// Where.
    pub at: Vec2<Fx>,
    /// How far beside it a body may be that is meant, if there is none right there: a few pixels.
    pub within: Fx,
}

impl Aim {
    /// Exactly there.
    #[must_use]
    pub const fn at(at: Vec2<Fx>) -> Self {
        Aim { at, within: Fx::ZERO }
    }
}

/// What a person does to a live world. Places are in metres in the world.
///
/// Acts take effect in the next tick, in their order. One that makes no sense then, such as dragging nothing, does
/// nothing; neither does one that the world refuses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Act {
    /// Takes hold of the dynamic body there, if there is one. What was held before is let go.
    Grab(Aim),
    /// Pulls what is held towards a place, by the point at which it was grabbed.
    DragTo(Vec2<Fx>),
    /// Lets go; the body keeps its velocity, and so is thrown.
    Release,
    /// Adds a dynamic body in the middle of `at`, as large as the way from there `to` where the pointer was let go: a
    /// radius, half a width and half a height, or, of a capsule, its one end. With no way to speak of it has half a metre.
    Spawn {
        /// Which.
        form: Form,
        /// Its middle; of a capsule one end.
        at: Vec2<Fx>,
        /// Gives its size.
        to: Vec2<Fx>,
    },
    /// Removes the body there, of any kind.
    Delete(Aim),
    /// Sets gravity, in m/s².
    Gravity(Vec2<Fx>),
    /// Pushes everything near a place away from it. [`Act::explode`] has settings that suit most scenes.
    Explode(Explosion),
}

impl Act {
    /// An explosion at a place that throws a block of a metre and a kilogram at 10 m/s, and reaches 8 m far.
    #[must_use]
    pub const fn explode(at: Vec2<Fx>) -> Self {
        Act::Explode(Explosion { radius: fx!(4), falloff: fx!(4), ..Explosion::new(at, fx!(10)) })
    }
}

/// What the pointer holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Held {
    /// The body.
    pub body: BodyId,
    /// By which point, in the body's own frame, in metres.
    pub point: Vec2<Fx>,
    /// Where the pointer pulls it, in metres in the world.
    pub towards: Vec2<Fx>,
}

/// A world that one can act in.
pub trait Playground {
    /// Does something in the next tick. One may do several things before.
    ///
    /// If that tick has been played already, because one has gone back, it is played anew with the act in place of what
    /// was done in it, and what came after is dropped. Going to another tick drops what has not been done yet, and lets
    /// go of what is held.
    fn act(&mut self, act: Act);

    /// What the pointer holds now; `None` also between the act and the tick that carries it out.
    fn held(&self) -> Option<Held>;

    /// How many things have been asked for and not been done yet: while it is paused they wait.
    fn waiting(&self) -> usize;
}
