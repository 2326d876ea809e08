use alloc::string::String;
use alloc::vec::Vec;
use core::fmt;

use super::parameters::ParameterDifference;
use crate::replay::RecordError;
use crate::session::ConfigError;

/// Reason why a peer cannot continue.
///
/// ```
/// # use lockstep2d::lockstep::{Sandbox, SandboxSetup};
/// use lockstep2d::peer::{LinkConditions, Network, Peer, PeerError, PeerIdentity, PeerOptions};
/// # let network = Network::new(LinkConditions::default(), 1);
/// // Invalid settings: the smallest delay is larger than the largest.
/// let options = PeerOptions { delay: (9, 3), start_with: 1, ..PeerOptions::lockstep() };
/// let me = PeerIdentity::new([1, 2, 3, 4]);
/// match Peer::<Sandbox, _>::host(&SandboxSetup::default(), options, me, network.port(0)) {
///     Err(PeerError::Config(error)) => assert_eq!(error.field, "delay.0"),
///     other => panic!("{other:?}"),
/// }
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum PeerError {
    /// The setup or the checkpoint interval is invalid, or a replay cannot represent the game, its inputs or its
    /// claims. An own input that changes when it is encoded and decoded gives this error even if there is no replay.
    Record(RecordError),
    /// A value is out of its range. The error names a field of [`PeerOptions`](super::PeerOptions), such as `delay.0`,
    /// a method, such as `Game::tick_rate`, or the `bytes of the default input`.
    Config(ConfigError),
    /// An encoded input is longer than [`PeerOptions::input_bytes`](super::PeerOptions::input_bytes). Without that
    /// option: the length of an encoded input differs from that of the default input, or the default input is longer
    /// than 65 535 bytes.
    InputLength {
        /// Bytes of the encoded input.
        bytes: usize,
        /// Number of bytes available.
        possible: usize,
    },
    /// The number of inputs is not the number of this peer's own seats.
    InputCount {
        /// Number of own seats.
        seats: usize,
        /// Number of inputs.
        inputs: usize,
    },
    /// The match does not have the requested seat.
    Seat {
        /// The requested seat.
        seat: u8,
        /// Number of seats of the match.
        seats: u8,
    },
    /// The requested seat belongs to another peer.
    SeatTaken {
        /// The requested seat.
        seat: u8,
    },
    /// The participant that received the request to join has other parameters than this peer.
    Parameters(Vec<ParameterDifference>),
    /// The participant that received the request to join refuses it.
    Refused {
        /// Reason of the refusal.
        why: &'static str,
    },
    /// The received state is not a state of this game.
    State {
        /// Reason.
        why: String,
    },
    /// A state, or the inputs of a tick, are no longer kept.
    NoState {
        /// Number of ticks before that state or tick.
        tick: u64,
    },
}

impl fmt::Display for PeerError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            PeerError::Record(error) => error.fmt(f),
            PeerError::Config(error) => error.fmt(f),
            PeerError::InputLength { bytes, possible } => {
                write!(
                    f,
                    "an input has {bytes} bytes, {possible} are possible: set `PeerOptions::input_bytes` to the size \
                     of the largest input"
                )
            }
            PeerError::InputCount { seats, inputs } => write!(f, "{inputs} inputs for {seats} own seats"),
            PeerError::Seat { seat, seats } => {
                write!(f, "there is no seat {seat}: the match has seats 0 to {}", seats.saturating_sub(1))
            }
            PeerError::SeatTaken { seat } => write!(f, "seat {seat} is taken"),
            PeerError::Parameters(differences) => {
                write!(f, "the peers have different parameters:")?;
                for (at, ParameterDifference { what, ours, theirs }) in differences.iter().enumerate() {
                    let comma = if at > 0 { "," } else { "" };
                    write!(f, "{comma} {what} {ours} here and {theirs} there")?;
                }
                Ok(())
            }
            PeerError::Refused { why } => write!(f, "refused: {why}"),
            PeerError::State { why } => write!(f, "the received state cannot be used: {why}"),
            PeerError::NoState { tick } => write!(f, "the state after {tick} ticks is not kept"),
        }
    }
}

impl core::error::Error for PeerError {}

impl From<RecordError> for PeerError {
    fn from(error: RecordError) -> Self {
        PeerError::Record(error)
    }
}

impl From<ConfigError> for PeerError {
    fn from(error: ConfigError) -> Self {
        PeerError::Config(error)
    }
}
