//! Samples of Box2D's group "Joints": machines that are built with joints.

use lockstep2d::body::{BodyDef, BodyId, Chain, Filter, JointId, ShapeDef};
use lockstep2d::fx;
use lockstep2d::math::{Angle, Fx, PI, Rot, Vec2, fx_mul, sqrt};
use lockstep2d::solver::{Distance, JointDef, Prismatic, Revolute, SolverSettings, Weld, Wheel};
use lockstep2d::world::Config;

use super::{Stage, ball, capsule, hull, near, num, pill, rect, square};

/// Sample "Bridge".
#[test]
fn a_bridge_carries() {
    let mut stage = Stage::new();
    let ground = stage.spawn(BodyDef::fixed(), &[]);
    let hinge = Revolute::new().motor(fx!(0), fx!(200)).spring(fx!(2), fx!(0.7), fx!(0));
    let mut before = ground;
    for i in 0..20 {
        let place = Vec2::new(num(i) - fx!(9.5), fx!(20));
        let def = BodyDef::dynamic().position(place).linear_damping(fx!(0.1)).angular_damping(fx!(0.1));
        let plank = stage.spawn(def, &[rect(fx!(0.5), fx!(0.125)).density(fx!(20))]);
        stage.join_at(before, plank, hinge, place - at!(0.5, 0));
        before = plank;
    }
    stage.join_at(before, ground, hinge, at!(10, 20));
    let wedge = hull(&[at!(-0.5, 0), at!(0.5, 0), at!(0, 1.5)]).density(fx!(20));
    let load = [stage.add(at!(-4, 22), wedge), stage.add(at!(0, 25), ball(fx!(0.5)).density(fx!(20)))];
    stage.run(900);
    assert!(stage.world.widest_joint_gap() < fx!(0.03), "{} m", stage.world.widest_joint_gap());
    for id in load {
        let place = stage.place(id);
        assert!(place.x.abs() < fx!(9) && place.y > fx!(17) && place.y < fx!(20.5), "{place:?}");
    }
}

/// Sample "Ball & Chain". Thirty links of 6 kg hold 1 t.
#[test]
fn a_chain_holds_a_heavy_ball() {
    let mut stage = Stage::new();
    let mut before = stage.spawn(BodyDef::fixed(), &[]);
    let own = |category, mask| Filter { category, mask, group: 0 };
    let link = pill(fx!(0.5), fx!(0.125)).density(fx!(20)).filter(own(1, 2));
    let hinge = Revolute::new().motor(fx!(0), fx!(100));
    let stiff = hinge.spring(fx!(4), fx!(0), fx!(0));
    for i in 0..30 {
        let body = stage.add(Vec2::new(num(i) + fx!(0.5), fx!(5)), link);
        stage.join_at(before, body, if i > 0 { stiff } else { hinge }, Vec2::new(num(i), fx!(5)));
        before = body;
    }
    let heavy = stage.add(at!(34, 5), ball(fx!(4)).density(fx!(20)).filter(own(2, 1)));
    stage.join_at(before, heavy, stiff, at!(30, 5));
    let start = stage.energy();
    stage.run_and(1200, |stage| {
        assert!(stage.world.widest_joint_gap() < fx!(0.2), "{} m", stage.world.widest_joint_gap());
        // The tolerance is 100 J of 300 kJ.
        assert!(stage.energy() < start + fx!(100), "{} J of {start}", stage.energy());
    });
}

/// Builds links of 6 kg and 1 m, welded in a row to the ground. Returns the last link.
fn cantilever(stage: &mut Stage, links: i32, weld: Weld) -> BodyId {
    let mut before = stage.spawn(BodyDef::fixed(), &[]);
    for i in 0..links {
        let link = pill(fx!(0.5), fx!(0.125)).density(fx!(20));
        let link = stage.add(Vec2::new(num(i) + fx!(0.5), fx!(0)), link);
        stage.join_at(before, link, weld, Vec2::new(num(i), fx!(0)));
        before = link;
    }
    before
}

/// Sample "Cantilever". With the settings of the sample, the cantilever falls and swings, and gains no energy.
#[test]
fn a_stiffer_cantilever_bends_less() {
    let tip = |hertz: Fx| {
        let mut stage = Stage::new();
        let tip = cantilever(&mut stage, 6, Weld::rigid().linear(fx!(15), fx!(5)).angular(hertz, fx!(5)));
        stage.run(1800);
        assert!(stage.fastest() < fx!(0.05), "still {} m/s", stage.fastest());
        stage.place(tip).y
    };
    let (soft, middle, stiff) = (tip(fx!(20)), tip(fx!(30)), tip(fx!(40)));
    assert!(soft < middle && middle < stiff && stiff < 0, "tips at {soft}, {middle} and {stiff} m");
    let mut stage = Stage::new();
    cantilever(&mut stage, 8, Weld::rigid().linear(fx!(15), fx!(0.5)).angular(fx!(5), fx!(0.5)));
    stage.run_and(1800, |stage| assert!(stage.energy() <= fx!(1), "{} J of 0", stage.energy()));
}

