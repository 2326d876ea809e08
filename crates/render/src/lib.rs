//! Renders a world into a draw list of pixels and colours, for any renderer.
//!
//! `lockstep2d::draw` produces primitives. This crate places them on the screen ([`Camera`]), gives them a colour
//! ([`paint`]), and turns them into polygons, lines and text ([`DrawList`]). It uses floats, which never flow back into
//! a simulation.
#![expect(clippy::disallowed_types, reason = "drawing uses floats")]

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
pub use paint::{Brush, filled, paint, world};
#[cfg(feature = "raster")]
pub use raster::{Image, SIDE_MAX, raster};
pub use text::{CELL_HEIGHT, CELL_WIDTH, width_of};
