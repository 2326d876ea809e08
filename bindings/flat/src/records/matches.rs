//! Matches and replays.

use lockstep2d::replay::{Limits, Verdict};
use lockstep2d::session::{Event, RefusalReason, Status};

use super::{check_reserved, check_size, size};
use crate::describe::{constants, records};
use crate::numbers::RawHash;
use crate::status::Outcome;

constants! {
    /// Verdict: setup and inputs reproduce every checkpoint and the trailer.
    MATCH = 0, "LS2D_MATCH";
    /// Verdict: a claim or the final hash in the trailer differs from the simulation.
    CLAIM_MISMATCH = 1, "LS2D_CLAIM_MISMATCH";
    /// Verdict: the simulation diverges from the checkpoints.
    DIVERGED = 2, "LS2D_DIVERGED";
    /// Verdict: the file ends before its trailer.
    INCOMPLETE = 3, "LS2D_INCOMPLETE";
    /// Verdict: the bytes are not a valid replay file.
    MALFORMED = 4, "LS2D_MALFORMED";
    /// Verdict: the file exceeds one of the limits.
    LIMIT_EXCEEDED = 5, "LS2D_LIMIT_EXCEEDED";
    /// Verdict: the file was recorded with another version of the engine, or with other rules.
    UNVERIFIABLE = 6, "LS2D_UNVERIFIABLE";
    /// Request: keep a copy of the state before `tick`. The copy replaces an older copy for the same tick.
    REQUEST_SAVE = 0, "LS2D_REQUEST_SAVE";
    /// Request: restore the copy of the state before `tick`. In a match, copies for later ticks are no longer needed.
    REQUEST_LOAD = 1, "LS2D_REQUEST_LOAD";
    /// Request: simulate `tick` with the inputs that come with this request.
    REQUEST_ADVANCE = 2, "LS2D_REQUEST_ADVANCE";
    /// Request: pass the hash of the copy of the state before `tick` to `ls2d_match_report_hash`, or, in a replay, the
    /// hash of the current state to `ls2d_replay_check`.
    REQUEST_CHECKSUM = 3, "LS2D_REQUEST_CHECKSUM";
    /// Request: copies for ticks below `tick` are no longer needed.
    REQUEST_FORGET = 4, "LS2D_REQUEST_FORGET";
    /// Event: the status is `value`, an `LS2D_MATCH_` constant. For `LS2D_MATCH_FINISHED`, `tick` is the number of
    /// ticks.
    EVENT_STATUS = 0, "LS2D_EVENT_STATUS";
    /// Event: voters, seats, start or end of the match have changed. `value` is the number of the new view, which each
    /// change increases by one.
    EVENT_VIEW = 1, "LS2D_EVENT_VIEW";
    /// Event: `peer` has `seat` from `tick` on.
    EVENT_SEATED = 2, "LS2D_EVENT_SEATED";
    /// Event: `peer` loses `seat` at `tick`.
    EVENT_UNSEATED = 3, "LS2D_EVENT_UNSEATED";
    /// Event: play stalls, because inputs of `peer` are missing. `value` is 1 if messages of this peer still arrive,
    /// directly or through other peers; otherwise 0.
    EVENT_WAITING = 4, "LS2D_EVENT_WAITING";
    /// Event: play continues.
    EVENT_RESUMED = 5, "LS2D_EVENT_RESUMED";
    /// Event: `peer` requests a pause (`value` is 1) or withdraws its request (0).
    EVENT_PAUSE = 6, "LS2D_EVENT_PAUSE";
    /// Event: the match ends after `tick` ticks.
    EVENT_END = 7, "LS2D_EVENT_END";
    /// Event: after `tick` ticks, the state of `peer` has the hash `theirs`, and the state of this peer the hash
    /// `ours`.
    EVENT_DESYNC = 8, "LS2D_EVENT_DESYNC";
    /// Event: `peer` has issued two different inputs for `tick`. The input that arrived first counts.
    EVENT_CONFLICT = 9, "LS2D_EVENT_CONFLICT";
    /// Event: this peer is so far behind that the others may have dropped inputs that it lacks. It has to join again.
    EVENT_TOO_FAR_BEHIND = 10, "LS2D_EVENT_TOO_FAR_BEHIND";
    /// Event: the contact refuses the request to join. `value` is the reason, an `LS2D_REFUSED_` constant.
    EVENT_REFUSED = 11, "LS2D_EVENT_REFUSED";
    /// Event: the state after `tick` ticks was downloaded. `value` is the handle of its bytes, which the caller frees.
    /// Restore this state before you fulfil the next request.
    EVENT_STATE = 12, "LS2D_EVENT_STATE";
    /// Event: the downloaded bytes are not a valid state. This peer requests the state again.
    EVENT_BAD_STATE = 13, "LS2D_EVENT_BAD_STATE";
    /// Reason: the offers differ.
    REFUSED_OFFER = 0, "LS2D_REFUSED_OFFER";
    /// Reason: too many peers are joining through this contact.
    REFUSED_FULL = 1, "LS2D_REFUSED_FULL";
    /// Reason: another peer already has the `peer` number of this peer.
    REFUSED_TAKEN = 2, "LS2D_REFUSED_TAKEN";
    /// Reason: the contact is not in a match yet. This peer repeats its request.
    REFUSED_NOT_READY = 3, "LS2D_REFUSED_NOT_READY";
    /// Status: follows the match and requests a seat.
    MATCH_JOINING = 0, "LS2D_MATCH_JOINING";
    /// Status: follows the match.
    MATCH_WATCHING = 1, "LS2D_MATCH_WATCHING";
    /// Status: has a seat, or is a dedicated server, in a match that has not begun.
    MATCH_WAITING = 2, "LS2D_MATCH_WAITING";
    /// Status: plays.
    MATCH_PLAYING = 3, "LS2D_MATCH_PLAYING";
    /// Status: no messages of a majority of the peers arrive, directly or through other peers.
    MATCH_PAUSED = 4, "LS2D_MATCH_PAUSED";
    /// Status: the other peers went on without this peer, which requests its seat again.
    MATCH_DROPPED = 5, "LS2D_MATCH_DROPPED";
    /// Status: removed by a vote.
    MATCH_KICKED = 6, "LS2D_MATCH_KICKED";
    /// Status: announces its departure.
    MATCH_LEAVING = 7, "LS2D_MATCH_LEAVING";
    /// Status: has left.
    MATCH_LEFT = 8, "LS2D_MATCH_LEFT";
    /// Status: all ticks of the match are final.
    MATCH_FINISHED = 9, "LS2D_MATCH_FINISHED";
    /// Status: nothing more is sent.
    MATCH_CLOSED = 10, "LS2D_MATCH_CLOSED";
    /// Status: requests to join, or downloads the initial state.
    MATCH_CONNECTING = 11, "LS2D_MATCH_CONNECTING";
}