/// Builds a car with two driven wheels on springs.
fn car(stage: &mut Stage, place: Vec2<Fx>, torque: Fx) -> (BodyId, [JointId; 2]) {
    let outline = [at!(-1.3, -0.4), at!(1.3, -0.4), at!(1.3, 0), at!(0, 0.8), at!(-1, 0.8), at!(-1.3, 0.2)];
    let chassis = stage.add(place + at!(0, 1), hull(&outline).friction(fx!(0.2)));
    let tyre = ball(fx!(0.4)).density(fx!(2)).friction(fx!(1.5)).rolling_resistance(fx!(0.1));
    let axle =
        Wheel::new().spring(fx!(5), fx!(0.7), fx!(0)).limit(fx!(-0.25), fx!(0.25)).motor(fx!(0), torque);
    let axles = [fx!(-1), fx!(1)].map(|x| {
        let hub = place + Vec2::new(x, fx!(0.4));
        let wheel = stage.add(hub, tyre);
        stage.join_along((chassis, wheel), axle, hub, at!(0, 1))
    });
    (chassis, axles)
}

/// Sample "Driving".
#[test]
fn a_car_drives_over_hills_and_a_teeter() {
    let mut stage = Stage::new();
    let mut points = vec![at!(-20, 20), at!(-20, 0), at!(20, 0)];
    let heights = [fx!(0.25), fx!(1), fx!(3), fx!(0), fx!(0), fx!(-1), fx!(-2), fx!(-2), fx!(-1.25), fx!(0)];
    points.extend((0..).zip(heights).map(|(i, y)| Vec2::new(num(25 + 5 * i), y)));
    points.extend([at!(130, 0), at!(130, 20)]);
    let ground = stage.spawn(BodyDef::fixed(), &Chain::new(&points).links().expect("valid"));
    // The teeter turns at first, so that its near end goes down.
    let teeter = BodyDef::dynamic().position(at!(95, 1)).angular_velocity(fx!(1));
    let teeter = stage.spawn(teeter, &[rect(fx!(10), fx!(0.25))]);
    let hinge = Revolute::new().limit(fx!(-0.14), fx!(0.14));
    let hinge = stage.join_at(ground, teeter, hinge, at!(95, 1));
    let (chassis, axles) = car(&mut stage, at!(0, 0), fx!(5));
    stage.run(60);
    for axle in axles {
        stage.world.set_joint_motor_speed(axle, fx!(-35)).expect("a motor");
    }
    let mut crossed = 0;
    while stage.place(chassis).x < fx!(115) && crossed < 1800 {
        crossed += 1;
        stage.run(1);
        assert!(
            stage.angle(chassis).abs() < fx!(1.2),
            "tilted by {} at {:?}",
            stage.angle(chassis),
            stage.place(chassis)
        );
        assert!(stage.world.joint_angle(hinge).is_some_and(|angle| angle.abs() < fx!(0.16)));
    }
    assert!(crossed < 1800, "it got to {:?}", stage.place(chassis));
}

/// Sample "Ragdoll".
#[test]
fn ragdolls_hold_together() {
    let mut stage = Stage::of_scene("ragdoll");
    stage.run_and(900, |stage| {
        let gap = stage.world.widest_joint_gap();
        assert!(gap < fx!(0.05), "{gap} m at tick {}", stage.world.tick());
    });
    assert!(stage.world.widest_joint_gap() < fx!(0.005), "{} m", stage.world.widest_joint_gap());
    assert!(stage.fastest() < fx!(0.2), "still {} m/s", stage.fastest());
}

