//! Free fall is semi-implicit Euler, bit for bit: `v' = v + g h`, `x' = x + h v'` in each sub-step of `h` seconds.

use lockstep2d::body::BodyId;
use lockstep2d::fx;
use lockstep2d::math::{Fx, Shift, Speed, Vec2, div_round, narrow};
use lockstep2d::world::{Config, World};

use crate::{open, run};

fn only_body(world: &World) -> BodyId {
    world.bodies().next().expect("a body").0
}

/// The engine rounds `g h` and each `h v'` once, to the nearest number of their formats. This test does the same.
#[test]
fn ten_seconds_equal_the_recurrence_exactly() {
    let mut game = open("free_fall");
    let body = only_body(game.world());
    let step_of = |v: Speed| {
        // One sub-step moves by v / 240. `Shift` has 5 more fraction bits than `Speed`.
        let bits = div_round(i128::from(v.to_bits()) << 5, 240);
        Shift::from_bits(bits.try_into().expect("a small step"))
    };
    let gh: Speed = narrow(fx!(-10) / 240);
    let (mut v, mut x) = (Speed::ZERO, Fx::ZERO);
    run(&mut game, 600, |tick, world| {
        for _ in 0..4 {
            v += gh;
            x += Fx::from(step_of(v));
        }
        let body = world.body(body).expect("still there");
        assert_eq!(body.velocity(), Vec2::new(Fx::ZERO, v.into()), "tick {tick}");
        assert_eq!(body.position(), Vec2::new(Fx::ZERO, x), "tick {tick}");
    });
}

/// `x_n = g h^2 n (n + 1) / 2`. Rounding errors are less than 2 mm after 10 s of a fall by 500 m.
#[test]
fn ten_seconds_are_within_2_mm_of_the_closed_form() {
    let mut game = open("free_fall");
    let body = only_body(game.world());
    run(&mut game, 600, |_, _| {});
    let n = 2400i64;
    let expected = lockstep2d::math::ratio(-10 * n * (n + 1), 2 * 240 * 240);
    let y = game.world().body(body).expect("still there").position().y;
    assert!((y - expected).abs() < fx!(0.002), "{y} m, expected {expected} m");
}

#[test]
fn a_thrown_body_keeps_its_velocity() {
    use lockstep2d::body::{BodyDef, Geometry, ShapeDef};
    let mut world = World::new(Config { gravity: Vec2::ZERO, ..Config::default() }).expect("valid");
    let ball = ShapeDef::new(Geometry::circle(fx!(0.5)).expect("valid"));
    let def = BodyDef::dynamic().velocity((fx!(3), fx!(-4))).angular_velocity(fx!(1));
    let id = world.spawn(&def, &[ball]).expect("valid");
    for _ in 0..3600 {
        world.step();
    }
    let body = world.body(id).expect("still there");
    assert_eq!(body.velocity(), Vec2::new(fx!(3), fx!(-4)));
    let distance = body.position().distance(Vec2::new(fx!(180), fx!(-240)));
    assert!(
        distance < fx!(0.00011),
        "error of {distance} m after 60 s and 300 m, expected at most 14400 roundings of 3.7 nm"
    );
    let turned = body.angle().to_radians();
    // 60 rad are 10 turns minus 2.8319 rad. Each of 14400 sub-steps has an error of at most 3.7 nm at the radius of
    // gyration, 0.35 m, which is 1.05e-8 rad. The sum is at most 1.5e-4 rad.
    assert!((turned - fx!(-2.831853072)).abs() < fx!(0.0002), "{turned} rad");
}

/// Explicit Euler multiplies the energy of a ball on a spring of 1 rad/s by `(1 + h^2)` in every step. Semi-implicit
/// Euler conserves it.
#[test]
fn explicit_euler_gains_energy_and_semi_implicit_does_not() {
    let h = fx!(1 / 60);
    let energy = |x: Fx, v: Fx| (Vec2::new(x, v).dot(Vec2::new(x, v))) / 2;
    let mul = lockstep2d::math::fx_mul;
    let (mut explicit, mut semi) = ((fx!(1), fx!(0)), (fx!(1), fx!(0)));
    for _ in 0..6000 {
        let (x, v) = explicit;
        explicit = (x + mul(h, v), v - mul(h, x));
        let (x, v) = semi;
        let v = v - mul(h, x);
        semi = (x + mul(h, v), v);
    }
    assert!(
        energy(explicit.0, explicit.1) > fx!(2.5),
        "expected the energy of explicit Euler to be (1 + 1/3600)^6000 = e^(5/3) times 0.5 J"
    );
    assert!((energy(semi.0, semi.1) - fx!(0.5)).abs() < fx!(0.01));
}