records! {
    /// Upper limits on the size of a replay and on the cost of playing it. `ls2d_limits_init` sets the defaults.
    struct RawLimits = "ls2d_limits" {
        /// Size of this struct in bytes.
        size: u32,
        /// Reserved: 0.
        reserved: u32,
        /// Largest number of bytes of the file.
        file_bytes: u64,
        /// Largest number of bytes of the setup.
        setup_bytes: u32,
        /// Largest number of players.
        players: u32,
        /// Largest number of bytes of a block, the part of the file with the inputs between two checkpoints.
        block_bytes: u32,
        /// Largest number of ticks between checkpoints.
        block_ticks: u32,
        /// Largest number of ticks of the game.
        ticks: u64,
        /// Largest number of bodies of the world.
        bodies: u64,
        /// Largest number of work units of a tick. A unit takes about a microsecond or less.
        tick_work: u64,
        /// Largest number of work units of the game.
        total_work: u64,
    }

    /// Result of verifying a replay. Every verdict except `LS2D_MATCH` means that the replay is not verified.
    struct RawVerdict = "ls2d_verdict" {
        /// `LS2D_MATCH` and so on.
        kind: u32,
        /// Reserved: 0.
        reserved: u32,
        /// Number of ticks played, for `LS2D_MATCH`, `LS2D_CLAIM_MISMATCH` and `LS2D_INCOMPLETE`; tick of the first
        /// checkpoint that differs, for `LS2D_DIVERGED`; otherwise 0.
        ticks: u64,
        /// Hash of the last state for `LS2D_MATCH`, `LS2D_CLAIM_MISMATCH` and `LS2D_INCOMPLETE`; otherwise 0.
        hash: RawHash,
    }

    /// Parameters of a match and of a peer. `ls2d_match_config_init` sets the defaults.
    struct RawMatchConfig = "ls2d_match_config" {
        /// Size of this struct in bytes.
        size: u32,
        /// Number of seats of the match, 1 to 64.
        seats: u32,
        /// Number of seats that this peer plays; 0 for a spectator or a dedicated server.
        own_seats: u32,
        /// Number of seats that have to be taken before the first tick, including those of the host.
        start_with: u32,
        /// Bytes of an input, 1 to 512.
        input_bytes: u32,
        /// Duration of a tick in microseconds, 1000 to 1 000 000.
        tick_micros: u32,
        /// Number of ticks that may be played with guessed inputs of other peers, 0 to 32; 0 means lockstep.
        guess: u32,
        /// Smallest delay of this peer's own inputs in ticks. The delay follows the latency.
        delay_min: u32,
        /// Largest delay of this peer's own inputs in ticks, at most 60.
        delay_max: u32,
        /// Interval in ticks at which states are saved. 0, the default, stands for the interval of a Rust `Peer`: 1
        /// with guessed inputs; in lockstep, the largest divisor of `check_interval` up to 8, or 6 if `check_interval`
        /// is 0.
        save_interval: u32,
        /// Interval in ticks at which states are compared: a multiple of `save_interval`. 0, the default, stands for
        /// the interval of a Rust `Peer`: the largest multiple of `save_interval` up to 10, or `save_interval` if it is
        /// more than 10.
        check_interval: u32,
        /// Number of ticks that may be played beyond the last final tick, at least 16.
        history: u32,
        /// Minimum number of final ticks whose inputs are kept for peers that return, at least `history`.
        log_ticks: u32,
        /// When a peer joins, its first tick lies three round trips and this number of ticks after the agreement on its
        /// seat.
        seat_lead: u32,
        /// A peer may get a seat if it lags by at most this many ticks.
        seat_within: u32,
        /// Number that identifies this peer. Choose a new random number in each process.
        peer: u32,
        /// Tag of the match: packets with another tag are ignored.
        match_tag: u64,
        /// Time in microseconds for which the other peers wait for a missing peer before they go on without it.
        patience: u64,
        /// Identity of the player: a peer that joins with the same key gets its seat back, if the seat is free.
        key: u64,
        /// Secret random numbers that protect against packets with forged addresses.
        secret: [u64; 2],
    }

    /// A request of a match or of a replay to the game.
    struct RawRequest = "ls2d_request" {
        /// `LS2D_REQUEST_SAVE` and so on.
        kind: u32,
        /// The tick that the request is about.
        tick: u32,
        /// Bit for each seat that nobody plays, for `LS2D_REQUEST_ADVANCE`.
        absent: u64,
        /// Bit for each seat whose input is guessed, for `LS2D_REQUEST_ADVANCE`.
        guessed: u64,
    }

    /// An event of a match.
    struct RawMatchEvent = "ls2d_match_event" {
        /// `LS2D_EVENT_STATUS` and so on.
        kind: u32,
        /// Number of the peer that the event names.
        peer: u32,
        /// The seat that the event names.
        seat: u32,
        /// The tick that the event names.
        tick: u32,
        /// A value whose meaning depends on the kind.
        value: u32,
        /// Reserved: 0.
        reserved: u32,
        /// Hash of this peer, for `LS2D_EVENT_DESYNC`.
        ours: RawHash,
        /// Hash of the other peer, for `LS2D_EVENT_DESYNC`.
        theirs: RawHash,
    }
}

