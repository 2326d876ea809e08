//! The files that a peer writes: the replay of the match, and the report of a desync.

use alloc::vec::Vec;

use super::error::PeerError;
use super::event::{PeerDesync, PeerEnd};
use super::participant::Peer;
use super::transport::Transport;
use crate::lockstep::Game;

impl<G: Game, T: Transport> Peer<G, T> {
    /// This peer's report of a desync, as the bytes of a file, for [`compare`](crate::report::compare()).
    ///
    /// # Errors
    /// [`PeerError`] if the states for the report are not kept.
    pub fn report(&mut self, desync: &PeerDesync) -> Result<Vec<u8>, PeerError> {
        Ok(self.simulation.report(desync, self.endpoint.session())?.to_bytes())
    }

    /// Takes the finished bytes of the replay, to be appended to its file. A peer that joined after the first tick has
    /// no replay.
    #[must_use]
    pub fn take_replay(&mut self) -> Vec<u8> {
        // Before the initial state has arrived, it is unknown whether this peer has a replay.
        if self.endpoint.session().is_some() { self.simulation.take_replay() } else { Vec::new() }
    }

    /// Returns a complete replay of the ticks that are final so far, including the bytes that have been taken.
    /// Recording continues. Empty if this peer has no replay.
    ///
    /// # Errors
    /// [`PeerError`] if the state after the last final tick is not kept, or the replay cannot be finished.
    pub fn replay_so_far(&mut self) -> Result<Vec<u8>, PeerError> {
        if self.endpoint.session().is_some() { self.simulation.replay_so_far() } else { Ok(Vec::new()) }
    }

    /// Ends the replay after the last final tick, and returns the rest of the replay and the game. First leave or end
    /// the match, and call [`update`](Peer::update) until [`Status::Closed`](crate::session::Status::Closed).
    ///
    /// # Errors
    /// [`PeerError`] if the replay cannot be finished.
    pub fn finish(self) -> Result<PeerEnd<G>, PeerError> {
        let ticks = self.simulation.committed;
        let (game, replay) = self.simulation.finish()?;
        Ok(PeerEnd { ticks, game, replay })
    }
}
