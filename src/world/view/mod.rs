//! Read-only views of a world for games and tools: contacts, joints, islands, the surroundings of a body, and the cost
//! of a tick.

mod contacts;
mod islands;
mod joints;
mod neighbours;
mod work;

pub use contacts::{ContactForce, ContactView, SolverColour};
pub(crate) use work::AddedWork;
