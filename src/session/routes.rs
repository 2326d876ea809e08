//! [`Routes`]: the addresses of peers. A received packet belongs to the [`PeerId`] that it states, whatever address it
//! comes from. A peer sends match packets to an address only after a probe or the handshake has shown that the receiver
//! gets packets there. Hence a peer may change its address, but cannot direct match packets to another machine.

use alloc::vec::Vec;

use super::address::Address;
use super::bytes::Write;
use super::id::PeerId;
use super::siphash::Secret;

/// Time between probes of an address in microseconds.
const PROBE_INTERVAL: u64 = 250_000;
/// Maximum number of probes of an address that another peer has told and that does not answer.
const PROBES_MAX: u8 = 40;
/// Number of probes of an address from which a packet has arrived. The source address of a packet may be forged, so a
/// packet causes only few probes.
const PROBES_OF_SOURCE: u8 = 3;
/// Maximum number of addresses of a peer that are probed at a time.
const CANDIDATES_MAX: usize = 4;
/// Time in microseconds after the last packet from a peer's address during which another address does not replace it.
const KEPT: u64 = 500_000;
const ROUTES_MAX: usize = 192;

#[derive(Clone, Debug)]
struct Candidate {
    address: Address,
    next_at: u64,
    /// Number of further probes.
    left: u8,
}

#[derive(Clone, Debug)]
struct Route {
    id: PeerId,
    /// The address, once the peer has proven that it receives packets there.
    address: Option<Address>,
    heard_at: u64,
    candidates: Vec<Candidate>,
}

#[derive(Clone, Debug, Default)]
pub(super) struct Routes {
    list: Vec<Route>,
    turn: usize,
}

impl Routes {
    fn find(&mut self, id: PeerId) -> Option<&mut Route> {
        self.list.iter_mut().find(|route| route.id == id)
    }

    fn add(&mut self, id: PeerId) -> Option<&mut Route> {
        if self.find(id).is_none() {
            if self.list.len() >= ROUTES_MAX {
                return None;
            }
            self.list.push(Route { id, address: None, heard_at: 0, candidates: Vec::new() });
        }
        self.find(id)
    }

    pub(super) fn address(&self, id: PeerId) -> Option<Address> {
        self.list.iter().find(|route| route.id == id).and_then(|route| route.address)
    }

    /// Whether no address of a peer is known, or no packet has arrived from the address for [`KEPT`].
    pub(super) fn is_lost(&self, id: PeerId, now: u64) -> bool {
        let heard = |route: &Route| route.address.is_some() && now < route.heard_at.saturating_add(KEPT);
        !self.list.iter().any(|route| route.id == id && heard(route))
    }

    /// Takes an address that is proven to belong to a peer. This address replaces the current one if no packet has
    /// arrived from the current one for [`KEPT`].
    pub(super) fn prove(&mut self, id: PeerId, address: Address, now: u64) {
        let Some(route) = self.add(id) else { return };
        if route.address != Some(address)
            && (route.address.is_none() || now >= route.heard_at.saturating_add(KEPT))
        {
            route.address = Some(address);
            route.heard_at = now;
        }
        route.candidates.retain(|candidate| candidate.address != address);
    }

    pub(super) fn heard(&mut self, id: PeerId, address: Address, now: u64) {
        match self.find(id) {
            Some(route) if route.address == Some(address) => route.heard_at = now,
            _ => self.add_candidate(id, address, PROBES_OF_SOURCE),
        }
    }

    /// Notes that according to another peer, an address belongs to a peer and should be probed.
    pub(super) fn suggest(&mut self, id: PeerId, address: Address) {
        self.add_candidate(id, address, PROBES_MAX);
    }

    fn add_candidate(&mut self, id: PeerId, address: Address, probes: u8) {
        let Some(route) = self.add(id).filter(|route| route.address != Some(address)) else { return };
        if let Some(known) = route.candidates.iter_mut().find(|candidate| candidate.address == address) {
            known.left = known.left.max(probes);
            return;
        }
        if route.candidates.len() == CANDIDATES_MAX {
            route.candidates.remove(0);
        }
        route.candidates.push(Candidate { address, next_at: 0, left: probes });
    }

    pub(super) fn probes(&mut self, now: u64) -> Vec<(PeerId, Address)> {
        let mut probes = Vec::new();
        for route in &mut self.list {
            for candidate in route.candidates.iter_mut().filter(|candidate| now >= candidate.next_at) {
                candidate.next_at = now + PROBE_INTERVAL;
                candidate.left = candidate.left.saturating_sub(1);
                probes.push((route.id, candidate.address));
            }
            route.candidates.retain(|candidate| candidate.left > 0);
        }
        probes
    }

    pub(super) fn retain(&mut self, matters: impl Fn(PeerId) -> bool) {
        self.list.retain(|route| matters(route.id));
    }

    /// Up to `most` known addresses of the peers for which `matters` holds. If there are more, successive calls return
    /// different addresses.
    pub(super) fn known(&mut self, most: usize, matters: impl Fn(PeerId) -> bool) -> Vec<(PeerId, Address)> {
        let routes = self.list.iter().filter(|route| matters(route.id));
        let known: Vec<_> = routes.filter_map(|route| Some((route.id, route.address?))).collect();
        self.turn = self.turn.wrapping_add(most);
        let start = self.turn.checked_rem(known.len()).unwrap_or(0);
        known.iter().cycle().skip(start).take(most.min(known.len())).copied().collect()
    }
}

/// The token of a probe to an address. A peer that receives the probe there returns the token.
pub(super) fn token(secret: Secret, id: PeerId, address: &Address) -> u64 {
    let mut bytes = Vec::with_capacity(64);
    bytes.put_u32(id.0);
    address.write(&mut bytes);
    secret.hash(&bytes)
}
