//! Areas against theory: Archimedes, terminal velocity, Kepler, and quantities that are conserved without drag. `v` is
//! the velocity of the body, `u` that of the medium, `a` the acceleration, `c` the drag per second, `r` the distance
//! from the centre of attraction, and `R` the distance at which the attraction is `g`.
//!
//! ```text
//! floating    submerged area * fluid density = area * density
//! terminal    v = u + a / c
//! bobbing     omega^2 = g / (depth at rest) for a body with straight sides
//! orbit       v^2 = g R^2 / r;  energy v^2 / 2 - g R^2 / r and angular momentum are conserved
//! ```

use lockstep2d::body::{Area, BodyDef, BodyId, Falloff, Geometry, MassSource, Polygon, ShapeDef, WorldError};
use lockstep2d::fx;
use lockstep2d::math::{Angle, Fx, PI, Vec2, fx_div, fx_mul, sqrt};
use lockstep2d::solver::SolverSettings;
use lockstep2d::world::{Command, Config, World};

fn world(gravity: Fx) -> World {
    World::new(Config { gravity: Vec2::new(fx!(0), gravity), ..Config::default() }).expect("valid")
}

/// Adds a pool with its surface at height 0, from `x - half` to `x + half`, 20 m deep.
fn pool(world: &mut World, x: Fx, half: Fx, area: Area) -> BodyId {
    let shape = ShapeDef::new(Polygon::rectangle(half, fx!(10)).expect("valid")).area(area);
    world.spawn(&BodyDef::fixed().position((x, fx!(-10))), &[shape]).expect("valid")
}

fn spawn(world: &mut World, shape: ShapeDef, position: (Fx, Fx)) -> BodyId {
    world.spawn(&BodyDef::dynamic().position(position), &[shape]).expect("valid")
}

fn spawn_awake(world: &mut World, shape: ShapeDef, position: (Fx, Fx)) -> BodyId {
    world.spawn(&BodyDef::dynamic().position(position).never_sleeps(), &[shape]).expect("valid")
}

fn run(world: &mut World, ticks: u32) {
    for _ in 0..ticks {
        world.step();
    }
    assert_eq!(world.validate(), Ok(()));
    assert_eq!(world.faults(), 0);
}

fn at(world: &World, body: BodyId) -> Vec2<Fx> {
    world.body(body).expect("valid").position()
}

#[track_caller]
fn close(found: Fx, expected: Fx, tolerance: Fx) {
    assert!((found - expected).abs() <= tolerance, "expected {expected}, got {found}");
}

fn square(half: Fx) -> ShapeDef {
    ShapeDef::new(Polygon::square(half).expect("valid"))
}

#[test]
fn a_box_of_half_the_density_floats_half_submerged() {
    let water = Area::fluid(fx!(1)).drag(fx!(8), fx!(8));
    for (density, height) in [(fx!(0.5), fx!(0)), (fx!(0.25), fx!(0.1)), (fx!(0.9), fx!(-0.16))] {
        let mut world = world(fx!(-10));
        pool(&mut world, fx!(0), fx!(20), water);
        // The raft is so flat that it does not capsize.
        let raft = ShapeDef::new(Polygon::rectangle(fx!(1), fx!(0.2)).expect("valid")).density(density);
        let raft = spawn_awake(&mut world, raft, (fx!(3), fx!(1)));
        run(&mut world, 900);
        close(at(&world, raft).y, height, fx!(0.0005));
        close(world.body(raft).expect("valid").angle().to_radians(), fx!(0), fx!(0.0005));
    }
}

#[test]
fn round_shapes_float_as_deep_as_their_density_says() {
    let water = Area::fluid(fx!(2)).drag(fx!(3), fx!(3));
    let end = Vec2::new(fx!(0.8), fx!(0));
    let disc = Geometry::circle(fx!(0.5)).expect("valid");
    let pill = Geometry::capsule(-end, end, fx!(0.3)).expect("valid");
    let rounded = Geometry::Polygon(
        Polygon::rectangle(fx!(0.9), fx!(0.2)).expect("valid").rounded(fx!(0.1)).expect("valid"),
    );
    // The shapes have half the density of the fluid, so their centres are at the surface.
    for geometry in [disc, pill, rounded] {
        let mut world = world(fx!(-10));
        pool(&mut world, fx!(0), fx!(20), water);
        let body = spawn_awake(&mut world, ShapeDef::new(geometry), (fx!(0), fx!(0.4)));
        run(&mut world, 900);
        close(at(&world, body).y, fx!(0), fx!(0.002));
    }
    // A disc whose centre is r / 2 below the surface: r^2 (pi - acos(1/2) + sqrt(3) / 4) of pi r^2 is submerged.
    let share = fx_div(PI - PI / 3 + fx!(0.433012701892), PI).expect("valid");
    let mut world = world(fx!(-10));
    pool(&mut world, fx!(0), fx!(20), water);
    let body = spawn_awake(&mut world, ShapeDef::new(disc).density(share * 2), (fx!(0), fx!(0.4)));
    run(&mut world, 900);
    close(at(&world, body).y, fx!(-0.25), fx!(0.002));
}

