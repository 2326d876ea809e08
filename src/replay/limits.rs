use core::fmt;

use super::format::{BLOCK_BYTES_MAX, BLOCK_TICKS_MAX, PLAYERS_MAX, SETUP_BYTES_MAX};
use super::reader::ReadError;

/// Bounds on the size and computing time of a replay.
///
/// The default allows a game of one day at 60 Hz and 20 000 million work units. This number of work units suffices for
/// a day with 150 bodies in contact, or for about seven hours with 400 (`docs/VERIFYING.md`). Within the default
/// limits, the verification of a file that was made to be slow takes up to about five and a half hours. A server for
/// one game should set its own limits.
///
/// ```
/// use lockstep2d::replay::Limits;
/// // Races of two players that last up to ten minutes at 60 Hz.
/// let limits = Limits { players: 2, ticks: 10 * 60 * 60, file_bytes: 1 << 20, ..Limits::default() };
/// assert!(limits.total_work > limits.tick_work);
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Size of the whole file in bytes.
    pub file_bytes: u64,
    /// Size of the encoded setup in bytes.
    pub setup_bytes: u32,
    /// Number of players.
    pub players: u32,
    /// Size of a block's payload in bytes.
    pub block_bytes: u32,
    /// Ticks between two checkpoints. A run of equal inputs is not longer, because it ends with its block.
    pub block_ticks: u32,
    /// Ticks in the whole game.
    pub ticks: u64,
    /// Bodies in the world of the game ([`Game::world`](crate::lockstep::Game::world)), checked at the start and after
    /// every tick. Between these checks, `setup_bytes` and `tick_work` bound the number of bodies.
    pub bodies: u64,
    /// Work units of one tick: those of [`Game::work`](crate::lockstep::Game::work), plus those that the world counts
    /// during the tick.
    pub tick_work: u64,
    /// Work units of the whole game, including its setup.
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
            // Maximum number of bodies in a world.
            bodies: 1 << 20,
            // In a file that was made to be slow, a work unit of the sandbox takes up to a microsecond
            // (docs/VERIFYING.md).
            tick_work: 10_000_000,
            total_work: 20_000_000_000,
        }
    }
}

/// Names one of the [`Limits`].
///
/// ```
/// # use lockstep2d::lockstep::{Sandbox, SandboxSetup};
/// use lockstep2d::replay::{LimitKind, Limits, Recording, Verdict, verify};
/// let mut recording = Recording::<Sandbox>::start(&SandboxSetup::default(), 60)?;
/// (0..90).try_for_each(|_| recording.step(&[vec![]]))?;
/// let file = recording.finish()?;
/// // Only races of up to one second are accepted.
/// let limits = Limits { ticks: 60, ..Limits::default() };
/// match verify::<Sandbox>(&file, &limits) {
///     Verdict::LimitExceeded { limit, max, .. } => assert_eq!((limit, max), (LimitKind::Ticks, 60)),
///     verdict => panic!("{verdict}"),
/// }
/// # Ok::<(), lockstep2d::replay::RecordError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LimitKind {
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

impl LimitKind {
    /// Name of the field in [`Limits`].
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            LimitKind::FileBytes => "file_bytes",
            LimitKind::SetupBytes => "setup_bytes",
            LimitKind::Players => "players",
            LimitKind::BlockBytes => "block_bytes",
            LimitKind::BlockTicks => "block_ticks",
            LimitKind::Ticks => "ticks",
            LimitKind::Bodies => "bodies",
            LimitKind::TickWork => "tick_work",
            LimitKind::TotalWork => "total_work",
        }
    }

    pub(super) fn check(self, value: impl Into<u64>, max: impl Into<u64>) -> Result<(), ReadError> {
        let (value, max) = (value.into(), max.into());
        if value > max { Err(ReadError::LimitExceeded { limit: self, value, max }) } else { Ok(()) }
    }
}

impl fmt::Display for LimitKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            LimitKind::FileBytes => "bytes of the file",
            LimitKind::SetupBytes => "bytes of the setup",
            LimitKind::Players => "players",
            LimitKind::BlockBytes => "bytes of a block",
            LimitKind::BlockTicks => "ticks between checkpoints",
            LimitKind::Ticks => "ticks",
            LimitKind::Bodies => "bodies",
            LimitKind::TickWork => "work units in one tick",
            LimitKind::TotalWork => "work units",
        })
    }
}
