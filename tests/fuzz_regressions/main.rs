//! Faults that the fuzz targets (`fuzz/`) have found, each reduced to a minimal case.

mod edge_of_the_world;
mod forged_snapshots;

use lockstep2d::body::{BodyDef, Geometry, MassSource, Polygon, ShapeDef};
use lockstep2d::lockstep::{Game, Sandbox, SandboxSetup};
use lockstep2d::math::{Angle, Fx, Vec2};
use lockstep2d::replay::{Limits, Recording, play_within, verify};
use lockstep2d::solver::{JointDef, Revolute};
use lockstep2d::world::{BodyPose, Command, Config, World};
use lockstep2d::{codec, fx};

fn weightless() -> World {
    World::new(Config { gravity: Vec2::ZERO, ..Config::default() }).expect("valid")
}

/// Steps the world, and a copy whose caches are cleared before every tick. Expects that their digests stay equal.
fn caches_decide_nothing(world: &mut World, ticks: u64) {
    let mut bare = world.clone();
    for _ in 0..ticks {
        bare.clear_scratch();
        bare.step();
        world.step();
        let differing = world.digest().differing(&bare.digest());
        assert!(differing.is_empty(), "tick {}: {differing:?} depend on caches", world.tick());
    }
}

#[test]
fn an_outline_that_goes_back_on_itself_is_refused() {
    // Every vertex coincides with an end of every edge, so no vertex is on the wrong side of an edge. The area is zero,
    // and the mass computation would divide by it.
    let there_and_back = [(0, 0), (1, 0), (0, 0), (1, 0)].map(|(x, y)| Vec2::new(Fx::from(x), Fx::from(y)));
    assert!(Polygon::new(&there_and_back).is_err());
}

#[test]
fn an_outline_that_goes_round_twice_is_refused() {
    let twice = [(0, 0), (1, 0), (0, 1), (0, 0), (1, 0), (0, 1)];
    let twice = twice.map(|(x, y)| Vec2::new(Fx::from(x), Fx::from(y)));
    assert!(Polygon::new(&twice).is_err());
}

#[test]
fn a_removed_shape_moves_the_others_as_their_caches_say() {
    // The removal moves the centre of mass. The new centre is rounded, which moves the remaining shapes a little. Their
    // caches must follow.
    let mut world = weightless();
    for turn in 1..40 {
        let ball = |x, y| ShapeDef::new(Geometry::circle(fx!(0.3)).unwrap()).offset((x, y));
        let shapes = [ball(fx!(0.1), fx!(0.7)), ball(fx!(1.3), fx!(0.2)), ball(fx!(-0.9), fx!(-0.35))];
        let body = BodyDef::dynamic().angle(Angle::from_bits(turn * 91_234_567)).velocity((fx!(50), fx!(3)));
        let body = world.spawn(&body, &shapes).unwrap();
        world.step();
        let first = world.body(body).unwrap().shapes()[0];
        world.remove_shape(first).unwrap();
        caches_decide_nothing(&mut world, 3);
        world.despawn(body).unwrap();
    }
}

#[test]
fn bodies_without_shapes_are_work() {
    let spawn = Command::Spawn { body: BodyDef::fixed(), shapes: Vec::new() };
    let setup = SandboxSetup { config: Config::default(), commands: vec![spawn; 1000] };
    let game = Sandbox::new(&setup).unwrap();
    assert!(game.work(&[Vec::new()]) >= 1000, "{}", game.work(&[Vec::new()]));
}

#[test]
fn many_shapes_at_one_point_are_work_in_their_first_tick() {
    let ball = ShapeDef::new(Geometry::circle(fx!(1)).unwrap());
    let spawn = Command::Spawn { body: BodyDef::dynamic(), shapes: vec![ball] };
    let setup = SandboxSetup { config: Config::default(), commands: vec![spawn; 400] };
    let play = |tick_work| {
        let (mut game, mut spent) = (Sandbox::new(&setup).unwrap(), 0);
        let limits = Limits { tick_work, ..Limits::default() };
        let played = play_within(&mut game, &[Vec::new()], &limits, &mut spent, Sandbox::step);
        (played.is_ok(), spent, game.world().pair_count() as u64)
    };
    let (_, spent, pairs) = play(u64::MAX);
    assert!(pairs == 79_800 && spent >= pairs, "{spent} work units for {pairs} pairs");
    // With a smaller budget, the search stops before it has listed all pairs. Each new pair costs 12 units.
    let (is_within, _, pairs) = play(100_000);
    assert!(!is_within && pairs <= 100_000 / 12, "{pairs} pairs");
}

