//! Ordinary scenes: piles, containers, drums and chains of moderate sizes, masses and speeds. Faults are rare: a value
//! is clamped in about one scene in five hundred, for example when a chain is spawned across a pile.

use lockstep2d::body::{Area, BodyDef, BodyId, BodyKind, Geometry, ShapeDef};
use lockstep2d::fx;
use lockstep2d::math::{Fx, Rng, Vec2, fx_mul};
use lockstep2d::solver::{ContactTuning, JointDef};
use lockstep2d::world::{BodyPose, Command, Config, Explosion, World};

use crate::generator::{serde_handle::Handle, spawn};
use crate::shapes::{half_extents, ordinary_chain, ordinary_shape};
use crate::source::Source;
use crate::{joints, settings};

/// Height of the floor, relative to the centre of the scene.
const FLOOR: Fx = fx!(-1);

/// Typical settings of a game.
pub fn config(source: &mut Source<'_>) -> Config {
    let mut config = Config { tick_rate: source.pick(&[60, 60, 60, 30, 120]), ..Config::default() };
    config.solver.sub_steps = source.pick(&[4, 4, 4, 8, 2]);
    if source.one_in(4) {
        config.solver.contact = ContactTuning::Baumgarte {
            share: source.thousandths(100, 300),
            slop: source.thousandths(2, 10),
            push_speed: source.thousandths(1000, 5000),
        };
    }
    if source.one_in(8) {
        config.solver.iterations = 2;
    }
    config.sleeping = !source.one_in(8);
    config.continuous = !source.one_in(8);
    if source.one_in(8) {
        config.gravity = Vec2::new(source.thousandths(-5000, 5000), source.thousandths(-15_000, 5000));
    }
    config
}

/// Adds ground, a pile on it, and sometimes another pile or a chain.
pub fn setup(source: &mut Source<'_>, middle: Vec2<Fx>, commands: &mut Vec<Command>) {
    ground(source, middle, commands);
    pile(source, middle, commands);
    match source.below(6) {
        4 => pile(source, middle, commands),
        5 => chain(source, middle, commands),
        _ => {}
    }
}

fn line(a: (Fx, Fx), b: (Fx, Fx)) -> ShapeDef {
    ShapeDef::new(Geometry::Segment { a: Vec2::new(a.0, a.1), b: Vec2::new(b.0, b.1) })
}

fn rectangle(half: (Fx, Fx), x: Fx, y: Fx) -> ShapeDef {
    ShapeDef::new(lockstep2d::body::Polygon::rectangle(half.0, half.1).expect("a valid size")).offset((x, y))
}

fn ground(source: &mut Source<'_>, middle: Vec2<Fx>, commands: &mut Vec<Command>) {
    let at = middle + Vec2::new(Fx::ZERO, FLOOR);
    let fixed = BodyDef::fixed().position(at);
    commands.push(match source.below(7) {
        5 => spawn(fixed, &ordinary_chain(source)),
        6 => spawn(fixed, &belt(source)),
        0 => spawn(fixed, &[line((fx!(-8), fx!(0)), (fx!(8), fx!(0)))]),
        1 => spawn(fixed, &[rectangle((fx!(10), fx!(0.5)), fx!(0), fx!(-0.5))]),
        2 => {
            let wall = (fx!(0.25), fx!(4));
            let floor = rectangle((fx!(3), fx!(0.5)), fx!(0), fx!(-0.5));
            spawn(fixed, &[floor, rectangle(wall, fx!(-3), fx!(3)), rectangle(wall, fx!(3), fx!(3))])
        }
        3 => {
            let slope = source.thousandths(-1000, 1000);
            spawn(fixed, &[line((fx!(-8), slope), (fx!(0), fx!(0))), line((fx!(0), fx!(0)), (fx!(8), slope))])
        }
        _ => {
            // A drum: four walls about a point three metres above the floor.
            let (lying, standing) = ((fx!(4), fx!(0.25)), (fx!(0.25), fx!(4)));
            let walls = [
                rectangle(lying, fx!(0), fx!(-3.25)),
                rectangle(lying, fx!(0), fx!(3.25)),
                rectangle(standing, fx!(-3.75), fx!(0)),
                rectangle(standing, fx!(3.75), fx!(0)),
            ];
            let drum = BodyDef::kinematic().position((at.x, at.y + fx!(3)));
            spawn(drum.angular_velocity(source.thousandths(-1500, 1500)), &walls)
        }
    });
}

