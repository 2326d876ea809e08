//! Identities of participants: [`PeerId`] and [`Key`].

use core::fmt;

/// Number of a tick: tick `t` leads from the state after `t` ticks to the state after `t + 1`.
pub type Tick = u32;

/// A tick that is never reached: the end of a span whose owner still plays, and of a match whose end is not decided.
pub const NEVER: Tick = u32::MAX;

/// Incarnation of a peer: a random number that a process chooses when it starts, unique in its match.
///
/// A process that restarts must choose another number, because it does not remember the promises that were made under
/// the old one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct PeerId(pub u32);

impl fmt::Display for PeerId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:08x}", self.0)
    }
}

/// Identity of a participant that outlives its process: the lobby assigns it, or the game derives it from a public key.
/// A peer that returns with the same key, and asks for no other seat, gets its former seat if that is still free.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Key(pub u64);
