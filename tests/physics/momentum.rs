//! A joint between two free bodies conserves momentum and angular momentum: its impulses act at one point, however far
//! its anchors are apart.
//!
//! The change of momentum is compared with `sum m |v|`. The change of angular momentum about the common centre of mass
//! is compared with `sum m |r x v| + m k^2 |w|`.

use lockstep2d::body::{Body, BodyDef, Geometry, MassSource, Polygon, ShapeDef};
use lockstep2d::fx;
use lockstep2d::math::{Fx, Rng, Rot, Vec2, fx_div, fx_mul};
use lockstep2d::solver::{Distance, JointDef, JointKind, Motor, Prismatic, Weld, Wheel};
use lockstep2d::world::{Config, World};

use crate::sweep;

/// Momentum, angular momentum about the common centre of mass, and the sums of the absolute values of their terms.
#[derive(Clone, Copy, Debug, Default)]
struct Momentum {
    linear: Vec2<Fx>,
    angular: Fx,
    linear_size: Fx,
    angular_size: Fx,
}

impl Momentum {
    fn of(world: &World) -> Self {
        let mass = world.bodies().fold(Fx::ZERO, |sum, (_, body)| sum + body.mass());
        let mean = |of: fn(&Body) -> Vec2<Fx>| {
            let share = |body: &Body| of(body).scale(fx_div(body.mass(), mass).expect("positive"));
            world.bodies().fold(Vec2::ZERO, |sum, (_, body)| sum + share(body))
        };
        let (centre, drift) = (mean(|body| body.centre_of_mass()), mean(|body| body.velocity()));
        let add = |sum: Momentum, body: &Body| {
            let (mass, v) = (body.mass(), body.velocity());
            let orbit = fx_mul(mass, (body.centre_of_mass() - centre).cross(v - drift));
            let spin = fx_mul(body.inertia(), body.angular_velocity());
            Momentum {
                linear: sum.linear + v.scale(mass),
                angular: sum.angular + orbit + spin,
                linear_size: sum.linear_size + fx_mul(mass, v.length()),
                angular_size: sum.angular_size + orbit.abs() + spin.abs(),
            }
        };
        world.bodies().fold(Momentum::default(), |sum, (_, body)| add(sum, body))
    }
}

struct Choice(Rng);

impl Choice {
    fn one_in(&mut self, n: u32) -> bool {
        self.0.below(n) == 0
    }

    fn within(&mut self, most: Fx) -> Fx {
        self.0.range(-most, most)
    }

    /// Force in N. A quarter of the forces are unlimited.
    fn force(&mut self) -> Fx {
        if self.one_in(4) { Fx::MAX } else { self.0.range(fx!(0.1), fx!(300)) }
    }

    fn hertz(&mut self) -> Fx {
        self.0.range(fx!(0.2), fx!(10))
    }

    fn damping_ratio(&mut self) -> Fx {
        if self.one_in(4) { Fx::ZERO } else { self.0.range(fx!(0), fx!(2)) }
    }

    /// Speed in m/s or rad/s. Half of the speeds are 0, which makes a motor act as friction.
    fn speed(&mut self) -> Fx {
        if self.one_in(2) { Fx::ZERO } else { self.within(fx!(2)) }
    }

    fn kind(&mut self, number: u64) -> JointKind {
        match number % 5 {
            0 => self.motor(),
            1 => self.distance(),
            2 => self.prismatic(),
            3 => self.wheel(),
            _ => self.weld(),
        }
    }

    fn motor(&mut self) -> JointKind {
        let mut kind = Motor::new();
        let parts = 1 + self.0.below(15);
        if parts & 1 > 0 {
            kind = kind.linear((self.speed(), self.speed()), self.force());
        }
        if parts & 2 > 0 {
            kind = kind.angular(self.speed(), self.force());
        }
        if parts & 4 > 0 {
            kind = kind.linear_spring(self.hertz(), self.damping_ratio(), self.force());
        }
        if parts & 8 > 0 {
            kind = kind.angular_spring(self.hertz(), self.damping_ratio(), self.force());
        }
        kind.into()
    }

    fn distance(&mut self) -> JointKind {
        let mut kind = if self.one_in(3) { Distance::rod(fx!(1)) } else { Distance::new() };
        if self.one_in(2) {
            kind = kind.limit(self.0.range(fx!(0), fx!(1)), self.0.range(fx!(1), fx!(3)));
        }
        if self.one_in(2) {
            kind = kind.motor(self.speed(), self.force());
        }
        if self.one_in(2) {
            kind = kind.spring(self.hertz(), self.damping_ratio(), self.0.range(fx!(0), fx!(2)));
        }
        if self.one_in(3) {
            kind = kind.spring_force(-self.force(), self.force());
        }
        kind.into()
    }

