//! Distant bodies change no bit: a group of bodies moves equally with and without another group a kilometre away.

use lockstep2d::body::{BodyDef, BodyId, Geometry, Polygon, ShapeDef};
use lockstep2d::fx;
use lockstep2d::math::{Fx, Rng, Vec2};
use lockstep2d::solver::{Distance, JointDef, JointKind, Motor, Prismatic, Revolute, Weld, Wheel};
use lockstep2d::world::World;

use super::{sweep, world_with_floor};

/// Random bodies on a floor of their own, some of them joined.
fn add_group(world: &mut World, rng: &mut Rng, place: Vec2<Fx>, count: u32) -> Vec<BodyId> {
    let floor = ShapeDef::new(Polygon::rectangle(fx!(20), fx!(1)).expect("valid"));
    world.spawn(&BodyDef::fixed().position(place + Vec2::new(fx!(0), fx!(-1))), &[floor]).expect("valid");
    let mut bodies: Vec<BodyId> = Vec::new();
    for _ in 0..count {
        let at = place + Vec2::new(rng.range(fx!(-6), fx!(6)), rng.range(fx!(0.5), fx!(12)));
        let speed = if rng.below(4) == 0 { fx!(40) } else { fx!(4) };
        let velocity = Vec2::new(rng.range(-speed, speed), rng.range(-speed, speed));
        let def = BodyDef::dynamic().position(at).angle(rng.angle()).velocity(velocity);
        let body = world.spawn(&def, &[random_shape(rng)]).expect("valid");
        if let Some(&last) = bodies.last()
            && rng.below(3) == 0
        {
            let anchor = world.body(last).expect("there").position();
            let kind = random_joint(rng);
            let def = JointDef::new(last, body, kind).anchor_a((fx!(0), fx!(0)));
            world.add_joint(&def.anchor_b((anchor - at).scale(fx!(0.1)))).expect("valid");
        }
        bodies.push(body);
    }
    bodies
}

fn random_shape(rng: &mut Rng) -> ShapeDef {
    let size = rng.range(fx!(0.2), fx!(0.7));
    let geometry = match rng.below(4) {
        0 => Geometry::circle(size).expect("valid"),
        1 => Geometry::capsule((-size, fx!(0)), (size, fx!(0)), size / 2).expect("valid"),
        2 => Polygon::regular(5, size).expect("valid").into(),
        _ => Polygon::rectangle(size, size / 2).expect("valid").into(),
    };
    let restitution = if rng.below(3) == 0 { fx!(0.8) } else { fx!(0) };
    ShapeDef::new(geometry).restitution(restitution).friction(rng.range(fx!(0), fx!(1)))
}

fn random_joint(rng: &mut Rng) -> JointKind {
    match rng.below(6) {
        0 => Revolute::new().into(),
        1 => Weld::rigid().into(),
        2 => Prismatic::new().into(),
        3 => Wheel::new().into(),
        4 => Distance::rod(fx!(1.5)).into(),
        _ => Motor::new().linear((fx!(1), fx!(0)), fx!(20)).into(),
    }
}

#[test]
fn what_is_far_away_changes_no_bit() {
    sweep::for_each(sweep::sample(0..200, 9), |seed: u64| {
        let mut rng = Rng::new(seed);
        let (mut alone, _) = world_with_floor();
        let near = add_group(&mut alone, &mut rng, Vec2::ZERO, 12);
        let mut beside = alone.clone();
        let others = 10 + rng.below(60);
        add_group(&mut beside, &mut rng, Vec2::new(fx!(1000), fx!(300)), others);
        for tick in 0..240 {
            alone.step();
            beside.step();
            for &id in &near {
                let [a, b] = [&alone, &beside].map(|world| world.body(id).expect("there"));
                let motion = |body: &lockstep2d::body::Body| {
                    (body.centre_of_mass(), body.angle(), body.velocity(), body.angular_velocity())
                };
                assert_eq!(motion(a), motion(b), "seed {seed}, tick {tick}, {others} others: body {id}");
                assert_eq!(a.is_asleep(), b.is_asleep(), "seed {seed}, tick {tick}: body {id}");
            }
            let contacts = |world: &World| {
                let near = world.contacts().filter(|contact| contact.manifold.origin.x < fx!(500));
                near.flat_map(|contact| {
                    contact.forces().map(|(&point, force)| (point, force)).collect::<Vec<_>>()
                })
                .collect::<Vec<_>>()
            };
            assert_eq!(contacts(&alone), contacts(&beside), "seed {seed}, tick {tick}");
        }
    });
}
