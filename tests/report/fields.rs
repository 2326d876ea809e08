//! If two states differ in any bit, the comparison of their fields finds a difference.

use lockstep2d::hash::StateHash;
use lockstep2d::inspect::{Field, differences, fields};
use lockstep2d::lockstep::{Game, Sandbox};
use lockstep2d::math::Rng;
use lockstep2d::world::World;
use lockstep2d_scenes::Scene;

use crate::sweep;

fn view(world: &World) -> Vec<Field> {
    fields(&world.save()).unwrap()
}

#[test]
fn whatever_bit_of_a_state_differs_is_a_field() {
    let flips = sweep::size(400, 80);
    sweep::for_each(vec![("ragdoll", 11), ("game", 12), ("chain", 13), ("box_stack", 14)], |(name, seed)| {
        let mut rng = Rng::new(seed);
        let scene = Scene::find(name).unwrap();
        let mut game = Sandbox::new(&scene.setup(1)).unwrap();
        for tick in 0..70 {
            game.step(&[scene.commands(tick, &game)]);
        }
        let bytes = game.world().to_bytes();
        let before = view(game.world());
        let copy = World::from_bytes(&bytes).unwrap();
        assert!(
            differences(&before, &view(&copy)).is_empty(),
            "{name}: equal worlds must have no differences"
        );
        let mut told = 0;
        for _ in 0..flips {
            let mut changed = bytes.clone();
            let state = changed.len() - 16;
            changed[24 + rng.next_u32() as usize % (state - 24)] ^= 1 << (rng.next_u32() % 8);
            let hash = StateHash::of_bytes(&changed[..state]);
            changed[state..].copy_from_slice(&hash.0.to_le_bytes());
            let Ok(other) = World::from_bytes(&changed) else { continue };
            let found = differences(&before, &view(&other));
            assert!(!found.is_empty(), "{name}: a changed bit is missing from the view");
            told += 1;
        }
        assert!(told * 8 > flips, "{name}: only {told} of {flips} states were possible");
    });
}
