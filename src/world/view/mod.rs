//! Read-only views of a world for games and tools: contacts, joints and islands.

mod contacts;
mod islands;
mod joints;

pub use contacts::{ContactForce, ContactView, SolverColour};
