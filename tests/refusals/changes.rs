//! Invalid changes are refused, and the world keeps its hash.

use lockstep2d::body::{Area, BodyDef, BodyKind, BodySettings, MassSource, ShapeDef, WorldError};
use lockstep2d::fx;
use lockstep2d::math::{Angle, Fx, Vec2};
use lockstep2d::solver::{JointDef, JointKind, Revolute};
use lockstep2d::world::{BodyPose, Command, Config, Explosion, World};

use super::{Stage, ball};

fn stale(error: &WorldError) -> bool {
    matches!(error, WorldError::StaleBody(_))
}

fn wrong_kind(error: &WorldError) -> bool {
    matches!(error, WorldError::WrongKind(_))
}

fn far(error: &WorldError) -> bool {
    matches!(error, WorldError::PositionOutOfRange { .. })
}

fn fast(error: &WorldError) -> bool {
    matches!(error, WorldError::SpeedOutOfRange { .. })
}

fn weightless(error: &WorldError) -> bool {
    matches!(error, WorldError::MassOutOfRange { .. })
}

#[test]
fn changes_to_bodies_that_are_gone_are_refused() {
    let mut stage = Stage::new();
    let body = stage.gone;
    let (position, angle) = (Vec2::ZERO, Angle::ZERO);
    let settings = BodySettings::default();
    for command in [
        Command::MoveTo { body, position, angle },
        Command::SetBody { body, settings },
        Command::SetKind { body, kind: BodyKind::Fixed },
        Command::SetMass { body, mass: MassSource::Shapes },
        Command::SetUserData { body, user_data: 1 },
        Command::Enable { body },
        Command::Disable { body },
        Command::Wake { body },
        Command::Sleep { body },
    ] {
        stage.refuses(command, stale);
    }
}

#[test]
fn settings_of_a_body_out_of_range_are_refused() {
    let mut stage = Stage::new();
    let body = stage.ball;
    let usual = BodySettings::default();
    let damping = |error: &WorldError| matches!(error, WorldError::DampingOutOfRange { .. });
    let gravity = |error: &WorldError| matches!(error, WorldError::GravityScaleOutOfRange { .. });
    let sleep_speed = |error: &WorldError| matches!(error, WorldError::SleepSpeedOutOfRange { .. });
    let mut refuses = |settings, matches: fn(&WorldError) -> bool| {
        stage.refuses(Command::SetBody { body, settings }, matches);
    };
    refuses(BodySettings { linear_damping: fx!(-1), ..usual }, damping);
    refuses(BodySettings { angular_damping: Fx::MAX, ..usual }, damping);
    refuses(BodySettings { gravity_scale: fx!(1001), ..usual }, gravity);
    refuses(BodySettings { sleep_speed: fx!(401), ..usual }, sleep_speed);
    refuses(BodySettings { sleep_speed: Fx::MIN, ..usual }, sleep_speed);
}

#[test]
fn what_a_kind_of_body_cannot_do_is_refused() {
    let mut stage = Stage::new();
    let (floor, lift, ball) = (stage.floor, stage.lift, stage.ball);
    let (position, angle) = (Vec2::new(fx!(5), fx!(1)), Angle::ZERO);
    for body in [floor, ball] {
        stage.refuses(Command::MoveTo { body, position, angle }, wrong_kind);
    }
    for body in [floor, lift] {
        stage.refuses(Command::Sleep { body }, wrong_kind);
    }
    // The first position is too far for one tick. The second is outside the world.
    let position = Vec2::new(fx!(1000), fx!(0));
    stage.refuses(Command::MoveTo { body: lift, position, angle }, fast);
    stage.refuses(Command::MoveTo { body: lift, position: Vec2::new(Fx::MIN, Fx::MAX), angle }, far);
    stage.world.disable(ball).expect("there");
    let up = Vec2::new(fx!(0), fx!(1));
    stage.refuses(Command::ApplyForce { body: ball, force: up, point: up }, wrong_kind);
    stage.refuses(Command::Sleep { body: ball }, wrong_kind);
}