/// Sample "Soft Body".
#[test]
fn a_soft_ring_keeps_its_shape() {
    let mut stage = Stage::with_floor();
    let length = fx!(4) * 22 / 49;
    let place = |i: i32| Angle::from_turns(num(i) / 7).direction().widen().scale(fx!(2));
    let part = |stage: &mut Stage, i: i32| {
        let def = BodyDef::dynamic().position(place(i) + at!(0, 10)).angle(Angle::from_turns(num(i) / 7));
        let half = Vec2::new(Fx::ZERO, length / 2);
        stage.spawn(def, &[capsule(-half, half, fx!(0.5)).friction(fx!(0.3))])
    };
    let ring: Vec<_> = (0..7).map(|i| part(&mut stage, i)).collect();
    let weld = Weld::rigid().angular(fx!(5), fx!(0.2));
    for (i, &body) in ring.iter().enumerate() {
        let before = ring[(i + 6) % 7];
        let mut def = JointDef::new(before, body, weld).anchor_a(Vec2::new(Fx::ZERO, length / 2));
        def.frame_b.anchor = Vec2::new(Fx::ZERO, -length / 2);
        def.frame_a.angle = Angle::from_turns(fx!(1 / 7));
        stage.join(def);
    }
    let area = |stage: &Stage| -> Fx {
        (0..7).map(|i| stage.place(ring[i]).cross(stage.place(ring[(i + 1) % 7])) / 2).sum()
    };
    let start = area(&stage);
    stage.run_and(600, |stage| assert!(area(stage) > start / 3, "collapsed to {} m²", area(stage)));
    assert!(area(&stage) > start * 4 / 5, "{} of {start} m²", area(&stage));
    assert!(stage.world.widest_joint_gap() < fx!(0.02), "{} m", stage.world.widest_joint_gap());
}

/// Sample "Doohickey". Bars that slide along each other connect the wheels of a pair.
#[test]
fn doohickeys_hold_together() {
    let mut stage = Stage::with_floor();
    stage.fixed(at!(0, 1), square(fx!(1)));
    let mut sliders = Vec::new();
    for i in 0..4 {
        let place = |x: Fx| Vec2::new(x, num(2 * i) + fx!(5.5));
        let mut wheel = |x| stage.add(place(x), ball(fx!(0.5)).rolling_resistance(fx!(0.1)));
        let wheels = [wheel(fx!(-2.5)), wheel(fx!(2.5))];
        let bars = [fx!(-0.75), fx!(0.75)].map(|x| stage.add(place(x), pill(fx!(1.75), fx!(0.075))));
        let hub = Revolute::new().motor(fx!(0), fx!(1));
        stage.join_at(wheels[0], bars[0], hub, place(fx!(-2.5)));
        stage.join_at(wheels[1], bars[1], hub, place(fx!(2.5)));
        let slider =
            Prismatic::new().limit(fx!(-1), fx!(1)).motor(fx!(0), fx!(1)).spring(fx!(1), fx!(0.5), fx!(0));
        let def = JointDef::new(bars[0], bars[1], slider).anchor_a(at!(1, 0)).anchor_b(at!(-1, 0));
        sliders.push(stage.join(def));
    }
    stage.run_and(900, |stage| {
        for &id in &sliders {
            let along = stage.world.joint_translation(id).expect("there").x;
            assert!(along.abs() < fx!(1.1), "{along} m along the bar");
        }
    });
    assert!(stage.world.widest_joint_gap() < fx!(0.02), "{} m", stage.world.widest_joint_gap());
}