#[test]
fn the_last_tick_of_all_is_followed_by_no_panic() {
    let world = World::default();
    let mut bytes = world.to_bytes();
    let config = codec::encode(world.config()).len();
    let at = 24 + config;
    bytes[at..at + 8].copy_from_slice(&u64::MAX.to_le_bytes());
    let end = bytes.len() - 16;
    let hash = lockstep2d::hash::StateHash::of_bytes(&bytes[..end]);
    bytes[end..].copy_from_slice(&hash.0.to_le_bytes());
    if let Ok(mut world) = World::from_bytes(&bytes) {
        world.step();
    }
}

#[test]
fn a_large_ball_is_pushed_out_of_the_floor() {
    // If distances and radii saturated at 16 m, the separation would be zero.
    let mut world = weightless();
    let floor = ShapeDef::new(Polygon::rectangle(fx!(100), fx!(50)).unwrap());
    world.spawn(&BodyDef::fixed().position((fx!(0), fx!(-50))), &[floor]).unwrap();
    let ball = ShapeDef::new(Geometry::circle(fx!(40)).unwrap());
    let ball = world.spawn(&BodyDef::dynamic().position((fx!(0), fx!(35))), &[ball]).unwrap();
    for _ in 0..300 {
        world.step();
    }
    let height = world.body(ball).unwrap().position().y;
    assert!(height > fx!(39), "expected the ball to be pushed out, at {height}");
}

#[test]
fn a_large_ball_beside_a_corner_does_not_touch_it() {
    let mut world = weightless();
    let block = ShapeDef::new(Polygon::square(fx!(10)).unwrap());
    world.spawn(&BodyDef::fixed().position((fx!(-10), fx!(-10))), &[block]).unwrap();
    let ball = ShapeDef::new(Geometry::circle(fx!(50)).unwrap());
    // The AABBs overlap, but the ball is 13 m from the corner.
    world.spawn(&BodyDef::dynamic().position((fx!(45), fx!(45))), &[ball]).unwrap();
    world.step();
    assert!(world.events().contact_begin.is_empty(), "expected no contact at a distance of 13 m");
}

#[test]
fn a_ball_deep_inside_a_large_block_leaves_by_the_nearest_face() {
    let mut world = weightless();
    let block = ShapeDef::new(Polygon::square(fx!(100)).unwrap());
    world.spawn(&BodyDef::fixed(), &[block]).unwrap();
    let ball = ShapeDef::new(Geometry::circle(fx!(0.5)).unwrap());
    let ball = world.spawn(&BodyDef::dynamic().position((fx!(70), fx!(0))), &[ball]).unwrap();
    for _ in 0..60 {
        world.step();
    }
    let x = world.body(ball).unwrap().position().x;
    assert!(x > fx!(70), "expected the ball to be pushed right, at {x}");
}

#[test]
fn impulses_that_grow_over_sub_steps_are_no_overflow() {
    // In a sub-step, an impulse may grow by several updates of up to 512 m/s each. The next sub-step applies their sum
    // at once. Each ball pushes all others, and gravity accelerates the balls to the speed limit.
    let gravity = Vec2::new(fx!(0), fx!(-100000));
    let mut world = World::new(Config { gravity, tick_rate: 20, ..Config::default() }).unwrap();
    let floor = ShapeDef::new(Polygon::rectangle(fx!(20), fx!(1)).unwrap());
    world.spawn(&BodyDef::fixed().position((fx!(0), fx!(-1))), &[floor]).unwrap();
    let ball = ShapeDef::new(Geometry::circle(fx!(0.5)).unwrap());
    for i in 0..40 {
        let mass = if i % 2 == 0 { fx!(1000) } else { fx!(1) };
        let mass = MassSource::Given { mass, centre: Vec2::ZERO, gyration: fx!(0.3) };
        let body = BodyDef::dynamic().position((fx!(0), Fx::from(i) / 10)).mass(mass);
        world.spawn(&body, &[ball]).unwrap();
    }
    for _ in 0..60 {
        world.step();
        world.validate().unwrap();
    }
}

