//! Messages about peers of a match.

use lockstep2d::peer::{ParameterDifference, PeerError};
use lockstep2d::replay::RecordError;
use lockstep2d::session::{ConfigError, InputSize};

use crate::says;

#[test]
fn peers() {
    let different = |what, ours: &str, theirs: &str| ParameterDifference {
        what,
        ours: ours.into(),
        theirs: theirs.into(),
    };
    let differences = vec![different("engine semantics", "3", "2"), different("number of seats", "4", "2")];
    says([
        (PeerError::from(RecordError::TickRate), "a tick rate of zero"),
        (
            PeerError::from(ConfigError { field: "start_with", value: 5, min: 0, max: 4, step: 1 }),
            "the session cannot start: `start_with` is 0 to 4, not 5",
        ),
        (
            PeerError::from(ConfigError { field: "check_interval", value: 12, min: 8, max: 65535, step: 8 }),
            "the session cannot start: `check_interval` is 8 to 65535 in steps of 8, not 12",
        ),
        (
            PeerError::InputLength { bytes: 9, possible: 4 },
            "an input has 9 bytes, 4 are possible: set `PeerOptions::input_bytes` to the size of the largest input",
        ),
        (PeerError::InputCount { seats: 1, inputs: 2 }, "2 inputs for 1 own seats"),
        (PeerError::Seat { seat: 4, seats: 4 }, "there is no seat 4: the match has seats 0 to 3"),
        (PeerError::SeatTaken { seat: 1 }, "seat 1 is taken"),
        (
            PeerError::Parameters(differences),
            "the peers have different parameters: engine semantics 3 here and 2 there, number of seats 4 here and 2 there",
        ),
        (PeerError::Refused { why: "too many peers are joining" }, "refused: too many peers are joining"),
        (PeerError::State { why: "a bad tag".into() }, "the received state cannot be used: a bad tag"),
        (PeerError::NoState { tick: 12 }, "the state after 12 ticks is not kept"),
    ]);
    says([(InputSize { expected: 1, given: 2 }, "2 bytes of inputs, 1 are expected")]);
}