/// Sample "Scissor Lift". At first, the platform rises eight times as fast as the strut grows. With one iteration, the
/// beams would give way by up to 0.23 m.
#[test]
fn a_scissor_lift_rises_level() {
    let solver = SolverSettings { sub_steps: 8, iterations: 8, ..SolverSettings::default() };
    let mut stage = Stage::of(Config { solver, ..Config::default() });
    let ground = stage.floor();
    let stiff = |def: JointDef| def.softness(fx!(120), fx!(5));
    // Beams at the angle `a` to the ground make a stage `5 sin a` high. At first, `sin a` is 0.15.
    let (sine, cosine) = (fx!(0.15), fx!(0.98868599));
    let (mut feet, mut anchors) = ([ground, ground], [at!(-2.5, 1.2), at!(2.5, 1.2)]);
    let mut strutted = ground;
    for i in 0..3 {
        let place = Vec2::new(fx!(-2.5) + cosine * 5 / 2, fx!(0.2) + sine * 5 / 2 * i64::from(2 * i + 1));
        let beam = |stage: &mut Stage, angle| {
            stage.spawn(BodyDef::dynamic().position(place).angle(angle), &[pill(fx!(2.5), fx!(0.15))])
        };
        let lean = Angle::of(Vec2::new(cosine, sine));
        let (rising, falling) = (beam(&mut stage, lean), beam(&mut stage, -lean));
        if i == 1 {
            strutted = falling;
        }
        // The lowest beams collide with the ground, although joints connect them to it.
        let on_ground = |def: JointDef| if i == 0 { def.colliding() } else { def };
        let foot =
            JointDef::new(feet[0], rising, Revolute::new()).anchor_a(anchors[0]).anchor_b(at!(-2.5, 0));
        stage.join(stiff(on_ground(foot)));
        let other =
            JointDef::new(feet[1], falling, Revolute::new()).anchor_a(anchors[1]).anchor_b(at!(2.5, 0));
        let other = on_ground(other);
        stage.join(stiff(if i == 0 { JointDef { kind: Wheel::new().into(), ..other } } else { other }));
        stage.join(stiff(JointDef::new(rising, falling, Revolute::new())));
        (feet, anchors) = ([falling, rising], [at!(-2.5, 0), at!(2.5, 0)]);
    }
    let platform = stage.add(Vec2::new(Fx::ZERO, fx!(0.6) + sine * 15), rect(fx!(3), fx!(0.2)));
    stage.join(stiff(
        JointDef::new(platform, feet[0], Revolute::new()).anchor_a(at!(-2.5, -0.4)).anchor_b(anchors[0]),
    ));
    let wheel = JointDef::new(platform, feet[1], Wheel::new()).anchor_a(at!(2.5, -0.4)).anchor_b(anchors[1]);
    stage.join(stiff(wheel));
    let strut = Distance::new().limit(fx!(0.2), fx!(5.5)).motor(fx!(0.25), fx!(4000));
    let strut = stage
        .join(stiff(JointDef::new(ground, strutted, strut).anchor_a(at!(-2.5, 1.2)).anchor_b(at!(0.5, 0))));
    stage.run_and(240, |stage| {
        near(stage.angle(platform), fx!(0), fx!(0.03));
        // The strut spans `3 cos a` along x and `7 sin a` along y.
        let length = stage.world.joint_length(strut).expect("there");
        let sine = sqrt((fx_mul(length, length) - fx!(9)) / 40).expect("longer than 3 m");
        near(stage.place(platform).y, fx!(0.6) + sine * 15, fx!(0.1));
    });
    // The strut grows from 3.1459 m by 0.25 m/s.
    near(stage.world.joint_length(strut).expect("there"), fx!(4.1459), fx!(0.1));
}

/// A disc of radius 1 m with 16 teeth, whose centres are `along` metres outside of its edge.
fn toothed(along: Fx) -> Vec<ShapeDef> {
    let tooth = |i: i32| {
        let angle = Angle::from_turns(num(i) / 16);
        let place = Rot::from_angle(angle).apply_wide(Vec2::new(fx!(1) + along, Fx::ZERO));
        let core =
            lockstep2d::body::Polygon::rectangle(fx!(0.09), fx!(0.06)).and_then(|core| core.rotated(angle));
        let tooth = core.and_then(|core| core.rounded(fx!(0.03))).expect("a valid tooth");
        ShapeDef::new(tooth).offset(place).friction(fx!(0.1))
    };
    let mut shapes = vec![ball(fx!(1)).friction(fx!(0.1))];
    shapes.extend((0..16).map(tooth));
    shapes
}

/// Samples "Gear Lift" and, of the group "World", "Far Gate". At a distance of a thousand kilometres from the origin,
/// the result is bit-identical.
#[test]
fn toothed_wheels_lift_a_door() {
    let lift = |origin: Vec2<Fx>| {
        let mut stage = Stage::new();
        let ground = stage.spawn(BodyDef::fixed().position(origin), &[]);
        let (driver, follower) = (at!(-4.25, 9.75), at!(-2.25, 10.75));
        let driver_wheel = stage.spawn(BodyDef::dynamic().position(origin + driver), &toothed(fx!(0.06)));
        let motor = Revolute::new().motor(fx!(-0.3), fx!(80));
        stage.join(JointDef::new(ground, driver_wheel, motor).anchor_a(driver));
        let wheel = stage.spawn(BodyDef::dynamic().position(origin + follower), &toothed(fx!(0.09)));
        let friction = Revolute::new().motor(fx!(0), fx!(0.5));
        stage.join(JointDef::new(ground, wheel, friction).anchor_a(follower));
        let (mut before, mut top) = (wheel, follower + at!(1.21, 0));
        for _ in 0..20 {
            let place = top - at!(0, 0.07);
            let link = capsule(at!(0, -0.07), at!(0, 0.07), fx!(0.05)).density(fx!(2));
            let link = stage.add(origin + place, link);
            stage.join_at(before, link, Revolute::new().motor(fx!(0), fx!(0.05)), origin + top);
            (before, top) = (link, place - at!(0, 0.07));
        }
        let door_place = top - at!(0, 1.5);
        let door = stage.add(origin + door_place, rect(fx!(0.15), fx!(1.5)).friction(fx!(0.1)));
        stage.join_at(before, door, Revolute::new().motor(fx!(0), fx!(0.05)), origin + top);
        stage.join_along(
            (ground, door),
            Prismatic::new().motor(fx!(0), fx!(0.2)),
            origin + door_place,
            at!(0, 1),
        );
        stage.run(240);
        let turned = [driver_wheel, wheel].map(|id| stage.angle(id));
        (turned, stage.place(door) - origin, door_place, stage.world.widest_joint_gap())
    };
    let (turned, door, start, gap) = lift(Vec2::ZERO);
    near(turned[0], fx!(-1.2), fx!(0.02));
    // The wheels turn by equal angles, except for the play of a tooth's width.
    near(turned[1], fx!(1.2), fx!(0.2));
    assert!(door.y > start.y + fx!(0.8), "the door went from {start:?} to {door:?}");
    assert!(gap < fx!(0.02), "{gap} m");
    assert_eq!(lift(at!(1000000, -3000)), (turned, door, start, gap));
}

