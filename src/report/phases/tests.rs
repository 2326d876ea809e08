use super::*;
use crate::body::BodyDef;
use crate::fx;

#[test]
fn patches_make_the_new_bytes() {
    let apply = |old: &[u8], new: &[u8]| {
        let mut bytes = old.to_vec();
        bytes.resize(new.len(), 0);
        for patch in patches(old, new) {
            let at = usize::try_from(patch.at).expect("small");
            bytes[at..at + patch.bytes.len()].copy_from_slice(&patch.bytes);
        }
        bytes
    };
    let long: Vec<u8> = (0..200).collect();
    let mut changed = long.clone();
    for at in [0, 1, 17, 40, 55, 120, 199] {
        changed[at] ^= 0x80;
    }
    for (old, new) in [(&long[..], &changed[..]), (&long[..50], &changed[..]), (&long[..], &changed[..60])] {
        assert_eq!(apply(old, new), new);
    }
    assert!(patches(&long, &long).is_empty());
    assert_eq!(patches(&long, &changed).len(), 4);
    assert_eq!(apply(&[], &long), long);
}

#[test]
fn a_start_comes_back_and_a_forged_one_is_refused() {
    let before = World::default();
    let mut changed = before.clone();
    changed.spawn(&BodyDef::fixed().position((fx!(1), fx!(2))), &[]).expect("valid");
    let (old, new) = (before.to_bytes(), changed.to_bytes());
    let logged =
        TickPhases { digests: Vec::new(), start: patches(&old, &new), start_length: new.len() as u64 };
    assert_eq!(logged.start(&before).map(|world| world.state_hash()), Some(changed.state_hash()));
    let endless = TickPhases { start_length: u64::MAX, ..logged.clone() };
    assert!(endless.start(&before).is_none());
    let mut beyond = logged.clone();
    beyond.start[0].at = u64::MAX;
    assert!(beyond.start(&before).is_none());
    let mut damaged = logged;
    damaged.start[0].bytes[0] ^= 1;
    assert!(damaged.start(&before).is_none());
}
