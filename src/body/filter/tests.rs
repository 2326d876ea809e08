use super::*;
use crate::math::Rng;

#[test]
fn groups_override_masks() {
    let player = Filter { category: 2, mask: 1, group: 0 };
    let wall = Filter::default();
    assert!(player.accepts(&wall) && wall.accepts(&player));
    assert!(!player.accepts(&player), "players should not collide with each other");
    let team = Filter { group: 7, ..player };
    assert!(team.accepts(&team));
    let ghost = Filter { group: -7, ..wall };
    assert!(!ghost.accepts(&ghost) && ghost.accepts(&wall));
}

#[test]
fn shapes_of_one_class_never_accept_each_other() {
    let (mut related, mut unrelated) = (0, 0);
    let mut rng = Rng::new(8);
    let mut random = || {
        let mut bits = || u64::from(rng.below(16)) << (60 * rng.below(2));
        let (category, mask) = (bits(), bits());
        let group = [0, 0, 1, -1, -2, -32_768, -32_769, i32::MIN][rng.below(8) as usize];
        Filter { category, mask, group }
    };
    for _ in 0..50_000 {
        let (a, b) = (random(), random());
        if a.collision_class().common(b.collision_class()) == CollisionClass::NONE {
            unrelated += u32::from(a.accepts(&b));
        } else {
            assert!(!a.accepts(&b), "{a:?} {b:?}");
            related += 1;
        }
    }
    assert!(related > 1000 && unrelated > 1000, "both outcomes should be frequent: {related} {unrelated}");
    let bullet = Filter { category: 1 << 63, mask: 1, group: 0 };
    assert_ne!(bullet.collision_class(), CollisionClass::NONE);
    assert_ne!(Filter { group: -5, ..bullet }.collision_class(), bullet.collision_class());
    assert_eq!(Filter::default().collision_class(), CollisionClass::NONE);
}