/// A conveyor, a one-way platform that lets bodies pass from below, and a sensor.
fn belt(source: &mut Source<'_>) -> [ShapeDef; 3] {
    let floor = rectangle((fx!(8), fx!(0.5)), fx!(0), fx!(-0.5));
    let platform = rectangle((fx!(1.5), fx!(0.1)), source.thousandths(-2000, 2000), fx!(1.5));
    [
        floor.surface_speed(source.thousandths(-3000, 3000)),
        platform.one_way(lockstep2d::math::Angle::from_bits(1 << 30)),
        pool(source, rectangle((fx!(3), fx!(2)), fx!(0), fx!(1))),
    ]
}

/// A sensor, which contains a fluid in half of the cases.
fn pool(source: &mut Source<'_>, shape: ShapeDef) -> ShapeDef {
    if source.one_in(2) {
        return shape.sensor();
    }
    let water = Area::fluid(source.thousandths(0, 3000))
        .drag(source.thousandths(0, 4000), source.thousandths(0, 4000));
    shape.area(
        water
            .flow((source.thousandths(-3000, 3000), fx!(0)))
            .force((source.thousandths(-2000, 2000), fx!(0))),
    )
}

/// Adds equal bodies in rows. Neighbours touch, overlap slightly, or are up to 10 cm apart.
pub(crate) fn pile(source: &mut Source<'_>, middle: Vec2<Fx>, commands: &mut Vec<Command>) {
    let shape = ordinary_shape(source);
    let count = source.pick(&[12, 8, 16, 14, 10, 12, 20, 28]);
    let columns = source.pick(&[4, 2, 3, 1, 6, 5]);
    let gap = source.pick(&[fx!(0), fx!(0.01), fx!(-0.005), fx!(0.1)]);
    let mut rng = Rng::new(source.byte().into());
    let wobble = source.pick(&[fx!(0), fx!(0.01), fx!(0.05)]);
    let turned = source.one_in(4);
    let mut half = half_extents(&shape);
    if turned {
        half = Vec2::new(half.x + half.y, half.x + half.y);
    }
    let corner =
        middle + Vec2::new(source.thousandths(-2000, 0), FLOOR + source.pick(&[fx!(0), fx!(0.5), fx!(2)]));
    let asleep = source.one_in(6);
    // Bodies sleep after half a second of rest, which is much of a short scene. Most piles get a higher sleep speed, so
    // that they count as resting earlier.
    let sleep_speed = source.pick(&[fx!(0.05), fx!(0.5), fx!(2)]);
    for index in 0..count {
        let (column, row) = (Fx::from(index % columns), Fx::from(index / columns));
        let x = fx_mul(column, half.x * 2 + gap) + rng.range(-wobble, wobble.max(Fx::DELTA));
        let y = half.y + fx_mul(row, half.y * 2 + gap);
        let mut body = BodyDef::dynamic().position((corner.x + x, corner.y + y));
        if turned {
            body = body.angle(rng.angle());
        }
        body.asleep = asleep;
        body.settings.sleep_speed = sleep_speed;
        commands.push(spawn(body, &[shape]));
    }
}

/// Adds a row of bodies, each joined to the next. The first body is usually joined to a fixed body.
fn chain(source: &mut Source<'_>, middle: Vec2<Fx>, commands: &mut Vec<Command>) {
    let slot = |commands: &[Command]| {
        let spawned = commands.iter().filter(|command| matches!(command, Command::Spawn { .. })).count();
        BodyId::of_bytes(spawned as u64)
    };
    let shape = ordinary_shape(source);
    let half = half_extents(&shape);
    let start = middle + Vec2::new(source.thousandths(-3000, 0), source.thousandths(0, 3000));
    let kind = joints::ordinary_kind(source);
    let mut before = None;
    if !source.one_in(4) {
        before = Some((slot(commands), Vec2::ZERO));
        commands.push(spawn(BodyDef::fixed().position(start), &[]));
    }
    for link in 0..source.pick(&[5i32, 2, 10, 3]) {
        let body = slot(commands);
        let x = start.x + fx_mul(half.x, Fx::from(2 * link + 1));
        commands.push(spawn(BodyDef::dynamic().position((x, start.y)), &[shape]));
        if let Some((other, anchor)) = before {
            let joint = JointDef::new(other, body, kind).anchor_a(anchor).anchor_b((-half.x, Fx::ZERO));
            commands.push(Command::AddJoint { joint });
        }
        before = Some((body, Vec2::new(half.x, Fx::ZERO)));
    }
}

