//! Packets between peers of a match. `docs/PROTOCOL.md` has their layout.
//!
//! The decoder drops a packet with a wrong checksum, an unknown flag, a number that is not in its shortest form, a
//! length beyond its bound, or bytes after its end.

use alloc::vec::Vec;

use super::bytes::{Decoded, Malformed, Reader, Write};
use super::id::{PeerId, Tick};
use super::row::Row;
use super::runs;
use super::view::Change;

/// Largest packet in bytes. Most networks transmit it without fragmentation.
pub const PACKET_BYTES_MAX: usize = 1200;
pub(super) const FOREIGN_ROWS_MAX: usize = 3;
pub(super) const CHANGES_MAX: usize = 16;
pub(super) const RUNS_MAX: usize = 128;
pub(super) const RUN_TICKS_MAX: u32 = 64;
/// Largest number of decoded bytes of inputs in a packet.
pub(super) const INPUTS_MAX: usize = 1 << 16;

mod flag {
    pub(super) const ECHO: u8 = 1;
    pub(super) const CHANGES: u8 = 1 << 1;
    pub(super) const RUNS: u8 = 1 << 2;
    pub(super) const FOREIGN: u8 = 1 << 3;
    pub(super) const ALL: u8 = (1 << 4) - 1;
}

/// Inputs of a span for consecutive ticks.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Run {
    pub(super) span: u16,
    pub(super) start: Tick,
    /// Range of the inputs in [`Packet::inputs`].
    pub(super) bytes: core::ops::Range<usize>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Header {
    pub(super) sender: PeerId,
    pub(super) sequence: u16,
    /// Time of sending in units of 128 us.
    pub(super) sent: u16,
    /// Timestamp of the last packet from the receiver of this packet, plus the time between its arrival and `sent`.
    pub(super) echo: Option<u16>,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Packet {
    pub(super) header: Header,
    pub(super) row: Row,
    /// Consecutive changes of the view, and the number of the view to which the first change leads.
    pub(super) changes: (u32, Vec<Change>),
    pub(super) runs: Vec<Run>,
    pub(super) inputs: Vec<u8>,
    pub(super) foreign: Vec<(PeerId, Row)>,
}

/// Seed of the checksum of a packet to `receiver`. A process that has been started again at the same address has another
/// incarnation. It rejects packets to its predecessor: their sequence numbers and echoes belong to another series.
pub(super) fn seed(match_tag: u64, receiver: PeerId) -> u64 {
    match_tag ^ u64::from(receiver.0)
}

/// The first four bytes of a packet: a checksum whose seed is [`seed`], or the tag of the match for packets for joining.
/// Thereby a receiver rejects packets of other matches.
pub(super) fn checksum(seed: u64, body: &[u8]) -> [u8; 4] {
    let digest = twox_hash::XxHash3_128::oneshot_with_seed(seed, body).to_le_bytes();
    [digest[0], digest[1], digest[2], digest[3]]
}

pub(super) fn open(seed: u64, bytes: &[u8]) -> Decoded<&[u8]> {
    let (sum, body) = bytes.split_first_chunk::<4>().ok_or(Malformed)?;
    if bytes.len() <= PACKET_BYTES_MAX && checksum(seed, body) == *sum { Ok(body) } else { Err(Malformed) }
}

/// Composes a packet. Call its methods in the order in which they are declared. Parts that would not fit in
/// [`PACKET_BYTES_MAX`] are left out.
pub(super) struct Composer {
    bytes: Vec<u8>,
    flags: u8,
}

/// Offset of the flags, which follow the checksum and the sender.
const FLAGS_AT: usize = 8;
/// Number of bytes kept free for the counts of the sections that may follow.
pub(super) const RESERVE: usize = 4;

impl Composer {
    pub(super) fn new(header: &Header, row: &[u8]) -> Self {
        let mut bytes = Vec::with_capacity(row.len() + 96);
        bytes.put_u32(0);
        bytes.put_u32(header.sender.0);
        bytes.push(0);
        bytes.put_u16(header.sequence);
        bytes.put_u16(header.sent);
        let mut flags = 0;
        if let Some(echo) = header.echo {
            bytes.put_u16(echo);
            flags |= flag::ECHO;
        }
        bytes.extend_from_slice(row);
        Composer { bytes, flags }
    }

    /// Appends a section with at most `most` parts, as many as fit if `room` bytes stay free. A section without parts
    /// is left out. Returns the number of parts.
    fn section<T>(
        &mut self,
        flag: u8,
        most: usize,
        room: usize,
        parts: impl IntoIterator<Item = T>,
        mut write: impl FnMut(T, &mut Vec<u8>),
    ) -> u8 {
        let at = self.bytes.len();
        self.bytes.push(0);
        let mut count = 0;
        for part in parts.into_iter().take(most) {
            let end = self.bytes.len();
            write(part, &mut self.bytes);
            if self.bytes.len() + room > PACKET_BYTES_MAX {
                self.bytes.truncate(end);
                break;
            }
            count += 1;
        }
        if count == 0 {
            self.bytes.truncate(at);
            return 0;
        }
        self.flags |= flag;
        if let Some(byte) = self.bytes.get_mut(at) {
            *byte = count;
        }
        count
    }

    /// Appends consecutive changes. The first of them leads to view `first`.
    pub(super) fn changes<'a>(&mut self, first: u32, changes: impl IntoIterator<Item = &'a Change>) {
        let at = self.bytes.len();
        self.bytes.put_var(first);
        let flags = self.flags;
        self.section(flag::CHANGES, CHANGES_MAX, RESERVE, changes, Change::write);
        if self.flags == flags {
            self.bytes.truncate(at);
        }
    }

    /// Appends runs, each given by its span, its first tick and its inputs of `size` bytes each. `room` bytes stay
    /// free. A run that does not fit is shortened. Returns the tick after the last input of each run that fits.
    pub(super) fn runs<'a>(
        &mut self,
        size: usize,
        room: usize,
        runs: impl IntoIterator<Item = (u16, Tick, &'a [u8])>,
    ) -> Vec<Tick> {
        let mut total = 0;
        let fitting = runs.into_iter().take_while(|(_, _, inputs)| {
            total += inputs.len();
            total <= INPUTS_MAX
        });
        let most = PACKET_BYTES_MAX.saturating_sub(room);
        let mut ends = Vec::new();
        let count = self.section(flag::RUNS, RUNS_MAX, room, fitting, |(span, start, inputs), bytes| {
            let at = bytes.len();
            let mut ticks = inputs.len() / size.max(1);
            loop {
                bytes.truncate(at);
                bytes.put_var(u32::from(span));
                bytes.put_var(start);
                bytes.put_count(ticks);
                runs::encode(inputs.get(..ticks * size).unwrap_or(inputs), size, bytes);
                if bytes.len() <= most || ticks <= 1 {
                    break;
                }
                let share = ticks * most.saturating_sub(at) / (bytes.len() - at);
                ticks = share.clamp(1, ticks - 1);
            }
            ends.push(start.saturating_add(Tick::try_from(ticks).unwrap_or(0)));
        });
        ends.truncate(usize::from(count));
        ends
    }

    /// Appends rows of other peers. Returns the number of rows that fit.
    pub(super) fn foreign<'a>(&mut self, rows: impl IntoIterator<Item = (PeerId, &'a Row)>) -> usize {
        let count = self.section(flag::FOREIGN, FOREIGN_ROWS_MAX, RESERVE, rows, |(id, row), bytes| {
            bytes.put_u32(id.0);
            row.write(bytes);
        });
        usize::from(count)
    }

    pub(super) fn finish(mut self, match_tag: u64, receiver: PeerId) -> Vec<u8> {
        if let Some(byte) = self.bytes.get_mut(FLAGS_AT) {
            *byte = self.flags;
        }
        let sum = checksum(seed(match_tag, receiver), self.bytes.get(4..).unwrap_or_default());
        if let Some(place) = self.bytes.first_chunk_mut::<4>() {
            *place = sum;
        }
        self.bytes
    }
}