#[test]
fn pools_that_touch_are_one_sea() {
    let water = Area::fluid(fx!(1)).drag(fx!(1), fx!(1));
    let mut heights = Vec::new();
    for pools in [1, 2, 5] {
        let mut world = world(fx!(-10));
        let half = fx!(10) / i64::from(pools);
        for index in 0..pools {
            pool(&mut world, fx!(-10) + half * (2 * i64::from(index) + 1), half, water);
        }
        let boat = ShapeDef::new(Polygon::rectangle(fx!(3), fx!(0.3)).expect("valid")).density(fx!(0.4));
        let boat = spawn(&mut world, boat, (fx!(0.7), fx!(1)));
        let mut trace = Vec::new();
        for _ in 0..300 {
            world.step();
            trace.push(at(&world, boat).y);
        }
        heights.push(trace);
    }
    for other in &heights[1..] {
        for (a, b) in heights[0].iter().zip(other) {
            close(*a, *b, fx!(0.00001));
        }
    }
}

#[test]
fn a_falling_body_reaches_the_terminal_velocity() {
    for (drag, flow) in [(fx!(1), fx!(0)), (fx!(2.5), fx!(3)), (fx!(20), fx!(-4))] {
        let mut world = world(fx!(-10));
        let air = Area::new().drag(drag, drag).flow((flow, fx!(0)));
        let sky = ShapeDef::new(Polygon::rectangle(fx!(100), fx!(100)).expect("valid")).area(air);
        world.spawn(&BodyDef::fixed(), &[sky]).expect("valid");
        let ball = ShapeDef::new(Geometry::circle(fx!(0.5)).expect("valid"));
        let ball = world
            .spawn(&BodyDef::dynamic().position((fx!(0), fx!(90))).angular_velocity(fx!(7)), &[ball])
            .expect("valid");
        run(&mut world, 720);
        let body = world.body(ball).expect("valid");
        close(body.velocity().y, -fx_div(fx!(10), drag).expect("valid"), fx!(0.001));
        close(body.velocity().x, flow, fx!(0.001));
        close(body.angular_velocity(), fx!(0), fx!(0.001));
    }
}

/// Without drag, a uniform acceleration equals gravity bit for bit.
#[test]
fn a_uniform_acceleration_is_gravity() {
    let mut falls = Vec::new();
    for in_area in [false, true] {
        let mut world = world(if in_area { fx!(0) } else { fx!(-9.8) });
        let field = Area::new().acceleration((fx!(0), if in_area { fx!(-9.8) } else { fx!(0) }));
        let room = ShapeDef::new(Polygon::square(fx!(100)).expect("valid")).area(field);
        world.spawn(&BodyDef::fixed(), &[room]).expect("valid");
        world.spawn(&BodyDef::fixed().position((fx!(0), fx!(-3))), &[square(fx!(1))]).expect("valid");
        let boxes = [fx!(0), fx!(1.5), fx!(3)].map(|y| spawn(&mut world, square(fx!(0.5)), (y / 8, y)));
        run(&mut world, 300);
        falls.push(boxes.map(|body| (at(&world, body), world.body(body).expect("valid").angle())));
    }
    assert_eq!(falls[0], falls[1]);
}

#[test]
fn wind_moves_light_things_more_than_heavy_ones() {
    let mut world = world(fx!(0));
    let wind = Area::new().force((fx!(3), fx!(4)));
    let gust = ShapeDef::new(Polygon::square(fx!(100)).expect("valid")).area(wind);
    // The force is given in the frame of the area's body, which is rotated by a quarter turn.
    world.spawn(&BodyDef::fixed().angle(Angle::QUARTER), &[gust]).expect("valid");
    let bodies = [fx!(1), fx!(10)]
        .map(|density| spawn(&mut world, square(fx!(0.5)).density(density), (fx!(0), density)));
    run(&mut world, 60);
    for (body, density) in bodies.into_iter().zip([1, 10]) {
        let velocity = world.body(body).expect("valid").velocity();
        close(velocity.x, fx!(-4) / density, fx!(0.0001));
        close(velocity.y, fx!(3) / density, fx!(0.0001));
        close(world.body(body).expect("valid").angular_velocity(), fx!(0), fx!(0.00001));
    }
}

