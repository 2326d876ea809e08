//! Invalid commands get a typed error and leave the world unchanged.

mod changes;

use lockstep2d::body::{
    BodyDef, BodyKind, Chain, Filter, Geometry, GeometryError, MassSource, Material, Polygon, ShapeDef,
    WorldError,
};
use lockstep2d::fx;
use lockstep2d::math::{Angle, Fx, Vec2};
use lockstep2d::solver::{
    ContactTuning, Distance, JointDef, JointKind, JointLimit, Motor, Prismatic, Revolute, SolverSettings,
    Threshold, Weld, Wheel,
};
use lockstep2d::world::{Command, Config, World};

fn ball() -> ShapeDef {
    ShapeDef::new(Geometry::circle(fx!(0.5)).expect("valid"))
}

/// A fixed floor, a kinematic lift, a ball, and a stale handle.
struct Stage {
    world: World,
    floor: lockstep2d::body::BodyId,
    lift: lockstep2d::body::BodyId,
    ball: lockstep2d::body::BodyId,
    gone: lockstep2d::body::BodyId,
}

impl Stage {
    fn new() -> Self {
        let mut world = World::default();
        let floor = world.spawn(&BodyDef::fixed(), &[ball()]).expect("valid");
        let lift = world.spawn(&BodyDef::kinematic().position((fx!(5), fx!(0))), &[ball()]).expect("valid");
        let gone = world.spawn(&BodyDef::dynamic(), &[ball()]).expect("valid");
        world.despawn(gone).expect("there");
        let ball = world.spawn(&BodyDef::dynamic().position((fx!(0), fx!(1))), &[ball()]).expect("valid");
        for _ in 0..10 {
            world.step();
        }
        Stage { world, floor, lift, ball, gone }
    }

    /// A refused command affects neither the state nor the next tick.
    fn refuses(&mut self, command: Command, matches: impl Fn(&WorldError) -> bool) {
        let before = self.world.state_hash();
        let mut unasked = self.world.clone();
        let error = self.world.execute(&command).expect_err("refused");
        assert!(matches(&error), "{command:?} was refused with {error:?}");
        assert!(!error.to_string().is_empty());
        assert_eq!(self.world.state_hash(), before, "{command:?} has changed the world");
        assert_eq!(self.world.validate(), Ok(()));
        self.world.step();
        unasked.step();
        assert_eq!(self.world.state_hash(), unasked.state_hash(), "{command:?} has changed the next tick");
    }
}

fn spawn(body: BodyDef, shape: ShapeDef) -> Command {
    Command::Spawn { body, shapes: vec![shape] }
}

#[test]
fn shapes_out_of_range_are_refused() {
    let point = Vec2::new;
    let concave =
        [point(fx!(0), fx!(0)), point(fx!(4), fx!(0)), point(fx!(1), fx!(1)), point(fx!(0), fx!(4))];
    assert!(matches!(Polygon::new(&concave), Err(GeometryError::NotConvex { .. })));
    let line = [point(fx!(0), fx!(0)), point(fx!(1), fx!(1)), point(fx!(2), fx!(2))];
    assert!(matches!(Polygon::new(&line), Err(GeometryError::NotConvex { .. })));
    let close = [point(fx!(0), fx!(0)), point(fx!(1), fx!(0)), point(fx!(1), fx!(0.0001))];
    assert!(matches!(Polygon::new(&close), Err(GeometryError::ShortEdge { vertex: 1 })));
    assert!(matches!(Chain::new(&line[..1]).links(), Err(GeometryError::ChainLength { points: 1 })));
    let two = [Material::default(); 2];
    let uneven = Chain::new(&line[..2]).materials(&two).links();
    assert!(matches!(uneven, Err(GeometryError::MaterialCount { links: 1, materials: 2 })));
    assert!(matches!(Polygon::hull(&line), Err(GeometryError::VertexCount { .. })));
    assert!(matches!(Polygon::hull(&[]), Err(GeometryError::VertexCount { count: 0 })));
    assert!(matches!(Geometry::circle(fx!(0)), Err(GeometryError::SizeOutOfRange { .. })));
    assert!(matches!(Geometry::circle(fx!(-1)), Err(GeometryError::SizeOutOfRange { .. })));
    assert!(matches!(Geometry::circle(Fx::MAX), Err(GeometryError::SizeOutOfRange { .. })));
    let here = point(fx!(1), fx!(1));
    assert!(matches!(Geometry::segment(here, here), Err(GeometryError::SizeOutOfRange { .. })));
    assert!(Polygon::rectangle(Fx::MIN, Fx::MAX).is_err());
    assert!(Polygon::square(fx!(1)).expect("valid").rounded(Fx::MIN).is_err());
}