#[test]
fn turns_and_levers_at_their_limits_are_no_overflow() {
    // The displacement of bodies that rotate about far centres is the sum of three products, two of which fill 63 bits.
    let sides = [1i64, -1];
    for (arm_a, arm_b, turn_a, turn_b) in sides
        .into_iter()
        .flat_map(|a| sides.map(|b| (a, b)))
        .flat_map(|(a, b)| sides.into_iter().flat_map(move |c| sides.map(|d| (a, b, c, d))))
    {
        let mut config = Config { gravity: Vec2::ZERO, tick_rate: 27, ..Config::default() };
        config.solver.sub_steps = 3;
        let mut world = World::new(config).unwrap();
        for (x, arm, turn) in [(-1, arm_a, turn_a), (1, arm_b, turn_b)] {
            let box_ = ShapeDef::new(Polygon::square(fx!(0.5)).unwrap()).friction(fx!(0));
            let centre = Vec2::new(fx!(0), fx!(128) * arm);
            let mass = MassSource::Given { mass: fx!(1), centre, gyration: fx!(0.002) };
            let body = BodyDef::dynamic().position((fx!(0.5) * x, fx!(0))).velocity((fx!(20) * x, fx!(0)));
            world.spawn(&body.mass(mass).angular_velocity(fx!(199000) * turn), &[box_]).unwrap();
        }
        for _ in 0..3 {
            world.step();
        }
    }
}

#[test]
fn joints_that_pull_with_all_they_have_leave_no_velocity_at_the_end_of_its_format() {
    // The two axes of a hinge together may change a velocity by more than 512 m/s. The velocity could then become the
    // most negative number of its format, whose magnitude does not fit the format.
    for turn in 0..64u32 {
        let mut world = weightless();
        let post = world.spawn(&BodyDef::fixed(), &[]).unwrap();
        let mass = MassSource::Given { mass: fx!(1), centre: Vec2::ZERO, gyration: fx!(0.4) };
        let body = BodyDef::dynamic().position((fx!(400), fx!(400))).angle(Angle::from_bits(turn << 26));
        let body = world.spawn(&body.velocity((fx!(-280), fx!(-280))).mass(mass), &[]).unwrap();
        world.add_joint(&JointDef::new(post, body, Revolute::new()).anchor_b((fx!(4), fx!(0)))).unwrap();
        for _ in 0..20 {
            world.step();
            world.validate().unwrap();
        }
    }
}

#[test]
fn many_shapes_added_in_one_tick_are_work() {
    let ball = ShapeDef::new(Geometry::circle(fx!(0.5)).unwrap());
    let setup = SandboxSetup {
        config: Config::default(),
        commands: vec![Command::Spawn { body: BodyDef::dynamic(), shapes: vec![ball] }],
    };
    let game = Sandbox::new(&setup).unwrap();
    let body = game.world().bodies().next().unwrap().0;
    let commands = vec![Command::AddShape { body, shape: ball }; 2000];
    assert!(game.work(&[commands]) > 10_000_000);
    let mut setup = setup;
    setup.commands.extend(vec![Command::AddShape { body, shape: ball }; 20_000]);
    assert!(Sandbox::new(&setup).is_err());
}

#[test]
fn many_fixed_shapes_at_one_point_wake_nobody_for_long() {
    // If each new shape were compared with all earlier ones, 20 000 shapes would already take a minute.
    let poses = vec![BodyPose { position: Vec2::ZERO, angle: Angle::ZERO }; 50_000];
    let ball = ShapeDef::new(Geometry::circle(fx!(0.5)).unwrap());
    let spawn = Command::SpawnEach { body: BodyDef::fixed(), shapes: vec![ball], poses };
    let game = Sandbox::new(&SandboxSetup { config: Config::default(), commands: vec![spawn] });
    assert_eq!(game.unwrap().world().body_count(), 50_000);
}

#[test]
fn a_shape_that_comes_wakes_who_lies_where_it_comes() {
    // Only the new shape wakes bodies. The other shapes of its body are not tested.
    let mut world = World::default();
    let ball = ShapeDef::new(Geometry::circle(fx!(0.5)).unwrap());
    let ground = world.spawn(&BodyDef::fixed(), &[ball]).unwrap();
    let [near, far] = [fx!(10), fx!(20)].map(|x| BodyDef::dynamic().position((x, fx!(0))).asleep());
    let (near, far) = (world.spawn(&near, &[ball]).unwrap(), world.spawn(&far, &[ball]).unwrap());
    world.add_shape(ground, &ball.offset((fx!(10), fx!(0.5)))).unwrap();
    let sleeps = |body| world.body(body).unwrap().is_asleep();
    assert!(!sleeps(near) && sleeps(far));
}

