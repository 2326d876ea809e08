//! Encoding of a [`Row`] and of a [`Change`]. `docs/PROTOCOL.md` specifies the layout.

use alloc::sync::Arc;
use alloc::vec::Vec;

use super::bytes::{Decoded, Malformed, Reader, Write};
use super::id::{Key, PeerId};
use super::row::{Ballot, REMOVALS_MAX, Removal, Row, STRANGERS_MAX, SeatWant, Wants};
use super::view::{Change, JOINS_MAX, Join, SEATS_MAX, SPANS_MAX};

mod flag {
    pub(super) const CONNECTED: u32 = 1;
    pub(super) const OTHERS: u32 = 1 << 1;
    pub(super) const PROMISED: u32 = 1 << 2;
    pub(super) const ACCEPTED: u32 = 1 << 3;
    pub(super) const HASH: u32 = 1 << 4;
    pub(super) const LEAVE: u32 = 1 << 5;
    pub(super) const PAUSED: u32 = 1 << 6;
    pub(super) const SEATS: u32 = 1 << 7;
    pub(super) const END: u32 = 1 << 8;
    pub(super) const REMOVALS: u32 = 1 << 9;
    pub(super) const ALL: u32 = (1 << 10) - 1;
}

impl Row {
    fn flags(&self) -> u32 {
        [
            (self.connected, flag::CONNECTED),
            (!self.hears_others.is_empty(), flag::OTHERS),
            (self.promised.is_some(), flag::PROMISED),
            (self.accepted.is_some(), flag::ACCEPTED),
            (self.hash.is_some(), flag::HASH),
            (self.wants.leave, flag::LEAVE),
            (self.paused, flag::PAUSED),
            (self.wants.seats.is_some(), flag::SEATS),
            (self.wants.end.is_some(), flag::END),
            (!self.wants.removals.is_empty(), flag::REMOVALS),
        ]
        .into_iter()
        .fold(0, |flags, (is, flag)| if is { flags | flag } else { flags })
    }

    pub(super) fn write(&self, bytes: &mut Vec<u8>) {
        bytes.put_var(self.flags());
        bytes.put_var(self.version);
        bytes.put_var(self.view);
        bytes.put_var(self.fin);
        bytes.put_near(self.ack, self.fin);
        bytes.put_near(self.played, self.fin);
        bytes.put_count(self.have.len());
        let mut expected = 0;
        for &(span, next) in &self.have {
            let above = u64::from(next.saturating_sub(self.fin));
            bytes.put_var64(above << 1 | u64::from(span != expected));
            if span != expected {
                bytes.put_var(u32::from(span));
            }
            expected = span.saturating_add(1);
        }
        bytes.put_var64(self.hears);
        if !self.hears_others.is_empty() {
            bytes.put_count(self.hears_others.len());
            self.hears_others.iter().for_each(|id| bytes.put_u32(id.0));
        }
        if let Some(ballot) = self.promised {
            write_ballot(ballot, bytes);
        }
        if let Some((ballot, change)) = &self.accepted {
            write_ballot(*ballot, bytes);
            change.write(bytes);
        }
        if let Some((tick, hash)) = self.hash {
            bytes.put_near(tick, self.fin);
            bytes.put_u128(hash);
        }
        self.wants.write(bytes);
    }

    pub(super) fn read(reader: &mut Reader) -> Decoded<Row> {
        let flags = reader.var()?;
        if flags & !flag::ALL != 0 {
            return Err(Malformed);
        }
        let has = |flag| flags & flag != 0;
        let mut row = Row { version: reader.var()?, ..Row::new(reader.var()?) };
        row.fin = reader.var()?;
        row.ack = reader.near(row.fin)?;
        row.played = reader.near(row.fin)?;
        row.have = read_have(reader, row.fin)?;
        row.hears = reader.var64()?;
        row.connected = has(flag::CONNECTED);
        row.paused = has(flag::PAUSED);
        if has(flag::OTHERS) {
            let count = read_positive(reader, STRANGERS_MAX)?;
            row.hears_others = (0..count).map(|_| reader.u32().map(PeerId)).collect::<Decoded<_>>()?;
        }
        if has(flag::PROMISED) {
            row.promised = Some(read_ballot(reader)?);
        }
        if has(flag::ACCEPTED) {
            row.accepted = Some((read_ballot(reader)?, Arc::new(Change::read(reader)?)));
        }
        if has(flag::HASH) {
            row.hash = Some((reader.near(row.fin)?, reader.u128()?));
        }
        row.wants.leave = has(flag::LEAVE);
        if has(flag::SEATS) {
            let (seats, key) = (reader.u8()?, Key(reader.u64()?));
            row.wants.seats = Some(SeatWant { seats, key, which: reader.u64()? });
        }
        if has(flag::END) {
            row.wants.end = Some(reader.var()?);
        }
        if has(flag::REMOVALS) {
            let count = read_positive(reader, REMOVALS_MAX)?;
            row.wants.removals = (0..count).map(|_| Removal::read(reader)).collect::<Decoded<_>>()?;
        }
        Ok(row)
    }
}