#[test]
fn kinds_and_masses_that_a_body_cannot_have_are_refused() {
    let mut stage = Stage::new();
    let (floor, ball) = (stage.floor, stage.ball);
    let speck = self::ball().density(Fx::DELTA);
    let speck = stage.world.spawn(&BodyDef::fixed(), &[speck]).expect("valid");
    stage.refuses(Command::SetKind { body: speck, kind: BodyKind::Dynamic }, weightless);
    let far_off = self::ball().offset((fx!(1000), fx!(0)));
    let wide = stage.world.spawn(&BodyDef::fixed(), &[far_off]).expect("valid");
    let reach = |error: &WorldError| matches!(error, WorldError::OffsetOutOfRange { .. });
    stage.refuses(Command::SetKind { body: wide, kind: BodyKind::Kinematic }, reach);
    let far = JointDef::new(floor, ball, JointKind::Filter).anchor_a((fx!(0), fx!(-129)));
    stage.world.add_joint(&far).expect("valid");
    stage.refuses(Command::SetKind { body: floor, kind: BodyKind::Kinematic }, reach);

    let given = |mass, x, gyration| MassSource::Given { mass, centre: Vec2::new(x, fx!(0)), gyration };
    let gyration = |error: &WorldError| matches!(error, WorldError::GyrationOutOfRange { .. });
    stage.refuses(Command::SetMass { body: ball, mass: given(fx!(-1), fx!(0), fx!(1)) }, weightless);
    stage.refuses(Command::SetMass { body: ball, mass: given(fx!(1), fx!(0), fx!(600)) }, gyration);
    stage.refuses(Command::SetMass { body: ball, mass: given(fx!(1), Fx::MIN, fx!(1)) }, reach);
    stage.world.set_velocity(ball, Vec2::ZERO, fx!(50)).expect("valid");
    stage.refuses(Command::SetMass { body: ball, mass: given(fx!(1), fx!(0), fx!(100)) }, fast);
}

#[test]
fn changes_to_shapes_out_of_range_are_refused() {
    let mut stage = Stage::new();
    let shape = stage.world.body(stage.ball).expect("there").shapes()[0];
    let old = *stage.world.shape(shape).expect("there").def();
    let set = |def| Command::SetShape { shape, def };
    stage.refuses(set(old.density(Fx::DELTA)), weightless);
    stage.refuses(set(old.density(Fx::MIN)), |error| matches!(error, WorldError::DensityOutOfRange { .. }));
    stage.refuses(set(old.offset((fx!(129), fx!(0)))), |error| {
        matches!(error, WorldError::OffsetOutOfRange { .. })
    });
    for def in [
        old.rolling_resistance(fx!(1.5)),
        old.restitution_threshold(fx!(401)),
        old.restitution_threshold(fx!(-0.5)),
        old.surface_speed(fx!(401)),
        old.surface_speed(Fx::MIN),
        old.friction(fx!(17)),
    ] {
        stage.refuses(set(def), |error| matches!(error, WorldError::MaterialOutOfRange { .. }));
    }
    let point = lockstep2d::body::Geometry::Capsule { a: Vec2::ZERO, b: Vec2::ZERO, radius: fx!(1) };
    stage.refuses(set(ShapeDef { geometry: point, ..old }), |error| matches!(error, WorldError::Geometry(_)));
    // The speed of a spinning ball with a radius of 100 m would exceed the limit.
    stage.world.set_velocity(stage.ball, Vec2::ZERO, fx!(50)).expect("valid");
    let large = lockstep2d::body::Geometry::Circle { radius: fx!(100) };
    stage.refuses(set(ShapeDef { geometry: large, ..old }), fast);
    let area = |what| move |error: &WorldError| matches!(error, WorldError::AreaOutOfRange { what: of, .. } if *of == what);
    let set_area = |area| Command::SetArea { shape, area: Some(area) };
    stage.refuses(set_area(Area::new()), |error| matches!(error, WorldError::AreaNotSensor));
    stage.world.set_shape(shape, &old.sensor()).expect("valid");
    stage.refuses(set_area(Area::fluid(fx!(-1))), area("density"));
    stage.refuses(set_area(Area::new().acceleration((fx!(10001), fx!(0)))), area("acceleration"));
    stage.world.despawn(stage.ball).expect("there");
    stage.refuses(set(old), |error| matches!(error, WorldError::StaleShape(_)));
    stage.refuses(set_area(Area::new()), |error| matches!(error, WorldError::StaleShape(_)));
}