#[test]
fn kinematic_bodies_that_start_to_move_are_work() {
    // When a kinematic body starts to move, the world visits all joints of the body. This work must be counted.
    let ball = ShapeDef::new(Geometry::circle(fx!(0.5)).unwrap());
    let mut setup = SandboxSetup { config: Config::default(), commands: Vec::new() };
    for kind in [BodyDef::kinematic(), BodyDef::dynamic().asleep()] {
        setup.commands.push(Command::Spawn { body: kind, shapes: vec![ball] });
    }
    let bodies: Vec<_> = Sandbox::new(&setup).unwrap().world().bodies().map(|(id, _)| id).collect();
    let joint = JointDef::new(bodies[0], bodies[1], Revolute::new());
    setup.commands.push(Command::AddJointEach { joint, ends: vec![(bodies[0], bodies[1]); 10_000] });
    let idle = Sandbox::new(&setup).unwrap().work(&[Vec::new()]);
    let (body, position, angle) = (bodies[0], Vec2::new(fx!(1), fx!(0)), Angle::ZERO);
    let velocity =
        |x| Command::SetVelocity { body, velocity: Vec2::new(x, fx!(0)), angular_velocity: fx!(0) };
    for command in [
        velocity(fx!(1)),
        Command::SetTransform { body, position, angle },
        Command::MoveTo { body, position, angle },
    ] {
        let mut recording = Recording::<Sandbox>::start(&setup, 60).unwrap();
        let commands = [command.clone(), velocity(fx!(0))];
        recording.step(&[vec![commands; 100].concat()]).unwrap();
        let limits = Limits { tick_work: idle + 1_000_000, ..Limits::default() };
        let verdict = verify::<Sandbox>(&recording.finish().unwrap(), &limits);
        assert_eq!(verdict.name(), "limit_exceeded", "{command:?}: {verdict}");
    }
}

#[test]
fn contacts_that_have_parted_do_not_rest() {
    // A body that is pushed out of an overlap may leave its fat box within the tick. If it then fell asleep before the
    // next pair update, contacts whose boxes no longer overlap would stay until the caches are cleared.
    let mut rng = lockstep2d::math::Rng::new(1);
    for _ in 0..40 {
        let gravity = Vec2::new(fx!(25), fx!(-40));
        let mut config = Config { gravity, tick_rate: 10, ..Config::default() };
        config.solver.sub_steps = 6;
        let mut world = World::new(config).unwrap();
        let line = Geometry::segment(Vec2::new(fx!(-8), fx!(0)), Vec2::new(fx!(8), fx!(-1))).unwrap();
        world.spawn(&BodyDef::fixed(), &[ShapeDef::new(line)]).unwrap();
        let (a, b) = (Vec2::new(fx!(-0.53), fx!(-0.53)), Vec2::new(fx!(0.453), fx!(0.083)));
        let pill =
            ShapeDef::new(Geometry::capsule(a, b, fx!(0.493)).unwrap()).offset((fx!(-0.8), fx!(0.662)));
        for _ in 0..12 {
            let (x, y) = (rng.range(fx!(-2), fx!(2)), rng.range(fx!(-1), fx!(2)));
            world.spawn(&BodyDef::dynamic().position((x, y)).angle(rng.angle()), &[pill]).unwrap();
        }
        for _ in 0..3 {
            world.step();
        }
        let first = world.bodies().nth(1).unwrap().0;
        world.sleep(first).unwrap();
        caches_decide_nothing(&mut world, 2);
    }
}

#[test]
fn a_body_that_a_joint_drags_out_of_range_is_not_slow() {
    // At 30 Hz or less a displacement may saturate on both axes. The sum of squares must not overflow.
    for tick_rate in [10, 20, 30] {
        let mut config = Config { tick_rate, ..Config::default() };
        config.solver.sub_steps = (60 / tick_rate).max(4);
        let mut world = World::new(config).unwrap();
        let pin = world.spawn(&BodyDef::fixed(), &[]).unwrap();
        let ball = ShapeDef::new(Geometry::circle(fx!(0.5)).unwrap());
        let def = BodyDef::dynamic().position((fx!(40), fx!(40))).lock_rotation();
        let ball = world.spawn(&def, &[ball]).unwrap();
        world.add_joint(&JointDef::new(pin, ball, Revolute::new())).unwrap();
        caches_decide_nothing(&mut world, 20);
        assert_eq!(world.validate(), Ok(()));
    }
}

