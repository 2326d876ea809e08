use core::fmt;

use super::view::SEATS_MAX;

/// One millisecond in microseconds. All times of a session are in microseconds.
pub(super) const MS: u64 = 1000;

/// Largest time. Later times count as this one, so that sums of times do not overflow.
pub(super) const TIME_MAX: u64 = u64::MAX / 2;
/// Largest value of a field of [`Timing`], except `patience`: a day.
const TIMING_MAX: u64 = 86_400_000 * MS;

/// Largest number of ticks that may be played with guessed inputs.
pub const GUESS_MAX: u16 = 32;
/// Largest delay of inputs in ticks.
pub const DELAY_MAX: u16 = 60;
/// Largest size of an input in bytes.
pub const INPUT_BYTES_MAX: u16 = 512;

/// Time limits of a session, in microseconds. `patience` must be equal for all peers of a match. Each of the other
/// limits is at most a day.
///
/// ```
/// use lockstep2d::session::{Config, Timing};
/// // A board game waits a minute for a missing player.
/// let timing = Timing { patience: 60_000_000, ..Timing::DEFAULT };
/// let config = Config { timing, ..Config::new(0, 4) };
/// assert!(config.validate().is_ok() && timing.patience > Timing::DEFAULT.patience);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Timing {
    /// Time for which the other peers wait for a missing peer before they continue without it; `u64::MAX` for no limit.
    /// [`Session::go_on_without`](super::Session::go_on_without) ends a stall earlier.
    pub patience: u64,
    /// Time for which a peer counts as heard after a packet from it has arrived.
    /// [`Event::Waiting`](super::Event::Waiting) reports a stall that is longer than both this time and six ticks.
    pub heard: u64,
    /// Time for which a peer's row (its latest status record) counts as fresh.
    pub fresh: u64,
    /// Time for which a proposer waits for promises of the remaining voters, after a quorum has promised.
    pub promises: u64,
    /// Minimum time between the promise of a ballot and the start of another ballot. Each round without a decision
    /// lengthens this time.
    pub ballot: u64,
    /// Minimum time for which a peer that has finished or left still answers.
    pub linger: u64,
    /// Maximum time for which a peer that has finished or left still answers; also the maximum time for which a leaving
    /// peer waits for a decision.
    pub linger_max: u64,
    /// Upper bound of the time that counts as passed between two calls. Without this bound, a process that was
    /// suspended would consider the other peers silent.
    pub step_max: u64,
}

impl Timing {
    /// Time limits for matches over the internet.
    pub const DEFAULT: Timing = Timing {
        patience: 2000 * MS,
        heard: 300 * MS,
        fresh: 1000 * MS,
        promises: 500 * MS,
        ballot: 1500 * MS,
        linger: 2000 * MS,
        linger_max: 12_000 * MS,
        step_max: 250 * MS,
    };
}

/// Parameters of a session.
///
/// ```
/// use lockstep2d::session::{Config, ConfigError, GUESS_MAX};
/// // Four seats at 30 ticks a second with inputs of two bytes. The match begins with two players.
/// let config = Config { input_bytes: 2, tick_micros: 33_333, start_with: 2, guess: 8, ..Config::new(17, 4) };
/// assert_eq!(config.validate(), Ok(()));
/// let config = Config { guess: GUESS_MAX + 1, ..config };
/// let error = ConfigError { field: "guess", value: 33, min: 0, max: 32, step: 1 };
/// assert_eq!(config.validate(), Err(error));
/// assert_eq!(error.to_string(), "the session cannot start: `guess` is 0 to 32, not 33");
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Config {
    /// Identifies the match. Packets with another tag are ignored.
    pub match_tag: u64,
    /// Number of seats, 1 to [`SEATS_MAX`].
    pub seats: u8,
    /// Bytes of an input, 1 to [`INPUT_BYTES_MAX`].
    pub input_bytes: u16,
    /// Duration of a tick in microseconds, 1000 to 1 000 000.
    pub tick_micros: u32,
    /// Number of seats that must be taken before the first tick, at most `seats`. The value of the
    /// [tie-holder](super::View::tie_holder) applies to all peers.
    pub start_with: u8,
    /// The seats that this peer requests, one bit for each; 0 requests any free seats.
    pub seats_wanted: u64,
    /// Number of ticks that may be played with guessed inputs, at most [`GUESS_MAX`]; 0 is lockstep. Peers may have
    /// different values.
    pub guess: u16,
    /// Smallest delay of inputs in ticks, at most `delay_max`. Peers may have different values.
    pub delay_min: u16,
    /// Largest delay of inputs in ticks, at most [`DELAY_MAX`].
    pub delay_max: u16,
    /// Ticks from the [cut](super::View::cut) of a view change to the first tick of a joining peer, in addition to
    /// three round trips. The sum is limited to half of `history`, or to `seat_lead` if `seat_lead` is larger. Unused
    /// before the match begins.
    pub seat_lead: u16,
    /// A peer requests a seat only while its number of played ticks is at most this many below the largest
    /// acknowledgement of the voters.
    pub seat_within: u16,
    /// Number of ticks that may be played beyond the last final one, at least 16.
    pub history: u16,
    /// Number of final ticks whose inputs are kept for peers that reconnect; at least `history`.
    pub log_ticks: u32,
    /// Interval in ticks at which states are saved, from 1 to half of `history`.
    pub save_interval: u16,
    /// Interval in ticks at which states are compared: a multiple of `save_interval`.
    pub check_interval: u16,
    /// Time limits.
    pub timing: Timing,
    /// Deliberate mistakes for tests.
    #[cfg(feature = "__faults")]
    #[doc(hidden)]
    pub fault: Option<Fault>,
}

