//! [`HandshakeParameters`]: handshake parameters, on which peers have to agree before the first tick.

use alloc::string::String;
use alloc::vec::Vec;
use core::fmt;

use serde::{Deserialize, Serialize};

use super::options::{Mode, NetOptions};
use crate::codec;
use crate::hash::StateHash;
use crate::lockstep::Game;

/// Handshake parameters of a peer. Peers that differ in any of them would reach different states.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct HandshakeParameters {
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
    /// Synchronisation mode.
    pub mode: Mode,
}

/// The handshake parameters in which two peers differ.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct HandshakeMismatch {
    /// All differences.
    pub differences: Vec<HandshakeDifference>,
}

/// A handshake parameter in which two peers differ.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct HandshakeDifference {
    /// Name of the parameter.
    pub what: &'static str,
    /// Value of this peer.
    pub ours: String,
    /// Value of the other peer.
    pub theirs: String,
}

impl fmt::Display for HandshakeMismatch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "the peers have different handshake parameters:")?;
        for (at, HandshakeDifference { what, ours, theirs }) in self.differences.iter().enumerate() {
            let comma = if at > 0 { "," } else { "" };
            write!(f, "{comma} {what} {ours} here and {theirs} there")?;
        }
        Ok(())
    }
}

impl core::error::Error for HandshakeMismatch {}

impl HandshakeParameters {
    /// The handshake parameters of a game.
    pub(super) fn of<G: Game>(game: &G, setup: &G::Setup, options: &NetOptions) -> Self {
        HandshakeParameters {
            semantics: crate::SEMANTICS,
            rules: G::RULES.name.into(),
            rules_version: G::RULES.version,
            setup: StateHash::of_bytes(&codec::encode(setup)),
            tick_rate: game.tick_rate(),
            players: game.players(),
            mode: options.mode,
        }
    }

    /// Compares the parameters with those of another peer.
    ///
    /// # Errors
    /// [`HandshakeMismatch`] with all differences.
    pub fn agree(&self, theirs: &HandshakeParameters) -> Result<(), HandshakeMismatch> {
        let mut differences = Vec::new();
        let mut compare = |what, ours: &dyn fmt::Display, theirs: &dyn fmt::Display| {
            let (ours, theirs) = (alloc::format!("{ours}"), alloc::format!("{theirs}"));
            if ours != theirs {
                differences.push(HandshakeDifference { what, ours, theirs });
            }
        };
        compare("engine semantics", &self.semantics, &theirs.semantics);
        compare("rules", &self.rules, &theirs.rules);
        compare("rules version", &self.rules_version, &theirs.rules_version);
        compare("setup", &self.setup, &theirs.setup);
        compare("tick rate", &self.tick_rate, &theirs.tick_rate);
        compare("number of seats", &self.players, &theirs.players);
        compare("mode", &self.mode, &theirs.mode);
        if differences.is_empty() { Ok(()) } else { Err(HandshakeMismatch { differences }) }
    }
}

#[cfg(test)]
mod tests {
    use alloc::string::ToString;

    use super::*;

    fn parameters() -> HandshakeParameters {
        HandshakeParameters {
            semantics: 3,
            rules: "pong".into(),
            rules_version: 1,
            setup: StateHash(7),
            tick_rate: 60,
            players: 2,
            mode: Mode::Lockstep,
        }
    }

    #[test]
    fn everything_that_differs_is_named() {
        assert_eq!(parameters().agree(&parameters()), Ok(()));
        let cases: [(HandshakeParameters, &str); 8] = [
            (HandshakeParameters { semantics: 4, ..parameters() }, "engine semantics 3 here and 4 there"),
            (HandshakeParameters { rules: "tug".into(), ..parameters() }, "rules pong here and tug there"),
            (HandshakeParameters { rules_version: 2, ..parameters() }, "rules version 1 here and 2 there"),
            (
                HandshakeParameters { setup: StateHash(8), ..parameters() },
                "7 here and 00000000000000000000000000000008 there",
            ),
            (HandshakeParameters { tick_rate: 30, ..parameters() }, "tick rate 60 here and 30 there"),
            (HandshakeParameters { players: 3, ..parameters() }, "number of seats 2 here and 3 there"),
            (
                HandshakeParameters { mode: Mode::Rollback { window: 8 }, ..parameters() },
                "lockstep here and rollback by up to 8 ticks",
            ),
            (
                HandshakeParameters { rules_version: 2, tick_rate: 30, ..parameters() },
                "rules version 1 here and 2 there, tick rate 60 here and 30 there",
            ),
        ];
        for (theirs, what) in cases {
            let mismatch = parameters().agree(&theirs).expect_err(what).to_string();
            assert!(mismatch.contains(what), "{mismatch}");
        }
    }
}