/// Without drag a floating box bobs with the theoretical period and without decay.
#[test]
fn bobbing_keeps_its_energy() {
    for sub_steps in [1, 2, 4, 8] {
        let solver = SolverSettings { sub_steps, ..SolverSettings::default() };
        let config = Config { gravity: Vec2::new(fx!(0), fx!(-10)), solver, ..Config::default() };
        let mut world = World::new(config).expect("valid");
        pool(&mut world, fx!(0), fx!(20), Area::fluid(fx!(1)));
        // 0.5 m are immersed at rest: omega^2 = g / 0.5 m.
        let buoy = square(fx!(0.5)).density(fx!(0.5));
        let buoy = world
            .spawn(&BodyDef::dynamic().position((fx!(0), fx!(0.2))).lock_rotation(), &[buoy])
            .expect("valid");
        let (mut highest, mut crossings, mut last) = ([fx!(0); 2], 0, fx!(0.2));
        for tick in 0..3600 {
            world.step();
            let y = at(&world, buoy).y;
            let half = usize::from(tick >= 3300);
            if !(300..3300).contains(&tick) {
                highest[half] = highest[half].max(y);
            }
            crossings += i64::from(last < 0 && y >= 0);
            last = y;
        }
        assert!((highest[0] - highest[1]).abs() < fx!(0.0005), "{sub_steps} sub-steps: {highest:?}");
        assert!((42..=43).contains(&crossings), "{sub_steps} sub-steps: {crossings} periods");
    }
}

/// On a circle and two ellipses, energy and angular momentum are conserved for a minute.
#[test]
fn orbits_close() {
    let mut world = world(fx!(0));
    let planet = Area::new().attraction(fx!(10), fx!(2), Falloff::InverseSquare);
    let planet = ShapeDef::new(Geometry::circle(fx!(50)).expect("valid")).area(planet);
    world.spawn(&BodyDef::fixed(), &[planet]).expect("valid");
    // g R^2 = 40 m^3/s^2.
    let circular = sqrt(fx!(40) / 10).expect("valid");
    let ball = ShapeDef::new(Geometry::circle(fx!(0.25)).expect("valid"));
    for speed in [circular, circular * 5 / 4, circular * 3 / 4] {
        let def = BodyDef::dynamic().position((fx!(10), fx!(0))).velocity((fx!(0), speed));
        let body = world.spawn(&def, &[ball]).expect("valid");
        let measure = |world: &World| {
            let body = world.body(body).expect("valid");
            let (x, v) = (body.position(), body.velocity());
            let energy = v.dot(v) / 2 - fx_div(fx!(40), x.length()).expect("valid");
            (energy, x.cross(v), x.length())
        };
        let start = measure(&world);
        for _ in 0..3600 {
            world.step();
            let now = measure(&world);
            close(now.0, start.0, fx!(0.02));
            close(now.1, start.1, fx!(0.002));
            if speed == circular {
                close(now.2, start.2, fx!(0.02));
            }
        }
        world.despawn(body).expect("valid");
    }
}

/// Inside a planet the pull is proportional to the distance: `omega^2 = g / R`.
#[test]
fn a_tunnel_through_a_planet_is_an_oscillator() {
    let mut world = world(fx!(0));
    let planet = Area::new().attraction(fx!(10), fx!(10), Falloff::InverseSquare);
    let planet = ShapeDef::new(Geometry::circle(fx!(50)).expect("valid")).area(planet);
    world.spawn(&BodyDef::fixed(), &[planet]).expect("valid");
    let ball = ShapeDef::new(Geometry::circle(fx!(0.25)).expect("valid"));
    let ball = spawn(&mut world, ball, (fx!(8), fx!(0)));
    // Half of the period, which is 2 pi s or 377 ticks.
    run(&mut world, 188);
    close(at(&world, ball).x, fx!(-8), fx!(0.01));
}