    fn prismatic(&mut self) -> JointKind {
        let mut kind = Prismatic::new().limit(self.0.range(fx!(-2), fx!(0)), self.0.range(fx!(0), fx!(2)));
        if self.one_in(2) {
            kind = kind.motor(self.speed(), self.force());
        }
        if self.one_in(2) {
            kind = kind.spring(self.hertz(), self.damping_ratio(), self.within(fx!(1)));
        }
        kind.into()
    }

    fn wheel(&mut self) -> JointKind {
        let mut kind = Wheel::new().limit(self.0.range(fx!(-2), fx!(0)), self.0.range(fx!(0), fx!(2)));
        if self.one_in(2) {
            kind = kind.motor(self.speed(), self.force());
        }
        if self.one_in(2) {
            kind = kind.spring(self.hertz(), self.damping_ratio(), self.within(fx!(1)));
        }
        kind.into()
    }

    fn weld(&mut self) -> JointKind {
        let kind = Weld::rigid().linear(self.hertz(), self.damping_ratio());
        let soft = self.one_in(2);
        if soft { kind.angular(self.hertz(), self.damping_ratio()) } else { kind }.into()
    }

    /// Mass from 0.1 to 100 kg. Each decade is equally likely.
    fn mass(&mut self) -> Fx {
        let decade = [fx!(0.1), fx!(1), fx!(10)][self.0.below(3) as usize];
        fx_mul(decade, self.0.range(fx!(1), fx!(10)))
    }

    /// A square body of 0.1 to 2 m, and an anchor on it.
    fn end(&mut self) -> (BodyDef, Vec2<Fx>) {
        let half = self.0.range(fx!(0.05), fx!(1));
        // The radius of gyration of a square is its side divided by the square root of 6.
        let gyration = fx_mul(half, fx!(0.81649658));
        let body = BodyDef::dynamic()
            .mass(MassSource::Given { mass: self.mass(), centre: Vec2::ZERO, gyration })
            .angle(self.0.angle())
            .velocity((self.within(fx!(3)), self.within(fx!(3))))
            .angular_velocity(self.within(fx!(5)));
        (body, Vec2::new(self.within(half), self.within(half)))
    }
}

/// Two bodies and a joint. The parts of the joint that are rigid are satisfied at the start.
fn pair(number: u64) -> (World, JointKind) {
    let mut choice = Choice(Rng::new(number));
    let config = Config { gravity: Vec2::ZERO, sleeping: false, ..Config::default() };
    let mut world = World::new(config).expect("valid");
    let kind = choice.kind(number);
    let ((mut a, anchor_a), (mut b, anchor_b)) = (choice.end(), choice.end());
    let (along, across) = (choice.within(fx!(1)), choice.within(fx!(1)));
    let gap = match kind {
        JointKind::Prismatic(_) | JointKind::Wheel(_) => Vec2::new(along, fx!(0)),
        JointKind::Distance(_) => Vec2::new(fx!(1), fx!(0)),
        _ => Vec2::new(along, across),
    };
    if matches!(kind, JointKind::Prismatic(_) | JointKind::Weld(_)) {
        b.angle = a.angle;
    }
    let rotation = |body: &BodyDef| Rot::from_angle(body.angle);
    a.position = Vec2::new(choice.within(fx!(5)), choice.within(fx!(5)));
    b.position = a.position + rotation(&a).apply_wide(anchor_a + gap) - rotation(&b).apply_wide(anchor_b);
    let [a, b] = [a, b].map(|body| world.spawn(&body, &[]).expect("valid"));
    let def = JointDef::new(a, b, kind).anchor_a(anchor_a).anchor_b(anchor_b);
    world.add_joint(&def).expect("valid");
    (world, kind)
}

/// Largest changes of momentum and of angular momentum within 10 s, each relative to the sum of the absolute values of
/// its terms.
fn changes(number: u64) -> (Fx, Fx) {
    let (mut world, kind) = pair(number);
    let start = Momentum::of(&world);
    let mut worst = Momentum::default();
    for _ in 0..600 {
        world.step();
        let now = Momentum::of(&world);
        let linear = (now.linear - start.linear).length();
        worst.linear.x = worst.linear.x.max(linear);
        worst.angular = worst.angular.max((now.angular - start.angular).abs());
        worst.linear_size = worst.linear_size.max(now.linear_size);
        worst.angular_size = worst.angular_size.max(now.angular_size);
    }
    assert_eq!(world.faults(), 0, "pair {number}, {kind:?}: expected no clamped or saturated value");
    let relative = |change: Fx, size: Fx| fx_div(change, size).expect("moving");
    (relative(worst.linear.x, worst.linear_size), relative(worst.angular, worst.angular_size))
}

