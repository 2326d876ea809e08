//! Processing of the packets that arrive at an endpoint.

use alloc::boxed::Box;

use super::address::Address;
use super::config::TIME_MAX;
use super::endpoint::{Endpoint, JoinEvent, STATE_BYTES_MAX};
use super::guests::Guests;
use super::id::{Key, PeerId};
use super::join_packet::{JoinPacket, RefusalReason, is_join_packet};
use super::packet;
use super::phase::Phase;
use super::routes::token;
use super::start_state::StartState;
use super::state::Session;
use super::transfer::Download;

impl Endpoint {
    /// Processes a received packet.
    pub fn receive(&mut self, now: u64, from: Address, bytes: &[u8]) {
        let now = now.min(TIME_MAX);
        // A closed endpoint does not answer. A joining peer can then ask another contact.
        if self.is_closed() {
            return;
        }
        if is_join_packet(bytes) {
            let Ok(body) = packet::open(self.config.match_tag, bytes) else { return };
            match JoinPacket::read(body) {
                Ok((sender, packet)) if sender != self.me || self.concerns_identity(&packet) => {
                    self.take(now, from, sender, packet);
                }
                _ => {}
            }
            return;
        }
        let Phase::InMatch(session) = &mut self.phase else { return };
        if let Some(sender) = session.receive(now, bytes) {
            self.routes.heard(sender, from, now);
        }
    }

    fn take(&mut self, now: u64, from: Address, sender: PeerId, packet: JoinPacket) {
        match packet {
            JoinPacket::Hello { nonce, key, cookie, offer } => {
                let right = Guests::cookies(self.secret, now, &from, sender, key, nonce);
                if right.contains(&cookie) {
                    // The cookie proves that the sender receives packets at its address.
                    self.admit(now, from, sender, key, nonce, &offer);
                } else {
                    let [cookie, _] = right;
                    self.send(from, &JoinPacket::Challenge { nonce, cookie });
                }
            }
            JoinPacket::Challenge { nonce, cookie } => {
                if let Phase::InMatch(session) = &mut self.phase {
                    if self.contacts.take_challenge(nonce, cookie, sender) {
                        // This peer sends packets to the contact even before the contact accepts the handshake.
                        session.attach(sender, None);
                        self.routes.prove(sender, from, now);
                    }
                } else if let Phase::Asking { nonce: own, cookie: known, next_at } = &mut self.phase
                    && *own == nonce
                    && *known != cookie
                {
                    (*known, *next_at) = (cookie, 0);
                }
            }
            JoinPacket::Refused { nonce, reason, offer } => {
                self.contacts.take_refusal(nonce);
                if matches!(self.phase, Phase::Asking { nonce: own, .. } if own == nonce) {
                    if reason != RefusalReason::NotReady {
                        self.phase = Phase::Refused;
                    }
                    self.events.push_back(JoinEvent::Refused { reason, offer });
                }
            }
            JoinPacket::Welcome { nonce, tick: _, hash, length } => {
                let own = matches!(self.phase, Phase::Asking { nonce: own, .. } if own == nonce);
                if own && length <= STATE_BYTES_MAX {
                    self.routes.prove(sender, from, now);
                    if let Some(download) = Download::new(now, hash, length) {
                        self.phase = Phase::Downloading(download);
                    }
                }
            }
            JoinPacket::Chunk { hash, index, bytes } => self.take_chunk(now, hash, index, &bytes),
            JoinPacket::Want { hash, next, window, masks } => {
                if self.routes.address(sender) == Some(from) {
                    self.guests.take_want(now, sender, hash, next, window, masks);
                }
            }
            JoinPacket::Probe { token } => {
                if self.knows(sender) {
                    self.routes.heard(sender, from, now);
                    self.send(from, &JoinPacket::Pong { token });
                }
            }
            JoinPacket::Pong { token: theirs } => {
                if self.knows(sender) && theirs == token(self.secret, sender, &from) {
                    self.routes.prove(sender, from, now);
                }
            }
            JoinPacket::AddressList { addresses } => {
                if self.routes.address(sender) == Some(from) {
                    for (id, address) in addresses.into_iter().filter(|(id, _)| *id != self.me) {
                        self.contacts.note(id, address);
                        if self.routes.is_lost(id, now) && self.knows(id) {
                            self.routes.suggest(id, address);
                        }
                    }
                }
            }
        }
    }

    /// Whether to process a packet whose sender has the same incarnation as this peer. In a match, this peer answers a
    /// hello with the same incarnation, so that the joining process learns that the incarnation is taken. A joining
    /// peer takes such answers. They contain the secret nonce of its hello, so they cannot be forged.
    fn concerns_identity(&self, packet: &JoinPacket) -> bool {
        match packet {
            JoinPacket::Hello { .. } => self.session().is_some(),
            JoinPacket::Challenge { .. } | JoinPacket::Refused { .. } => self.session().is_none(),
            _ => false,
        }
    }

    fn knows(&self, id: PeerId) -> bool {
        self.session().is_some_and(|session| session.link(id).is_some())
    }

    fn admit(&mut self, now: u64, from: Address, sender: PeerId, key: Key, nonce: u64, offer: &[u8]) {
        // Outside of a match, the own offer says nothing: this peer may itself be refused because of it.
        let reason = match &mut self.phase {
            Phase::InMatch(_) if offer != self.offer => Some(RefusalReason::Offer),
            Phase::InMatch(session) => self.guests.admit(now, session, sender, key, nonce),
            _ => Some(RefusalReason::NotReady),
        };
        match reason {
            Some(reason) => {
                let offer = self.offer.clone();
                self.send(from, &JoinPacket::Refused { nonce, reason, offer });
            }
            None => self.routes.prove(sender, from, now),
        }
    }

    fn take_chunk(&mut self, now: u64, hash: u64, index: u32, bytes: &[u8]) {
        let Phase::Downloading(download) = &mut self.phase else { return };
        if download.hash == hash {
            download.take(now, index, bytes);
        }
        if download.is_complete() {
            self.begin(now);
        }
    }

    fn begin(&mut self, now: u64) {
        let Phase::Downloading(download) = core::mem::replace(&mut self.phase, Phase::UNASKED) else {
            return;
        };
        let start = download.finish().and_then(|bytes| StartState::decode(&bytes).ok());
        let session = start.and_then(|start| {
            let seed = self.secret.0[0];
            let session = Session::resume(
                self.config.clone(),
                self.me,
                self.key,
                self.role,
                start.view,
                start.tick,
                seed,
            );
            Some((session.ok()?, start.addresses, start.tick, start.state))
        });
        let Some((session, addresses, tick, bytes)) = session else {
            if let Some(contact) = self.contact {
                self.ask(contact);
            }
            self.events.push_back(JoinEvent::BadState);
            return;
        };
        let mut session = Box::new(session);
        let contact = self.routes.known(usize::MAX, |_| true);
        for (id, _) in &contact {
            session.attach(*id, None);
        }
        session.look(now);
        self.phase = Phase::InMatch(session);
        for (id, address) in addresses.into_iter().filter(|(id, _)| *id != self.me) {
            self.contacts.note(id, address);
            self.routes.suggest(id, address);
        }
        self.events.push_back(JoinEvent::State { tick, bytes });
    }
}
