mod driver;
mod wire;
pub use driver::{Divergence, Driver, DriverError};
pub use wire::{Address, Echo, GgrsConfig, NetGame, Wire};
