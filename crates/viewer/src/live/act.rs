//! [`Act`]: user actions in a live world, with the pointer and with keys.

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
    /// Random convex polygon, a new one for each spawn.
    Polygon,
    /// Capsule: a rod with round ends.
    Capsule,
}

impl Form {
    /// All forms, in the order in which the key `b` steps through them.
    pub const ALL: [Form; 4] = [Form::Circle, Form::Box, Form::Polygon, Form::Capsule];

    /// Returns the name for display.
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

/// Point that the user points at, in metres in world coordinates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Aim {
    /// The point.
    pub at: Vec2<Fx>,
    /// Largest distance of a body that is picked if none contains the point, in metres: a few pixels on the screen.
    pub within: Fx,
}

impl Aim {
    /// Aims at exactly this point.
    #[must_use]
    pub const fn at(at: Vec2<Fx>) -> Self {
        Aim { at, within: Fx::ZERO }
    }
}

/// User action in a live world. Points are in metres in world coordinates.
///
/// Acts take effect in the next tick, in their order. An act has no effect if it makes no sense in that tick, such as
/// dragging without a grabbed body, or if the world refuses it.
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
    /// Grabs the dynamic body at this point, if there is one. A body that was held before is released.
    Grab(Aim),
    /// Pulls the held body towards a point, by the point at which it was grabbed.
    DragTo(Vec2<Fx>),
    /// Releases the held body, which keeps its velocity, so that it can be thrown.
    Release,
    /// Adds a dynamic body. The drag from `at` to `to` gives the radius of a circle or polygon, half the width and
    /// half the height of a box, or the two ends of a capsule's segment. Sizes are limited to 50 m. A drag shorter than
    /// 0.05 m gives the default size of 0.5 m.
    Spawn {
        /// Form of the body.
        form: Form,
        /// Centre of the body; for a capsule with a longer drag, one end of its segment.
        at: Vec2<Fx>,
        /// End of the drag.
        to: Vec2<Fx>,
    },
    /// Removes the body at this point, of any kind.
    Delete(Aim),
    /// Sets gravity, in m/s².
    Gravity(Vec2<Fx>),
    /// Sets off an explosion. [`Act::explode`] has settings that suit most scenes.
    Explode(Explosion),
}

impl Act {
    /// Explosion at a point with a range of 8 m. Up to 4 m away it gives a resting block of 1 kg and 1 m width a speed
    /// of 10 m/s, beyond that a lower speed.
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
    /// Point at which the body was grabbed, in the body's frame, in metres.
    pub point: Vec2<Fx>,
    /// Target point of the pointer, in world coordinates, in metres.
    pub towards: Vec2<Fx>,
}

/// World that the user can act in.
pub trait Playground {
    /// Queues an act for the next tick. Several acts may be queued.
    ///
    /// If the next tick is already recorded, because the user went back, and the queued acts issue commands, it is
    /// played again with these acts in place of the recorded ones, and all later ticks are dropped. A seek to an
    /// earlier tick drops queued acts and releases the held body.
    fn act(&mut self, act: Act);

    /// Returns the held body; `None` also before the second tick after the grab, which attaches the body to the
    /// pointer.
    fn held(&self) -> Option<Held>;

    /// Number of queued acts. Acts remain queued while the world is paused.
    fn waiting(&self) -> usize;
}