/// A parameter that is out of its range.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ConfigError {
    /// Name of the field.
    pub field: &'static str,
    /// Value of the parameter.
    pub value: u64,
    /// Smallest value allowed.
    pub min: u64,
    /// Largest value allowed.
    pub max: u64,
    /// The value must be a multiple of this number.
    pub step: u64,
}

impl fmt::Display for ConfigError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ConfigError { field, value, min, max, step } = self;
        write!(f, "the session cannot start: `{field}` is {min} to {max}")?;
        if *step > 1 {
            write!(f, " in steps of {step}")?;
        }
        write!(f, ", not {value}")
    }
}

impl core::error::Error for ConfigError {}

impl Config {
    /// Lockstep at 60 ticks a second, with inputs of one byte.
    #[must_use]
    pub const fn new(match_tag: u64, seats: u8) -> Self {
        Config {
            match_tag,
            seats,
            input_bytes: 1,
            tick_micros: 16_667,
            start_with: 1,
            seats_wanted: 0,
            guess: 0,
            delay_min: 0,
            delay_max: 20,
            seat_lead: 8,
            seat_within: 40,
            history: 128,
            log_ticks: 36_000,
            save_interval: 8,
            check_interval: 64,
            timing: Timing::DEFAULT,
            #[cfg(feature = "__faults")]
            fault: None,
        }
    }

    /// Checks all ranges.
    ///
    /// # Errors
    /// [`ConfigError`] for the first field that is out of its range.
    pub fn validate(&self) -> Result<(), ConfigError> {
        let check = |field: &'static str, value: u64, (min, max): (u64, u64), step: u64| {
            let is_valid = (min..=max).contains(&value) && value.is_multiple_of(step);
            is_valid.then_some(()).ok_or(ConfigError { field, value, min, max, step })
        };
        let [seats_max, history, save_interval] =
            [SEATS_MAX as u64, self.history.into(), self.save_interval.into()];
        for (field, value, range) in [
            ("seats", self.seats.into(), (1, seats_max)),
            ("input_bytes", self.input_bytes.into(), (1, INPUT_BYTES_MAX.into())),
            ("tick_micros", self.tick_micros.into(), (1000, 1_000_000)),
            ("start_with", self.start_with.into(), (0, self.seats.into())),
            ("seats_wanted", self.seats_wanted, (0, self.seat_set())),
            ("guess", self.guess.into(), (0, GUESS_MAX.into())),
            ("delay_max", self.delay_max.into(), (0, DELAY_MAX.into())),
            ("delay_min", self.delay_min.into(), (0, self.delay_max.into())),
            ("history", history, (16, u16::MAX.into())),
            ("save_interval", save_interval, (1, history / 2)),
            ("log_ticks", self.log_ticks.into(), (history, u32::MAX.into())),
        ] {
            check(field, value, range, 1)?;
        }
        let Timing { patience: _, heard, fresh, promises, ballot, linger, linger_max, step_max } =
            self.timing;
        for (field, value) in [
            ("timing.heard", heard),
            ("timing.fresh", fresh),
            ("timing.promises", promises),
            ("timing.ballot", ballot),
            ("timing.linger", linger),
            ("timing.linger_max", linger_max),
            ("timing.step_max", step_max),
        ] {
            check(field, value, (0, TIMING_MAX), 1)?;
        }
        check("check_interval", self.check_interval.into(), (save_interval, u16::MAX.into()), save_interval)
    }

    pub(super) fn seat_set(&self) -> u64 {
        if usize::from(self.seats) >= SEATS_MAX { u64::MAX } else { (1 << self.seats) - 1 }
    }

    /// Whether an injected fault is active.
    #[cfg(not(feature = "__faults"))]
    #[expect(clippy::unused_self, reason = "the other version needs it")]
    pub(super) const fn has(&self, _: Fault) -> bool {
        false
    }

    #[cfg(feature = "__faults")]
    pub(super) fn has(&self, fault: Fault) -> bool {
        self.fault == Some(fault)
    }
}

/// Deliberate mistakes in the protocol, which tests must detect.
#[doc(hidden)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// A promise does not freeze the acknowledgement.
    NoFreeze,
    /// The cut is the acknowledgement of the proposer alone.
    OwnCut,
    /// Complete ticks (those with all inputs) count as final.
    FinalComplete,
    /// Half of the weight counts as a quorum.
    HalfIsEnough,
    /// Complete ticks are not computed again when a view is installed.
    KeepComplete,
    /// Rows and inputs of other peers are not relayed.
    NoRelay,
    /// The match ends at the tick that this peer wants, not at the decided one.
    LocalEnd,
    /// Ballots start while a promise is in force.
    CompetingBallots,
    /// A proposal drops the voters that have not promised the ballot at once, and does not wait for `patience`.
    Accuse,
    /// A proposer ignores changes that other voters have accepted.
    ForgetAccepted,
    /// A change is accepted without the inputs before its cut.
    AcceptBlind,
    /// A peer that has finished or left does not linger.
    HastyLeave,
    /// Wrong guesses are not corrected.
    NoRollback,
}
