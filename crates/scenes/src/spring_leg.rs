//! A dynamic character that is held above the ground by a spring leg. The character pushes crates, loads dynamic ground
//! with its weight, and is carried by moving ground.

use alloc::vec;
use alloc::vec::Vec;

use super::Scene;
use super::builder::{build, rectangle};
use lockstep2d::body::{Body, BodyDef, BodyId, Chain, Geometry, ShapeDef, WorldError};
use lockstep2d::fx;
use lockstep2d::math::{Angle, Fx, Vec2, fx_mul};
use lockstep2d::world::{CastHit, Command, Config, Probe, QueryFilter, World};

pub(super) const SPRING_LEG: Scene = Scene {
    name: "spring_leg",
    about: "a dynamic character on a spring leg takes steps and a slope, pushes crates, jumps and rides a lift",
    ticks: 1200,
    golden_ticks: 1200,
    setup: |_| {
        build(Config::default(), |scene| {
            let character = BodyDef::dynamic().position((fx!(-6), fx!(1))).lock_rotation();
            scene.spawn(character, &[ShapeDef::new(pill()?).friction(fx!(0))])?;
            scene.spawn(BodyDef::kinematic().position(lift_at(0)), &[rectangle(fx!(1.5), fx!(0.2))?])?;
            scene.spawn(BodyDef::fixed(), &Chain::new(&level()).links()?)?;
            for x in [fx!(10), fx!(10.6), fx!(11.2)] {
                scene.spawn(
                    BodyDef::dynamic().position((x, fx!(0.25))),
                    &[rectangle(fx!(0.25), fx!(0.25))?],
                )?;
            }
            Ok(())
        })
    },
    script: |tick, game| play(tick, game.world()).unwrap_or_default(),
};

/// A wall, a floor, four steps up, a slope of 17 degrees down, a floor, a pit for the lift, an upper floor, and a wall.
fn level() -> Vec<Vec2<Fx>> {
    let mut points = vec![(fx!(-9), fx!(6)), (fx!(-9), fx!(0))];
    let (mut x, mut y) = (fx!(-2), fx!(0));
    for _ in 0..4 {
        points.extend([(x, y), (x, y + fx!(0.2))]);
        (x, y) = (x + fx!(0.5), y + fx!(0.2));
    }
    points.extend([
        (fx!(2), y),
        (fx!(4.7), fx!(0)),
        (fx!(16), fx!(0)),
        (fx!(16), fx!(-1)),
        (fx!(19.2), fx!(-1)),
    ]);
    points.extend([(fx!(19.2), fx!(2)), (fx!(24), fx!(2)), (fx!(24), fx!(8))]);
    points.into_iter().map(|(x, y)| Vec2::new(x, y)).collect()
}

fn pill() -> Result<Geometry, WorldError> {
    Ok(Geometry::capsule(Vec2::new(fx!(0), fx!(-0.2)), Vec2::new(fx!(0), fx!(0.4)), fx!(0.3))?)
}

/// Position of the lift. Its top goes from the floor to the upper floor and back in 8 s.
fn lift_at(tick: u64) -> Vec2<Fx> {
    let phase = Angle::from_turns(Fx::from_num(tick % 480) / 480);
    let rise = fx!(1) - Fx::from(phase.cos());
    Vec2::new(fx!(17.6), rise - fx!(0.2))
}

/// Height of the centre of mass above the ground, in metres, at which the force of the leg is equal to the weight.
const RIDE_HEIGHT: Fx = fx!(0.9);
/// Length of the leg, in metres below the centre of mass, within which ground is found. At this height, the spring no
/// longer pushes.
const LEG_LENGTH: Fx = fx!(1.1);
/// Stiffness of the leg per unit of mass, `(2 pi 4 Hz)²`, in 1/s².
const STIFFNESS: Fx = fx!(632);
/// Damping of the leg per unit of mass, `2 * 0.7 * 2 pi 4 Hz` (a damping ratio of 0.7), in 1/s.
const DAMPING: Fx = fx!(35);
/// Largest acceleration that the leg causes, in m/s².
const PUSH_MAX: Fx = fx!(100);
/// Largest horizontal acceleration in m/s².
const DRIVE_MAX: Fx = fx!(25);
/// Upward speed relative to the ground, in m/s, above which the leg does not push, because the character is jumping.
const LIFT_OFF: Fx = fx!(2);

/// Pairs of a tick and the horizontal speed in m/s, relative to the ground, from this tick on.
const SPEEDS: [(u64, Fx); 6] =
    [(0, fx!(0)), (60, fx!(3)), (560, fx!(0)), (730, fx!(3)), (900, fx!(-4)), (1150, fx!(0))];

const JUMPS: [u64; 3] = [30, 420, 1000];

/// Commands of a tick: the force of the leg, its reaction on the ground, and the movement of the lift.
fn play(tick: u64, world: &World) -> Option<Vec<Command>> {
    let mut bodies = world.bodies().map(|(id, _)| id);
    let (character, lift) = (bodies.next()?, bodies.next()?);
    let mut commands = vec![Command::MoveTo { body: lift, position: lift_at(tick + 1), angle: Angle::ZERO }];
    let body = world.body(character)?;
    if let Some(hit) = foot(world, character, body) {
        commands.extend(push(tick, world, (character, body), &hit)?);
    }
    Some(commands)
}

/// Finds the ground by casting a foot, which is narrower than the body, downwards.
fn foot(world: &World, character: BodyId, body: &Body) -> Option<CastHit> {
    let radius = fx!(0.1);
    let foot = Probe::new(Geometry::circle(radius).ok()?, body.centre_of_mass()).ok()?;
    let down = Vec2::new(Fx::ZERO, radius - LEG_LENGTH);
    world.cast_shape(&foot, down, QueryFilter::default().except(character))
}

/// Commands that push the character away from the ground, and drive it along the ground.
fn push(tick: u64, world: &World, (character, body): (BodyId, &Body), hit: &CastHit) -> Option<Vec<Command>> {
    let ground = world.shape(hit.shape)?.body();
    let relative = body.velocity() - world.body(ground)?.velocity_at(hit.point);
    let wanted = SPEEDS.iter().rev().find(|(from, _)| *from <= tick).map_or(Fx::ZERO, |step| step.1);
    // The spring carries the weight at the ride height. It pushes but never pulls.
    let shortened = RIDE_HEIGHT - (body.centre_of_mass().y - hit.point.y);
    let spring = fx_mul(STIFFNESS, shortened) - fx_mul(DAMPING, relative.y) - world.config().gravity.y;
    let up = if relative.y > LIFT_OFF { Fx::ZERO } else { spring.clamp(Fx::ZERO, PUSH_MAX) };
    // Removes a third of the difference to the wanted speed in each tick, with an acceleration of at most DRIVE_MAX.
    let along = ((wanted - relative.x) * 20).clamp(-DRIVE_MAX, DRIVE_MAX);
    let force = Vec2::new(along, up).scale(body.mass());
    let mut commands = vec![Command::ApplyForce { body: character, force, point: body.centre_of_mass() }];
    if world.body(ground)?.is_dynamic() {
        commands.push(Command::ApplyForce { body: ground, force: -force, point: hit.point });
    }
    if JUMPS.contains(&tick) {
        let impulse = Vec2::new(Fx::ZERO, fx!(5.5)).scale(body.mass());
        commands.push(Command::ApplyImpulse { body: character, impulse, point: body.centre_of_mass() });
    }
    Some(commands)
}
