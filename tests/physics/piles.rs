//! Piles are stable and come to rest.

use lockstep2d::fx;
use lockstep2d::math::Fx;

use crate::{deepest, open, run, speed_max, speed_mean, sweep};

#[test]
fn ten_boxes_stand_for_a_minute() {
    let mut game = open("box_stack");
    run(&mut game, 3600, |tick, world| {
        let (_, top) = world.bodies().last().expect("boxes");
        assert!(top.position().x.abs() < fx!(0.001), "tick {tick}: the top is {} m off", top.position().x);
        assert!(
            tick < 300 || top.position().y > fx!(9.4),
            "tick {tick}: the top is at {} m",
            top.position().y
        );
    });
    let fastest = speed_max(game.world());
    assert!(fastest < fx!(0.0001), "{fastest} m/s after a minute");
}

#[test]
fn a_pyramid_of_30_rows_comes_to_rest_and_loses_no_warm_start() {
    let mut game = open("pyramid");
    run(&mut game, 600, |tick, world| {
        assert!(tick == 0 || world.stats().points_lost == 0, "tick {tick}: {:?}", world.stats());
    });
    let fastest = speed_max(game.world());
    assert!(fastest < fx!(0.00001), "{fastest} m/s after 10 s");
}

/// In Box2D 3.2, after 300 steps, the top is at 98.77 m, the deepest overlap is 21.2 mm and the mean speed is 0.017
/// m/s.
#[test]
fn a_pyramid_of_5050_boxes_stands() {
    let mut game = open("large_pyramid");
    run(&mut game, sweep::size(500, 200), |_, _| {});
    let world = game.world();
    let top = world.bodies().map(|(_, body)| body.position().y).max().expect("boxes");
    assert!(top >= fx!(98.76), "top at {top} m");
    assert!(deepest(world) <= fx!(0.021), "deepest {} m", deepest(world));
    assert!(speed_mean(world) < fx!(0.01), "mean speed {} m/s", speed_mean(world));
    assert_eq!(world.stats().points_lost, 0);
}

#[test]
fn a_box_rests_on_one_of_a_hundredth_of_its_mass() {
    let mut game = open("heavy_on_light");
    run(&mut game, 600, |_, _| {});
    let world = game.world();
    let heights: Vec<Fx> = world.bodies().skip(1).map(|(_, body)| body.position().y).collect();
    assert!(heights[0] > fx!(0.48) && heights[1] > fx!(1.44), "at {heights:?} m");
    assert!(speed_max(world) < fx!(0.0001), "{} m/s", speed_max(world));
}

/// In every sub-step, Baumgarte contacts remove a share of that part of an overlap that exceeds the slop.
#[test]
fn a_stack_stands_on_baumgarte_contacts() {
    use lockstep2d::lockstep::{Game, Sandbox};
    use lockstep2d::solver::ContactTuning;
    use lockstep2d_scenes::Scene;
    for (sub_steps, iterations) in [(4, 1), (1, 8)] {
        let mut setup = Scene::find("box_stack").expect("there").setup(1);
        setup.config.solver.contact =
            ContactTuning::Baumgarte { share: fx!(0.2), slop: fx!(0.005), push_speed: fx!(3) };
        setup.config.solver.sub_steps = sub_steps;
        setup.config.solver.iterations = iterations;
        let mut game = Sandbox::new(&setup).expect("valid");
        run(&mut game, 1200, |_, _| {});
        let world = game.world();
        let (_, top) = world.bodies().last().expect("boxes");
        let place = top.position();
        assert!(place.x.abs() < fx!(0.005) && place.y > fx!(9.4) && place.y < fx!(9.5), "top at {place:?}");
        assert!(speed_max(world) < fx!(0.001), "{} m/s", speed_max(world));
        assert!(deepest(world) < fx!(0.012), "{} m deep", deepest(world));
    }
}

/// The boxes fall a short distance onto each other, or are rounded.
#[test]
fn stacks_stand_that_are_not_built_exactly() {
    use lockstep2d::body::{BodyDef, Polygon, ShapeDef};
    use lockstep2d::world::World;
    let square = |half: Fx, radius: Fx| {
        ShapeDef::new(Polygon::square(half).and_then(|square| square.rounded(radius)).expect("valid"))
    };
    for (shape, gap) in [
        (square(fx!(0.5), fx!(0)), fx!(0.001)),
        (square(fx!(0.5), fx!(0)), fx!(0.01)),
        (square(fx!(0.4), fx!(0.1)), fx!(0)),
        (square(fx!(0.45), fx!(0.05)), fx!(0.005)),
        (square(fx!(0.49), fx!(0.01)), fx!(0)),
    ] {
        let mut world = World::default();
        let floor = ShapeDef::new(Polygon::rectangle(fx!(20), fx!(1)).expect("valid"));
        world.spawn(&BodyDef::fixed().position((fx!(0), fx!(-1))), &[floor]).expect("valid");
        for i in 0..10 {
            let y = fx!(0.5) + gap + (fx!(1) + gap) * i;
            world.spawn(&BodyDef::dynamic().position((fx!(0), y)), &[shape]).expect("valid");
        }
        for tick in 0..3600 {
            world.step();
            let (_, top) = world.bodies().last().expect("boxes");
            // Nine impacts, one above the other, amplify rounding errors to 0.1 mm or 2 mm, depending on the gap.
            assert!(top.position().x.abs() < fx!(0.003), "gap {gap}, tick {tick}: {} m", top.position().x);
        }
        assert!(speed_max(&world) < fx!(0.0001));
        assert_eq!(world.faults(), 0);
    }
}
