//! Each setter has its documented effect, and a refused command changes nothing.

use lockstep2d::body::{
    BodyDef, BodyId, BodyKind, BodySettings, Geometry, MassSource, Material, ShapeDef, ShapeId, WorldError,
};
use lockstep2d::fx;
use lockstep2d::math::{Angle, Fx, Vec2};
use lockstep2d::solver::{JointDef, Revolute};
use lockstep2d::world::{Command, Config, World};

use super::{ball, rectangle, run, shape_of, spawn, square, weightless, world_with_floor};

fn close(a: Fx, b: Fx) {
    assert!((a - b).abs() < fx!(0.001), "{a} differs from {b}");
}

#[test]
fn settings_take_effect() {
    let mut world = World::default();
    let id = spawn(&mut world, BodyDef::dynamic(), ball(fx!(0.5)));
    let settings = BodySettings { gravity_scale: fx!(-0.5), ..BodySettings::default() };
    world.set_body(id, &settings).expect("valid");
    run(&mut world, 60);
    assert_eq!(*world.body(id).expect("there").settings(), settings);
    close(world.body(id).expect("there").velocity().y, fx!(5));
    let settings = BodySettings { gravity_scale: fx!(0), linear_damping: fx!(1), ..settings };
    world.set_body(id, &settings).expect("valid");
    run(&mut world, 60);
    // Damping of 1 for one second leaves e^-1 of 5 m/s, and slightly more because the integration is implicit.
    let left = world.body(id).expect("there").velocity().y;
    assert!((left - fx!(1.843)).abs() < fx!(0.01), "{left}");
    world.set_user_data(id, 7).expect("there");
    assert_eq!(world.body(id).expect("there").user_data(), 7);
}

#[test]
fn a_given_mass_keeps_place_and_motion() {
    let mut world = weightless();
    let def =
        BodyDef::dynamic().position((fx!(3), fx!(4))).velocity((fx!(1), fx!(0))).angular_velocity(fx!(2));
    let id = spawn(&mut world, def, square(fx!(0.5)));
    let heavy = MassSource::Given { mass: fx!(10), centre: Vec2::new(fx!(0), fx!(0.25)), gyration: fx!(0.5) };
    world.set_mass(id, heavy).expect("valid");
    let body = world.body(id).expect("there");
    assert_eq!((body.position(), body.mass()), (Vec2::new(fx!(3), fx!(4)), fx!(10)));
    close(body.angular_velocity(), fx!(2));
    // The new centre of mass is 0.25 m above the old one, and gets the velocity that the body has at the new centre.
    close(body.velocity().x, fx!(0.5));
    close(body.velocity_at(Vec2::new(fx!(3), fx!(4))).x, fx!(1));
    world.set_mass(id, MassSource::Shapes).expect("valid");
    assert_eq!(world.body(id).expect("there").mass(), fx!(1));
    close(world.body(id).expect("there").velocity().x, fx!(1));
}

#[test]
fn a_body_changes_its_kind_and_back() {
    let (mut world, floor) = world_with_floor();
    let def =
        BodyDef::dynamic().position((fx!(0), fx!(5))).velocity((fx!(1), fx!(0))).angular_velocity(fx!(1));
    let id = spawn(&mut world, def, square(fx!(0.5)));
    world.set_kind(id, BodyKind::Kinematic).expect("valid");
    run(&mut world, 60);
    let body = world.body(id).expect("there");
    close(body.position().x, fx!(1));
    assert_eq!((body.position().y, body.mass()), (fx!(5), fx!(0)));
    close(body.angular_velocity(), fx!(1));
    world.set_kind(id, BodyKind::Fixed).expect("valid");
    run(&mut world, 10);
    let held = world.body(id).expect("there").position();
    world.set_kind(id, BodyKind::Dynamic).expect("valid");
    assert_eq!(
        (world.body(id).expect("there").mass(), world.body(id).expect("there").position()),
        (fx!(1), held)
    );
    run(&mut world, 120);
    assert!(
        world.body(id).expect("there").position().y < fx!(1),
        "expected the box to have fallen onto the floor"
    );
    // A dynamic floor falls together with the box on it.
    world.set_kind(floor, BodyKind::Dynamic).expect("valid");
    run(&mut world, 60);
    assert!(world.body(floor).expect("there").position().y < fx!(-4));
    world.set_kind(id, BodyKind::Fixed).expect("valid");
    world.set_kind(floor, BodyKind::Fixed).expect("valid");
    assert_eq!(world.validate(), Ok(()), "two fixed bodies in contact");
    run(&mut world, 2);
    assert_eq!(world.pair_count(), 0);
}

