use alloc::collections::BTreeSet;

use super::*;

#[test]
fn every_rollback_has_its_turn() {
    let name = |(depth, guess): Rollback| (depth, Guess::ALL.iter().position(|one| *one == guess));
    for depth_max in 1..=9 {
        let turns = 0..3 * u64::from(depth_max);
        let in_turn = turns.flat_map(|turn| rollbacks(Depths::InTurn, depth_max, depth_max, turn));
        let in_turn: BTreeSet<_> = in_turn.map(name).collect();
        let each = rollbacks(Depths::Each, depth_max, depth_max, 5);
        let each: BTreeSet<_> = each.into_iter().map(name).collect();
        assert_eq!(in_turn, each);
        assert_eq!(each.len(), 3 * depth_max as usize);
    }
    assert!(rollbacks(Depths::InTurn, 0, 8, 5).is_empty());
}

#[test]
fn near_the_start_rollbacks_are_less_deep() {
    let depths = |depths, earlier| {
        let depths = rollbacks(depths, 8, earlier, 5).into_iter().map(|(depth, _)| depth);
        depths.collect::<Vec<_>>()
    };
    assert_eq!((depths(Depths::InTurn, 8), depths(Depths::InTurn, 2)), (vec![6], vec![2]));
    assert_eq!(depths(Depths::Each, 2), [1, 1, 1, 2, 2, 2]);
    assert!(depths(Depths::InTurn, 0).is_empty() && depths(Depths::Each, 0).is_empty());
}
