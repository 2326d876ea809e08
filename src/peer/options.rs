#[cfg(test)]
mod tests;

use core::time::Duration;

use crate::lockstep::Game;
use crate::replay::CHECKPOINT_INTERVAL;
use crate::session::{Config, ConfigError, INPUT_BYTES_MAX, Key, PeerId, Timing};

use super::error::PeerError;
use super::input_slot::{InputSlot, LENGTH_BYTES};

/// Options of a peer. `patience`, `input_bytes` and `match_tag` must be equal for all peers of a match.
///
/// The defaults are [`PeerOptions::lockstep`] and [`PeerOptions::rollback`]. [`Peer::host`](super::Peer::host), `join`
/// and `watch` check the ranges.
///
/// ```
/// use core::time::Duration;
/// use lockstep2d::peer::PeerOptions;
/// // Three players, who wait at most five seconds for a missing one.
/// let options = PeerOptions { start_with: 3, patience: Duration::from_secs(5), ..PeerOptions::rollback() };
/// assert_eq!(options.guess, 8);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PeerOptions {
    /// Largest number of ticks played with guessed inputs, 0 (lockstep) to 32. Default: 0 for lockstep, 8 for rollback.
    pub guess: u16,
    /// Bounds of the input delay in ticks, 0 to 60. Within these bounds the delay follows the latency. Default: (0, 20)
    /// for lockstep, (1, 20) for rollback.
    pub delay: (u16, u16),
    /// Time after which the other peers continue without a missing peer; `Duration::MAX` for never. Default: 2 s.
    pub patience: Duration,
    /// Number of seats that must be taken before the first tick: 0 to the number of players of the game. Only the value
    /// of the host counts. Default: 2.
    pub start_with: u8,
    /// Number of own seats, at most the number of players. 0 makes a host a dedicated server; a joining player requests
    /// at least 1. Default: 1.
    pub seats: u8,
    /// First own seat. The peer requests this seat and the next ones, `seats` in total. `first_seat` + `seats` is at
    /// most the number of players. Default: `None`, any free seats.
    pub first_seat: Option<u8>,
    /// Largest encoded input in bytes, 0 to 510, for inputs that differ in length: see [`codec`](crate::codec).
    /// Default: `None`, inputs are as long as the default input, which has at most 512 bytes.
    pub input_bytes: Option<u16>,
    /// Identifies a match of a game. A peer with another tag gets no answer. Default: 0.
    pub match_tag: u64,
    /// Ticks per block of the replay, 1 to 3600. Default: 60
    /// ([`CHECKPOINT_INTERVAL`](crate::replay::CHECKPOINT_INTERVAL)).
    pub checkpoint_interval: u32,
}

impl PeerOptions {
    /// Lockstep, with an input delay of 0 to 20 ticks.
    #[must_use]
    pub const fn lockstep() -> Self {
        PeerOptions {
            guess: 0,
            delay: (0, 20),
            patience: Duration::from_secs(2),
            start_with: 2,
            seats: 1,
            first_seat: None,
            input_bytes: None,
            match_tag: 0,
            checkpoint_interval: CHECKPOINT_INTERVAL,
        }
    }

    /// Up to 8 guessed ticks, with an input delay of 1 to 20 ticks.
    #[must_use]
    pub const fn rollback() -> Self {
        PeerOptions { guess: 8, delay: (1, 20), ..Self::lockstep() }
    }

    /// Bit for each seat that this peer requests; 0 for any.
    fn wanted_seats(&self, seats: u8) -> Result<u64, PeerError> {
        let Some(first) = self.first_seat else { return Ok(0) };
        let end = first.saturating_add(self.seats);
        if end > seats {
            return Err(PeerError::Seat { seat: end - 1, seats });
        }
        Ok((first..end).fold(0, |set, seat| set | 1_u64.checked_shl(seat.into()).unwrap_or(0)))
    }

