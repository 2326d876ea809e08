//! [`Pace`]: the time of the next tick, and the delay of this peer's inputs.
//!
//! The current tick of another player is estimated from its newest row, the row's age and half a round trip. A voter
//! adjusts its tick length to approach the median of these estimates. A peer without a vote approaches the tick that is
//! [`FOLLOW`] ticks behind the final ticks. Ticks become at most 1/8 longer or 1/16 shorter, so that the speed changes
//! gradually. A peer that is far behind plays ticks before they are due, and a voter that is far ahead waits.
//!
//! A voter catches up with the other players, not with the number of complete ticks (ticks with all inputs), because a
//! voter that plays a tick issues inputs for a later tick. If all players played every complete tick at once, these
//! inputs would complete further ticks, and all players would run ahead without end.

use alloc::vec::Vec;

use super::config::Config;
use super::id::{PeerId, Tick};
use super::peers::within;
use super::state::Session;

#[derive(Clone, Debug)]
pub(super) struct Pace {
    tick_micros: u64,
    /// Time at which the next tick is due; `None` before the first one.
    next_at: Option<u64>,
    /// Current duration of a tick in microseconds.
    length: u64,
    /// Delay of this peer's inputs in ticks.
    pub(super) delay: u16,
    delay_at: u64,
    /// Whether this peer waits because another one is far behind.
    held: bool,
    /// Number of ticks that this peer may play before they are due. For a voter: complete ticks that it has not played,
    /// at most its lag behind the median of the other players. For a peer without a vote: final ticks that it has not
    /// played.
    behind: Tick,
    /// Whether this peer has just got a vote and plays ticks before they are due until it is level with the others.
    hurries: bool,
}

/// A voter waits if it leads the slowest other player by more than this number of ticks.
const AHEAD_MAX: Tick = 6;
/// Maximum number of overdue ticks that are made up after a wait for inputs.
const LATE_MAX: u64 = 3;
/// A peer plays ticks before they are due while [`Pace::behind`] is at least this number.
const CATCH_UP: Tick = 12;
/// Minimum time between two changes of the input delay by one tick, in microseconds.
const DELAY_INTERVAL: u64 = 500_000;
/// Ticks by which a peer without a vote stays behind the final ticks.
const FOLLOW: i64 = 2;
/// Leads over other players are measured in units of 1/256 tick.
const PART: i64 = 256;

impl Pace {
    pub(super) fn new(config: &Config) -> Self {
        let tick_micros = u64::from(config.tick_micros);
        Pace {
            tick_micros,
            next_at: None,
            length: tick_micros,
            delay: config.delay_min,
            delay_at: 0,
            held: false,
            behind: 0,
            hurries: false,
        }
    }

    pub(super) fn is_time(&self, now: u64) -> bool {
        let due = self.next_at.is_none_or(|at| now >= at);
        self.behind >= CATCH_UP || self.hurries && self.behind > 0 || due && !self.held
    }

    pub(super) fn played(&mut self, now: u64) {
        let at = self.next_at.unwrap_or(now);
        let oldest = now.saturating_sub(LATE_MAX * self.tick_micros);
        let at_once = self.behind >= CATCH_UP || self.hurries && self.behind > 0;
        if !at_once || now >= at {
            self.next_at = Some(at.max(oldest) + self.length);
        }
        self.behind = self.behind.saturating_sub(1);
    }

    /// Notes that a tick was due but could not be played, for example because inputs are missing.
    pub(super) fn blocked(&mut self, now: u64) {
        let oldest = now.saturating_sub(LATE_MAX * self.tick_micros);
        self.next_at = Some(self.next_at.unwrap_or(now).max(oldest));
    }
}

impl Session {
    pub(super) fn steer(&mut self) {
        let ahead = self.ticks_ahead();
        let own = self.view.voter(self.me).is_some();
        let slowest = ahead.last().copied();
        self.pace.held = own && slowest.is_some_and(|ahead| ahead > i64::from(AHEAD_MAX) * PART);
        let tick = self.pace.tick_micros;
        let median = ahead.get(ahead.len() / 2).copied().unwrap_or(0);
        let ahead = if own { median } else { (FOLLOW - i64::from(self.pace.behind)) * PART };
        // In each tick, the adjustment removes 1/32 of the lead.
        let adjust = ahead * i64::try_from(tick).unwrap_or(0) / (PART * 32);
        let most = i64::try_from(tick / 8).unwrap_or(0);
        let adjust = adjust.clamp(-most / 2, most);
        self.pace.length = tick.saturating_add_signed(adjust);
        self.pace.behind = if own {
            let complete = self.progress.complete.saturating_sub(self.play.played);
            complete.min(Tick::try_from(-median / PART).unwrap_or(0))
        } else {
            self.progress.fin.saturating_sub(self.play.played)
        };
        self.pace.hurries &= self.pace.behind > 0;
        self.adapt_delay();
    }

