//! [`Engine`]: the interface to the engines that are measured.

/// Number of saves that are kept.
pub const DEPTH: usize = 9;

/// An engine that keeps saves of its last ticks.
pub trait Engine {
    /// Plays a tick.
    fn step(&mut self);

    /// Saves the state after the tick. Drops the oldest save if there are more than [`DEPTH`].
    fn save(&mut self);

    /// Returns to the oldest save that is kept, and drops the later saves.
    fn load(&mut self);

    /// The state for comparison after a rollback: bits of all positions, rotations and velocities, or a hash.
    fn state(&mut self) -> Vec<u64>;
}
