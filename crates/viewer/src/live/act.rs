//! [`Act`]: user actions in a live world.

use lockstep2d::body::BodyId;
use lockstep2d::fx;
use lockstep2d::math::{Fx, Vec2};
use lockstep2d::world::Explosion;

/// Form of a body to spawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Form {
    /// Circle.
    #[default]
    Circle,
    /// Rectangle.
    Box,
    /// Random convex polygon.
    Polygon,
    /// Capsule: a rod with round ends.
    Capsule,
}

impl Form {
    /// All forms, in the order in which the key `b` selects them.
    pub const ALL: [Form; 4] = [Form::Circle, Form::Box, Form::Polygon, Form::Capsule];

    /// Name for display.
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

/// Point at which an action of the user is aimed, in world coordinates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Aim {
    /// The point, in metres.
    pub at: Vec2<Fx>,
    /// Largest distance in metres from the point to a body that is picked. Used if no body contains the point.
    pub within: Fx,
}

impl Aim {
    /// Aims at exactly this point.
    #[must_use]
    pub const fn at(at: Vec2<Fx>) -> Self {
        Aim { at, within: Fx::ZERO }
    }
}

/// User action in a live world. Points are in metres, in world coordinates.
///
/// Acts take effect in the next tick, in the order of the calls. An act that finds no body or that the world refuses
/// has no effect.
///
/// ```
/// use lockstep2d::{body::BodyKind, fx, math::Vec2};
/// use lockstep2d_scenes::Scene;
/// use lockstep2d_viewer::{Source, live::{Act, Aim, Form, Held, Live, Playground}};
///
/// let mut live = Live::scene(Scene::find("box_stack").expect("a scene"), 0)?;
/// let place = Vec2::new(fx!(5), fx!(9));
/// live.act(Act::Spawn { form: Form::Circle, at: place, to: place });
/// live.seek(1)?;
/// // The body exists after one tick. It is grabbed at its position in that tick.
/// let (_, ball) = live.world().bodies().last().expect("the circle");
/// let at = ball.position();
/// assert_eq!(ball.kind(), BodyKind::Dynamic);
/// live.act(Act::Grab(Aim::at(at)));
/// live.seek(4)?;
/// let Some(Held { point, .. }) = live.held() else { panic!("the circle is held") };
/// assert_eq!(point, Vec2::ZERO, "by its centre");
/// fn throw(playground: &mut impl Playground) {
///     playground.act(Act::DragTo(Vec2::new(fx!(9), fx!(9))));
///     playground.act(Act::Release);
/// }
/// throw(&mut live);
/// assert_eq!(live.waiting(), 2);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Act {
    /// Grabs the dynamic body at this point. If another body is held, it is released first.
    Grab(Aim),
    /// Pulls the held body by its grabbed point towards this point.
    DragTo(Vec2<Fx>),
    /// Releases the held body, which keeps its velocity.
    Release,
    /// Adds a dynamic body. The vector from `at` to `to` gives the size: the radius of a circle or polygon, the half
    /// extents of a box, or the segment of a capsule. The size is at most 50 m. If the vector is shorter than 0.05 m,
    /// the size is 0.5 m.
    Spawn {
        /// Form of the body.
        form: Form,
        /// Centre of the body. For a capsule, one end of its segment.
        at: Vec2<Fx>,
        /// End of the drag.
        to: Vec2<Fx>,
    },
    /// Removes the body at this point, whatever its kind is.
    Delete(Aim),
    /// Sets gravity to this acceleration, in m/s².
    Gravity(Vec2<Fx>),
    /// Sets off an explosion, for example [`Act::explode`].
    Explode(Explosion),
}

impl Act {
    /// Explosion at `at` with a range of 8 m, and full strength within 4 m.
    #[must_use]
    pub const fn explode(at: Vec2<Fx>) -> Self {
        Act::Explode(Explosion { radius: fx!(4), falloff: fx!(4), ..Explosion::new(at, fx!(10)) })
    }
}

/// Body held by the pointer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Held {
    /// The body.
    pub body: BodyId,
    /// Grabbed point, in the body's frame, in metres.
    pub point: Vec2<Fx>,
    /// Target of the drag, in world coordinates, in metres.
    pub towards: Vec2<Fx>,
}

/// A world in which the user can act.
pub trait Playground {
    /// Queues an act for the next tick.
    ///
    /// If the source has sought to an earlier tick, an act that issues commands drops the later recorded ticks. The
    /// seek itself drops queued acts and releases the held body.
    fn act(&mut self, act: Act);

    /// Returns the held body. After [`Act::Grab`], the result is `None` until two ticks have been played.
    fn held(&self) -> Option<Held>;

    /// Number of queued acts.
    fn waiting(&self) -> usize;
}
