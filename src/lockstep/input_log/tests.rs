use super::*;

fn log_of(values: &[u8]) -> InputLog<u8> {
    let mut log = InputLog::new(1);
    for value in values {
        assert_eq!(log.push(&[*value]), Ok(&[*value][..]));
    }
    log
}

fn values_of(log: &InputLog<u8>) -> Vec<u8> {
    assert_eq!(log.get(log.ticks()), None, "the log should end at `ticks()`");
    (0..log.ticks()).map(|tick| log.get(tick).expect("a logged tick")[0]).collect()
}

#[test]
fn a_log_gives_back_every_tick() {
    let values = [1, 1, 1, 2, 1, 1, 3, 3];
    let log = log_of(&values);
    assert_eq!(values_of(&log), values);
    assert_eq!(log.runs(), 4);
    assert!(values_of(&InputLog::new(1)).is_empty());
}

#[test]
fn a_log_cut_anywhere_is_the_log_of_fewer_ticks() {
    let values = [1, 1, 1, 2, 1, 1, 3, 3];
    for ticks in 0..=values.len() + 2 {
        let kept = &values[..ticks.min(values.len())];
        let mut log = log_of(&values);
        log.truncate(ticks as u64);
        assert_eq!(values_of(&log), kept, "after truncating to {ticks}");
        assert_eq!(log.runs(), log_of(kept).runs(), "after truncating to {ticks}");
        assert_eq!(log.push(&[9]), Ok(&[9][..]));
        assert_eq!(log.ticks(), kept.len() as u64 + 1);
    }
}

#[test]
fn a_log_takes_one_input_for_each_player() {
    let mut log = InputLog::<u8>::new(2);
    assert_eq!(log.push(&[1]), Err(InputError::Count { players: 2, inputs: 1 }));
    assert_eq!(log.ticks(), 0);
}

#[test]
fn only_canonical_bytes_are_inputs() {
    assert_eq!(decode_inputs::<(u8, bool)>(&[5, 1, 6, 0], 2), Ok(alloc::vec![(5, true), (6, false)]));
    for bad in [&[5, 1, 6][..], &[5, 1, 6, 0, 0], &[5, 1, 6, 2], &[]] {
        assert_eq!(decode_inputs::<(u8, bool)>(bad, 2), Err(InputError::NotCanonical), "{bad:?}");
    }
    // Elements in descending order decode, but the canonical encoding is ascending.
    type Set = alloc::collections::BTreeSet<u8>;
    let sorted = [2, 0, 0, 0, 0, 0, 0, 0, 3, 4];
    assert_eq!(decode_inputs::<Set>(&sorted, 1), Ok(alloc::vec![Set::from([3, 4])]));
    let unsorted = [2, 0, 0, 0, 0, 0, 0, 0, 4, 3];
    assert_eq!(decode_inputs::<Set>(&unsorted, 1), Err(InputError::NotCanonical));
}
