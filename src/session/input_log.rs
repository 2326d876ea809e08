//! [`InputLog`]: the inputs of all spans. A span is the range of ticks in which one peer, its owner, plays a seat
//! (`view.rs`). The owner issues one input for each tick of its span, and never changes it.

use alloc::vec::Vec;

use super::id::Tick;
use super::view::Span;

#[derive(Clone, Debug)]
struct SpanLog {
    /// First tick whose input is in `bytes`.
    first: Tick,
    /// First tick whose input is missing.
    next: Tick,
    bytes: Vec<u8>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Added {
    /// No input was added: all of them are already known, or they would leave a gap after the known ones.
    Nothing,
    /// Inputs were added, the first of them for this tick.
    From(Tick),
    /// The known input of the owner for this tick differs from the given one.
    Conflict(Tick),
}

#[derive(Clone, Debug)]
pub(super) struct InputLog {
    size: usize,
    spans: Vec<SpanLog>,
}

impl InputLog {
    pub(super) fn new(size: u16) -> Self {
        InputLog { size: usize::from(size), spans: Vec::new() }
    }

    pub(super) const fn size(&self) -> usize {
        self.size
    }

    pub(super) fn follow(&mut self, spans: &[Span]) {
        let new = spans.get(self.spans.len()..).unwrap_or_default();
        let empty = |span: &Span| SpanLog { first: span.from, next: span.from, bytes: Vec::new() };
        self.spans.extend(new.iter().map(empty));
    }

    /// Discards all inputs, and starts the log at `tick`, whose state has been loaded.
    pub(super) fn start_at(&mut self, spans: &[Span], tick: Tick) {
        self.spans.clear();
        let empty = |span: &Span| {
            let first = span.from.max(tick);
            SpanLog { first, next: first, bytes: Vec::new() }
        };
        self.spans.extend(spans.iter().map(empty));
    }

    pub(super) fn next(&self, span: usize) -> Tick {
        self.spans.get(span).map_or(0, |log| log.next)
    }

    pub(super) fn get(&self, span: usize, tick: Tick) -> Option<&[u8]> {
        self.range(span, tick, tick.checked_add(1)?)
    }

    /// The inputs for the ticks `from <= tick < until`, if all of them are present.
    pub(super) fn range(&self, span: usize, from: Tick, until: Tick) -> Option<&[u8]> {
        let log = self.spans.get(span)?;
        let at = |tick: Tick| usize::try_from(tick.checked_sub(log.first)?).ok()?.checked_mul(self.size);
        log.bytes.get(at(from)?..at(until)?)
    }

    /// Adds consecutive inputs, the first of them for tick `start`. Inputs after a gap are ignored: their sender sends
    /// them again after the missing ones.
    pub(super) fn add(&mut self, span: usize, start: Tick, inputs: &[u8]) -> Added {
        let size = self.size;
        let Some(log) = self.spans.get_mut(span) else { return Added::Nothing };
        if start > log.next {
            return Added::Nothing;
        }
        let before = log.next;
        for (tick, input) in (start..).zip(inputs.chunks_exact(size)) {
            if tick == log.next {
                log.bytes.extend_from_slice(input);
                log.next += 1;
                continue;
            }
            let Some(at) = tick.checked_sub(log.first) else { continue };
            let at = usize::try_from(at).unwrap_or(usize::MAX).saturating_mul(size);
            if log.bytes.get(at..).is_some_and(|known| !known.starts_with(input)) {
                return Added::Conflict(tick);
            }
        }
        if log.next > before { Added::From(before) } else { Added::Nothing }
    }

    /// Drops the inputs before `tick`. A span in which these are at most half of the kept inputs is left unchanged,
    /// because dropping inputs moves all later ones.
    pub(super) fn forget_before(&mut self, tick: Tick) {
        for log in &mut self.spans {
            let until = tick.min(log.next);
            let Some(count) = until.checked_sub(log.first) else { continue };
            let bytes = usize::try_from(count).unwrap_or(0).saturating_mul(self.size);
            if 2 * bytes > log.bytes.len() {
                log.bytes.drain(..bytes.min(log.bytes.len()));
                log.first = until;
            }
        }
    }

    pub(super) fn bytes(&self) -> usize {
        self.spans.iter().map(|log| log.bytes.len()).sum()
    }
}
