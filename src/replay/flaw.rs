//! [`Flaw`]: what is wrong with the bytes of a replay.

use alloc::string::String;
use core::fmt;

use super::format::{CLAIM_NAME_BYTES_MAX, CLAIMS_MAX, PLAYERS_MAX, RULES_NAME_BYTES_MAX};

/// Why a file is no replay, or not one that a recorder could have written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Flaw {
    /// The first bytes are not [`MAGIC`](super::MAGIC).
    Magic,
    /// The file ends inside the header.
    HeaderCut,
    /// The name of the rules is empty, too long or not UTF-8.
    RulesName,
    /// The header's checksum is not that of its bytes.
    HeaderChecksum,
    /// More players than a game can have.
    Players {
        /// How many the header states.
        count: u32,
    },
    /// No ticks in a second.
    TickRate,
    /// No ticks in a block.
    CheckpointInterval,
    /// The setup's bytes are not the canonical encoding of a setup.
    Setup,
    /// The game cannot start from this setup.
    SetupRefused {
        /// The game's reason.
        why: String,
    },
    /// The game made from the setup has another number of players than the header states.
    PlayersDisagree {
        /// As the header has it.
        header: u32,
        /// As the game has it.
        game: u32,
    },
    /// The game made from the setup has another tick rate than the header states.
    TickRateDisagrees {
        /// As the header has it.
        header: u32,
        /// As the game has it.
        game: u32,
    },
    /// A kind of block that this version does not have.
    BlockKind {
        /// The kind.
        kind: u8,
    },
    /// A block's checksum is not that of the bytes before it.
    BlockChecksum,
    /// A block ends in the middle of a field.
    BlockCut,
    /// A number is not written in its shortest form, or is too large.
    Number,
    /// A block without a tick.
    EmptyBlock,
    /// A run of no ticks.
    EmptyRun,
    /// Two neighbouring runs with the same inputs, which are one run.
    SplitRun,
    /// A block has more ticks than the header's checkpoint interval.
    BlockTicks {
        /// Ticks in the block.
        ticks: u64,
        /// The checkpoint interval.
        interval: u32,
    },
    /// A block of inputs follows one with fewer ticks than the interval, which only the last may have.
    BlockAfterLast,
    /// The bytes of a run are not the canonical encoding of one input for each player.
    Inputs,
    /// The trailer states another number of ticks than the blocks have.
    Ticks {
        /// As the trailer has it.
        trailer: u64,
        /// As the blocks have it.
        blocks: u64,
    },
    /// The trailer's chain hash is not that of the header and the blocks.
    Chain,
    /// More claims than a trailer may have.
    Claims {
        /// How many it states.
        count: u32,
    },
    /// The name of a claim is empty, too long or not UTF-8.
    ClaimName,
    /// The claims are not in ascending order of their names, each name once.
    ClaimOrder,
    /// Bytes follow the last claim.
    TrailerLength,
    /// Bytes follow the trailer.
    TrailingBytes {
        /// How many.
        count: u64,
    },
}

impl fmt::Display for Flaw {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Flaw::Magic => write!(f, "this is no replay file"),
            Flaw::HeaderCut => write!(f, "the file ends inside the header"),
            Flaw::RulesName => {
                write!(f, "the name of the rules is not 1 to {RULES_NAME_BYTES_MAX} bytes of UTF-8")
            }
            Flaw::HeaderChecksum => write!(f, "the header does not match its checksum"),
            Flaw::Players { count } => write!(f, "{count} players, at most {PLAYERS_MAX} are possible"),
            Flaw::TickRate => write!(f, "a tick rate of zero"),
            Flaw::CheckpointInterval => write!(f, "a checkpoint interval of zero"),
            Flaw::Setup => write!(f, "the setup is not one of this game"),
            Flaw::SetupRefused { why } => write!(f, "the setup cannot start a game: {why}"),
            Flaw::PlayersDisagree { header, game } => {
                write!(f, "the header states {header} players, its setup makes a game of {game}")
            }
            Flaw::TickRateDisagrees { header, game } => {
                write!(f, "the header states {header} ticks per second, its setup makes a game of {game}")
            }
            Flaw::BlockKind { kind } => write!(f, "a block of unknown kind {kind}"),
            Flaw::BlockChecksum => write!(f, "the block does not match its checksum"),
            Flaw::BlockCut => write!(f, "the block ends in the middle of a field"),
            Flaw::Number => write!(f, "a number in a form that no recorder writes"),
            Flaw::EmptyBlock => write!(f, "a block without a tick"),
            Flaw::EmptyRun => write!(f, "a run of no ticks"),
            Flaw::SplitRun => write!(f, "two neighbouring runs have the same inputs"),
            Flaw::BlockTicks { ticks, interval } => {
                write!(f, "{ticks} ticks in a block, at a checkpoint interval of {interval}")
            }
            Flaw::BlockAfterLast => write!(f, "a block of inputs follows the short one that ends a game"),
            Flaw::Inputs => write!(f, "these are not the inputs of all players of this game"),
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
