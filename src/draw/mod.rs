//! Pictures of a world: plain primitives for any renderer, and an SVG of a tick.
//!
//! [`primitives`] describes the visible objects in world coordinates, with a meaning ([`Style`]) instead of a colour,
//! so that all renderers show the same picture. [`svg`] is one of these renderers.
//!
//! A picture shows the contacts that the last tick solved. The tick found them before the bodies moved, so the contacts
//! of a fast body lag behind its outline by one tick. After [`World::restore`] or [`World::from_bytes`], there are no
//! contacts until the next tick.
//!
//! Primitives and SVG use no floating-point numbers: the same world gives the same text on every machine, so that
//! pictures can be compared with `diff`.
//!
//! ```
//! use lockstep2d::{body::{BodyDef, Geometry, ShapeDef}, fx, world::World};
//! use lockstep2d::draw::{self, Form, Layers, View};
//!
//! let mut world = World::default();
//! let ball = ShapeDef::new(Geometry::circle(fx!(0.5))?);
//! world.spawn(&BodyDef::dynamic().position((fx!(0), fx!(10))), &[ball])?;
//! let outlines = draw::primitives(&world, Layers { outlines: true, ..Layers::NONE });
//! // The circle, and a radius that shows how it is turned.
//! assert!(matches!(outlines[..], [
//!     draw::Primitive { form: Form::Circle { .. }, .. },
//!     draw::Primitive { form: Form::Line { .. }, .. },
//! ]));
//! assert!(draw::svg(&world, &View::default()).starts_with("<svg "));
//! # Ok::<(), lockstep2d::body::WorldError>(())
//! ```
//!
//! [`World::restore`]: crate::world::World::restore
//! [`World::from_bytes`]: crate::world::World::from_bytes

mod bar;
mod convert;
mod fit;
mod joint;
mod legend;
mod paint;
mod path;
mod primitive;
mod primitives;
mod screen;
mod svg;
mod view;

pub use bar::Bar;
pub use convert::to_f32;
pub use fit::fit;
pub use legend::Legend;
pub use paint::{Fill, PAPER, Paint};
pub use primitive::{ContactProximity, Form, Hue, Layers, Primitive, Style, Subject};
pub use primitives::{each_primitive, primitives};
pub use svg::svg;
pub use view::{Frame, View};
