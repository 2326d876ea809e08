//! Every command can be recorded, whether the world accepts or refuses it.

use lockstep2d::body::{
    Area, BodyDef, BodyId, BodyKind, BodySettings, Geometry, MassSource, Name, Polygon, ShapeDef,
};
use lockstep2d::fx;
use lockstep2d::lockstep::{Game, Sandbox, SandboxSetup};
use lockstep2d::math::{Angle, Fx, Vec2};
use lockstep2d::replay::{Limits, Recording, verify};
use lockstep2d::solver::{JointDef, Revolute};
use lockstep2d::world::{BodyPose, Command, Config, Explosion, World};

fn ball() -> ShapeDef {
    ShapeDef::new(Geometry::circle(fx!(0.5)).unwrap())
}

fn setup() -> SandboxSetup {
    let mut commands = vec![
        Command::Spawn { body: BodyDef::fixed(), shapes: vec![ball()] },
        Command::Spawn { body: BodyDef::kinematic().position((fx!(5), fx!(0))), shapes: vec![ball()] },
    ];
    let poses = (0..6).map(|x| BodyPose { position: Vec2::new(Fx::from(x), fx!(2)), angle: Angle::ZERO });
    commands.push(Command::SpawnEach {
        body: BodyDef::dynamic(),
        shapes: vec![ball()],
        poses: poses.collect(),
    });
    SandboxSetup { config: Config::default(), commands }
}

/// Commands of every kind on a body, with values that may be refused.
fn commands(world: &World, body: BodyId, value: Fx) -> Vec<Command> {
    let vector = Vec2::new(value, value.saturating_neg());
    let position = world.body(body).map_or(Vec2::ZERO, |body| body.position());
    let (angle, velocity) = (Angle::from_bits(1 << 20), vector);
    let other = world.bodies().next().unwrap().0;
    let joint = JointDef::new(other, body, Revolute::new().motor(value, fx!(1)));
    let mut commands = vec![
        Command::Spawn {
            body: BodyDef::dynamic().velocity((value, fx!(0))),
            shapes: vec![ball().density(value)],
        },
        Command::SpawnEach {
            body: BodyDef::fixed(),
            shapes: vec![ball().sensor()],
            poses: vec![BodyPose { position: vector, angle }],
        },
        Command::AddShape { body, shape: ball().offset((value, fx!(0))) },
        Command::AddJoint { joint },
        Command::AddJointEach { joint, ends: vec![(body, other); 2] },
        Command::ApplyForce { body, force: vector, point: vector },
        Command::ApplyTorque { body, torque: value },
        Command::ApplyImpulse { body, impulse: vector, point: vector },
        Command::ApplyAngularImpulse { body, impulse: value },
        Command::SetVelocity { body, velocity, angular_velocity: value },
        Command::SetTransform { body, position: position + vector, angle },
        Command::SetGravity { gravity: vector },
        Command::SetName { body, name: Name::new("probe").ok() },
        Command::SetConfig { config: Config { hit_speed: value, ..*world.config() } },
        Command::MoveTo { body, position, angle },
        Command::SetBody { body, settings: BodySettings { linear_damping: value, ..Default::default() } },
        Command::SetMass {
            body,
            mass: MassSource::Given { mass: value, centre: Vec2::ZERO, gyration: fx!(0.5) },
        },
        Command::SetUserData { body, user_data: 7 },
        Command::Sleep { body },
        Command::Wake { body },
        Command::Disable { body },
        Command::Enable { body },
        Command::Explode { explosion: Explosion::new(vector, value) },
        Command::SetKind { body, kind: BodyKind::Dynamic },
    ];
    if let Some((shape, old)) = world.shapes().last() {
        commands.push(Command::SetShape { shape, def: old.def().friction(value) });
        commands.push(Command::SetArea { shape, area: Some(Area::new().acceleration(vector)) });
        commands.push(Command::RemoveShape { shape });
    }
    if let Some((joint, old)) = world.joints().last() {
        commands.push(Command::SetJoint { joint, def: old.def().colliding() });
        commands.push(Command::RemoveJoint { joint });
    }
    if value > fx!(100) {
        commands.push(Command::Despawn { body });
    }
    commands
}

#[test]
fn every_command_can_be_recorded_and_verified() {
    let mut recording = Recording::<Sandbox>::start(&setup(), 3).unwrap();
    for value in [fx!(1), fx!(0.5), fx!(-1), fx!(200), Fx::MAX, Fx::MIN] {
        let world = recording.game().world();
        let bodies: Vec<BodyId> = world.bodies().map(|(id, _)| id).take(6).collect();
        for body in bodies {
            let input = commands(recording.game().world(), body, value);
            recording.step(&[input]).unwrap();
        }
        recording.step(&[Vec::new()]).unwrap();
    }
    let world = recording.game().world();
    assert_eq!(world.validate(), Ok(()));
    assert!(recording.game().refused() > 100 && world.tick() > 30, "{}", recording.game().refused());
    let file = recording.finish().unwrap();
    let verdict = verify::<Sandbox>(&file, &Limits::default());
    assert!(verdict.is_match(), "{verdict}");
}

#[test]
fn many_bodies_in_one_command_are_work() {
    for (count, expected) in [(20_000, "limit_exceeded"), (1000, "match")] {
        let mut recording = Recording::<Sandbox>::start(&setup(), 3).unwrap();
        let poses = vec![BodyPose { position: Vec2::ZERO, angle: Angle::ZERO }; count];
        let body = BodyDef { settings: BodySettings::default(), ..BodyDef::fixed() };
        recording.step(&[vec![Command::SpawnEach { body, shapes: vec![ball()], poses }]]).unwrap();
        let file = recording.finish().unwrap();
        // Each body costs at least one unit of work.
        let limits = Limits { tick_work: 20_000, ..Limits::default() };
        let verdict = verify::<Sandbox>(&file, &limits);
        assert_eq!(verdict.name(), expected, "{verdict}");
    }
}

/// A tick with many bodies costs far more work if they overlap.
#[test]
fn a_heap_in_one_place_is_dear() {
    let work = |apart: i32| {
        let square = ShapeDef::new(Polygon::square(fx!(0.5)).unwrap());
        let spawn = |place: i32| Command::Spawn {
            body: BodyDef::dynamic().position((Fx::from_num(place * apart), fx!(0))),
            shapes: vec![square],
        };
        let commands = (0..200).map(spawn).collect();
        let mut game = Sandbox::new(&SandboxSetup { commands, ..SandboxSetup::default() }).unwrap();
        game.step(&[vec![]]);
        game.work(&[vec![]])
    };
    assert!(work(0) > 50 * work(3), "expected 50 times the work: {} and {}", work(0), work(3));
}