impl RawLimits {
    pub(crate) fn of(limits: &Limits) -> Self {
        let Limits {
            file_bytes,
            setup_bytes,
            players,
            block_bytes,
            block_ticks,
            ticks,
            bodies,
            tick_work,
            total_work,
        } = *limits;
        RawLimits {
            size: size::<Self>(),
            reserved: 0,
            file_bytes,
            setup_bytes,
            players,
            block_bytes,
            block_ticks,
            ticks,
            bodies,
            tick_work,
            total_work,
        }
    }

    pub(crate) fn limits(&self) -> Outcome<Limits> {
        check_size::<Self>(self.size)?;
        check_reserved(self.reserved)?;
        let RawLimits { file_bytes, setup_bytes, players, block_bytes, block_ticks, ticks, .. } = *self;
        let RawLimits { bodies, tick_work, total_work, .. } = *self;
        Ok(Limits {
            file_bytes,
            setup_bytes,
            players,
            block_bytes,
            block_ticks,
            ticks,
            bodies,
            tick_work,
            total_work,
        })
    }
}

impl RawVerdict {
    pub(crate) fn of(verdict: &Verdict) -> Self {
        let kind = match verdict {
            Verdict::Match { .. } => MATCH,
            Verdict::ClaimMismatch { .. } => CLAIM_MISMATCH,
            Verdict::Diverged { .. } => DIVERGED,
            Verdict::Incomplete { .. } => INCOMPLETE,
            Verdict::Malformed { .. } => MALFORMED,
            Verdict::LimitExceeded { .. } => LIMIT_EXCEEDED,
            Verdict::Unverifiable { .. } => UNVERIFIABLE,
        };
        let hash = RawHash::of(verdict.hash().unwrap_or_default());
        RawVerdict { kind, reserved: 0, ticks: verdict.ticks(), hash }
    }
}

