//! Hinges hold, and bodies that swing on them neither gain energy nor lose too much.

use lockstep2d::fx;
use lockstep2d::math::{Fx, PI, fx_mul, sqrt};

use crate::{energy, joint_gap, open, run, speed_max, sweep};

/// A rod of 1 m and 1 kg at 20 rad/s has `1/2 (1/3) 20^2 = 66.7 J`.
#[test]
fn a_spinning_rod_keeps_its_hinge_and_much_of_its_energy() {
    let mut game = open("spinning_rod");
    let start = energy(game.world());
    assert!((start - fx!(66.6667)).abs() < fx!(0.01), "{start} J");
    let mut widest = Fx::ZERO;
    run(&mut game, 3600, |tick, world| {
        assert!(energy(world) <= start, "tick {tick}: {} J of {start} J", energy(world));
        widest = widest.max(joint_gap(world));
    });
    assert!(widest <= fx!(0.008), "gap {widest} m");
    assert!(energy(game.world()) >= fx!(12), "{} J left", energy(game.world()));
}

#[test]
fn long_arms_stay_closed() {
    for arm in [fx!(4.618802153517), fx!(11.547005383793)] {
        let mut game = spinning_rod_with_arm(arm);
        let start = energy(game.world());
        let mut widest = Fx::ZERO;
        run(&mut game, 3600, |tick, world| {
            assert!(energy(world) <= start, "arm {arm}, tick {tick}: {} J of {start} J", energy(world));
            widest = widest.max(joint_gap(world));
        });
        assert!(widest <= fx!(0.008), "arm {arm}: gap {widest} m");
        assert!(
            energy(game.world()) * 100 >= start * 18,
            "arm {arm}: {} J of {start} J left",
            energy(game.world())
        );
    }
}

fn spinning_rod_with_arm(arm: Fx) -> lockstep2d::lockstep::Sandbox {
    use lockstep2d::lockstep::Game;
    use lockstep2d::world::Command;
    let scene = lockstep2d_scenes::Scene::find("long_arm").expect("there");
    let mut setup = scene.setup(0);
    for command in &mut setup.commands {
        match command {
            Command::Spawn { body, .. } if body.angular_velocity != Fx::ZERO => {
                body.position.x = arm;
                body.velocity.y = fx_mul(body.angular_velocity, arm);
            }
            Command::AddJoint { joint } => joint.frame_b.anchor.x = -arm,
            _ => {}
        }
    }
    lockstep2d::lockstep::Sandbox::new(&setup).expect("valid")
}

#[test]
fn a_grid_of_19_800_hinges_stays_calm() {
    let mut game = open("joint_grid");
    let start = energy(game.world());
    run(&mut game, sweep::size(500, 200), |tick, world| {
        assert!(energy(world) <= start, "tick {tick}: energy {} J above the start", energy(world) - start);
        // A corner of the cloth whips at 21 m/s for three ticks. In free fall it would reach 44 m/s.
        assert!(speed_max(world) <= fx!(25), "tick {tick}: {} m/s", speed_max(world));
        assert!(joint_gap(world) <= fx!(0.7), "tick {tick}: gap {} m", joint_gap(world));
    });
}

/// The hinge is at height 0, so potential energy is measured from the hinge.
#[test]
fn a_chain_carries_a_hundredfold_weight() {
    let mut game = open("chain");
    let start = energy(game.world());
    run(&mut game, 1200, |tick, world| {
        assert!(joint_gap(world) <= fx!(0.18), "tick {tick}: gap {} m", joint_gap(world));
        assert!(energy(world) <= start, "tick {tick}: energy {} J above the start", energy(world) - start);
    });
}

/// A thin rod swings about its end with `T = 2 pi sqrt(2 L / (3 g))`, times `1 + a^2 / 16` at an amplitude `a`.
#[test]
fn a_pendulum_swings_with_the_period_of_theory() {
    let mut game = open("pendulum");
    let body = game.world().bodies().last().expect("a rod").0;
    let pivot_height = fx!(0);
    let lowest = |world: &lockstep2d::world::World| {
        // The energy is relative to that of the rod at rest, 0.5 m below the hinge.
        let rod = world.body(body).expect("still there");
        energy(world) + fx_mul(rod.mass() * 10, fx!(0.5) - pivot_height)
    };
    let start = lowest(game.world());
    let (mut crossings, mut last) = (Vec::new(), fx!(1));
    run(&mut game, 3600, |tick, world| {
        let x = world.body(body).expect("still there").position().x;
        if last < Fx::ZERO && x >= Fx::ZERO {
            // The time of the crossing is interpolated between ticks.
            let part = lockstep2d::math::fx_div(x, x - last).expect("it moves");
            crossings.push((Fx::from_num(tick + 1) - part) / 60);
        }
        last = x;
        assert!(lowest(world) <= start + start / 200, "tick {tick}: {} J of {start} J", lowest(world));
    });
    let periods = i64::try_from(crossings.len()).expect("few") - 1;
    let period = (crossings[crossings.len() - 1] - crossings[0]) / periods;
    // The rod is 0.04 m thick: I = m (1 + 0.04^2) / 12 + m / 4.
    let over_g = (fx!(1.0016) / 12 + fx!(0.25)) / 5;
    let small = fx_mul(PI * 2, sqrt(over_g).expect("positive"));
    let theory = small + small / 1600;
    assert!((period - theory).abs() < theory / 200, "{period} s, expected {theory} s");
    assert!(
        lowest(game.world()) >= start - start / 10,
        "expected to lose at most a tenth of the energy: {} J left of {start} J",
        lowest(game.world())
    );
}
