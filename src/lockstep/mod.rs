//! What makes a simulation a lockstep game: [`Game`], the seam that every tool is generic over.

mod game;

pub use game::{Game, RulesId, SetupError};