#[test]
fn bodies_out_of_range_are_refused() {
    let mut stage = Stage::new();
    let is_mass = |error: &WorldError| matches!(error, WorldError::MassOutOfRange { .. });
    stage.refuses(spawn(BodyDef::dynamic(), ball().density(Fx::DELTA)), is_mass);
    let negative = |error: &WorldError| matches!(error, WorldError::DensityOutOfRange { .. });
    stage.refuses(spawn(BodyDef::dynamic(), ball().density(fx!(-1))), negative);
    stage.refuses(spawn(BodyDef::fixed(), ball().density(Fx::MAX)), negative);

    let far = |error: &WorldError| matches!(error, WorldError::PositionOutOfRange { .. });
    stage.refuses(spawn(BodyDef::dynamic().position((Fx::MAX, fx!(0))), ball()), far);
    stage.refuses(spawn(BodyDef::fixed().position((fx!(0), Fx::MIN)), ball()), far);
    let fast = |error: &WorldError| matches!(error, WorldError::SpeedOutOfRange { .. });
    stage.refuses(spawn(BodyDef::dynamic().velocity((fx!(300), fx!(300))), ball()), fast);
    stage.refuses(spawn(BodyDef::dynamic().angular_velocity(Fx::MIN), ball()), fast);
    let offset = |error: &WorldError| matches!(error, WorldError::OffsetOutOfRange { .. });
    stage.refuses(spawn(BodyDef::dynamic(), ball().offset((fx!(129), fx!(0)))), offset);
    stage.refuses(spawn(BodyDef::fixed(), ball().offset((Fx::MIN, fx!(0)))), offset);
    let material = |error: &WorldError| matches!(error, WorldError::MaterialOutOfRange { .. });
    stage.refuses(spawn(BodyDef::dynamic(), ball().friction(fx!(-0.1))), material);
    stage.refuses(spawn(BodyDef::dynamic(), ball().restitution(fx!(1.501))), material);
    let damping = |error: &WorldError| matches!(error, WorldError::DampingOutOfRange { .. });
    stage.refuses(spawn(BodyDef::dynamic().linear_damping(fx!(-1)), ball()), damping);
    stage.refuses(spawn(BodyDef::dynamic().angular_damping(fx!(1001)), ball()), damping);

    let given = |mass, gyration| MassSource::Given { mass, centre: Vec2::ZERO, gyration };
    stage.refuses(spawn(BodyDef::dynamic().mass(given(fx!(0), fx!(1))), ball()), is_mass);
    let gyration = |error: &WorldError| matches!(error, WorldError::GyrationOutOfRange { .. });
    stage.refuses(spawn(BodyDef::dynamic().mass(given(fx!(1), fx!(0))), ball()), gyration);
    stage.refuses(spawn(BodyDef::dynamic().mass(given(fx!(1), Fx::MAX)), ball()), gyration);
    // A command can contain a shape that its constructor refuses.
    let flat = ShapeDef { geometry: Geometry::Circle { radius: fx!(0) }, ..ball() };
    stage.refuses(spawn(BodyDef::dynamic(), flat), |error| matches!(error, WorldError::Geometry(_)));
}

