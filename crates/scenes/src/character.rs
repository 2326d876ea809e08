//! A character that is moved by queries of the world. A kinematic body follows it.

use alloc::vec;
use alloc::vec::Vec;

use super::Scene;
use super::builder::{build, rectangle};
use lockstep2d::body::{Body, BodyDef, BodyId, Chain, Geometry, ShapeDef, WorldError};
use lockstep2d::fx;
use lockstep2d::lockstep::Sandbox;
use lockstep2d::math::{Angle, Fx, Vec2};
use lockstep2d::world::{Command, Config, Mover, MoverState, QueryFilter};

pub(super) const CHARACTER: Scene = Scene {
    name: "character",
    about: "a pill walks, runs against a wall, climbs, takes steps and jumps, moved by queries alone",
    ticks: 900,
    golden_ticks: 900,
    setup: |_| {
        build(Config::default(), |scene| {
            scene.spawn(BodyDef::kinematic().position((fx!(-5), fx!(2))), &[ShapeDef::new(pill()?)])?;
            scene.spawn(BodyDef::fixed(), &Chain::new(&level()).links()?)?;
            let ceiling = rectangle(fx!(1.5), fx!(0.25))?;
            scene.spawn(BodyDef::fixed().position((fx!(15), fx!(3.85))), &[ceiling])?;
            Ok(())
        })
    },
    script: |tick, game| play(tick, game).unwrap_or_default(),
};

/// A wall, a floor, a slope of 27 degrees, a plateau, four steps down, a floor, a slope of 60 degrees and a wall.
fn level() -> Vec<Vec2<Fx>> {
    let mut points = vec![(fx!(-10), fx!(6)), (fx!(-10), fx!(0)), (fx!(0), fx!(0)), (fx!(6), fx!(3))];
    let (mut x, mut y) = (fx!(9), fx!(3));
    for _ in 0..4 {
        points.extend([(x, y), (x, y - fx!(0.25))]);
        (x, y) = (x + fx!(0.6), y - fx!(0.25));
    }
    points.extend([(fx!(20), fx!(2)), (fx!(22), fx!(5.464)), (fx!(22), fx!(9))]);
    points.into_iter().map(|(x, y)| Vec2::new(x, y)).collect()
}

/// A capsule 1.4 m high.
fn pill() -> Result<Geometry, WorldError> {
    Ok(Geometry::capsule(Vec2::new(fx!(0), fx!(-0.4)), Vec2::new(fx!(0), fx!(0.4)), fx!(0.3))?)
}

/// Pairs of a tick and the horizontal speed in m/s from this tick on.
const SPEEDS: [(u64, Fx); 6] =
    [(0, fx!(0)), (60, fx!(-8)), (120, fx!(3)), (300, fx!(6)), (600, fx!(-6)), (880, fx!(0))];

/// Ticks of the jumps: against the wall, on the slope, under the ceiling, at the steep slope, up the steps.
const JUMPS: [u64; 5] = [100, 330, 440, 520, 700];

fn play(tick: u64, game: &Sandbox) -> Option<Vec<Command>> {
    let world = game.world();
    let (id, body) = world.bodies().next()?;
    let mover = Mover::new(pill().ok()?).ok()?.step_height(fx!(0.3)).snap_distance(fx!(0.3));
    let filter = QueryFilter::default().except(id);
    let mut state = recall(body);
    if body.user_data() & ON_GROUND != 0 {
        let planes = world.collide_mover(&mover.probe(state.position), fx!(0.3), filter);
        state.ground = planes.into_iter().max_by_key(|plane| plane.normal.y);
    }

    state.velocity.x = SPEEDS.iter().rev().find(|(from, _)| *from <= tick).map_or(Fx::ZERO, |step| step.1);
    state.velocity.y -= fx!(1 / 6);
    if JUMPS.contains(&tick) && state.is_on_ground() {
        state.velocity.y = fx!(5);
    }
    Some(store_state(id, world.move_character(&mover, &state, filter).state).into())
}

/// Lowest bit of the body's user data: whether the character is on ground. The other bits hold the character's upward
/// speed.
const ON_GROUND: u64 = 1;

/// Reads the state of the character from the body and its user data.
fn recall(body: &Body) -> MoverState {
    let upwards = Fx::from_ne_bytes((body.user_data() & !ON_GROUND).to_ne_bytes());
    MoverState { velocity: Vec2::new(Fx::ZERO, upwards), ..MoverState::at(body.position()) }
}

fn store_state(body: BodyId, state: MoverState) -> [Command; 2] {
    let upwards = u64::from_ne_bytes(state.velocity.y.to_ne_bytes());
    let user_data = (upwards & !ON_GROUND) | u64::from(state.is_on_ground());
    [
        Command::MoveTo { body, position: state.position, angle: Angle::ZERO },
        Command::SetUserData { body, user_data },
    ]
}
