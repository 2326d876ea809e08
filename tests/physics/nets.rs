//! Nets of rods and of ropes yield as the softness of joints says.
//!
//! A joint with the angular frequency `omega` that carries the force `F` between bodies of the reduced mass `m` yields
//! by `F / (m omega^2)`.

use lockstep2d::body::{BodyDef, BodyId, JointId, MassSource};
use lockstep2d::fx;
use lockstep2d::math::{Fx, TAU, Vec2, fx_div, fx_mul};
use lockstep2d::solver::{Distance, JointDef};
use lockstep2d::world::{Config, World};

use crate::joint_bench::close;

/// A net of bodies of 1 kg at a distance of 1 m, in rows of `columns`. The bodies of the first row are fixed if
/// `is_held` says so of their columns.
fn net(
    columns: usize,
    rows: usize,
    kind: Distance,
    is_held: impl Fn(usize) -> bool,
) -> (World, Vec<JointId>) {
    let mut world = World::new(Config { sleeping: false, ..Config::default() }).expect("valid");
    let mass = MassSource::Given { mass: fx!(1), centre: Vec2::ZERO, gyration: fx!(0.1) };
    let mut above: Vec<BodyId> = Vec::new();
    let mut joints = Vec::new();
    for y in 0..rows {
        let mut row: Vec<BodyId> = Vec::new();
        for x in 0..columns {
            let held = y == 0 && is_held(x);
            let body = if held { BodyDef::fixed() } else { BodyDef::dynamic().mass(mass) };
            let place = Vec2::new(Fx::from_num(x), -Fx::from_num(y));
            let body = world.spawn(&body.position(place), &[]).expect("valid");
            for other in row.last().into_iter().chain(above.get(x)) {
                joints.push(world.add_joint(&JointDef::new(*other, body, kind)).expect("valid"));
            }
            row.push(body);
        }
        above = row;
    }
    (world, joints)
}

fn longest(world: &World, joints: &[JointId]) -> Fx {
    joints.iter().map(|&id| world.joint_length(id).expect("there")).max().expect("joints")
}

fn kinds() -> [Distance; 2] {
    [Distance::rope(fx!(1)), Distance::rod(fx!(1))]
}

/// A net of 10 columns and 6 moving rows, with 114 joints that bear loads, hangs from its first row. A joint at the top
/// carries 60 N between a fixed body and a body of 1 kg. The joint below it carries 50 N between two bodies of 1 kg,
/// whose reduced mass is 0.5 kg, and therefore yields most.
#[test]
fn a_hanging_net_yields_as_theory_says() {
    for kind in kinds() {
        let (mut world, joints) = net(10, 7, kind, |_| true);
        (0..300).for_each(|_| world.step());
        let omega = fx_mul(TAU, world.config().solver.joint_hertz);
        let theory = fx_div(fx!(50) * 2, fx_mul(omega, omega)).expect("positive");
        close(longest(&world, &joints), fx!(1) + theory, theory / 20, "m");
        assert_eq!(world.faults(), 0);
    }
}

/// Nets that hang from their two upper corners. The joints at a corner carry half of the weight and more.
#[test]
fn a_net_between_two_corners_stays_in_shape() {
    for kind in kinds() {
        for (columns, rows, most) in
            [(10, 6, fx!(0.02)), (20, 10, fx!(0.04)), (60, 2, fx!(0.03)), (20, 20, fx!(0.06))]
        {
            let (mut world, joints) = net(columns, rows, kind, |x| x == 0 || x == columns - 1);
            for tick in 0..120 {
                world.step();
                let stretch = longest(&world, &joints) - fx!(1);
                assert!(stretch < most, "{columns} x {rows}, tick {tick}: stretched by {stretch} m");
            }
            assert_eq!(world.faults(), 0);
        }
    }
}