/// Sample "Door".
#[test]
fn a_door_swings_back_and_stops_at_its_limits() {
    for blow in [2000, 10000, 50000] {
        let mut stage = Stage::new();
        let ground = stage.spawn(BodyDef::fixed(), &[]);
        let def = BodyDef::dynamic().position(at!(0, 1.5)).gravity_scale(fx!(0));
        let door = stage.spawn(def, &[rect(fx!(0.1), fx!(1.5)).density(fx!(1000))]);
        let hinge = Revolute::new().spring(fx!(1), fx!(0.5), fx!(0)).limit(-PI / 2, PI / 2);
        let def = JointDef::new(ground, door, hinge).anchor_b(at!(0, -1.5)).softness(fx!(60), fx!(1));
        let joint = stage.join(def);
        stage.world.apply_impulse(door, Vec2::new(num(blow), Fx::ZERO), at!(0, 3)).expect("valid");
        let mut widest = Fx::ZERO;
        stage.run_and(900, |stage| {
            widest = widest.max(stage.world.joint_angle(joint).expect("there").abs());
        });
        assert!(widest > fx!(0.3) && widest < PI / 2 + fx!(0.1), "{blow} N s: {widest} rad");
        near(stage.world.joint_angle(joint).expect("there"), fx!(0), fx!(0.01));
        assert!(stage.world.widest_joint_gap() < fx!(0.001));
    }
}

/// Sample "Scale Ragdoll".
#[test]
fn a_figure_grows() {
    let mut stage = Stage::with_floor();
    let bone =
        |scale: Fx| capsule(Vec2::new(-scale / 2, Fx::ZERO), Vec2::new(scale / 2, Fx::ZERO), scale / 5);
    let bones: Vec<_> = (0..4).map(|i| stage.add(Vec2::new(num(i), fx!(1)), bone(fx!(1)))).collect();
    let hinge =
        Revolute::new().limit(fx!(-0.8), fx!(0.8)).motor(fx!(0), fx!(0.03)).spring(fx!(1), fx!(0.5), fx!(0));
    let anchored = |pair: &[BodyId], scale: Fx| {
        let half = Vec2::new(scale / 2, Fx::ZERO);
        JointDef::new(pair[0], pair[1], hinge).anchor_a(half).anchor_b(-half)
    };
    let joints: Vec<_> = bones.windows(2).map(|pair| stage.join(anchored(pair, fx!(1)))).collect();
    stage.run(120);
    for percent in (110..=200).step_by(10) {
        let scale = num(percent) / 100;
        for &id in &bones {
            let shape = stage.shape(id);
            stage.world.set_geometry(shape, bone(scale).geometry).expect("valid");
        }
        for (&joint, pair) in joints.iter().zip(bones.windows(2)) {
            stage.world.set_joint(joint, &anchored(pair, scale)).expect("valid");
        }
        stage.run(60);
        assert!(
            stage.world.widest_joint_gap() < fx!(0.01),
            "scale {scale}: {} m",
            stage.world.widest_joint_gap()
        );
    }
    // The mass of a capsule grows with the square of its size.
    near(stage.body(bones[0]).mass(), fx!(1.6) + PI * 4 / 25, fx!(0.001));
    assert!(bones.iter().all(|&id| stage.place(id).y > fx!(0.38)));
}
