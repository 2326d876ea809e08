//! With extreme joint settings and positions, the world stays valid and a restored world continues identically.

use lockstep2d::body::{BodyDef, BodyId, MassSource};
use lockstep2d::fx;
use lockstep2d::math::{Fx, Rng, Vec2};
use lockstep2d::solver::{
    Distance, Drive, JointDef, JointKind, JointLimit, Motor, Prismatic, Pull, Revolute, Soft, Spring, Weld,
    Wheel,
};
use lockstep2d::world::World;

/// A random number from 0 to `most`: below 0.001, below 10, any, or `most` itself.
fn size(rng: &mut Rng, most: Fx) -> Fx {
    match rng.below(4) {
        0 => rng.range(Fx::ZERO, fx!(0.001)),
        1 => most,
        2 => rng.range(Fx::ZERO, most),
        _ => rng.range(Fx::ZERO, fx!(10)).min(most),
    }
}

fn signed(rng: &mut Rng, most: Fx) -> Fx {
    let size = size(rng, most);
    if rng.below(2) == 0 { size } else { -size }
}

const SANE: Fx = fx!(1048576);

fn maybe<T>(rng: &mut Rng, make: impl Fn(&mut Rng) -> T) -> Option<T> {
    (rng.below(2) == 0).then(|| make(rng))
}

fn limit(rng: &mut Rng) -> JointLimit {
    let (a, b) = (signed(rng, SANE), signed(rng, SANE));
    JointLimit { lower: a.min(b), upper: a.max(b) }
}

fn drive(rng: &mut Rng) -> Drive {
    Drive { speed: signed(rng, SANE), max: size(rng, Fx::MAX) }
}

fn soft(rng: &mut Rng) -> Soft {
    Soft { hertz: size(rng, fx!(1000)).max(Fx::DELTA), damping_ratio: size(rng, fx!(100)) }
}

fn spring(rng: &mut Rng) -> Spring {
    let Soft { hertz, damping_ratio } = soft(rng);
    Spring { hertz, damping_ratio, target: signed(rng, SANE) }
}

fn pull(rng: &mut Rng) -> Pull {
    Pull { soft: soft(rng), max: size(rng, Fx::MAX) }
}

fn kind(rng: &mut Rng) -> JointKind {
    let (limit, motor, spring) = (maybe(rng, limit), maybe(rng, drive), maybe(rng, spring));
    match rng.below(6) {
        0 => Revolute { limit, motor, spring }.into(),
        1 => Prismatic { limit, motor, spring }.into(),
        2 => Wheel { limit, motor, spring }.into(),
        3 => {
            let length = |x: Fx| x.abs();
            let limit = limit.map(|JointLimit { lower, upper }| JointLimit {
                lower: length(lower).min(length(upper)),
                upper: length(lower).max(length(upper)),
            });
            let spring = spring.map(|spring| Spring { target: spring.target.abs(), ..spring });
            let rod = maybe(rng, |rng| size(rng, SANE).max(fx!(0.001)));
            let spring_force =
                maybe(rng, |rng| JointLimit { lower: -size(rng, Fx::MAX), upper: size(rng, Fx::MAX) });
            Distance { rod, limit, motor, spring, spring_force }.into()
        }
        4 => Weld { linear: maybe(rng, soft), angular: maybe(rng, soft) }.into(),
        _ => {
            let mut kind = Motor { angular: motor, ..Motor::new() };
            kind.linear_spring = maybe(rng, pull);
            kind.angular_spring = maybe(rng, pull);
            kind.linear(Vec2::new(signed(rng, SANE), signed(rng, SANE)), size(rng, Fx::MAX)).into()
        }
    }
}

fn body(rng: &mut Rng, world: &mut World) -> BodyId {
    let at = || fx!(1000);
    let gyration = size(rng, fx!(512)).max(fx!(0.002));
    let mass = size(rng, fx!(1073741824)).max(fx!(0.00001));
    let centre = Vec2::new(signed(rng, fx!(128)), signed(rng, fx!(128)));
    let def = match rng.below(5) {
        0 => BodyDef::kinematic(),
        1 => BodyDef::fixed(),
        _ => BodyDef::dynamic().mass(MassSource::Given { mass, centre, gyration }),
    };
    let def = def.position((signed(rng, at()), signed(rng, at()))).angle(rng.angle());
    world.spawn(&def, &[]).expect("valid")
}

#[test]
fn no_joint_breaks_the_world() {
    let mut rng = Rng::new(20);
    let (mut joints, mut steps) = (0, 0);
    for _ in 0..400 {
        let mut world = World::default();
        let bodies: Vec<BodyId> = (0..5).map(|_| body(&mut rng, &mut world)).collect();
        for _ in 0..8 {
            let pick = |rng: &mut Rng| bodies[rng.below(5) as usize];
            let reach = fx!(128);
            let def = JointDef::new(pick(&mut rng), pick(&mut rng), kind(&mut rng))
                .anchor_a((signed(&mut rng, reach), signed(&mut rng, reach)))
                .anchor_b((signed(&mut rng, reach), signed(&mut rng, reach)))
                .angle_a(rng.angle());
            joints += u32::from(world.add_joint(&def).is_ok());
        }
        for tick in 0..12 {
            if tick % 4 == 3 {
                let (far, angle) = (fx!(1000000), rng.angle());
                let to = Vec2::new(signed(&mut rng, far), signed(&mut rng, far));
                world.set_transform(bodies[rng.below(5) as usize], to, angle).expect("valid");
            }
            let mut restored = World::from_bytes(&world.to_bytes()).expect("valid");
            world.step();
            restored.step();
            assert_eq!(world.validate(), Ok(()));
            assert_eq!(world.state_hash(), restored.state_hash());
            for (id, _) in world.joints() {
                let (a, b) = (world.joint_angle(id), world.joint_force(id));
                let (c, d) = (world.joint_translation(id), world.joint_velocity(id));
                assert!(a.is_some() && b.is_some() && c.is_some() && d.is_some());
                assert!(world.joint_length(id).is_some() && world.joint_angular_velocity(id).is_some());
            }
            steps += 1;
        }
    }
    assert!(joints > 1500 && steps == 4800, "{joints} joints");
}