/// Reads the length of a list whose flag is set. The length is not 0, because the flag of an empty list is not set.
fn read_positive(reader: &mut Reader, max: usize) -> Decoded<usize> {
    match reader.count(max)? {
        0 => Err(Malformed),
        count => Ok(count),
    }
}

fn read_have(reader: &mut Reader, fin: u32) -> Decoded<Vec<(u16, u32)>> {
    let count = reader.count(SPANS_MAX)?;
    let mut have = Vec::new();
    let mut expected = 0_u16;
    for _ in 0..count {
        let coded = reader.var64()?;
        let above = u32::try_from(coded >> 1).map_err(|_| Malformed)?;
        let span = if coded & 1 == 1 {
            let span = u16::try_from(reader.var()?).map_err(|_| Malformed)?;
            if span <= expected { Err(Malformed) } else { Ok(span) }?
        } else {
            expected
        };
        have.push((span, fin.checked_add(above).ok_or(Malformed)?));
        expected = span.checked_add(1).ok_or(Malformed)?;
    }
    Ok(have)
}

impl Wants {
    fn write(&self, bytes: &mut Vec<u8>) {
        if let Some(want) = self.seats {
            bytes.push(want.seats);
            bytes.put_u64(want.key.0);
            bytes.put_u64(want.which);
        }
        if let Some(end) = self.end {
            bytes.put_var(end);
        }
        if !self.removals.is_empty() {
            bytes.put_count(self.removals.len());
            self.removals.iter().for_each(|removal| removal.write(bytes));
        }
    }
}

impl Removal {
    fn write(self, bytes: &mut Vec<u8>) {
        match self {
            Removal::Without(id) => {
                bytes.push(0);
                bytes.put_u32(id.0);
            }
            Removal::Kick(key) => {
                bytes.push(1);
                bytes.put_u64(key.0);
            }
        }
    }

    fn read(reader: &mut Reader) -> Decoded<Self> {
        match reader.u8()? {
            0 => Ok(Removal::Without(PeerId(reader.u32()?))),
            1 => Ok(Removal::Kick(Key(reader.u64()?))),
            _ => Err(Malformed),
        }
    }
}

fn write_ballot(ballot: Ballot, bytes: &mut Vec<u8>) {
    bytes.put_var(ballot.round);
    bytes.put_u32(ballot.proposer.0);
}

fn read_ballot(reader: &mut Reader) -> Decoded<Ballot> {
    Ok(Ballot { round: reader.var()?, proposer: PeerId(reader.u32()?) })
}

impl Change {
    pub(super) fn write(&self, bytes: &mut Vec<u8>) {
        bytes.push(u8::from(self.begun) | u8::from(self.end.is_some()) << 1);
        bytes.put_var(self.cut);
        bytes.put_near(self.from, self.cut);
        if let Some(end) = self.end {
            bytes.put_var(end);
        }
        bytes.put_var64(self.leaves);
        bytes.put_u32(self.tie_holder.0);
        bytes.put_count(self.joins.len());
        for join in &self.joins {
            bytes.put_u32(join.id.0);
            bytes.put_u64(join.key.0);
            bytes.put_var64(join.seats);
        }
    }

    pub(super) fn read(reader: &mut Reader) -> Decoded<Self> {
        let flags = reader.u8()?;
        if flags > 3 {
            return Err(Malformed);
        }
        let cut = reader.var()?;
        let from = reader.near(cut)?;
        let end = if flags & 2 == 0 { None } else { Some(reader.var()?) };
        let leaves = reader.var64()?;
        let tie_holder = PeerId(reader.u32()?);
        let count = reader.count(JOINS_MAX.min(SEATS_MAX))?;
        let join = |reader: &mut Reader| {
            Ok(Join { id: PeerId(reader.u32()?), key: Key(reader.u64()?), seats: reader.var64()? })
        };
        let joins = (0..count).map(|_| join(reader)).collect::<Decoded<_>>()?;
        Ok(Change { cut, end, begun: flags & 1 == 1, leaves, tie_holder, joins, from })
    }
}