#[test]
fn a_disabled_body_is_not_there_until_it_is_enabled() {
    let (mut world, _) = world_with_floor();
    let id = spawn(
        &mut world,
        BodyDef::dynamic().position((fx!(0), fx!(2))).velocity((fx!(1), fx!(0))),
        square(fx!(0.5)),
    );
    world.disable(id).expect("there");
    world.disable(id).expect("nothing to do");
    let place = world.body(id).expect("there").position();
    let through = spawn(&mut world, BodyDef::dynamic().position((fx!(0), fx!(4))), ball(fx!(0.3)));
    run(&mut world, 90);
    assert_eq!(world.body(id).expect("there").position(), place);
    close(world.body(through).expect("there").position().y, fx!(0.3));
    assert_eq!(world.apply_torque(id, fx!(1)), Err(WorldError::WrongKind(id)));
    assert_eq!(world.sleep(id), Err(WorldError::WrongKind(id)));
    world.set_transform(id, Vec2::new(fx!(4), fx!(1)), Angle::ZERO).expect("valid");
    world.set_geometry(shape_of(&world, id), ball(fx!(0.2)).geometry).expect("valid");
    run(&mut world, 2);
    world.enable(id).expect("there");
    assert_eq!(
        world.body(id).expect("there").velocity().x,
        fx!(1),
        "expected the velocity from before the body was disabled"
    );
    run(&mut world, 60);
    close(world.body(id).expect("there").position().y, fx!(0.2));
    let late = spawn(&mut world, BodyDef::dynamic().position((fx!(-9), fx!(5))).disabled(), ball(fx!(0.3)));
    run(&mut world, 30);
    assert_eq!(world.body(late).expect("there").position().y, fx!(5));
}

#[test]
fn a_joint_to_a_disabled_body_does_not_pull() {
    let mut world = World::default();
    let post = world.spawn(&BodyDef::fixed(), &[]).expect("valid");
    let bob = spawn(&mut world, BodyDef::dynamic().position((fx!(0), fx!(-1))), ball(fx!(0.3)));
    world.add_joint(&JointDef::new(post, bob, Revolute::new()).anchor_b((fx!(0), fx!(1)))).expect("valid");
    run(&mut world, 60);
    close(world.body(bob).expect("there").position().y, fx!(-1));
    world.disable(post).expect("there");
    run(&mut world, 60);
    close(world.body(bob).expect("there").velocity().y, fx!(-10));
}

#[test]
fn shapes_take_what_they_are_given() {
    let (mut world, _) = world_with_floor();
    let id = spawn(&mut world, BodyDef::dynamic().position((fx!(0), fx!(0.5))), square(fx!(0.5)));
    let shape = shape_of(&world, id);
    run(&mut world, 60);
    world.set_geometry(shape, rectangle(fx!(1), fx!(0.25)).geometry).expect("valid");
    run(&mut world, 60);
    close(world.body(id).expect("there").position().y, fx!(0.25));
    let ice = Material { friction: fx!(0), ..Material::default() };
    world.set_material(shape, ice).expect("valid");
    world.set_velocity(id, Vec2::new(fx!(2), fx!(0)), fx!(0)).expect("valid");
    run(&mut world, 60);
    close(world.body(id).expect("there").velocity().x, fx!(2));
    let heavy = ShapeDef { density: fx!(4), ..*world.shape(shape).expect("there").def() };
    world.set_shape(shape, &heavy).expect("valid");
    close(world.body(id).expect("there").mass(), fx!(4));
    assert_eq!(*world.shape(shape).expect("there").def(), heavy);
}