#[test]
fn stale_handles_are_refused() {
    let mut stage = Stage::new();
    let gone = stage.gone;
    let stale = |error: &WorldError| matches!(error, WorldError::StaleBody(_));
    let zero = Vec2::ZERO;
    stage.refuses(Command::Despawn { body: gone }, stale);
    stage.refuses(Command::AddShape { body: gone, shape: ball() }, stale);
    stage.refuses(Command::ApplyForce { body: gone, force: zero, point: zero }, stale);
    stage.refuses(Command::ApplyTorque { body: gone, torque: fx!(1) }, stale);
    stage.refuses(Command::ApplyImpulse { body: gone, impulse: zero, point: zero }, stale);
    stage.refuses(Command::ApplyAngularImpulse { body: gone, impulse: fx!(1) }, stale);
    stage.refuses(Command::SetVelocity { body: gone, velocity: zero, angular_velocity: fx!(0) }, stale);
    stage.refuses(Command::SetTransform { body: gone, position: zero, angle: Angle::ZERO }, stale);
    let ball = stage.ball;
    stage.refuses(Command::AddJoint { joint: JointDef::new(ball, gone, Revolute::new()) }, stale);
    stage.refuses(Command::AddJoint { joint: JointDef::new(gone, ball, Revolute::new()) }, stale);

    let joint =
        stage.world.add_joint(&JointDef::new(stage.ball, stage.floor, Revolute::new())).expect("valid");
    stage.world.remove_joint(joint).expect("there");
    stage.refuses(Command::RemoveJoint { joint }, |error| matches!(error, WorldError::StaleJoint(_)));
    let shape = stage.world.add_shape(stage.ball, &self::ball()).expect("valid");
    stage.world.remove_shape(shape).expect("there");
    stage.refuses(Command::RemoveShape { shape }, |error| matches!(error, WorldError::StaleShape(_)));
}

#[test]
fn what_a_body_cannot_do_is_refused() {
    let mut stage = Stage::new();
    let (floor, lift, ball) = (stage.floor, stage.lift, stage.ball);
    let wrong = |error: &WorldError| matches!(error, WorldError::WrongKind(_));
    let up = Vec2::new(fx!(0), fx!(1));
    for body in [floor, lift] {
        stage.refuses(Command::ApplyForce { body, force: up, point: up }, wrong);
        stage.refuses(Command::ApplyTorque { body, torque: fx!(1) }, wrong);
        stage.refuses(Command::ApplyImpulse { body, impulse: up, point: up }, wrong);
        stage.refuses(Command::ApplyAngularImpulse { body, impulse: fx!(1) }, wrong);
    }
    stage.refuses(Command::SetVelocity { body: floor, velocity: up, angular_velocity: fx!(0) }, wrong);
    let fast = |error: &WorldError| matches!(error, WorldError::SpeedOutOfRange { .. });
    let velocity = Vec2::new(Fx::MAX, Fx::MIN);
    stage.refuses(Command::SetVelocity { body: ball, velocity, angular_velocity: fx!(0) }, fast);
    let far = |error: &WorldError| matches!(error, WorldError::PositionOutOfRange { .. });
    stage.refuses(Command::SetTransform { body: ball, position: velocity, angle: Angle::ZERO }, far);
    stage.refuses(Command::AddJoint { joint: JointDef::new(ball, ball, Revolute::new()) }, |error| {
        matches!(error, WorldError::JointToItself(_))
    });
    let long = JointDef::new(floor, ball, Revolute::new());
    let beyond = fx!(1073741825);
    for joint in [
        long.anchor_b((fx!(300), fx!(0))),
        long.between(lift, ball).anchor_a((fx!(0), fx!(-129))),
        long.anchor_a((beyond, fx!(0))),
    ] {
        stage.refuses(Command::AddJoint { joint }, |error| {
            matches!(error, WorldError::OffsetOutOfRange { .. })
        });
    }
    refuses_impossible_joints(&mut stage);
    stage.refuses(Command::SetGravity { gravity: velocity }, |error| {
        matches!(error, WorldError::Setting { .. })
    });
    let config = *stage.world.config();
    for changed in [
        Config { body_limit: 9, ..config },
        Config { shape_limit: 9, ..config },
        Config { joint_limit: 9, ..config },
        Config { pair_limit: 9, ..config },
    ] {
        stage.refuses(Command::SetConfig { config: changed }, |error| {
            matches!(error, WorldError::FixedSetting { .. })
        });
    }
    let fast = Config { tick_rate: 1001, ..config };
    stage.refuses(Command::SetConfig { config: fast }, |error| {
        *error == WorldError::CountSetting { name: "tick_rate", value: 1001, min: 10, max: 1000 }
    });
}