    /// The leads of this peer over the other players with fresh rows, in 1/256 ticks, ascending. A lag is a negative
    /// lead.
    fn ticks_ahead(&self) -> Vec<i64> {
        let (fresh, active) = (self.config.timing.fresh, self.clock.active);
        let tick = self.pace.tick_micros.max(1);
        let own = i64::from(self.play.played) * PART + self.phase();
        let mut ahead: Vec<i64> = self
            .peers
            .voters()
            .filter(|(_, remote)| remote.id != self.me && within(remote.fresh, fresh, active))
            .filter(|(_, remote)| self.plays_at(remote.id, self.play.played))
            .filter_map(|(_, remote)| {
                let row = remote.row.as_ref()?;
                let age = active.saturating_sub(remote.fresh?).min(4 * tick) + remote.link.round_trip / 2;
                let theirs = i64::from(row.played) * PART + i64::try_from(age * 256 / tick).unwrap_or(0);
                Some(own - theirs)
            })
            .collect();
        ahead.sort_unstable();
        ahead
    }

    /// The peer that holds up the match: the owner of a missing input for the first incomplete tick. If this owner
    /// leads another player by 6 ticks or more, it is itself held up. Then the result is the slowest player that has
    /// the inputs for its next tick.
    #[must_use]
    pub fn waiting_for(&self) -> Option<PeerId> {
        let tick = self.progress.complete;
        let missing = |&index: &usize| {
            let span = self.view.spans.get(index)?;
            (span.contains(tick) && self.log.next(index) <= tick).then_some(span.owner)
        };
        let owner = self.progress.live.iter().find_map(missing)?;
        let (fresh, active) = (self.config.timing.fresh, self.clock.active);
        let players = self
            .peers
            .voters()
            .filter(|(_, remote)| within(remote.fresh, fresh, active) && self.plays_at(remote.id, tick));
        let able = players.filter_map(|(_, remote)| {
            let row = remote.row.as_ref().filter(|row| row.played < row.ack)?;
            Some((row.played, remote.id))
        });
        let waits = |least: Tick| {
            let row = self.peers.find(owner).and_then(|remote| remote.row.as_ref());
            row.is_some_and(|row| row.played >= least.saturating_add(AHEAD_MAX))
        };
        let slowest = able.min().filter(|&(played, _)| waits(played));
        Some(slowest.map_or(owner, |(_, slowest)| slowest))
    }

    fn plays_at(&self, id: PeerId, tick: Tick) -> bool {
        self.view.spans.iter().any(|span| span.owner == id && span.is_open() && span.from <= tick)
    }

    /// Elapsed part of the current tick, in 1/256 ticks.
    fn phase(&self) -> i64 {
        let left = self.pace.next_at.unwrap_or(0).saturating_sub(self.clock.now).min(self.pace.tick_micros);
        i64::try_from((self.pace.tick_micros - left) * 256 / self.pace.tick_micros.max(1)).unwrap_or(0)
    }

    /// Begins to catch up, after this peer got a vote. The input delay is set at once, so that this peer's first inputs
    /// arrive in time.
    pub(super) fn hurry(&mut self) {
        self.pace.hurries = true;
        self.pace.delay = self.delay_aim();
        self.pace.delay_at = self.clock.now;
    }

    fn adapt_delay(&mut self) {
        let now = self.clock.now;
        // Before the first tick of the match or of a joining player, the delay rises at once, so that the inputs arrive
        // in time.
        let played = self.play.played;
        if played == 0 || self.view.spans.iter().any(|span| span.is_open() && span.from > played) {
            self.pace.delay = self.pace.delay.max(self.delay_aim());
        }
        if now < self.pace.delay_at.saturating_add(DELAY_INTERVAL) {
            return;
        }
        let aim = self.delay_aim();
        if aim != self.pace.delay {
            self.pace.delay_at = now;
            self.pace.delay = if aim > self.pace.delay { self.pace.delay + 1 } else { self.pace.delay - 1 };
        }
    }

    /// Target of the input delay in ticks, from the slowest link to a player: half a round trip plus twice the jitter
    /// plus the interval of packets, minus [`Config::guess`]. The result is within the bounds of the delay.
    fn delay_aim(&self) -> u16 {
        let (least, most) = (self.config.delay_min, self.config.delay_max);
        let tick = self.pace.tick_micros.max(1);
        let (fresh, active) = (self.config.timing.fresh, self.clock.active);
        let players = self.peers.voters().filter(|(_, remote)| {
            remote.id != self.me && within(remote.fresh, fresh, active) && self.view.seats_of(remote.id) != 0
        });
        let latency = players.map(|(_, remote)| remote.link.round_trip / 2 + 2 * remote.link.jitter).max();
        // Inputs wait for the next packet. In large matches, the interval of packets is longer than a tick.
        let packet = (self.send_interval() / tick).max(1);
        let needed = latency.map_or(0, |latency| latency.div_ceil(tick) + packet);
        let needed = u16::try_from(needed).unwrap_or(most).saturating_sub(self.config.guess);
        needed.clamp(least, most)
    }
}
