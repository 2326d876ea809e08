//! The shove game for people: two at one keyboard ([`Netplay`]), or over a network ([`Online`]).

mod decorate;
mod keys;
mod local;
#[cfg(not(target_arch = "wasm32"))]
mod online;

pub use decorate::{SEAT_COLOURS, decorate};
pub use keys::{Keys, Side};
pub use local::{Chair, Netplay};
#[cfg(not(target_arch = "wasm32"))]
pub use online::Online;
