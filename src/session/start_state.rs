//! [`StartState`]: the view, the addresses and the game's state for a joining peer.

use alloc::vec::Vec;

use super::address::Address;
use super::bytes::{Decoded, Malformed, Reader, Write};
use super::id::{Key, NEVER, PeerId, Tick};
use super::view::{SEATS_MAX, SPANS_MAX, Span, View, Voter};

const ADDRESSES_MAX: usize = 256;

#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct StartState {
    pub(super) view: View,
    pub(super) addresses: Vec<(PeerId, Address)>,
    /// Number of ticks that the game has played to reach `state`. All of them are final.
    pub(super) tick: Tick,
    pub(super) state: Vec<u8>,
}

impl StartState {
    pub(super) fn encode(&self) -> Vec<u8> {
        let mut bytes = Vec::with_capacity(self.state.len() + 1024);
        let View { number, begun, cut, end, tie_holder, voters, spans } = &self.view;
        bytes.put_var(*number);
        bytes.push(u8::from(*begun) | u8::from(end.is_some()) << 1);
        bytes.put_var(*cut);
        bytes.put_var(end.unwrap_or(0));
        bytes.put_u32(tie_holder.0);
        bytes.put_count(voters.len());
        for voter in voters {
            bytes.put_u32(voter.id.0);
            bytes.put_u64(voter.key.0);
            bytes.push(voter.weight);
        }
        bytes.put_count(spans.len());
        for span in spans {
            bytes.push(span.seat);
            bytes.put_u32(span.owner.0);
            bytes.put_u64(span.key.0);
            bytes.put_var(span.since);
            bytes.put_var(span.from);
            bytes.put_var(span.until);
        }
        bytes.put_count(self.addresses.len().min(ADDRESSES_MAX));
        for (id, address) in self.addresses.iter().take(ADDRESSES_MAX) {
            bytes.put_u32(id.0);
            address.write(&mut bytes);
        }
        bytes.put_var(self.tick);
        bytes.extend_from_slice(&self.state);
        bytes
    }

    pub(super) fn decode(bytes: &[u8]) -> Decoded<Self> {
        let reader = &mut Reader::new(bytes);
        let number = reader.var()?;
        let flags = reader.u8()?;
        let (cut, end) = (reader.var()?, reader.var()?);
        let tie_holder = PeerId(reader.u32()?);
        let count = reader.count(SEATS_MAX)?;
        let voter = |reader: &mut Reader| {
            Ok(Voter { id: PeerId(reader.u32()?), key: Key(reader.u64()?), weight: reader.u8()? })
        };
        let voters = (0..count).map(|_| voter(reader)).collect::<Decoded<Vec<_>>>()?;
        let count = reader.count(SPANS_MAX)?;
        let spans = (0..count).map(|_| read_span(reader)).collect::<Decoded<Vec<_>>>()?;
        let end = (flags & 2 != 0).then_some(end);
        let view = View { number, begun: flags & 1 != 0, cut, end, tie_holder, voters, spans };
        let count = reader.count(ADDRESSES_MAX)?;
        let address = |reader: &mut Reader| Ok((PeerId(reader.u32()?), Address::read(reader)?));
        let addresses = (0..count).map(|_| address(reader)).collect::<Decoded<Vec<_>>>()?;
        let tick = reader.var()?;
        let right = flags < 4 && is_sound(&view) && tick <= view.stop();
        let state = reader.rest().to_vec();
        if right { Ok(StartState { view, addresses, tick, state }) } else { Err(Malformed) }
    }
}

fn read_span(reader: &mut Reader) -> Decoded<Span> {
    let span = Span {
        seat: reader.u8()?,
        owner: PeerId(reader.u32()?),
        key: Key(reader.u64()?),
        since: reader.var()?,
        from: reader.var()?,
        until: reader.var()?,
    };
    let sound = usize::from(span.seat) < SEATS_MAX && span.from <= span.until;
    if sound { Ok(span) } else { Err(Malformed) }
}

/// Whether a received view satisfies the invariants of views.
fn is_sound(view: &View) -> bool {
    let distinct = view.voters.iter().enumerate().all(|(at, voter)| view.voter(voter.id) == Some(at));
    let mut taken = 0;
    let seats = view.spans.iter().filter(|span| span.until == NEVER).all(|span| {
        let seat = super::view::bit(usize::from(span.seat));
        let free = taken & seat == 0;
        taken |= seat;
        free && view.voter(span.owner).is_some()
    });
    let since = view.spans.iter().all(|span| span.since <= view.number);
    let end = view.end.is_none_or(|end| end >= view.cut);
    distinct && seats && since && end && view.voter(view.tie_holder).is_some()
}
