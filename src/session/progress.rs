//! Complete, acknowledged and final ticks.
//!
//! A tick is *complete* when this peer has all its inputs. A tick in which no peer plays is complete if a peer plays in
//! a later tick, if the tick lies before the cut, or if the end of the match is decided: in each of these cases, no
//! change of the view can add a player to it. This peer *acknowledges* complete ticks. When it promises a ballot, the
//! number of acknowledged ticks is frozen until the view changes. A complete tick is *final* when a quorum of this view
//! acknowledges it, when it lies before the view's cut, or when a voter's row in this view states it as final. A change
//! of the view may revoke complete ticks, but never final ones.

use alloc::vec::Vec;

use super::config::Fault;
use super::id::{NEVER, Tick};
use super::state::Session;
use super::view::{View, bit};

#[derive(Clone, Debug)]
pub(super) struct Progress {
    pub(super) complete: Tick,
    pub(super) ack: Tick,
    pub(super) fin: Tick,
    /// Time at which `complete` last increased. If a change of the view has decreased it, only an increase above the
    /// value before the change counts.
    pub(super) moved_at: u64,
    /// Indices of the spans with ticks from `live_from` on. Earlier ticks are not played again.
    pub(super) live: Vec<usize>,
    pub(super) live_from: Tick,
    cleaned: Tick,
}

/// Interval in ticks at which old inputs are dropped.
const CLEAN_INTERVAL: Tick = 256;

impl Progress {
    pub(super) fn new(view: &View, tick: Tick) -> Self {
        let mut progress = Progress {
            complete: tick,
            ack: tick,
            fin: tick,
            moved_at: 0,
            live: Vec::new(),
            live_from: tick,
            cleaned: tick,
        };
        progress.follow(view, tick);
        progress
    }

    pub(super) fn follow(&mut self, view: &View, tick: Tick) {
        self.live.clear();
        self.live_from = tick;
        let live = |(index, span): (usize, &super::view::Span)| (span.until > tick).then_some(index);
        self.live.extend(view.spans.iter().enumerate().filter_map(live));
    }
}

impl Session {
    pub(super) fn settle(&mut self) {
        self.complete_ticks();
        if self.agreement.promised.is_none() || self.config.has(Fault::NoFreeze) {
            self.progress.ack = self.progress.complete;
        }
        self.refresh_row();
        self.finalise_ticks();
    }

    fn complete_ticks(&mut self) {
        while self.progress.complete < self.view.stop() && self.view.begun {
            let tick = self.progress.complete;
            // Up to the next start or end of a span, all ticks are in the same spans as `tick`.
            let mut limit = self.view.stop();
            let mut goes_on = self.view.end.is_some();
            for &index in &self.progress.live {
                let Some(span) = self.view.spans.get(index) else { continue };
                if span.contains(tick) {
                    goes_on = true;
                    limit = limit.min(span.until).min(self.log.next(index));
                } else if span.from > tick && span.from < span.until {
                    goes_on |= span.is_open();
                    limit = limit.min(span.from);
                }
            }
            if !goes_on {
                // No peer plays from `tick` on, but a peer may still join in a tick from the cut on, so such ticks are
                // not complete yet.
                limit = limit.min(self.view.cut);
            }
            if limit <= tick || limit == NEVER {
                return;
            }
            self.progress.complete = limit;
            self.progress.moved_at = self.clock.active;
        }
    }

    fn finalise_ticks(&mut self) {
        let mut fin = self.acknowledged().max(self.view.cut);
        if self.config.has(Fault::FinalComplete) {
            fin = self.progress.complete;
        }
        fin = fin.min(self.progress.complete);
        if fin <= self.progress.fin {
            return;
        }
        self.progress.fin = fin;
        if fin - self.progress.cleaned >= CLEAN_INTERVAL {
            self.progress.cleaned = fin;
            // If the game has not played all final ticks, it still needs their inputs.
            let needed = self.play.needed_from().min(fin);
            self.progress.follow(&self.view, needed);
            self.log.forget_before(fin.saturating_sub(self.config.log_ticks).min(needed));
        }
    }

    /// Number of ticks that a quorum acknowledges in rows of this view, or that a voter's row in this view states as
    /// final.
    fn acknowledged(&self) -> Tick {
        let view = self.view.number;
        let mut acks = [(0, 0_u64); super::view::SEATS_MAX];
        let mut count = 0;
        let mut acknowledged = 0;
        for (index, _, row) in self.peers.rows(view) {
            if let Some(place) = acks.get_mut(count) {
                *place = (row.ack, bit(index));
                count += 1;
            }
            acknowledged = acknowledged.max(row.fin);
        }
        let acks = acks.get_mut(..count).unwrap_or_default();
        acks.sort_unstable_by(|a, b| b.cmp(a));
        let mut set = 0;
        for &mut (ack, voter) in acks {
            set |= voter;
            if self.is_quorum(set) {
                return acknowledged.max(ack);
            }
        }
        acknowledged
    }

    pub(super) fn is_quorum(&self, set: u64) -> bool {
        let half = self.config.has(Fault::HalfIsEnough)
            && 2 * self.view.weight_of(set) + 1 >= self.view.weight_of(u64::MAX);
        half || self.view.is_quorum(set)
    }
}
