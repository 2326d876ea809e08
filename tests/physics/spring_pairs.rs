//! Two free bodies that are joined by one spring along a line.
#![expect(clippy::disallowed_types, reason = "energies are compared with floating point, not simulated")]
#![expect(clippy::float_arithmetic, reason = "the oracle computes energy in floating point")]

use lockstep2d::body::{BodyDef, MassSource};
use lockstep2d::fx;
use lockstep2d::math::{Angle, Fx, Rng, Vec2};
use lockstep2d::solver::{Distance, JointDef, JointKind, Prismatic, Wheel};
use lockstep2d::world::{Config, World};

use crate::assembly::{Assembly, pick};
use crate::sweep;

/// Largest gain of energy, and energy at the start, in J.
fn spring_pair_gain(seed: u64, ticks: u32) -> (f64, f64) {
    let mut rng = Rng::with_stream(seed, 77);
    let config = Config { gravity: Vec2::ZERO, sleeping: false, ..Config::default() };
    let mut world = World::new(config).expect("valid");
    let ratio = pick(&mut rng, &[fx!(0), fx!(0.1), fx!(0.5)]);
    let hertz = rng.range(fx!(0.3), fx!(5));
    let mut ends = [0, 1].map(|side: usize| {
        let gyration = pick(&mut rng, &[fx!(0.2), fx!(0.5), fx!(1)]);
        let mass = MassSource::Given {
            mass: pick(&mut rng, &[fx!(1), fx!(3), fx!(30)]),
            centre: Vec2::ZERO,
            gyration,
        };
        let place = Vec2::new(Fx::from_num(side) * 2, rng.range(fx!(-0.5), fx!(0.5)));
        let mut own = |most: Fx| Vec2::new(rng.range(-most, most), rng.range(-most, most));
        let (velocity, anchor) = (own(fx!(2)), own(gyration * 2));
        let body = BodyDef::dynamic().mass(mass).position(place).velocity(velocity);
        (world.spawn(&body.angular_velocity(rng.range(fx!(-3), fx!(3))), &[]).expect("valid"), anchor)
    });
    let target = rng.range(fx!(1), fx!(2));
    let kind: JointKind = match seed % 3 {
        0 => Distance::new().spring(hertz, ratio, target).into(),
        1 => Wheel::new().spring(hertz, ratio, fx!(0)).into(),
        _ => Prismatic::new().spring(hertz, ratio, fx!(0)).into(),
    };
    let [(a, anchor_a), (b, anchor_b)] = &mut ends;
    let mut def = JointDef::new(*a, *b, kind).anchor_a(*anchor_a).anchor_b(*anchor_b);
    if !matches!(kind, JointKind::Distance(_)) {
        // The axis goes through both anchors.
        let gap = world.body(*b).expect("there").position() + *anchor_b
            - world.body(*a).expect("there").position()
            - *anchor_a;
        def = def.angle_a(Angle::of(gap)).angle_b(Angle::of(gap));
    }
    let joint = world.add_joint(&def).expect("valid");
    let mut assembly = Assembly { world, bodies: vec![*a, *b], joints: vec![joint] };
    let start = assembly.energy();
    let mut gain = f64::MIN;
    for _ in 0..ticks {
        assembly.world.step();
        gain = gain.max(assembly.energy() - start);
    }
    (gain, start)
}

/// The largest gain among 600 pairs is 0.008 %.
#[test]
fn a_pair_on_a_spring_gains_no_energy() {
    sweep::for_each((0..sweep::size(600, 60)).collect(), |seed| {
        let (gain, start) = spring_pair_gain(seed, 1200);
        assert!(gain <= 0.001 * start, "seed {seed}: gains {gain} J of {start} J");
    });
}