#[test]
fn a_shape_in_the_slot_of_one_that_slept_has_its_own_surface() {
    // The combined material of two shapes is cached under their slots. Here a sleeping shape, whose contacts are not
    // active, is removed, and a new shape reuses its slot before the next tick. It must not get the cached material.
    let mut world = World::default();
    let ground = ShapeDef::new(Polygon::rectangle(fx!(20), fx!(1)).unwrap());
    world.spawn(&BodyDef::fixed().position((fx!(0), fx!(-1))), &[ground]).unwrap();
    let square = |friction| ShapeDef::new(Polygon::square(fx!(0.5)).unwrap()).friction(friction);
    let def = BodyDef::dynamic().position((fx!(0), fx!(0.5)));
    let rough = world.spawn(&def, &[square(fx!(1))]).unwrap();
    (0..30).for_each(|_| world.step());
    world.sleep(rough).unwrap();
    world.despawn(rough).unwrap();
    world.spawn(&def.velocity((fx!(5), fx!(0))), &[square(fx!(0))]).unwrap();
    caches_decide_nothing(&mut world, 2);
}

#[test]
fn a_circle_in_line_with_a_turned_capsule_is_beyond_its_end() {
    // At one in four angles, rounding may put the ball's centre between the long sides of the capsule. The ball would
    // then be one radius deep.
    let ends = [fx!(-0.03), fx!(-0.5)].map(|along| Vec2::new(along, along));
    let capsule = Geometry::capsule(ends[0], ends[1], fx!(0.018)).expect("valid");
    let ball = Geometry::circle(fx!(0.007)).expect("valid");
    let gap = fx!(0.0424264) - fx!(0.025);
    let mut contacts = 0;
    for turn in 0..1000u32 {
        let mut world = weightless();
        let angle = Angle::from_bits(turn.wrapping_mul(2_654_435_761));
        world.spawn(&BodyDef::fixed().angle(angle), &[ShapeDef::new(capsule)]).expect("valid");
        world.spawn(&BodyDef::dynamic(), &[ShapeDef::new(ball)]).expect("valid");
        world.step();
        for contact in world.contacts() {
            contacts += 1;
            let separation = Fx::from(contact.manifold.points()[0].separation);
            assert!((separation - gap).abs() < fx!(0.000002), "{separation} at {angle:?}");
        }
    }
    assert!(contacts == 1000, "{contacts}");
}

#[test]
fn a_bar_below_an_outline_that_hardly_bends_touches_it_where_it_is() {
    // The edge of the outline that faces the bar most directly lies beside the bar. The contact points must lie on the
    // bar.
    let corners =
        [(fx!(-0.5), fx!(-0.5)), (fx!(-0.37), fx!(-0.5)), (fx!(0.182), fx!(-0.499)), (fx!(-0.5), fx!(0.394))];
    let outline = Polygon::new(&corners.map(|(x, y)| Vec2::new(x, y))).expect("convex");
    let ends = [fx!(-0.204), fx!(-0.327)].map(|x| Vec2::new(x, fx!(-0.5)));
    let bar = Geometry::capsule(ends[0], ends[1], fx!(0.002)).expect("valid");
    let mut world = weightless();
    world.spawn(&BodyDef::fixed(), &[ShapeDef::new(bar)]).expect("valid");
    world.spawn(&BodyDef::dynamic(), &[ShapeDef::new(outline)]).expect("valid");
    world.step();
    let contact = world.contacts().next().expect("they overlap");
    assert_eq!(contact.manifold.points().len(), 2);
    for point in contact.manifold.points() {
        let place = contact.manifold.origin + point.anchor.widen();
        assert!((fx!(-0.33)..=fx!(-0.2)).contains(&place.x), "{place:?}");
        assert!((place.y + fx!(0.5)).abs() < fx!(0.002), "{place:?}");
    }
}

#[test]
fn an_overlap_beyond_the_range_of_separations_at_a_predicted_impact() {
    // The upper sliver turns by 19 degrees in the tick. When the corners are predicted to touch, one of its ends is
    // more than 16 m inside the lower sliver, which exceeds the range of a separation.
    let sliver = |x: Fx, y: Fx| {
        let corners = [(fx!(-100), fx!(0)), (x, y), (fx!(100), fx!(0))].map(Vec2::from);
        ShapeDef::new(Polygon::hull(&corners).unwrap())
    };
    let mut world = World::new(Config { tick_rate: 15, gravity: Vec2::ZERO, ..Config::default() }).unwrap();
    world.spawn(&BodyDef::fixed(), &[sliver(fx!(-17), fx!(0.01))]).unwrap();
    let falling = BodyDef::dynamic().position((fx!(0), fx!(7))).velocity((fx!(0), fx!(-90)));
    world.spawn(&falling.angular_velocity(fx!(-5)), &[sliver(fx!(17), fx!(-0.01))]).unwrap();
    caches_decide_nothing(&mut world, 3);
}
