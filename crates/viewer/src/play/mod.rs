//! Play of any game: by people and bots at one computer ([`LocalMatch`]), or over a network ([`Online`]).

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
