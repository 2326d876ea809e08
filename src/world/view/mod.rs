//! Read-only views of a world for games and tools.

mod contacts;
mod islands;
mod joints;
mod neighbours;
mod work;

pub use contacts::{ContactForce, ContactView, SolverColour};
pub(crate) use work::AddedWork;