#[test]
fn a_kinematic_body_goes_where_it_is_told_and_stops() {
    let mut world = weightless();
    let lift = spawn(&mut world, BodyDef::kinematic(), square(fx!(0.5)));
    let (place, angle) = (Vec2::new(fx!(0.123), fx!(-0.3)), Angle::from_bits(123_456_789));
    world.move_to(lift, place, angle).expect("valid");
    assert!(world.body(lift).expect("there").velocity().x > fx!(7));
    run(&mut world, 1);
    let body = world.body(lift).expect("there");
    assert_eq!((body.position(), body.angle(), body.velocity()), (place, angle, Vec2::ZERO));
    run(&mut world, 5);
    assert_eq!(world.body(lift).expect("there").position(), place);
    // A velocity or a transform replaces the target of `move_to`.
    world.move_to(lift, Vec2::ZERO, Angle::ZERO).expect("valid");
    world.set_velocity(lift, Vec2::new(fx!(6), fx!(0)), fx!(0)).expect("valid");
    run(&mut world, 2);
    close(world.body(lift).expect("there").position().x, fx!(0.323));
}

/// The pushed body gets the velocity of the body that pushes it.
#[test]
fn a_kinematic_body_pushes_on_its_way() {
    let mut world = weightless();
    let pusher = spawn(&mut world, BodyDef::kinematic(), square(fx!(0.5)));
    let pushed = spawn(&mut world, BodyDef::dynamic().position((fx!(1.01), fx!(0))), square(fx!(0.5)));
    for tick in 1..=60 {
        world.move_to(pusher, Vec2::new(Fx::from_num(tick) / 60, fx!(0)), Angle::ZERO).expect("valid");
        run(&mut world, 1);
    }
    let body = world.body(pushed).expect("there");
    assert!((body.velocity().x - fx!(1)).abs() < fx!(0.05), "{}", body.velocity().x);
    assert!(body.position().x > fx!(1.97), "{}", body.position().x);
}

/// A body of each kind, a joint and stale handles.
struct Stage {
    world: World,
    floor: BodyId,
    lift: BodyId,
    ball: BodyId,
    gone: BodyId,
    gone_shape: ShapeId,
}

impl Stage {
    fn new(config: Config) -> Self {
        let mut world = World::new(config).expect("valid");
        let floor =
            spawn(&mut world, BodyDef::fixed().position((fx!(0), fx!(-1))), rectangle(fx!(9), fx!(1)));
        let lift = spawn(&mut world, BodyDef::kinematic().position((fx!(5), fx!(0))), ball(fx!(0.5)));
        let gone = spawn(&mut world, BodyDef::dynamic(), ball(fx!(0.5)));
        let gone_shape = shape_of(&world, gone);
        world.despawn(gone).expect("there");
        let ball = spawn(&mut world, BodyDef::dynamic().position((fx!(0), fx!(0.5))), ball(fx!(0.5)));
        world
            .add_joint(&JointDef::new(floor, ball, Revolute::new()).anchor_a((fx!(0), fx!(1.5))))
            .expect("valid");
        run(&mut world, 10);
        Stage { world, floor, lift, ball, gone, gone_shape }
    }

    /// Expects that the command is refused while the ball is awake and while it sleeps, and that it affects neither the
    /// state nor the next tick.
    fn refuses(&mut self, command: &Command, matches: fn(&WorldError) -> bool) {
        for _ in 0..2 {
            let mut unasked = self.world.clone();
            let error = self.world.execute(command).expect_err("refused");
            assert!(matches(&error), "{command:?} was refused with {error:?}");
            assert_eq!(self.world.state_hash(), unasked.state_hash(), "{command:?} has changed the world");
            for world in [&mut self.world, &mut unasked] {
                run(world, 1);
            }
            assert_eq!(
                self.world.state_hash(),
                unasked.state_hash(),
                "{command:?} has changed the next tick"
            );
            self.world.sleep(self.ball).expect("dynamic");
        }
        self.world.wake(self.ball).expect("there");
    }
}

