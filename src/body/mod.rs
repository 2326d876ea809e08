//! Bodies, shapes, geometry, materials and filters, addressed by generational handles.

mod area;
mod arena;
#[expect(clippy::module_inception, reason = "the file that holds `Body`")]
mod body;
mod body_def;
mod chain;
mod error;
mod event_switches;
mod filter;
mod geometry;
mod mass;
mod material;
mod name;
mod polygon;
mod rest_ticks;
mod settings;
mod shape;
mod shape_fields;
mod shape_list;
mod turning;

pub use area::{Area, Attraction, Falloff};
pub(crate) use arena::{Arena, ArenaRange, Handle, SharedArena};
pub use arena::{BodyId, IslandId, JointId, ShapeId};
pub use body::Body;
pub(crate) use body::{Pose, SPEED_MAX};
pub(crate) use body_def::check_position;
pub use body_def::{BodyDef, BodyKind};
pub use chain::Chain;
pub use error::{GeometryError, WorldError};
pub use event_switches::EventSwitches;
pub(crate) use filter::CollisionClass;
pub use filter::Filter;
pub use geometry::{Geometry, Sides};
pub(crate) use mass::area_of;
pub use mass::{MassProperties, MassSource};
pub use material::{Material, Mixing};
pub use name::Name;
pub(crate) use name::label;
pub use polygon::{POLYGON_VERTICES_MAX, Polygon, SHAPE_EXTENT_MAX};
pub(crate) use rest_ticks::RestTicks;
pub use settings::{BodySettings, Continuous, MotionLocks};
pub use shape::{DENSITY_MAX, REACH_MAX, SHAPES_PER_BODY_MAX, Shape, ShapeDef, WORLD_EXTENT_MAX};
