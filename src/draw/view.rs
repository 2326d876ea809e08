//! What a picture shows, and how large it is.

use alloc::string::String;

use super::primitive::Layers;
use crate::math::Aabb;

/// How to draw a picture.
///
/// ```
/// use lockstep2d::{draw::{Frame, View}, fx, math::{Aabb, Vec2}};
/// let corner = Aabb::new(Vec2::new(fx!(0), fx!(0)), Vec2::new(fx!(2), fx!(1)));
/// let view = View { frame: Frame::Window(corner), title: "the corner".into(), ..View::default() };
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct View {
    /// Width in pixels, 64 to 16384; what is outside of this range is moved to its border.
    pub width: u32,
    /// Height in pixels, legend included, 64 to 16384 as well.
    pub height: u32,
    /// Which part of the world to show.
    pub frame: Frame,
    /// What to draw.
    pub layers: Layers,
    /// Shown before the legend.
    pub title: String,
}

impl Default for View {
    /// 960 x 720 pixels of what is worth seeing, without a title.
    fn default() -> Self {
        View { width: 960, height: 720, frame: Frame::Fit, layers: Layers::default(), title: String::new() }
    }
}

/// Which part of the world a picture shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Frame {
    /// The window that [`fit`](super::fit()) finds.
    Fit,
    /// At least this window, in the middle. Windows narrower than 2 cm are shown as 2 cm.
    ///
    /// For several ticks of one scene give the same window to all.
    Window(Aabb),
}