/// Buoyancy acts against the accelerations of all areas, not only against gravity.
#[test]
fn a_planet_may_have_a_sea() {
    let mut world = world(fx!(0));
    let field = Area::new().attraction(fx!(10), fx!(10), Falloff::Constant);
    let field = ShapeDef::new(Geometry::circle(fx!(50)).expect("valid")).area(field);
    let sea = ShapeDef::new(Geometry::circle(fx!(20)).expect("valid"))
        .area(Area::fluid(fx!(1)).drag(fx!(1), fx!(1)));
    world.spawn(&BodyDef::fixed(), &[field, sea]).expect("valid");
    let ball = ShapeDef::new(Geometry::circle(fx!(0.5)).expect("valid")).density(fx!(0.5));
    let balls = [(20, 0), (0, 20), (-20, 0), (0, -20)]
        .map(|(x, y)| spawn(&mut world, ball, (Fx::from_num(x), Fx::from_num(y))));
    run(&mut world, 900);
    for ball in balls {
        // The tolerance allows for the engine's approximation of the circular sea by a polygon with 32 corners.
        close(at(&world, ball).length(), fx!(20), fx!(0.07));
    }
}

#[test]
fn bodies_without_area_are_measured_by_length() {
    let mut world = world(fx!(-10));
    pool(&mut world, fx!(0), fx!(20), Area::new().acceleration((fx!(0), fx!(20))));
    let end = Vec2::new(fx!(0), fx!(1));
    let mass = MassSource::Given { mass: fx!(1), centre: Vec2::ZERO, gyration: fx!(1) };
    let stick = ShapeDef::new(Geometry::segment(-end, end).expect("valid"));
    let stick = world.spawn(&BodyDef::dynamic().mass(mass).lock_rotation(), &[stick]).expect("valid");
    // Half of the stick is inside, where the field is twice as strong as gravity.
    run(&mut world, 60);
    close(at(&world, stick).y, fx!(0), fx!(0.001));
}

#[test]
fn what_floats_sleeps_and_wakes() {
    let mut world = world(fx!(-10));
    let water = Area::fluid(fx!(1)).drag(fx!(3), fx!(3));
    let sea = pool(&mut world, fx!(0), fx!(20), water);
    let bodies = [fx!(0), fx!(3)].map(|x| spawn(&mut world, square(fx!(0.3)).density(fx!(0.5)), (x, fx!(0))));
    run(&mut world, 600);
    let asleep = |world: &World| bodies.map(|body| world.body(body).expect("valid").is_asleep());
    assert_eq!(asleep(&world), [true, true]);
    // An area on a moving body wakes the bodies inside.
    let fan = Area::new().force((fx!(0), fx!(2)));
    let fan = ShapeDef::new(Polygon::square(fx!(1)).expect("valid")).area(fan);
    let carrier = BodyDef::kinematic().position((fx!(-6), fx!(0))).velocity((fx!(2), fx!(0)));
    let carrier = world.spawn(&carrier, &[fan]).expect("valid");
    run(&mut world, 150);
    assert_eq!(asleep(&world), [false, true]);
    run(&mut world, 400);
    assert!(at(&world, carrier).x > fx!(8));
    run(&mut world, 400);
    assert_eq!(asleep(&world), [true, true]);
    // A change of the sea wakes the bodies inside.
    let shape = world.shapes_of(sea)[0];
    let denser = world.shape(shape).expect("valid").def().area(water.density(fx!(2)));
    world.set_shape(shape, &denser).expect("valid");
    assert_eq!(asleep(&world), [false, false]);
    run(&mut world, 600);
    assert_eq!(asleep(&world), [true, true]);
    // A body falls asleep after half a second below its sleep speed, so it may be off by 0.5 s times this speed.
    close(at(&world, bodies[0]).y, fx!(0.15), fx!(0.025));
    world.despawn(sea).expect("valid");
    assert_eq!(asleep(&world), [false, false]);
}

/// Setting the same wind again wakes no body.
#[test]
fn a_command_sets_the_wind() {
    let mut world = world(fx!(0));
    let air = ShapeDef::new(Polygon::rectangle(fx!(50), fx!(9)).expect("valid")).sensor();
    let air = world.spawn(&BodyDef::fixed(), &[air]).expect("valid");
    let air = world.shapes_of(air)[0];
    let body = spawn(&mut world, square(fx!(0.5)), (fx!(0), fx!(0)));
    let wind = Area::new().acceleration((fx!(3), fx!(0)));
    world.execute(&Command::SetArea { shape: air, area: Some(wind) }).expect("a sensor");
    run(&mut world, 60);
    close(world.body(body).expect("valid").velocity().x, fx!(3), fx!(0.001));
    world.set_area(air, None).expect("a sensor");
    run(&mut world, 60);
    close(world.body(body).expect("valid").velocity().x, fx!(3), fx!(0.001));
    world.set_velocity(body, (fx!(0), fx!(0)), fx!(0)).expect("valid");
    run(&mut world, 60);
    world.set_area(air, None).expect("a sensor");
    assert!(world.body(body).expect("valid").is_asleep());
    world.set_area(air, Some(wind)).expect("a sensor");
    assert!(!world.body(body).expect("valid").is_asleep());
}

