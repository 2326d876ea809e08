//! Builds the arena, and places the players in it.
//!
//! Distances from the centre, in metres: the mill's flails reach to 4.4, bumpers stand at 5.4, inner crates lie at 6.2,
//! plates at 7.2, players start at 8.1, outer crates lie at 10. The platform ends at 12, and at 4.5 when it has
//! crumbled.

use lockstep2d::body::{
    Body, BodyDef, BodyId, EventSwitches, Filter, Geometry, Polygon, ShapeDef, WorldError,
};
use lockstep2d::fx;
use lockstep2d::math::{Angle, Fx, Rng, Rot, Vec2, fx_mul};
use lockstep2d::solver::{JointDef, Revolute};
use lockstep2d::world::{Config, World};

/// Ticks per second.
pub(crate) const TICK_RATE: u32 = 60;
/// Radius of the platform at the start of a round, in metres.
pub const START_RADIUS: Fx = fx!(12);
/// Width of a ring that crumbles, in metres.
const RING: Fx = fx!(0.5);
/// Number of rings of the platform that crumble in a round.
pub(crate) const RINGS: u8 = 15;

/// Distance of the start positions from the centre, in metres.
const START_RING: Fx = fx!(8.1);
/// Radius of a player, in metres.
const PLAYER_RADIUS: Fx = fx!(0.5);
/// Angular velocity of the mill, in rad/s.
const MILL_SPEED: Fx = fx!(2);
/// Largest torque of the mill's motor, in N m.
const MILL_TORQUE: Fx = fx!(400);

/// Role of a body, stored in its user data.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// The floor, which collides with nothing.
    Platform,
    /// A player, with its seat.
    Player(u8),
    /// A crate, which can be pushed around.
    Crate,
    /// A bumper, which kicks bodies that hit it.
    Bumper,
    /// A plate, which recharges the dash of a player.
    Plate,
    /// The bar in the centre, or a part of its flails.
    Mill,
}

impl Role {
    const PLAYERS: u64 = 16;

    const fn user_data(self) -> u64 {
        match self {
            Role::Platform => 0,
            Role::Crate => 1,
            Role::Bumper => 2,
            Role::Plate => 3,
            Role::Mill => 4,
            Role::Player(seat) => Role::PLAYERS + seat as u64,
        }
    }

    /// Role of a body of the game.
    #[must_use]
    pub fn of(body: &Body) -> Role {
        match body.user_data() {
            1 => Role::Crate,
            2 => Role::Bumper,
            3 => Role::Plate,
            4 => Role::Mill,
            other => match other.checked_sub(Role::PLAYERS).map(u8::try_from) {
                Some(Ok(seat)) => Role::Player(seat),
                _ => Role::Platform,
            },
        }
    }
}

/// Radius in metres after the loss of `rings_lost` rings.
pub(crate) fn radius(rings_lost: u8) -> Fx {
    START_RADIUS.saturating_sub(RING.saturating_mul_int(rings_lost.into()))
}

fn polar(radius: Fx, angle: Angle) -> Vec2<Fx> {
    Rot::from_angle(angle).apply_wide(Vec2::new(radius, Fx::ZERO))
}

/// Angle of `index / count` of a full turn.
fn part(index: u8, count: u8) -> Angle {
    Angle::from_turns(Fx::from_num(index) / i64::from(count))
}

fn at(def: BodyDef, place: Vec2<Fx>, role: Role) -> BodyDef {
    def.position(place).user_data(role.user_data())
}

/// The world before the first round, without players and crates.
pub(crate) fn build() -> Result<World, WorldError> {
    let mut world = World::new(Config {
        tick_rate: TICK_RATE,
        gravity: Vec2::ZERO,
        body_limit: 64,
        shape_limit: 64,
        joint_limit: 16,
        ..Config::default()
    })?;
    let picture = Filter { category: 2, mask: 0, group: 0 };
    let platform = ShapeDef::new(Geometry::circle(START_RADIUS)?).sensor().filter(picture);
    world.spawn(&at(BodyDef::fixed(), Vec2::ZERO, Role::Platform), &[platform])?;

    let hits = EventSwitches { hit: true, ..EventSwitches::default() };
    let bumper = ShapeDef::new(Geometry::circle(fx!(0.6))?).restitution(fx!(1)).events(hits);
    let plate = ShapeDef::new(Polygon::square(fx!(0.6))?).sensor();
    for quarter in 0..4 {
        let place = polar(fx!(5.4), part(quarter, 4));
        world.spawn(&at(BodyDef::fixed(), place, Role::Bumper), &[bumper])?;
        let place = polar(fx!(7.2), part(quarter, 4) + Angle::EIGHTH);
        world.spawn(&at(BodyDef::fixed(), place, Role::Plate), &[plate])?;
    }
    build_mill(&mut world)?;
    Ok(world)
}