/// Hinges and rigid welds are left out, because they are solved by other code, in batches.
#[test]
fn a_joint_between_free_bodies_keeps_their_momentum() {
    sweep::for_each((0..sweep::size(1000, 250)).collect(), |number| {
        let (linear, angular) = changes(number);
        let bound = fx!(0.0001);
        assert!(linear < bound, "pair {number}: momentum changes by {linear} of its parts");
        assert!(angular < bound, "pair {number}: angular momentum changes by {angular} of its parts");
    });
}

/// A motor joint between two balls acts as friction. If it held up the higher ball, it would also turn the lower ball,
/// because nothing else could bear the torque of the friction.
#[test]
fn friction_between_two_balls_holds_neither_of_them_up() {
    for (apart, force) in [(fx!(1.2), fx!(5)), (fx!(1.2), fx!(11)), (fx!(2), fx!(20)), (fx!(4), Fx::MAX)] {
        for fall in [fx!(0), fx!(1)] {
            let mut world = World::default();
            let floor = ShapeDef::new(Polygon::rectangle(fx!(50), fx!(1)).expect("valid"));
            world.spawn(&BodyDef::fixed().position((fx!(0), fx!(-1))), &[floor]).expect("valid");
            // Each ball has 1 kg.
            let ball = ShapeDef::new(Geometry::circle(fx!(0.5)).expect("valid")).density(fx!(1.2732));
            let low = BodyDef::dynamic().position((fx!(0), fx!(0.5) + fall));
            let high = BodyDef::dynamic().position((apart, fx!(3)));
            let [low, high] = [low, high].map(|def| world.spawn(&def, &[ball]).expect("valid"));
            let friction = Motor::new().linear((fx!(0), fx!(0)), force);
            world.add_joint(&JointDef::new(low, high, friction).colliding()).expect("valid");
            for _ in 0..600 {
                world.step();
            }
            for id in [low, high] {
                let y = world.body(id).expect("there").position().y;
                assert!((y - fx!(0.5)).abs() < fx!(0.005), "{force} N, {apart} m apart: rests at {y} m");
            }
        }
    }
}

/// A motor joint with a speed of 0 acts as friction. It holds a weight of 10 N if its largest force suffices. Otherwise
/// the weight falls with the remaining acceleration.
#[test]
fn friction_holds_a_falling_body_only_if_it_suffices() {
    for (force, falls) in [(fx!(9.5), true), (fx!(10.5), false)] {
        let mut world = World::default();
        let wall = world.spawn(&BodyDef::fixed().position((fx!(-2), fx!(1))), &[]).expect("valid");
        let given = MassSource::Given { mass: fx!(1), centre: Vec2::ZERO, gyration: fx!(0.4) };
        let body = world.spawn(&BodyDef::dynamic().mass(given), &[]).expect("valid");
        let friction = Motor::new().linear((fx!(0), fx!(0)), force);
        world.add_joint(&JointDef::new(wall, body, friction)).expect("valid");
        for _ in 0..120 {
            world.step();
        }
        // The body falls at 0.5 m/s² for 2 s.
        let expected = if falls { fx!(-1) } else { fx!(0) };
        let y = world.body(body).expect("there").position().y;
        assert!((y - expected).abs() < fx!(0.01), "{force} N: at {y} m");
    }
}

#[test]
fn an_unlimited_motor_rests_at_the_limit_of_its_joint() {
    let slider = Prismatic::new().limit(fx!(-1), fx!(1)).motor(fx!(2), Fx::MAX);
    let rope = Distance::new().limit(fx!(0.5), fx!(1)).motor(fx!(2), Fx::MAX);
    for kind in [JointKind::from(slider), JointKind::from(rope)] {
        let config = Config { gravity: Vec2::ZERO, sleeping: false, ..Config::default() };
        let mut world = World::new(config).expect("valid");
        let given = MassSource::Given { mass: fx!(1), centre: Vec2::ZERO, gyration: fx!(0.4) };
        let a = BodyDef::dynamic().mass(given);
        let b = a.position((fx!(0.75), fx!(0)));
        let [a, b] = [a, b].map(|def| world.spawn(&def, &[]).expect("valid"));
        let joint = world.add_joint(&JointDef::new(a, b, kind)).expect("valid");
        for _ in 0..1200 {
            world.step();
        }
        let length = world.joint_length(joint).expect("there");
        assert!((length - Fx::ONE).abs() < fx!(0.0001), "{kind:?}: rests at {length} m");
        assert_eq!(world.faults(), 0);
    }
}
