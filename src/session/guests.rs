//! [`Guests`]: peers that join the match through this peer, and the uploads of states to them. A guest is removed when
//! its first row ([`Row`](super::row::Row)) arrives, because it then takes part in the match, or when it stops sending
//! requests. A peer becomes a guest only after the handshake has confirmed its address.

use alloc::sync::Arc;
use alloc::vec::Vec;

use super::address::Address;
use super::bytes::Write;
use super::congestion::{BURST, RATE_MAX};
use super::id::{Key, PeerId};
use super::join_packet::{JoinPacket, RefusalReason};
use super::siphash::Secret;
use super::state::Session;
use super::transfer::{Pinned, Upload};

/// Maximum number of peers that join through one contact (the peer that they ask) at a time.
pub const GUESTS_MAX: usize = 64;
/// Period of the cookies of the handshake, in microseconds. A cookie is valid in the period in which it is issued and
/// in the next one.
const COOKIE_LIFE: u64 = 15_000_000;
/// Time without a request after which a guest is removed, in microseconds.
const GUEST_PATIENCE: u64 = 5_000_000;
/// Time between two announcements of a state ([`JoinPacket::Welcome`]) to a guest, in microseconds. The announcements
/// end when the guest requests chunks.
const WELCOME_INTERVAL: u64 = 200_000;

#[derive(Debug)]
struct Guest {
    id: PeerId,
    nonce: u64,
    upload: Option<Upload>,
    asked: bool,
    welcome_at: u64,
    /// Time of the guest's last request. Until its upload starts, requests to join count; afterwards, requests for
    /// chunks.
    heard_at: u64,
}

#[derive(Debug, Default)]
pub(super) struct Guests {
    list: Vec<Guest>,
    budget: u64,
    budget_at: u64,
}

impl Guests {
    /// The two valid cookies of a joining peer: that of the current period, then that of the period before.
    pub(super) fn cookies(
        secret: Secret,
        now: u64,
        address: &Address,
        id: PeerId,
        key: Key,
        nonce: u64,
    ) -> [u64; 2] {
        let epoch = now / COOKIE_LIFE;
        [epoch, epoch.wrapping_sub(1)].map(|epoch| {
            let mut bytes = Vec::with_capacity(80);
            address.write(&mut bytes);
            bytes.put_u32(id.0);
            bytes.put_u64(key.0);
            bytes.put_u64(nonce);
            bytes.put_u64(epoch);
            // 0 stands for no cookie.
            secret.hash(&bytes).max(1)
        })
    }

    /// Makes a peer whose address is confirmed a guest. Returns the reason if the peer is refused, `None` if it is a
    /// guest.
    pub(super) fn admit(
        &mut self,
        now: u64,
        session: &mut Session,
        id: PeerId,
        key: Key,
        nonce: u64,
    ) -> Option<RefusalReason> {
        if let Some(guest) = self.list.iter_mut().find(|guest| guest.id == id) {
            if guest.nonce != nonce {
                (guest.nonce, guest.upload, guest.asked) = (nonce, None, false);
            }
            if guest.upload.is_none() {
                guest.heard_at = now;
            }
            return None;
        }
        if id == session.id() || session.view().voter(id).is_some() {
            return Some(RefusalReason::Taken);
        }
        if self.list.len() >= GUESTS_MAX {
            return Some(RefusalReason::Full);
        }
        session.attach(id, Some(key));
        if session.link(id).is_none() {
            return Some(RefusalReason::Full);
        }
        self.list.push(Guest { id, nonce, upload: None, asked: false, welcome_at: 0, heard_at: now });
        None
    }

    pub(super) fn anybody_waits(&self) -> bool {
        self.list.iter().any(|guest| guest.upload.is_none())
    }

    pub(super) fn serve(&mut self, state: &Arc<Pinned>) {
        for guest in self.list.iter_mut().filter(|guest| guest.upload.is_none()) {
            guest.upload = Some(Upload::new(Arc::clone(state)));
        }
    }

    pub(super) fn take_want(
        &mut self,
        now: u64,
        id: PeerId,
        hash: u64,
        next: u32,
        window: u32,
        masks: Vec<u64>,
    ) {
        let Some(guest) = self.list.iter_mut().find(|guest| guest.id == id) else { return };
        let Some(upload) = guest.upload.as_mut().filter(|upload| upload.state.hash == hash) else { return };
        guest.asked = true;
        guest.heard_at = now;
        upload.take(now, next, window, masks);
    }

    /// Returns the packets that are due for guests. Removes guests whose first row has arrived, and guests without a
    /// request for [`GUEST_PATIENCE`].
    pub(super) fn update(&mut self, now: u64, session: &mut Session) -> Vec<(PeerId, JoinPacket)> {
        let passed = now.saturating_sub(self.budget_at).min(BURST);
        self.budget_at = now;
        self.budget = (self.budget + passed * RATE_MAX / 1_000_000).min(BURST * RATE_MAX / 1_000_000);
        let mut packets = Vec::new();
        for guest in &mut self.list {
            session.attach(guest.id, None);
            let Some(upload) = guest.upload.as_mut().filter(|_| now < guest.heard_at + GUEST_PATIENCE) else {
                continue;
            };
            if !guest.asked && now >= guest.welcome_at {
                guest.welcome_at = now + WELCOME_INTERVAL;
                let length = u64::try_from(upload.state.bytes.len()).unwrap_or(u64::MAX);
                let (tick, hash) = (upload.state.tick, upload.state.hash);
                packets.push((guest.id, JoinPacket::Welcome { nonce: guest.nonce, tick, hash, length }));
            }
            while self.budget > 0 {
                let Some(chunk) = upload.next_chunk(now) else { break };
                let JoinPacket::Chunk { bytes, .. } = &chunk else { break };
                self.budget = self.budget.saturating_sub(u64::try_from(bytes.len()).unwrap_or(u64::MAX));
                packets.push((guest.id, chunk));
            }
        }
        // The next call begins with another guest, so that each guest gets a share of the rate.
        if !self.list.is_empty() {
            self.list.rotate_left(1);
        }
        self.list.retain(|guest| {
            let begun = session.has_row(guest.id);
            let gone = now >= guest.heard_at + GUEST_PATIENCE;
            if gone && !begun {
                session.detach(guest.id);
            }
            !begun && !gone
        });
        packets
    }
}
