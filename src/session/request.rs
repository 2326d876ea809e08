use alloc::vec::Vec;
use core::fmt;

use super::id::Tick;
use super::view::has_bit;

/// Status of the input of a seat.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InputStatus {
    /// Issued by the player.
    Confirmed,
    /// Not received yet. The player's last known input is used, or zeros if there is none.
    Guessed,
    /// No peer plays the seat.
    Absent,
}

/// The inputs of all seats for a tick.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TickInputs {
    pub(super) bytes: Vec<u8>,
    pub(super) size: usize,
    pub(super) absent: u64,
    pub(super) guessed: u64,
}

impl TickInputs {
    /// The input of a seat with its status; `None` if the seat does not exist. The input of an absent player is zeros.
    #[must_use]
    pub fn seat(&self, seat: u8) -> Option<(&[u8], InputStatus)> {
        let index = usize::from(seat);
        let input = self.bytes.chunks_exact(self.size.max(1)).nth(index)?;
        let status = if has_bit(self.absent, index) {
            InputStatus::Absent
        } else if has_bit(self.guessed, index) {
            InputStatus::Guessed
        } else {
            InputStatus::Confirmed
        };
        Some((input, status))
    }

    /// The inputs of all seats, one after another.
    #[must_use]
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// Bit for each seat that no peer plays.
    #[must_use]
    pub fn absent(&self) -> u64 {
        self.absent
    }

    /// Bit for each seat whose input is guessed.
    #[must_use]
    pub fn guessed(&self) -> u64 {
        self.guessed
    }

    pub(super) fn set(&mut self, seat: u8, input: &[u8]) {
        let start = usize::from(seat) * self.size;
        if let Some(place) = self.bytes.get_mut(start..start + self.size) {
            place.copy_from_slice(input);
        }
    }
}

/// A request of a session to the game.
///
/// ```
/// use lockstep2d::session::{Config, InputStatus, Request, Session, TickInputs, Tick};
/// /// A game in a session, whose state is the sum of all inputs.
/// #[derive(Default)]
/// struct Sum { now: u64, saved: Vec<(Tick, u64)> }
/// impl Sum {
///     fn fulfil(&mut self, request: Request, session: &mut Session) {
///         match request {
///             Request::Save { tick } => self.saved.push((tick, self.now)),
///             Request::Load { tick } => self.now = self.before(tick),
///             Request::Advance { inputs, .. } => self.now += Self::of_tick(&inputs),
///             Request::Checksum { tick } => session.report_hash(tick, self.before(tick).into()),
///             Request::Forget { tick } => self.saved.retain(|saved| saved.0 >= tick),
///         }
///     }
///     fn before(&self, tick: Tick) -> u64 {
///         self.saved.iter().rev().find(|saved| saved.0 == tick).expect("saved").1
///     }
///     fn of_tick(inputs: &TickInputs) -> u64 {
///         match inputs.seat(0) {
///             Some((_, InputStatus::Absent)) | None => 0,
///             Some((bytes, InputStatus::Confirmed | InputStatus::Guessed)) => bytes[0].into(),
///         }
///     }
/// }
/// # use lockstep2d::session::{Key, PeerId, Role, View};
/// # let view = View::opened_by(PeerId(1), Key(1), 1, true);
/// # let mut session = Session::new(Config::new(17, 1), PeerId(1), Key(1), Role::Player { seats: 1 }, view, 7)?;
/// // A match of one player, who presses 3 in every tick of a second.
/// let mut sum = Sum::default();
/// for millisecond in 0..1000 {
///     let now = millisecond * 1000;
///     session.update(now);
///     while session.is_due(now) {
///         session.advance(now, &[3]).expect("one byte");
///         while let Some(request) = session.next_request() {
///             sum.fulfil(request, &mut session);
///         }
///     }
/// }
/// assert!(session.played() > 50);
/// assert_eq!(sum.now, 3 * u64::from(session.played()));
/// # Ok::<(), lockstep2d::session::ConfigError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Request {
    /// Keep a copy of the state before this tick. It replaces an older copy for the same tick.
    Save {
        /// The tick.
        tick: Tick,
    },
    /// Restore the copy of the state before this tick. Copies for later ticks are no longer needed.
    Load {
        /// The tick.
        tick: Tick,
    },
    /// Simulate a tick.
    Advance {
        /// The tick.
        tick: Tick,
        /// The inputs.
        inputs: TickInputs,
    },
    /// Pass the hash of the copy of the state before this tick to
    /// [`Session::report_hash`](super::Session::report_hash).
    Checksum {
        /// The tick.
        tick: Tick,
    },
    /// Copies for earlier ticks are no longer needed.
    Forget {
        /// The tick.
        tick: Tick,
    },
}

/// Error: the inputs do not have the expected size.
///
/// ```
/// # use lockstep2d::session::{Config, Key, PeerId, Role, Session, View};
/// use lockstep2d::session::InputSize;
/// # let view = View::opened_by(PeerId(1), Key(1), 0b11, true);
/// # let mut session = Session::new(Config::new(17, 2), PeerId(1), Key(1), Role::Player { seats: 2 }, view, 7)?;
/// // Two players share one machine, but only the input of one of them is given.
/// assert_eq!(session.advance(0, &[0x10]), Err(InputSize { expected: 2, given: 1 }));
/// # Ok::<(), lockstep2d::session::ConfigError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct InputSize {
    /// Expected number of bytes: the size of an input times the number of own seats.
    pub expected: usize,
    /// Given number of bytes.
    pub given: usize,
}

impl fmt::Display for InputSize {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} bytes of inputs, {} are expected", self.given, self.expected)
    }
}

impl core::error::Error for InputSize {}