#[test]
fn stale_handles_are_refused() {
    let mut stage = Stage::new(Config::default());
    let (body, shape) = (stage.gone, stage.gone_shape);
    let settings = BodySettings::default();
    for command in [
        Command::SetBody { body, settings },
        Command::SetUserData { body, user_data: 1 },
        Command::SetMass { body, mass: MassSource::Shapes },
        Command::SetKind { body, kind: BodyKind::Fixed },
        Command::MoveTo { body, position: Vec2::ZERO, angle: Angle::ZERO },
        Command::Enable { body },
        Command::Disable { body },
        Command::Wake { body },
        Command::Sleep { body },
    ] {
        stage.refuses(&command, |error| matches!(error, WorldError::StaleBody(_)));
    }
    let def = ball(fx!(0.5));
    stage.refuses(&Command::SetShape { shape, def }, |error| matches!(error, WorldError::StaleShape(_)));
}

#[test]
fn values_out_of_range_are_refused() {
    let mut stage = Stage::new(Config::default());
    let Stage { floor, lift, ball: body, .. } = stage;
    let shape = shape_of(&stage.world, body);
    let valid = *stage.world.shape(shape).expect("there").def();
    let settings = BodySettings::default();
    let damping = BodySettings { linear_damping: fx!(-1), ..settings };
    stage.refuses(&Command::SetBody { body, settings: damping }, |error| {
        matches!(error, WorldError::DampingOutOfRange { .. })
    });
    let restless = BodySettings { sleep_speed: fx!(401), ..settings };
    stage.refuses(&Command::SetBody { body, settings: restless }, |error| {
        matches!(error, WorldError::SleepSpeedOutOfRange { .. })
    });
    let is_mass = |error: &WorldError| matches!(error, WorldError::MassOutOfRange { .. });
    let given = |mass, gyration| MassSource::Given { mass, centre: Vec2::ZERO, gyration };
    stage.refuses(&Command::SetMass { body, mass: given(fx!(0), fx!(1)) }, is_mass);
    stage.refuses(&Command::SetMass { body: floor, mass: given(fx!(0), fx!(1)) }, is_mass);
    stage.refuses(&Command::SetShape { shape, def: valid.density(Fx::DELTA) }, is_mass);
    let flat = ShapeDef { geometry: Geometry::Circle { radius: fx!(0) }, ..valid };
    stage.refuses(&Command::SetShape { shape, def: flat }, |error| matches!(error, WorldError::Geometry(_)));
    stage.refuses(&Command::SetShape { shape, def: valid.offset((fx!(200), fx!(0))) }, |error| {
        matches!(error, WorldError::OffsetOutOfRange { .. })
    });
    let angle = Angle::ZERO;
    let far = Vec2::new(fx!(0), Fx::MAX);
    stage.refuses(&Command::MoveTo { body: lift, position: far, angle }, |error| {
        matches!(error, WorldError::PositionOutOfRange { .. })
    });
    stage.refuses(&Command::MoveTo { body: lift, position: Vec2::new(fx!(20), fx!(0)), angle }, |error| {
        matches!(error, WorldError::SpeedOutOfRange { .. })
    });
    for body in [floor, body] {
        stage.refuses(&Command::MoveTo { body, position: Vec2::ZERO, angle }, |error| {
            matches!(error, WorldError::WrongKind(_))
        });
    }
    for body in [floor, lift] {
        stage.refuses(&Command::Sleep { body }, |error| matches!(error, WorldError::WrongKind(_)));
    }
}