impl Packet {
    pub(super) fn read(body: &[u8], size: usize) -> Decoded<Packet> {
        let reader = &mut Reader::new(body);
        let sender = PeerId(reader.u32()?);
        let flags = reader.u8()?;
        if flags & !flag::ALL != 0 {
            return Err(Malformed);
        }
        let has = |flag| flags & flag != 0;
        let (sequence, sent) = (reader.u16()?, reader.u16()?);
        let echo = if has(flag::ECHO) { Some(reader.u16()?) } else { None };
        let header = Header { sender, sequence, sent, echo };
        let row = Row::read(reader)?;
        let mut packet = Packet {
            header,
            row,
            changes: (0, Vec::new()),
            runs: Vec::new(),
            inputs: Vec::new(),
            foreign: Vec::new(),
        };
        if has(flag::CHANGES) {
            packet.changes.0 = reader.var()?;
            let count = section_count(reader, CHANGES_MAX)?;
            packet.changes.1 = (0..count).map(|_| Change::read(reader)).collect::<Decoded<_>>()?;
        }
        if has(flag::RUNS) {
            packet.read_runs(reader, size)?;
        }
        if has(flag::FOREIGN) {
            let count = section_count(reader, FOREIGN_ROWS_MAX)?;
            let row = |reader: &mut Reader| Ok((PeerId(reader.u32()?), Row::read(reader)?));
            packet.foreign = (0..count).map(|_| row(reader)).collect::<Decoded<_>>()?;
        }
        if reader.is_empty() { Ok(packet) } else { Err(Malformed) }
    }

    fn read_runs(&mut self, reader: &mut Reader, size: usize) -> Decoded<()> {
        for _ in 0..section_count(reader, RUNS_MAX)? {
            let span = u16::try_from(reader.var()?).map_err(|_| Malformed)?;
            let start = reader.var()?;
            let ticks = reader.var()?;
            if ticks == 0 || ticks > RUN_TICKS_MAX || start.checked_add(ticks).is_none() {
                return Err(Malformed);
            }
            let at = self.inputs.len();
            let count = usize::try_from(ticks).map_err(|_| Malformed)?;
            if at + count * size > INPUTS_MAX {
                return Err(Malformed);
            }
            runs::decode(reader, count * size, size, &mut self.inputs)?;
            self.runs.push(Run { span, start, bytes: at..self.inputs.len() });
        }
        Ok(())
    }
}

/// Reads the number of parts of a section. The number 0 is malformed, because an empty section has no flag.
fn section_count(reader: &mut Reader, most: usize) -> Decoded<usize> {
    let count = usize::from(reader.u8()?);
    if (1..=most).contains(&count) { Ok(count) } else { Err(Malformed) }
}
