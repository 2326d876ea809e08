use alloc::string::String;
use core::fmt;

use super::format::{CLAIM_NAME_BYTES_MAX, CLAIMS_MAX, PLAYERS_MAX, RULES_NAME_BYTES_MAX};

/// Reason why a file is not a replay that a recorder could have written.
///
/// ```
/// use lockstep2d::{lockstep::Sandbox, replay::{Flaw, Limits, Verdict, verify}};
/// // The message of a website for an uploaded file.
/// let answer = |file: &[u8]| match verify::<Sandbox>(file, &Limits::default()) {
///     Verdict::Malformed { flaw: Flaw::Magic, .. } => "this is no replay",
///     Verdict::Malformed { .. } => "this replay is damaged",
///     verdict => verdict.name(),
/// };
/// assert_eq!(answer(b"GIF89a, a picture"), "this is no replay");
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Flaw {
    /// The first bytes are not [`MAGIC`](super::MAGIC).
    Magic,
    /// The file ends inside the header.
    HeaderCut,
    /// The name of the rules is empty, too long or not UTF-8.
    RulesName,
    /// The header does not match its checksum.
    HeaderChecksum,
    /// There are more players than a game can have.
    Players {
        /// Number of players in the header.
        count: u32,
    },
    /// The tick rate is zero.
    TickRate,
    /// The checkpoint interval is zero.
    CheckpointInterval,
    /// The setup's bytes are not the canonical encoding of a setup.
    Setup,
    /// The game cannot start from this setup.
    SetupRefused {
        /// Reason given by the game.
        why: String,
    },
    /// The game that the setup creates has another number of players than the header states.
    PlayersDisagree {
        /// Players in the header.
        header: u32,
        /// Players of the game.
        game: u32,
    },
    /// The game that the setup creates has another tick rate than the header states.
    TickRateDisagrees {
        /// Tick rate in the header.
        header: u32,
        /// Tick rate of the game.
        game: u32,
    },
    /// The kind of a block is unknown.
    BlockKind {
        /// The kind found.
        kind: u8,
    },
    /// A block does not match its checksum.
    BlockChecksum,
    /// A block ends in the middle of a field.
    BlockCut,
    /// A number is not in its shortest form, or is too large.
    Number,
    /// A block has no ticks.
    EmptyBlock,
    /// A run has no ticks.
    EmptyRun,
    /// Two consecutive runs of a block have the same inputs.
    SplitRun,
    /// A block has more ticks than the checkpoint interval.
    BlockTicks {
        /// Ticks up to and including the run that exceeds the interval.
        ticks: u64,
        /// The checkpoint interval.
        interval: u32,
    },
    /// A block of inputs follows a block with fewer ticks than the checkpoint interval.
    BlockAfterLast,
    /// The bytes of a run are not the canonical encoding of one input for each player.
    Inputs,
    /// The trailer states another number of ticks than the blocks have.
    Ticks {
        /// Ticks in the trailer.
        trailer: u64,
        /// Ticks in the blocks.
        blocks: u64,
    },
    /// The trailer's chain hash does not match the header and the blocks.
    Chain,
    /// The trailer has too many claims.
    Claims {
        /// Number of claims in the trailer.
        count: u32,
    },
    /// The name of a claim is empty, too long or not UTF-8.
    ClaimName,
    /// The claims are not in strictly ascending order of names.
    ClaimOrder,
    /// Bytes follow the last claim.
    TrailerLength,
    /// Bytes follow the trailer.
    TrailingBytes {
        /// Number of bytes.
        count: u64,
    },
}

impl fmt::Display for Flaw {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Flaw::Magic => write!(f, "this is not a replay file"),
            Flaw::HeaderCut => write!(f, "the file ends inside the header"),
            Flaw::RulesName => {
                write!(f, "the name of the rules is not 1 to {RULES_NAME_BYTES_MAX} bytes of UTF-8")
            }
            Flaw::HeaderChecksum => write!(f, "the header does not match its checksum"),
            Flaw::Players { count } => write!(f, "{count} players, at most {PLAYERS_MAX} are possible"),
            Flaw::TickRate => write!(f, "a tick rate of zero"),
            Flaw::CheckpointInterval => write!(f, "a checkpoint interval of zero"),
            Flaw::Setup => write!(f, "the setup is not a valid setup of this game"),
            Flaw::SetupRefused { why } => write!(f, "the setup cannot start a game: {why}"),
            Flaw::PlayersDisagree { header, game } => {
                write!(f, "the header states {header} players, its setup makes a game with {game}")
            }
            Flaw::TickRateDisagrees { header, game } => {
                write!(f, "the header states {header} ticks per second, its setup makes a game with {game}")
            }
            Flaw::BlockKind { kind } => write!(f, "a block of unknown kind {kind}"),
            Flaw::BlockChecksum => write!(f, "the block does not match its checksum"),
            Flaw::BlockCut => write!(f, "the block ends in the middle of a field"),
            Flaw::Number => write!(f, "a number is too large or not in its shortest form"),
            Flaw::EmptyBlock => write!(f, "a block without a tick"),
            Flaw::EmptyRun => write!(f, "a run of no ticks"),
            Flaw::SplitRun => write!(f, "two neighbouring runs have the same inputs"),
            Flaw::BlockTicks { ticks, interval } => {
                write!(f, "{ticks} ticks in a block, at a checkpoint interval of {interval}")
            }
            Flaw::BlockAfterLast => {
                write!(f, "a block of inputs follows a block shorter than the checkpoint interval")
            }
            Flaw::Inputs => write!(f, "the bytes are not one valid input of this game for each player"),
            Flaw::Ticks { trailer, blocks } => {
                write!(f, "the trailer states {trailer} ticks, the blocks have {blocks}")
            }
            Flaw::Chain => write!(f, "the trailer's chain hash is not that of this file"),
            Flaw::Claims { count } => write!(f, "{count} claims, at most {CLAIMS_MAX} are possible"),
            Flaw::ClaimName => {
                write!(f, "the name of a claim is not 1 to {CLAIM_NAME_BYTES_MAX} bytes of UTF-8")
            }
            Flaw::ClaimOrder => write!(f, "the claims are not in ascending order of their names"),
            Flaw::TrailerLength => write!(f, "bytes follow the last claim"),
            Flaw::TrailingBytes { count } => write!(f, "{count} bytes follow the trailer"),
        }
    }
}
