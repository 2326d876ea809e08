//! [`Limits`]: how much a stranger's file may cost.

use core::fmt;

use super::format::{BLOCK_BYTES_MAX, BLOCK_TICKS_MAX, PLAYERS_MAX, SETUP_BYTES_MAX};
use super::reader::ReadError;

/// How large a replay may be and how much it may compute.
///
/// The default lets through what any honest game records in a day and stops one file after some minutes of
/// computing. A server that knows its game narrows it: to a race of ten minutes and two players, for example.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Bytes of the whole file.
    pub file_bytes: u64,
    /// Bytes of the encoded setup.
    pub setup_bytes: u32,
    /// Players.
    pub players: u32,
    /// Bytes of a block's payload.
    pub block_bytes: u32,
    /// Ticks between two checkpoints, which is also the longest run.
    pub block_ticks: u32,
    /// Ticks of the whole game.
    pub ticks: u64,
    /// Bodies in the game's world, at the start and after every tick, if it shows one
    /// ([`Game::world_mut`](crate::lockstep::Game::world_mut)). Between two looks, `setup_bytes` and `tick_work` bound
    /// them.
    pub bodies: u64,
    /// Work units of one tick, as [`Game::work`](crate::lockstep::Game::work) counts them.
    pub tick_work: u64,
    /// Work units of the whole game.
    pub total_work: u64,
}

impl Default for Limits {
    fn default() -> Self {
        Limits {
            file_bytes: 64 << 20,
            setup_bytes: SETUP_BYTES_MAX,
            players: PLAYERS_MAX,
            block_bytes: BLOCK_BYTES_MAX,
            block_ticks: BLOCK_TICKS_MAX,
            // A day at 60 Hz.
            ticks: 24 * 60 * 60 * 60,
            // As many as a world can hold.
            bodies: 1 << 20,
            // A unit of the sandbox is some 25 ns: a quarter of a second, and eight minutes.
            tick_work: 10_000_000,
            total_work: 20_000_000_000,
        }
    }
}

/// Names one of the [`Limits`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Limit {
    /// [`Limits::file_bytes`]
    FileBytes,
    /// [`Limits::setup_bytes`]
    SetupBytes,
    /// [`Limits::players`]
    Players,
    /// [`Limits::block_bytes`]
    BlockBytes,
    /// [`Limits::block_ticks`]
    BlockTicks,
    /// [`Limits::ticks`]
    Ticks,
    /// [`Limits::bodies`]
    Bodies,
    /// [`Limits::tick_work`]
    TickWork,
    /// [`Limits::total_work`]
    TotalWork,
}

impl Limit {
    /// The name of the field in [`Limits`].
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Limit::FileBytes => "file_bytes",
            Limit::SetupBytes => "setup_bytes",
            Limit::Players => "players",
            Limit::BlockBytes => "block_bytes",
            Limit::BlockTicks => "block_ticks",
            Limit::Ticks => "ticks",
            Limit::Bodies => "bodies",
            Limit::TickWork => "tick_work",
            Limit::TotalWork => "total_work",
        }
    }

    /// Refuses a value above `max`.
    pub(super) fn check(self, value: impl Into<u64>, max: impl Into<u64>) -> Result<(), ReadError> {
        let (value, max) = (value.into(), max.into());
        if value > max { Err(ReadError::LimitExceeded { limit: self, value, max }) } else { Ok(()) }
    }
}

impl fmt::Display for Limit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Limit::FileBytes => "bytes of the file",
            Limit::SetupBytes => "bytes of the setup",
            Limit::Players => "players",
            Limit::BlockBytes => "bytes of a block",
            Limit::BlockTicks => "ticks between checkpoints",
            Limit::Ticks => "ticks",
            Limit::Bodies => "bodies",
            Limit::TickWork => "work units in one tick",
            Limit::TotalWork => "work units",
        })
    }
}
