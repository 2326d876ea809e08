//! Pictures of a world: a list of what to draw, in pixels and colours, for any renderer.
//!
//! `lockstep2d::draw` says what there is to see and what it means; here it gets a place on a screen ([`Camera`]), a
//! colour ([`paint`]), and becomes polygons, lines and text ([`DrawList`]). A window, a web page and a picture file show
//! the same list.
//!
//! Floating-point numbers are used from here on: nothing that is drawn flows back into a simulation.
#![expect(clippy::disallowed_types, reason = "floats are what screens take")]

mod camera;
mod colour;
#[cfg(feature = "files")]
mod files;
mod glyphs;
mod list;
mod page;
mod paint;
#[cfg(feature = "raster")]
mod raster;
mod text;

pub use camera::Camera;
pub use colour::Colour;
#[cfg(feature = "files")]
pub use files::{Animation, Pace};
pub use glyphs::{GLYPH_HEIGHT, GLYPH_WIDTH, Glyph, glyph};
pub use list::{DrawList, Item, Points, Text};
pub use page::page;
pub use paint::{Brush, paint, world};
#[cfg(feature = "raster")]
pub use raster::{Image, SIDE_MAX, raster};
pub use text::{CELL_HEIGHT, CELL_WIDTH, width_of};
