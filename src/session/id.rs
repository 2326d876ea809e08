use core::fmt;

/// Number of a tick: tick `t` leads from the state after `t` ticks to the state after `t + 1`.
pub type Tick = u32;

/// A tick that is never reached. It stands for the end of an open span, and for the end of a match while no end is
/// decided.
pub const NEVER: Tick = u32::MAX;

/// Incarnation of a peer: a random number chosen at the start of each process, unique in its match.
///
/// A restarted process must choose another number, because it does not remember the promises that the old process made
/// in votes on changes of the view.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct PeerId(pub u32);

impl fmt::Display for PeerId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:08x}", self.0)
    }
}

/// Identity of a participant that outlives its process: assigned by a lobby, or derived from a public key. A peer that
/// returns with its key gets its former seat, if that seat is free and the peer does not request another one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Key(pub u64);