/// Adds a command that makes a moderate change.
pub fn command(
    source: &mut Source<'_>,
    world: &World,
    middle: Vec2<Fx>,
    body: BodyId,
    commands: &mut Vec<Command>,
) {
    let (mass, centre) =
        world.body(body).map_or((Fx::ONE, middle), |body| (body.mass(), body.centre_of_mass()));
    let vector = |source: &mut Source<'_>, reach: i64| {
        Vec2::new(source.thousandths(-reach, reach), source.thousandths(-reach, reach))
    };
    let above = middle + Vec2::new(source.thousandths(-2000, 2000), source.thousandths(1000, 4000));
    commands.push(match source.below(32) {
        0..=2 => {
            let kind =
                source.pick(&[BodyKind::Dynamic, BodyKind::Dynamic, BodyKind::Dynamic, BodyKind::Kinematic]);
            let mut body = BodyDef::new(kind).position(above).angle(source.angle());
            body.settings = settings::ordinary_settings(source);
            let velocity = vector(source, 4000);
            spawn(body.velocity(velocity), &[ordinary_shape(source)])
        }
        3 => Command::Despawn { body },
        4 => {
            let mut shape = ordinary_shape(source);
            shape.offset = vector(source, 300);
            Command::AddShape { body, shape }
        }
        5 => match world.body(body).and_then(|body| body.shapes().first()) {
            Some(&shape) => Command::RemoveShape { shape },
            None => return,
        },
        6..=8 => match neighbours(source, world, body) {
            Some(joint) => Command::AddJoint { joint },
            None => return,
        },
        9 => match world.joints().nth(source.below(world.joint_count())) {
            Some((joint, _)) => Command::RemoveJoint { joint },
            None => return,
        },
        10 => {
            let force = vector(source, 20_000).scale(mass);
            Command::ApplyForce { body, force, point: centre + vector(source, 200) }
        }
        11 => Command::ApplyTorque { body, torque: fx_mul(mass, source.thousandths(-2000, 2000)) },
        12 => {
            let impulse = vector(source, 3000).scale(mass);
            Command::ApplyImpulse { body, impulse, point: centre + vector(source, 200) }
        }
        13 => {
            let velocity = vector(source, 5000);
            Command::SetVelocity { body, velocity, angular_velocity: source.thousandths(-5000, 5000) }
        }
        14 => Command::SetTransform { body, position: above, angle: source.angle() },
        15 => Command::SetGravity { gravity: vector(source, 12_000) },
        16 => {
            let impulse_per_length = source.thousandths(-3000, 3000);
            Command::Explode { explosion: Explosion::new(middle + vector(source, 2000), impulse_per_length) }
        }
        _ => return change(source, world, body, commands),
    });
}

fn neighbours(source: &mut Source<'_>, world: &World, body: BodyId) -> Option<JointDef> {
    let (other, there) = world.bodies().find(|(id, _)| id.index() > body.index())?;
    let here = world.body(body)?;
    let between = (here.centre_of_mass() + there.centre_of_mass()).scale(fx!(0.5));
    let anchor = |body: &lockstep2d::body::Body| body.transform().apply_inverse(between);
    let (a, b) = (anchor(here), anchor(there));
    let mut joint = JointDef::new(body, other, joints::ordinary_kind(source)).anchor_a(a).anchor_b(b);
    // Frame B gets the current relative angle of the bodies, so that joints that hold an angle have nothing to correct.
    joint.frame_b.angle = here.angle() - there.angle();
    Some(joints::finish(source, joint))
}

/// Adds a command that changes a body, shape or joint, or spawns a few bodies.
fn change(source: &mut Source<'_>, world: &World, body: BodyId, commands: &mut Vec<Command>) {
    let here = world.body(body).map_or(Vec2::ZERO, |body| body.position());
    let some_shape = world.body(body).and_then(|body| body.shapes().first());
    let some_joint = world.joints().nth(source.below(world.joint_count()));
    commands.push(match source.below(14) {
        0 => Command::Sleep { body },
        1 => Command::Wake { body },
        2 => Command::Disable { body },
        3 | 4 => Command::Enable { body },
        5 => Command::SetBody { body, settings: settings::ordinary_settings(source) },
        6 => Command::SetKind { body, kind: settings::kind(source) },
        7 => Command::SetMass { body, mass: settings::ordinary_mass(source) },
        8 => Command::SetUserData { body, user_data: source.byte().into() },
        9 | 10 => {
            let offset = Vec2::new(source.thousandths(-100, 100), source.thousandths(-100, 100));
            Command::MoveTo { body, position: here + offset, angle: lockstep2d::math::Angle::ZERO }
        }
        11 => match some_shape {
            Some(&shape) => Command::SetShape { shape, def: ordinary_shape(source) },
            None => return,
        },
        12 => match some_joint {
            Some((joint, old)) => Command::SetJoint { joint, def: joints::finish(source, *old.def()) },
            None => return,
        },
        _ => {
            let count = 1 + source.below(4);
            let pose = |index: usize| BodyPose {
                position: here + Vec2::new(Fx::from_num(index), fx!(2)),
                angle: lockstep2d::math::Angle::ZERO,
            };
            let poses = (0..count).map(pose).collect();
            Command::SpawnEach { body: BodyDef::dynamic(), shapes: vec![ordinary_shape(source)], poses }
        }
    });
}
