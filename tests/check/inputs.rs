//! Input logs from arbitrary bytes and from random numbers.

use std::collections::BTreeSet;

use lockstep2d::check::{inputs_from_bytes, random_inputs};
use lockstep2d::lockstep::{EncodedInputs, Sandbox};
use lockstep2d::math::Rng;
use lockstep2d::world::Command;

use super::harvest::{Action, Harvest};

#[test]
fn every_list_of_bytes_is_a_log() {
    let mut rng = Rng::new(1);
    for length in 0..400 {
        let bytes: Vec<u8> = (0..length).map(|_| rng.next_u32().to_le_bytes()[0]).collect();
        let log = inputs_from_bytes::<Sandbox>(1, &bytes);
        assert!(log.len() <= 16 * bytes.len(), "{length} bytes are {} ticks", log.len());
        assert!(bytes.is_empty() || !log.is_empty());
        for inputs in &log {
            let encoded = EncodedInputs::new(inputs, 1).unwrap();
            assert_eq!(encoded.inputs(), inputs);
        }
    }
    assert!(inputs_from_bytes::<Harvest>(0, &[0, 1, 2, 255]).iter().all(Vec::is_empty));
}

#[test]
fn bytes_hold_change_and_repeat_inputs() {
    // Player 0 gets Walk and player 1 gets Reach. Three more ticks repeat both inputs. Then player 1 gets Rest.
    let bytes = [5, 1, 3, 255, 2, 7 | 2 << 3, 1 << 3, 0];
    let (walk, reach) = (Action::Walk { x: 3, y: -1 }, Action::Reach);
    let held = vec![walk, reach];
    let expected = [held.clone(), held.clone(), held.clone(), held, vec![walk, Action::Rest]];
    assert_eq!(inputs_from_bytes::<Harvest>(2, &bytes), expected);
}

#[test]
fn random_inputs_reach_every_command() {
    let log = random_inputs::<Sandbox>(1, 5000, &mut Rng::new(2));
    assert_eq!(log.len(), 5000);
    let name = |command: &Command| format!("{command:?}").split([' ', '{', '(']).next().unwrap().to_owned();
    let names: BTreeSet<String> = log.iter().flatten().flatten().map(name).collect();
    assert!(names.len() > 20, "expected more than 20 kinds of commands, found {names:?}");
    assert_eq!(
        log,
        random_inputs::<Sandbox>(1, 5000, &mut Rng::new(2)),
        "expected the same log from the same seed"
    );
}