#[test]
fn changes_to_joints_out_of_range_are_refused() {
    let mut stage = Stage::new();
    let (floor, lift, ball) = (stage.floor, stage.lift, stage.ball);
    let old = JointDef::new(floor, ball, Revolute::new());
    let joint = stage.world.add_joint(&old).expect("valid");
    let others = |error: &WorldError| matches!(error, WorldError::JointOfOtherBodies(id) if *id == joint);
    stage.refuses(Command::SetJoint { joint, def: old.between(ball, floor) }, others);
    stage.refuses(Command::SetJoint { joint, def: old.between(lift, ball) }, others);
    stage.refuses(Command::SetJoint { joint, def: old.anchor_b((fx!(0), fx!(-129))) }, |error| {
        matches!(error, WorldError::OffsetOutOfRange { .. })
    });
    let def = JointDef { kind: Revolute::new().limit(fx!(2), fx!(1)).into(), ..old };
    stage.refuses(Command::SetJoint { joint, def }, |error| {
        *error == WorldError::JointLimitReversed { lower: fx!(2), upper: fx!(1) }
    });
    for (hertz, damping_ratio, wrong) in [
        (fx!(0), fx!(1), "softness frequency in Hz"),
        (fx!(1001), fx!(1), "softness frequency in Hz"),
        (fx!(1), fx!(-1), "softness damping ratio"),
    ] {
        stage.refuses(
            Command::SetJoint { joint, def: old.softness(hertz, damping_ratio) },
            |error| matches!(error, WorldError::JointOutOfRange { what, .. } if *what == wrong),
        );
    }
    stage.world.remove_joint(joint).expect("there");
    let stale = |error: &WorldError| matches!(error, WorldError::StaleJoint(_));
    stage.refuses(Command::SetJoint { joint, def: old }, stale);
    stage.refuses(Command::EnableJoint { joint }, stale);
    stage.refuses(Command::DisableJoint { joint }, stale);
}

/// If one body or joint is refused, none is added.
#[test]
fn one_of_many_refuses_all() {
    let mut stage = Stage::new();
    let (floor, lift, ball, gone) = (stage.floor, stage.lift, stage.ball, stage.gone);
    let pose = |x| BodyPose { position: Vec2::new(x, fx!(5)), angle: Angle::ZERO };
    let each = |shape, poses| Command::SpawnEach { body: BodyDef::dynamic(), shapes: vec![shape], poses };
    stage.refuses(each(self::ball(), vec![pose(fx!(0)), pose(Fx::MAX)]), far);
    stage.refuses(each(self::ball().density(Fx::DELTA), vec![pose(fx!(0)), pose(fx!(3))]), weightless);
    let join = |ends| Command::AddJointEach { joint: JointDef::new(floor, ball, Revolute::new()), ends };
    stage.refuses(join(vec![(floor, ball), (ball, gone)]), stale);
    stage.refuses(join(vec![(floor, ball), (ball, ball)]), |error| {
        matches!(error, WorldError::JointToItself(_))
    });
    stage.refuses(join(vec![(lift, ball), (lift, gone)]), stale);

    let config = Config { body_limit: 3, shape_limit: 4, joint_limit: 1, ..Config::default() };
    let mut world = World::new(config).expect("valid");
    let body = world.spawn(&BodyDef::dynamic(), &[self::ball()]).expect("room");
    let other = world.spawn(&BodyDef::dynamic(), &[self::ball()]).expect("room");
    let before = world.state_hash();
    let full = |what, limit| Err(WorldError::Full { what, limit });
    assert_eq!(world.execute(&each(self::ball(), vec![pose(fx!(0)); 2])), full("bodies", 3));
    let poses = vec![pose(fx!(0))];
    let shapes = vec![self::ball(); 3];
    let three = Command::SpawnEach { body: BodyDef::dynamic(), shapes, poses };
    assert_eq!(world.execute(&three), full("shapes", 4));
    let joint = JointDef::new(body, other, Revolute::new());
    let twice = Command::AddJointEach { joint, ends: vec![(body, other); 2] };
    assert_eq!(world.execute(&twice), full("joints", 1));
    assert_eq!(world.state_hash(), before);
}

#[test]
fn more_shapes_than_a_body_may_have_are_refused() {
    let mut world = World::default();
    let shapes = vec![ball(); 4097];
    let full = WorldError::Full { what: "shapes of one body", limit: 4096 };
    assert_eq!(world.spawn(&BodyDef::fixed(), &shapes), Err(full));
    let body = world.spawn(&BodyDef::fixed(), &shapes[1..]).expect("as many as there may be");
    assert_eq!(world.add_shape(body, &ball()), Err(full));
}

#[test]
fn explosions_out_of_range_are_refused() {
    let mut stage = Stage::new();
    let usual = Explosion::new(Vec2::ZERO, fx!(1));
    stage.refuses(
        Command::Explode { explosion: Explosion { centre: Vec2::new(Fx::MAX, Fx::MIN), ..usual } },
        far,
    );
    for explosion in [
        Explosion { radius: fx!(-1), ..usual },
        Explosion { radius: Fx::MAX, ..usual },
        Explosion { falloff: Fx::MIN, ..usual },
        Explosion { falloff: fx!(1001), ..usual },
        Explosion { impulse_per_length: Fx::MIN, ..usual },
        Explosion { impulse_per_length: Fx::MAX, ..usual },
    ] {
        stage.refuses(Command::Explode { explosion }, |error| {
            matches!(error, WorldError::ExplosionOutOfRange { .. })
        });
    }
}