/// Adds a bar that a motor turns about the origin, with a flail at each end.
fn build_mill(world: &mut World) -> Result<(), WorldError> {
    let axle = world.spawn(&at(BodyDef::fixed(), Vec2::ZERO, Role::Mill), &[])?;
    let bar = ShapeDef::new(Polygon::rectangle(fx!(2.2), fx!(0.2))?).density(fx!(4));
    let mill = BodyDef::dynamic().never_sleeps();
    let bar = world.spawn(&at(mill, Vec2::ZERO, Role::Mill), &[bar])?;
    world.add_joint(&JointDef::new(axle, bar, Revolute::new().motor(MILL_SPEED, MILL_TORQUE)))?;
    for side in [fx!(1), fx!(-1)] {
        hang_flail(world, bar, side)?;
    }
    Ok(())
}

/// Hinges a flail to the end of the bar at `side` (1 or -1), pointing outwards: three links, each 0.5 m from hinge to
/// hinge, and a ball.
fn hang_flail(world: &mut World, bar: BodyId, side: Fx) -> Result<(), WorldError> {
    let link = Geometry::capsule(Vec2::new(fx!(-0.2), fx!(0)), Vec2::new(fx!(0.2), fx!(0)), fx!(0.08))?;
    let link = ShapeDef::new(link).density(fx!(6));
    let ball = ShapeDef::new(Geometry::circle(fx!(0.35))?).density(fx!(3)).restitution(fx!(0.5));
    let (mut inner, mut anchor) = (bar, fx!(2.2));
    for (shape, half) in [(link, fx!(0.25)), (link, fx!(0.25)), (link, fx!(0.25)), (ball, fx!(0.35))] {
        let middle = world.body(inner).map_or(Vec2::ZERO, Body::position);
        let reach = fx_mul(side, anchor.saturating_add(half));
        let def = BodyDef::dynamic().never_sleeps().angular_damping(fx!(1));
        let outer = world.spawn(&at(def, middle + Vec2::new(reach, fx!(0)), Role::Mill), &[shape])?;
        let hinge = JointDef::new(inner, outer, Revolute::new());
        let hinge = hinge.anchor_a((fx_mul(side, anchor), fx!(0))).anchor_b((fx_mul(side, -half), fx!(0)));
        world.add_joint(&hinge)?;
        (inner, anchor) = (outer, half);
    }
    Ok(())
}

/// Replaces the crates: 8 between the bumpers and 12 near the edge.
pub(crate) fn lay_crates(world: &mut World, rng: &mut Rng) -> Result<(), WorldError> {
    let found = world.bodies().filter(|(_, body)| Role::of(body) == Role::Crate);
    let old: Vec<_> = found.map(|(id, _)| id).collect();
    for id in old {
        world.despawn(id)?;
    }
    let square = ShapeDef::new(Polygon::square(fx!(0.4))?).density(fx!(0.8)).restitution(fx!(0.2));
    let turn = rng.angle();
    let inner = (0..12).filter(|slot| slot % 3 != 0).map(|slot| polar(fx!(6.2), part(slot, 12)));
    let outer = (0..12).map(|slot| polar(fx!(10), part(slot, 12) + turn));
    for place in inner.chain(outer) {
        let def = BodyDef::dynamic().linear_damping(fx!(1.5)).angular_damping(fx!(1.5)).angle(rng.angle());
        world.spawn(&at(def, place, Role::Crate), &[square])?;
    }
    Ok(())
}

/// Places a player on the start ring: at position `place` of `count` evenly spaced positions, counted counter-clockwise
/// from 0 at the angle `first`.
pub(crate) fn place_player(
    world: &mut World,
    seat: u8,
    (place, count): (u8, u8),
    first: Angle,
) -> Result<BodyId, WorldError> {
    let disc = ShapeDef::new(Geometry::circle(PLAYER_RADIUS)?).friction(fx!(0.3)).restitution(fx!(1));
    let def = BodyDef::dynamic().linear_damping(fx!(1.2)).angular_damping(fx!(2)).never_sleeps();
    world.spawn(&at(def, polar(START_RING, first + part(place, count)), Role::Player(seat)), &[disc])
}

pub(crate) fn draw_platform(world: &mut World, radius: Fx) -> Result<(), WorldError> {
    let shape = world.bodies().find(|(_, body)| Role::of(body) == Role::Platform);
    let Some(&shape) = shape.and_then(|(_, body)| body.shapes().first()) else { return Ok(()) };
    world.set_geometry(shape, Geometry::circle(radius)?)
}

/// Removes the players and crates whose centres are outside of the platform. Returns the seats of the removed players.
pub(crate) fn drop_outside(world: &mut World, radius: Fx) -> Vec<u8> {
    let falls = |body: &Body| {
        matches!(Role::of(body), Role::Player(_) | Role::Crate) && body.centre_of_mass().length() > radius
    };
    let found = world.bodies().filter(|(_, body)| falls(body));
    let outside: Vec<_> = found.map(|(id, body)| (id, Role::of(body))).collect();
    let mut seats = Vec::new();
    for (id, role) in outside {
        // The body was just found in the world, so this cannot fail.
        let _ = world.despawn(id);
        if let Role::Player(seat) = role {
            seats.push(seat);
        }
    }
    seats
}
