//! Collisions of two bodies.

use lockstep2d::body::BodyKind;
use lockstep2d::fx;
use lockstep2d::math::{Fx, Vec2, fx_mul};
use lockstep2d::world::World;

use crate::{energy, open, run};

fn momentum(world: &World) -> Vec2<Fx> {
    world.bodies().fold(Vec2::ZERO, |sum, (_, body)| sum + body.velocity().scale(body.mass()))
}

/// Angular momentum of all bodies about the origin: the sum of `m r x v + I w`.
fn angular_momentum(world: &World) -> Fx {
    world.bodies().fold(Fx::ZERO, |sum, (_, body)| {
        let orbital = fx_mul(body.mass(), body.centre_of_mass().cross(body.velocity()));
        sum + orbital + fx_mul(body.inertia(), body.angular_velocity())
    })
}

#[test]
fn momentum_stays_in_every_tick_of_a_collision() {
    for name in ["head_on", "oblique"] {
        let mut game = open(name);
        let before = momentum(game.world());
        let tolerance = before.length() / 100_000;
        run(&mut game, 120, |tick, world| {
            let error = momentum(world).distance(before);
            assert!(
                error <= tolerance,
                "{name}, tick {tick}: momentum off by {error} of {}",
                before.length()
            );
        });
    }
}

/// The solver keeps lever arms constant within a tick of length `dt`. With the impulse `P` and the relative velocity
/// `v_rel`, the angular momentum may therefore deviate by `|P| |v_rel| dt`.
#[test]
fn angular_momentum_stays_within_impulse_times_motion_in_a_tick() {
    let mut game = open("oblique");
    let before = angular_momentum(game.world());
    let bodies: Vec<_> = game.world().bodies().map(|(id, body)| (id, body.velocity(), body.mass())).collect();
    let relative = bodies[0].1.distance(bodies[1].1);
    run(&mut game, 120, |_, _| {});
    let (id, old, mass) = bodies[0];
    let impulse = fx_mul(mass, game.world().body(id).expect("still there").velocity().distance(old));
    assert!(impulse > fx!(1), "expected a collision");
    let bound = fx_mul(impulse, relative) / 60;
    let error = (angular_momentum(game.world()) - before).abs();
    assert!(error <= bound, "angular momentum off by {error}, more than {bound}");
}

/// 1 kg at 4 m/s hits 3 kg at -2 m/s: `v1' = v1 - 2 m2 / (m1 + m2) (v1 - v2) = -5`, `v2' = 1`.
#[test]
fn an_elastic_collision_exchanges_velocities_as_the_textbook_says() {
    let mut game = open("head_on");
    let before = energy(game.world());
    run(&mut game, 120, |_, _| {});
    let velocities: Vec<_> = game.world().bodies().map(|(_, body)| body.velocity()).collect();
    for (velocity, expected) in velocities.into_iter().zip([fx!(-5), fx!(1)]) {
        assert!((velocity.x - expected).abs() < fx!(0.0001), "{velocity:?}, expected {expected} m/s");
        assert!(velocity.y.abs() < fx!(0.0001));
    }
    let gained = energy(game.world()) - before;
    assert!(gained.abs() < before / 10_000, "energy changed from {before} J by {gained} J");
}

#[test]
fn a_ball_inside_a_block_is_pushed_out_not_through() {
    let mut game = open("ball_in_box");
    run(&mut game, 240, |_, _| {});
    let balls: Vec<_> = game
        .world()
        .bodies()
        .filter(|(_, body)| body.kind() == BodyKind::Dynamic)
        .map(|(_, body)| body.position())
        .collect();
    assert!(balls[0].y > fx!(1.24), "expected the ball above the top, at {:?}", balls[0]);
    assert!(balls[1].y < fx!(-1.24), "expected the ball below the bottom, at {:?}", balls[1]);
    assert!(balls[2].x > fx!(3.24), "expected the ball beyond the right side, at {:?}", balls[2]);
    assert!(
        balls[3].y > fx!(1.24),
        "expected the ball that starts just above the middle to leave through the top, at {:?}",
        balls[3]
    );
}