/// If a moving body has an area, the area wakes a sleeping body as soon as it reaches it.
#[test]
fn a_moving_magnet_wakes_a_box_that_it_reaches() {
    let mut world = world(fx!(-10));
    let floor = ShapeDef::new(Polygon::rectangle(fx!(50), fx!(1)).expect("valid"));
    world.spawn(&BodyDef::fixed().position((fx!(0), fx!(-1))), &[floor]).expect("valid");
    let crate_ = spawn(&mut world, square(fx!(0.3)), (fx!(0), fx!(0.3)));
    run(&mut world, 120);
    assert!(world.body(crate_).expect("valid").is_asleep());
    let pull = Area::new().attraction(fx!(4), fx!(1), Falloff::Constant);
    let reach = ShapeDef::new(Geometry::circle(fx!(3)).expect("valid")).area(pull).density(fx!(0));
    let ball = ShapeDef::new(Geometry::circle(fx!(0.3)).expect("valid"));
    let magnet = BodyDef::dynamic().position((fx!(-8), fx!(0.3))).velocity((fx!(4), fx!(0)));
    let magnet = world.spawn(&magnet, &[ball, reach]).expect("valid");
    let mut woken_at = None;
    for _ in 0..120 {
        world.step();
        if woken_at.is_none() && !world.body(crate_).expect("valid").is_asleep() {
            woken_at = Some(at(&world, magnet).x);
        }
    }
    // The area has a radius of 3 m, so it reaches the left side of the box, x = -0.3, when the magnet is at x = -3.3.
    close(woken_at.expect("it passes"), fx!(-3.3), fx!(0.1));
}

#[test]
fn areas_without_an_inside_or_out_of_range_are_refused() {
    let mut world = world(fx!(0));
    let body = world.spawn(&BodyDef::fixed(), &[]).expect("valid");
    let mut refused = |shape: ShapeDef| world.add_shape(body, &shape).unwrap_err();
    let line = Geometry::segment(Vec2::ZERO, Vec2::new(fx!(1), fx!(0))).expect("valid");
    assert_eq!(refused(ShapeDef::new(line).area(Area::new())), WorldError::AreaOfLine);
    let mut solid = square(fx!(1)).area(Area::new());
    solid.sensor = false;
    assert_eq!(refused(solid), WorldError::AreaNotSensor);
    for (area, expected) in [
        (Area::new().acceleration((fx!(10001), fx!(0))), ("acceleration", fx!(10001))),
        (Area::new().force((fx!(0), fx!(-1048577))), ("force", fx!(-1048577))),
        (Area::new().flow((fx!(401), fx!(0))), ("flow", fx!(401))),
        (Area::new().drag(fx!(1001), fx!(0)), ("linear drag", fx!(1001))),
        (Area::new().drag(fx!(0), fx!(-1)), ("angular drag", fx!(-1))),
        (Area::fluid(fx!(1048577)), ("density", fx!(1048577))),
        (Area::new().attraction(fx!(10001), fx!(1), Falloff::Inverse), ("attraction", fx!(10001))),
        (Area::new().attraction(fx!(1), fx!(0), Falloff::Inverse), ("radius of attraction", fx!(0))),
    ] {
        let error = refused(square(fx!(1)).area(area));
        let WorldError::AreaOutOfRange { what, value, min, max } = error else { panic!("{error:?}") };
        assert_eq!((what, value), expected);
        assert!(!(min..=max).contains(&value), "{error}");
    }
    // An area accelerates no body beyond the speed limit.
    let strongest = Area::new().force((fx!(1048576), fx!(0))).acceleration((fx!(10000), fx!(0)));
    world.add_shape(body, &square(fx!(50)).area(strongest)).expect("valid");
    let leaf = spawn(&mut world, square(fx!(0.3)).density(fx!(0.001)), (fx!(-40), fx!(0)));
    run(&mut world, 60);
    assert!(world.body(leaf).expect("valid").velocity().x > fx!(300));
    assert!(fx_mul(world.body(leaf).expect("valid").velocity().x, fx!(1)) <= fx!(400));
}
