use alloc::string::{String, ToString};
use alloc::vec::Vec;

use serde::{Deserialize, Serialize};

use crate::codec;
use crate::hash::StateHash;
use crate::lockstep::Game;
use crate::session::Config;

/// Parameters that must be equal for all peers of a match.
///
/// ```
/// use lockstep2d::{SEMANTICS, hash::StateHash, peer::{ParameterDifference, PeerParameters}};
/// let ours = PeerParameters {
///     semantics: SEMANTICS,
///     rules: "pucks".into(),
///     rules_version: 2,
///     setup: StateHash::of("level 3"),
///     tick_rate: 60,
///     players: 2,
///     input_bytes: 1,
///     patience: 2_000_000,
/// };
/// // The reason why another peer cannot join.
/// let theirs = PeerParameters { rules_version: 1, ..ours.clone() };
/// let [ParameterDifference { what, ours, theirs }] = &ours.differences(&theirs)[..] else { panic!("one") };
/// assert_eq!(format!("{what}: {theirs} there, {ours} here"), "rules version: 1 there, 2 here");
/// ```
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct PeerParameters {
    /// Version of the engine's semantics, [`SEMANTICS`](crate::SEMANTICS).
    pub semantics: u32,
    /// Name of the game's rules.
    pub rules: String,
    /// Version of the rules.
    pub rules_version: u32,
    /// Hash of the setup.
    pub setup: StateHash,
    /// Ticks per second.
    pub tick_rate: u32,
    /// Number of seats.
    pub players: u32,
    /// Bytes of an input in the session: [`PeerOptions::input_bytes`](super::PeerOptions::input_bytes) plus 2, or
    /// without that option the length of the default input, at least 1.
    pub input_bytes: u16,
    /// [`PeerOptions::patience`](super::PeerOptions::patience) in microseconds.
    pub patience: u64,
}

/// A parameter in which two peers differ.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ParameterDifference {
    /// Name of the parameter.
    pub what: &'static str,
    /// Value of this peer.
    pub ours: String,
    /// Value of the other peer.
    pub theirs: String,
}

impl PeerParameters {
    pub(super) fn of<G: Game>(game: &G, setup: &G::Setup, config: &Config) -> Self {
        PeerParameters {
            semantics: crate::SEMANTICS,
            rules: G::RULES.name.into(),
            rules_version: G::RULES.version,
            setup: StateHash::of_bytes(&codec::encode(setup)),
            tick_rate: game.tick_rate(),
            players: game.players(),
            input_bytes: config.input_bytes,
            patience: config.timing.patience,
        }
    }

    /// The differences to another peer.
    #[must_use]
    pub fn differences(&self, theirs: &Self) -> Vec<ParameterDifference> {
        let values = |parameters: &Self| {
            let PeerParameters {
                semantics,
                rules,
                rules_version,
                setup,
                tick_rate,
                players,
                input_bytes,
                patience,
            } = parameters;
            [
                ("engine semantics", semantics.to_string()),
                ("rules", rules.clone()),
                ("rules version", rules_version.to_string()),
                ("setup", setup.to_string()),
                ("tick rate", tick_rate.to_string()),
                ("number of seats", players.to_string()),
                ("input bytes", input_bytes.to_string()),
                ("patience in microseconds", patience.to_string()),
            ]
        };
        let pairs = values(self).into_iter().zip(values(theirs));
        let differing = pairs.filter(|((_, ours), (_, theirs))| ours != theirs);
        differing.map(|((what, ours), (_, theirs))| ParameterDifference { what, ours, theirs }).collect()
    }
}
