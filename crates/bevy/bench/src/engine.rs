//! [`Engine`]: the interface to the engines that are measured.

/// Number of saves that an engine keeps.
pub const DEPTH: usize = 9;

/// An engine that keeps saves of its last ticks.
pub trait Engine {
    /// Plays a tick.
    fn step(&mut self);

    /// Saves the state after the tick. If there are then more than [`DEPTH`] saves, drops the oldest one.
    fn save(&mut self);

    /// Loads the oldest save, and drops the later saves.
    fn load(&mut self);

    /// State to compare after a rollback: bits of positions, rotations and velocities, or a hash.
    fn state(&mut self) -> Vec<u64>;
}