fn refuses_impossible_joints(stage: &mut Stage) {
    let (one, two) = (fx!(1), fx!(2));
    let pushes = Distance { spring_force: Some(JointLimit { lower: one, upper: two }), ..Distance::new() };
    let kinds: [(JointKind, &str); 12] = [
        (Revolute::new().limit(two, one).into(), "lower limit of 2 is above its upper limit of 1"),
        (
            Revolute::new().spring(fx!(0), one, one).into(),
            "spring frequency in Hz is above 0 and at most 1000, not 0",
        ),
        (Revolute::new().spring(one, fx!(-1), one).into(), "spring damping ratio is 0 to 100, not -1"),
        (Prismatic::new().motor(one, fx!(-1)).into(), "largest motor force or torque is 0 or more, not -1"),
        (Wheel::new().motor(fx!(10000000), one).into(), "motor speed is within ±1048576, not 10000000"),
        (Distance::rod(fx!(0)).into(), "rod length in m is 0.001 to 1048576, not 0"),
        (Distance::rope(fx!(-1)).into(), "upper limit in m is 0 or more, not -1"),
        (Distance::new().spring(one, one, fx!(-1)).into(), "spring length in m is 0 to 1048576, not -1"),
        (pushes.into(), "smallest spring force in N is 0 or less, not 1"),
        (
            Weld::rigid().angular(fx!(1001), one).into(),
            "angular frequency in Hz is above 0 and at most 1000, not 1001",
        ),
        (
            Motor::new().linear(Vec2::new(one, fx!(-1048577)), one).into(),
            "linear motor velocity in m/s is within ±1048576, not -1048577",
        ),
        (
            Motor::new().linear_spring(one, one, fx!(-1)).into(),
            "largest linear spring force in N is 0 or more, not -1",
        ),
    ];
    for (kind, text) in kinds {
        let joint = JointDef::new(stage.floor, stage.ball, kind);
        stage.refuses(Command::AddJoint { joint }, |error| error.to_string() == format!("a joint's {text}"));
    }
    let threshold = Threshold { force: Some(fx!(-1)), ..Threshold::NONE };
    let joint = JointDef::new(stage.floor, stage.ball, JointKind::Filter).threshold(threshold);
    stage.refuses(Command::AddJoint { joint }, |error| matches!(error, WorldError::JointOutOfRange { .. }));
}

#[test]
fn a_full_world_refuses_more() {
    let config = Config { body_limit: 2, shape_limit: 3, joint_limit: 1, ..Config::default() };
    let mut world = World::new(config).expect("valid");
    let a = world.spawn(&BodyDef::dynamic(), &[ball()]).expect("room");
    let too_many = world.spawn(&BodyDef::fixed(), &[ball(); 3]);
    assert_eq!(too_many, Err(WorldError::Full { what: "shapes", limit: 3 }));
    let b = world.spawn(&BodyDef::dynamic(), &[ball()]).expect("room");
    assert_eq!(world.spawn(&BodyDef::fixed(), &[]), Err(WorldError::Full { what: "bodies", limit: 2 }));
    world.add_joint(&JointDef::new(a, b, Revolute::new())).expect("room");
    let second = world.add_joint(&JointDef::new(a, b, Revolute::new()));
    assert_eq!(second, Err(WorldError::Full { what: "joints", limit: 1 }));
}

