//! Play of any game: people at one keyboard and bots ([`LocalMatch`]), or over a network ([`Online`]).

mod controls;
mod local;
mod online;
mod player;
mod presentation;

pub use controls::Controls;
pub use local::LocalMatch;
pub use online::Online;
pub use player::{Bot, Player};
pub(crate) use presentation::{Presentation, listed};