pub(crate) const fn match_status(status: Status) -> u32 {
    match status {
        Status::Joining => MATCH_JOINING,
        Status::Watching => MATCH_WATCHING,
        Status::Waiting => MATCH_WAITING,
        Status::Playing => MATCH_PLAYING,
        Status::Paused => MATCH_PAUSED,
        Status::Dropped => MATCH_DROPPED,
        Status::Kicked => MATCH_KICKED,
        Status::Leaving => MATCH_LEAVING,
        Status::Left => MATCH_LEFT,
        Status::Finished { .. } => MATCH_FINISHED,
        Status::Closed => MATCH_CLOSED,
    }
}

impl RawMatchEvent {
    pub(crate) fn new(kind: u32) -> Self {
        let none = RawHash { low: 0, high: 0 };
        RawMatchEvent { kind, peer: 0, seat: 0, tick: 0, value: 0, reserved: 0, ours: none, theirs: none }
    }

    pub(crate) fn of(event: Event) -> Self {
        let new = RawMatchEvent::new;
        let raw = |hash: u128| RawHash::of(lockstep2d::hash::StateHash(hash));
        match event {
            Event::Status(status) => {
                let tick = if let Status::Finished { ticks } = status { ticks } else { 0 };
                Self { value: match_status(status), tick, ..new(EVENT_STATUS) }
            }
            Event::View { number } => Self { value: number, ..new(EVENT_VIEW) },
            Event::Seated { peer, seat, from } => {
                Self { peer: peer.0, seat: seat.into(), tick: from, ..new(EVENT_SEATED) }
            }
            Event::Unseated { peer, seat, from } => {
                Self { peer: peer.0, seat: seat.into(), tick: from, ..new(EVENT_UNSEATED) }
            }
            Event::Waiting { peer, heard } => {
                Self { peer: peer.0, value: heard.into(), ..new(EVENT_WAITING) }
            }
            Event::Resumed => new(EVENT_RESUMED),
            Event::Pause { peer, paused } => Self { peer: peer.0, value: paused.into(), ..new(EVENT_PAUSE) },
            Event::End { ticks } => Self { tick: ticks, ..new(EVENT_END) },
            Event::Desync { peer, tick, ours, theirs } => {
                Self { peer: peer.0, tick, ours: raw(ours), theirs: raw(theirs), ..new(EVENT_DESYNC) }
            }
            Event::Conflict { peer, tick } => Self { peer: peer.0, tick, ..new(EVENT_CONFLICT) },
            Event::TooFarBehind => new(EVENT_TOO_FAR_BEHIND),
        }
    }

    pub(crate) fn refused(reason: RefusalReason) -> Self {
        let value = match reason {
            RefusalReason::Offer => REFUSED_OFFER,
            RefusalReason::Full => REFUSED_FULL,
            RefusalReason::Taken => REFUSED_TAKEN,
            RefusalReason::NotReady => REFUSED_NOT_READY,
        };
        Self { value, ..Self::new(EVENT_REFUSED) }
    }
}