#[test]
fn kinds_that_a_body_cannot_have_are_refused() {
    let mut stage = Stage::new(Config::default());
    let speck = ShapeDef::new(Geometry::circle(fx!(0.01)).expect("valid")).density(fx!(0.001));
    let speck = spawn(&mut stage.world, BodyDef::fixed(), speck);
    stage.refuses(&Command::SetKind { body: speck, kind: BodyKind::Dynamic }, |error| {
        matches!(error, WorldError::MassOutOfRange { .. })
    });
    let edge = fx!(1000);
    let line = Geometry::segment(Vec2::new(-edge, fx!(0)), Vec2::new(edge, fx!(0))).expect("valid");
    let ground = spawn(&mut stage.world, BodyDef::fixed().position((fx!(0), fx!(-9))), ShapeDef::new(line));
    stage.refuses(&Command::SetKind { body: ground, kind: BodyKind::Kinematic }, |error| {
        matches!(error, WorldError::OffsetOutOfRange { .. })
    });
}

/// The speed limit does not prevent the change, because a body that becomes fixed stops.
#[test]
fn a_fast_rotating_body_becomes_fixed() {
    let mut world = weightless();
    let star = spawn(&mut world, BodyDef::dynamic().angular_velocity(fx!(120)), ball(fx!(0.14)));
    world.set_kind(star, BodyKind::Fixed).expect("a fixed body stops");
    assert_eq!(world.body(star).expect("there").angular_velocity(), Fx::ZERO);
}

/// At a speed above the limit, the world refuses changes of the mass and accepts changes of the material.
#[test]
fn a_material_changes_at_any_speed() {
    let mut world = weightless();
    let body = spawn(&mut world, BodyDef::dynamic().angular_velocity(fx!(100)), square(fx!(0.5)));
    let mut config = *world.config();
    config.solver.speed_max = fx!(10);
    world.set_config(&config).expect("valid");
    let shape = shape_of(&world, body);
    world
        .set_material(shape, Material { friction: fx!(0.1), ..Material::default() })
        .expect("mass is unchanged");
    let heavy = |shape: &ShapeDef| ShapeDef { density: fx!(5), ..*shape };
    let def = heavy(world.shape(shape).expect("there").def());
    assert!(world.set_shape(shape, &def).is_err());
}

/// `disable` and `set_transform` drop the target of a body together with the velocity towards it.
#[test]
fn a_transform_replaces_a_target() {
    for disables in [false, true] {
        let mut world = weightless();
        let lift = spawn(&mut world, BodyDef::kinematic(), square(fx!(0.5)));
        world.move_to(lift, (fx!(1), fx!(0)), Angle::ZERO).expect("in reach");
        let place = Vec2::new(fx!(5), fx!(5));
        if disables {
            world.disable(lift).expect("there");
            world.enable(lift).expect("there");
        } else {
            world.set_transform(lift, place, Angle::ZERO).expect("in the world");
        }
        run(&mut world, 60);
        let expected = if disables { Vec2::ZERO } else { place };
        assert_eq!(world.body(lift).expect("there").position(), expected);
    }
}

/// Cached manifolds measure displacements modulo 1024 m. A body that is moved by exactly this distance must still lose
/// its contact.
#[test]
fn a_body_moved_by_a_kilometre_leaves_its_contact() {
    let mut world = World::default();
    let slope = Geometry::segment((fx!(-1500), fx!(-150)), (fx!(1500), fx!(150))).expect("valid");
    spawn(&mut world, BodyDef::fixed(), ShapeDef::new(slope));
    let def = BodyDef::dynamic().position((fx!(600), fx!(61)));
    let def = def.angle(Angle::from_radians(fx!(0.1)));
    let body = spawn(&mut world, def, square(fx!(0.5)).friction(fx!(1)));
    run(&mut world, 60);
    let position = world.body(body).expect("there").position();
    let place = position - Vec2::new(fx!(1024), fx!(0));
    world.set_transform(body, place, world.body(body).expect("there").angle()).expect("in the world");
    run(&mut world, 60);
    // The slope is a hundred metres below.
    let fallen = place.y - world.body(body).expect("there").position().y;
    assert!((fx!(4)..fx!(6)).contains(&fallen), "{fallen} m in a second");
}