#[test]
fn settings_out_of_range_are_named() {
    let solver = SolverSettings::default();
    let soft = ContactTuning::Soft { hertz: fx!(0), damping_ratio: fx!(1), push_speed: fx!(1) };
    let cases = [
        ("tick_rate", Config { tick_rate: 0, ..Config::default() }),
        ("gravity", Config { gravity: Vec2::new(Fx::MAX, fx!(0)), ..Config::default() }),
        ("fat_margin", Config { fat_margin: fx!(0), ..Config::default() }),
        ("body_limit", Config { body_limit: u32::MAX, ..Config::default() }),
        ("sub_steps", Config { solver: SolverSettings { sub_steps: 0, ..solver }, ..Config::default() }),
        ("tick_rate x sub_steps", Config { tick_rate: 1000, ..Config::default() }),
        ("speculative_distance", Config { speculative_distance: fx!(2), ..Config::default() }),
        ("hit_speed", Config { hit_speed: fx!(-1), ..Config::default() }),
        ("shape_limit", Config { shape_limit: u32::MAX, ..Config::default() }),
        ("joint_limit", Config { joint_limit: u32::MAX, ..Config::default() }),
        ("pair_limit", Config { pair_limit: u32::MAX, ..Config::default() }),
        ("iterations", Config { solver: SolverSettings { iterations: 0, ..solver }, ..Config::default() }),
        (
            "joint_hertz",
            Config { solver: SolverSettings { joint_hertz: Fx::MAX, ..solver }, ..Config::default() },
        ),
        (
            "joint_damping_ratio",
            Config { solver: SolverSettings { joint_damping_ratio: Fx::MIN, ..solver }, ..Config::default() },
        ),
        (
            "restitution_threshold",
            Config {
                solver: SolverSettings { restitution_threshold: Fx::MIN, ..solver },
                ..Config::default()
            },
        ),
        ("contact.hertz", Config { solver: SolverSettings { contact: soft, ..solver }, ..Config::default() }),
        (
            "speed_max",
            Config { solver: SolverSettings { speed_max: fx!(401), ..solver }, ..Config::default() },
        ),
    ];
    for (name, mut config) in cases {
        if name == "tick_rate x sub_steps" {
            config.solver.sub_steps = 5;
        }
        let error = World::new(config).expect_err("refused");
        let (WorldError::Setting { name: named, .. } | WorldError::CountSetting { name: named, .. }) = error
        else {
            panic!("{error:?}");
        };
        assert_eq!(named, name);
    }
}

#[test]
fn valid_extremes_are_accepted() {
    let mut world = World::default();
    let edge = fx!(1073741824);
    let far = BodyDef::dynamic().position((edge, -edge)).velocity((fx!(400), fx!(0)));
    world.spawn(&far, &[ball()]).expect("the edge of the world");
    let line =
        Geometry::segment(Vec2::new(-edge, fx!(0)), Vec2::new(edge, fx!(0))).expect("as long as the world");
    world.spawn(&BodyDef::fixed(), &[ShapeDef::new(line)]).expect("valid");
    let everything = Filter { category: u64::MAX, mask: u64::MAX, group: i32::MIN };
    let rough = Material { friction: fx!(16), restitution: fx!(1), ..Material::default() };
    let shape = ShapeDef { filter: everything, material: rough, ..ball() };
    world.spawn(&BodyDef::new(BodyKind::Kinematic).velocity((fx!(-400), fx!(0))), &[shape]).expect("valid");
    for _ in 0..60 {
        world.step();
        assert_eq!(world.validate(), Ok(()));
    }
}

#[test]
fn a_body_that_reaches_too_far_or_would_spin_too_fast_is_refused() {
    let mut stage = Stage::new();
    let ball = stage.ball;
    let reach = |error: &WorldError| matches!(error, WorldError::OffsetOutOfRange { .. });
    let plank = ShapeDef::new(Polygon::rectangle(fx!(100), fx!(1)).expect("valid"));
    stage.refuses(spawn(BodyDef::dynamic(), plank.offset((fx!(60), fx!(0)))), reach);
    stage.refuses(Command::AddShape { body: ball, shape: plank.offset((fx!(0), fx!(128))) }, reach);
    // A speed of 50 rad/s is 18 m/s at a radius of gyration of 0.35 m. A second ball 60 m away makes that radius 30 m,
    // and the speed 1500 m/s.
    stage.world.set_velocity(ball, Vec2::ZERO, fx!(50)).expect("valid");
    let arm = self::ball().offset((fx!(60), fx!(0))).density(fx!(1));
    stage.refuses(Command::AddShape { body: ball, shape: arm }, |error| {
        matches!(error, WorldError::SpeedOutOfRange { .. })
    });
    stage.refuses(spawn(BodyDef::dynamic().gravity_scale(Fx::MIN), self::ball()), |error| {
        matches!(error, WorldError::GravityScaleOutOfRange { .. })
    });
}

#[test]
fn a_shape_does_not_change_how_a_kinematic_body_turns() {
    let mut stage = Stage::new();
    stage.world.set_velocity(stage.lift, Vec2::ZERO, fx!(10)).expect("valid");
    stage.world.add_shape(stage.lift, &ball().offset((fx!(60), fx!(60)))).expect("valid");
    assert_eq!(stage.world.body(stage.lift).expect("there").angular_velocity(), fx!(10));
}
