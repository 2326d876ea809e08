//! [`Contacts`]: the peers that a peer without a vote can ask for the match if its contact falls silent.
//!
//! A spectator receives the match through its contact, the peer through which it joined. If recent rows (status
//! records) of a majority are missing, the spectator starts the join handshake with other peers, one after another.
//! When a peer has accepted it, the spectator continues at its current tick.

use alloc::vec::Vec;

use super::address::Address;
use super::id::PeerId;

/// Time in microseconds without fresh rows of a majority, after which this peer asks other peers.
const SILENCE: u64 = 500_000;
/// Time for which this peer tries to reach one contact before it asks the next one, in microseconds.
const ASK_TIME: u64 = 1_500_000;
/// Time between two hello packets, in microseconds.
const HELLO_INTERVAL: u64 = 200_000;
const CONTACTS_MAX: usize = 128;

#[derive(Clone, Copy, Debug)]
pub(super) struct PendingContact {
    id: PeerId,
    pub(super) address: Address,
    pub(super) nonce: u64,
    pub(super) cookie: u64,
    next_at: u64,
    until: u64,
}

#[derive(Debug, Default)]
pub(super) struct Contacts {
    list: Vec<(PeerId, Address)>,
    turn: usize,
    silent_since: Option<u64>,
    asked: Option<PendingContact>,
}

impl Contacts {
    pub(super) fn note(&mut self, id: PeerId, address: Address) {
        match self.list.iter_mut().find(|(known, _)| *known == id) {
            Some(known) => known.1 = address,
            None => {
                if self.list.len() == CONTACTS_MAX {
                    self.list.remove(0);
                }
                self.list.push((id, address));
            }
        }
    }

    /// Returns the contact to send a hello to, if one is due. `is_silent` is true if recent rows of a majority are
    /// missing. `nonce` returns the nonce of a new handshake.
    pub(super) fn update(
        &mut self,
        now: u64,
        is_silent: bool,
        nonce: impl Fn(&Address) -> u64,
    ) -> Option<PendingContact> {
        if !is_silent {
            (self.silent_since, self.asked) = (None, None);
            return None;
        }
        let since = *self.silent_since.get_or_insert(now);
        if now < since.saturating_add(SILENCE) {
            return None;
        }
        if self.asked.is_none_or(|asked| now >= asked.until) {
            let (id, address) = *self.list.get(self.turn.checked_rem(self.list.len())?)?;
            self.turn = self.turn.wrapping_add(1);
            let until = now.saturating_add(ASK_TIME);
            self.asked =
                Some(PendingContact { id, address, nonce: nonce(&address), cookie: 0, next_at: now, until });
        }
        let asked = self.asked.as_mut().filter(|asked| now >= asked.next_at)?;
        asked.next_at = now.saturating_add(HELLO_INTERVAL);
        Some(*asked)
    }

    /// Handles a challenge. Returns whether it answers this peer's hello and the sender is the expected peer; then the
    /// address of this contact is confirmed. The check of the sender is needed because another process, in another
    /// match, may now use the address.
    pub(super) fn take_challenge(&mut self, nonce: u64, cookie: u64, sender: PeerId) -> bool {
        let is_answer = |asked: &&mut PendingContact| asked.nonce == nonce && asked.id == sender;
        let Some(asked) = self.asked.as_mut().filter(is_answer) else { return false };
        if asked.cookie != cookie {
            (asked.cookie, asked.next_at) = (cookie, 0);
        }
        true
    }

    /// Handles a refusal: the next update asks another peer.
    pub(super) fn take_refusal(&mut self, nonce: u64) {
        if self.asked.is_some_and(|asked| asked.nonce == nonce) {
            self.asked = None;
        }
    }
}