    pub(super) fn config<G: Game>(&self, game: &G, slot: InputSlot) -> Result<Config, PeerError> {
        let seats = u8::try_from(game.players()).unwrap_or(u8::MAX);
        let mut config = Config::new(self.match_tag, seats);
        config.input_bytes = slot.bytes();
        config.tick_micros = 1_000_000 / game.tick_rate().max(1);
        config.start_with = self.start_with;
        config.seats_wanted = self.wanted_seats(seats)?;
        config.guess = self.guess;
        (config.delay_min, config.delay_max) = self.delay;
        let patience = u64::try_from(self.patience.as_micros()).unwrap_or(u64::MAX);
        config.timing = Timing { patience, ..Timing::DEFAULT };
        // Checkpoints need the state hashes of saves, so the save interval divides the checkpoint interval.
        let divides = |interval: &u16| self.checkpoint_interval.is_multiple_of(u32::from(*interval));
        let longest = if self.guess > 0 { 1 } else { 8 };
        config.save_interval = (1..=longest).rev().find(divides).unwrap_or(1);
        config.check_interval = config.save_interval * (10 / config.save_interval).max(1);
        config.validate().map_err(|error| named(error, game, slot))?;
        if self.seats > seats {
            let (value, max) = (self.seats.into(), seats.into());
            return Err(ConfigError { field: "seats", value, min: 0, max, step: 1 }.into());
        }
        Ok(config)
    }
}

/// Replaces the name of the session's field by the name of the peer's option or the game's method that sets it. The
/// error states the value and the range of that option or method.
fn named<G: Game>(error: ConfigError, game: &G, slot: InputSlot) -> ConfigError {
    match (error.field, slot) {
        ("delay_min", _) => ConfigError { field: "delay.0", ..error },
        ("delay_max", _) => ConfigError { field: "delay.1", ..error },
        ("seats", _) => ConfigError { field: "Game::players", value: game.players().into(), ..error },
        ("tick_micros", _) => {
            let value = game.tick_rate().into();
            ConfigError { field: "Game::tick_rate", value, min: 1, max: 1000, step: 1 }
        }
        ("input_bytes", InputSlot::Fixed(_)) => ConfigError { field: "bytes of the default input", ..error },
        ("input_bytes", InputSlot::Prefixed(bytes)) => {
            let max = u64::from(INPUT_BYTES_MAX - LENGTH_BYTES);
            ConfigError { value: bytes.into(), min: 0, max, ..error }
        }
        _ => error,
    }
}

/// Identity of a peer.
///
/// ```
/// use lockstep2d::{peer::PeerIdentity, session::Key};
/// // A player's process crashes and is started again. The lobby knows the player's account.
/// let account = Key(1234);
/// let before = PeerIdentity::random().with_key(account);
/// let after = PeerIdentity::random().with_key(account);
/// // The new process has the same key, so it gets the seat of the old one.
/// assert!(before.key == after.key && before.secret != after.secret);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PeerIdentity {
    /// A random number, new for each process.
    pub id: PeerId,
    /// The identity that outlives processes. A peer that returns with this key gets its seat back, if the seat is free.
    pub key: Key,
    /// Random numbers unknown to others: the key of handshake cookies and probe tokens.
    pub secret: [u64; 2],
}

/// Random numbers: hashes of the numbers from 0. The keys of the standard library's hash function are random numbers of
/// the operating system.
#[cfg(all(feature = "std", not(all(target_family = "wasm", target_os = "unknown"))))]
pub(super) fn random_numbers<const N: usize>() -> [u64; N] {
    use std::hash::{BuildHasher, RandomState};
    let keyed = RandomState::new();
    core::array::from_fn(|number| keyed.hash_one(number))
}

impl PeerIdentity {
    /// An identity from random numbers, which must be new for each process. The low 32 bits of the first are the id,
    /// the second is the key, and the others are the secret.
    #[must_use]
    pub fn new(random: [u64; 4]) -> Self {
        let [id, key, secret @ ..] = random;
        let [a, b, c, d, ..] = id.to_le_bytes();
        PeerIdentity { id: PeerId(u32::from_le_bytes([a, b, c, d])), key: Key(key), secret }
    }

    /// An identity from random numbers of the operating system. On the web, use [`PeerIdentity::new`] with random
    /// numbers of the browser.
    #[cfg(all(feature = "std", not(all(target_family = "wasm", target_os = "unknown"))))]
    #[must_use]
    pub fn random() -> Self {
        PeerIdentity::new(random_numbers())
    }

    /// Replaces the key by one that the lobby has assigned.
    #[must_use]
    pub fn with_key(self, key: Key) -> Self {
        PeerIdentity { key, ..self }
    }
}
