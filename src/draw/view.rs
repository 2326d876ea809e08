use alloc::string::String;

use super::primitive::Layers;
use crate::math::Aabb;

/// Options of a picture.
///
/// ```
/// use lockstep2d::{draw::{Frame, View}, fx, math::{Aabb, Vec2}};
/// let corner = Aabb::new(Vec2::new(fx!(0), fx!(0)), Vec2::new(fx!(2), fx!(1)));
/// let view = View { frame: Frame::Window(corner), title: "the corner".into(), ..View::default() };
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct View {
    /// Width in pixels, clamped to `64..=16384`.
    pub width: u32,
    /// Height in pixels, including the legend, clamped to `64..=16384`.
    pub height: u32,
    /// The part of the world to show.
    pub frame: Frame,
    /// The layers to draw.
    pub layers: Layers,
    /// Title, shown before the legend.
    pub title: String,
}

impl Default for View {
    /// 960 x 720 pixels, with [`Frame::Fit`] and without a title.
    fn default() -> Self {
        View { width: 960, height: 720, frame: Frame::Fit, layers: Layers::default(), title: String::new() }
    }
}

/// The part of the world that a picture shows.
///
/// ```
/// use lockstep2d::draw::{Frame, View, fit, svg};
/// # use lockstep2d::{body::{BodyDef, Geometry, ShapeDef}, fx, world::World};
/// # let mut world = World::default();
/// # world.spawn(&BodyDef::dynamic(), &[ShapeDef::new(Geometry::circle(fx!(1))?)])?;
/// // The later pictures use the window of the first one.
/// let camera = View { frame: Frame::Window(fit(&world)), ..View::default() };
/// assert_eq!(svg(&world, &camera), svg(&world, &View::default()));
/// world.step();
/// assert_ne!(svg(&world, &camera), svg(&world, &View { frame: Frame::Fit, ..camera.clone() }));
/// # Ok::<(), lockstep2d::body::WorldError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Frame {
    /// The window chosen by [`fit`](super::fit()).
    Fit,
    /// This window, centred. If the picture has another aspect ratio, it shows more of the world in one direction.
    /// Sides shorter than 2 cm are extended to 2 cm.
    Window(Aabb),
}
