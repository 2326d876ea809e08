//! Characters: shapes that a game moves by rules of its own rather than by forces, and that slide along what they meet.
//!
//! A move is a cast; what is left of it at a hit is turned along the surface, and so on, until nothing is left. Casts
//! are exact and stop a tenth of a millimetre before they touch, so nothing is ever entered that was not entered
//! before. Box2D's `b2SolvePlanes` is for pushing out of what has come over a character; sliding along planes instead of
//! casting would stop it at corners that it only just passes by.
//!
//! What is ground and what is wall depends on the slope alone. On ground a character stands without sliding, and walks
//! along it at the speed that it has on level ground. Everything else it only slides along, and never up.

use alloc::vec::Vec;

use serde::{Deserialize, Serialize};

use super::World;
use super::mover_planes::{MoverPlane, clipped, solve_planes};
use super::probe::Probe;
use super::query::QueryFilter;
use crate::body::{Geometry, GeometryError, ShapeId, Sides};
use crate::collision::{Core, SKIN, distance};
use crate::fx;
use crate::math::{Angle, Fx, Rot, Unit, Vec2, fx_div};

/// How often a move is turned in a tick, and how often a character is pushed out of what overlaps it.
const TURNS_MAX: u32 = 8;

/// Movements below this length, in metres, are not worth a cast.
const LEFT_OVER: Fx = fx!(0.000001);

/// By how much the cosine of ground at the limit may be less, for normals that are rounded or a skin away.
const SLOPE_ROUNDING: Unit = Unit::lit("0.0005");

/// How far behind the edge of a step, in metres, ground has to be.
const STEP_DEPTH: Fx = fx!(0.02);

/// Heights of steps and lengths of snaps, in metres, are limited to this.
const HEIGHT_MAX: Fx = fx!(100);

/// How a character looks and what it can do: upright, `y` is up.
///
/// ```
/// use lockstep2d::body::{BodyDef, Geometry, Polygon, ShapeDef};
/// use lockstep2d::world::{Mover, MoverState, QueryFilter, World};
/// use lockstep2d::{fx, math::{Angle, Vec2}};
/// let mut world = World::default();
/// let floor = ShapeDef::new(Polygon::rectangle(fx!(50), fx!(1))?);
/// world.spawn(&BodyDef::fixed().position((fx!(0), fx!(-1))), &[floor])?;
///
/// let pill = Geometry::capsule(Vec2::new(fx!(0), fx!(0.3)), Vec2::new(fx!(0), fx!(1.5)), fx!(0.3))?;
/// let mover = Mover::new(pill)?.slope_max(Angle::from_degrees(fx!(50))).step_height(fx!(0.3));
/// let mut player = MoverState::at(Vec2::new(fx!(0), fx!(2)));
/// for _ in 0..60 {
///     // The game's own rules: gravity, and 3 m/s to the right.
///     player.velocity = Vec2::new(fx!(3), player.velocity.y - fx!(1 / 6));
///     player = world.move_character(&mover, &player, QueryFilter::default()).state;
/// }
/// assert!(player.is_on_ground() && player.position.y < fx!(0.001));
/// assert!((player.position.x - fx!(3)).abs() < fx!(0.001));
/// # Ok::<(), lockstep2d::body::WorldError>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Mover {
    geometry: Geometry,
    /// The cosine of the steepest ground.
    ground_cosine: Unit,
    step_height: Fx,
    snap_distance: Fx,
}

impl Mover {
    /// A character that stands on slopes up to 45 degrees, takes no steps, and stays on ground that falls away by up to
    /// 0.1 m in a tick.
    ///
    /// # Errors
    /// [`GeometryError`] when its size is out of range.
    pub fn new(geometry: impl Into<Geometry>) -> Result<Self, GeometryError> {
        let geometry = geometry.into();
        geometry.validate()?;
        let mover =
            Mover { geometry, ground_cosine: Unit::ZERO, step_height: Fx::ZERO, snap_distance: fx!(0.1) };
        Ok(mover.slope_max(Angle::EIGHTH))
    }

    /// Sets the steepest slope that is ground, from level; beyond a quarter turn it is one.
    #[must_use]
    pub fn slope_max(mut self, slope: Angle) -> Self {
        self.ground_cosine = slope.cos().max(Unit::ZERO);
        self
    }

    /// Sets the height in metres of steps that it takes without a jump, 0 to 100.
    #[must_use]
    pub fn step_height(mut self, height: Fx) -> Self {
        self.step_height = height.clamp(Fx::ZERO, HEIGHT_MAX);
        self
    }

    /// Sets how far below itself, in metres, it still follows the ground, 0 to 100: at least the speed for each tick
    /// times the steepest slope down, and the height of steps down.
    #[must_use]
    pub fn snap_distance(mut self, distance: Fx) -> Self {
        self.snap_distance = distance.clamp(Fx::ZERO, HEIGHT_MAX);
        self
    }

    /// Its shape somewhere, for queries.
    #[must_use]
    pub fn probe(&self, position: Vec2<Fx>) -> Probe {
        Probe::of(self.geometry, position)
    }

    fn is_ground(&self, normal: Vec2<Unit>) -> bool {
        normal.y > 0 && normal.y.saturating_add(SLOPE_ROUNDING) >= self.ground_cosine
    }
}

/// Where a character is and how it moves: data that the game keeps, saves and hashes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct MoverState {
    /// Of its geometry's centre, in the world, in metres.
    pub position: Vec2<Fx>,
    /// In m/s.
    pub velocity: Vec2<Fx>,
    /// The ground that it stands on.
    pub ground: Option<MoverPlane>,
}

impl MoverState {
    /// At rest somewhere, in the air.
    #[must_use]
    pub const fn at(position: Vec2<Fx>) -> Self {
        MoverState { position, velocity: Vec2::new(Fx::ZERO, Fx::ZERO), ground: None }
    }

    /// Whether it stands on ground.
    #[must_use]
    pub const fn is_on_ground(&self) -> bool {
        self.ground.is_some()
    }
}

/// What has become of a character within a tick.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Moved {
    /// Where it is now; and the velocity that surfaces have left of its own. Ground takes nothing but a fall.
    pub state: MoverState,
    /// The surfaces that it has met, in the order of the way.
    pub met: Vec<MoverPlane>,
}

impl World {
    /// Moves a character for the length of a tick, at its velocity, through the shapes that a filter sees, as they are
    /// now. Nothing in the world changes: to let the character push or be seen, give it a kinematic body, leave that out
    /// by [`QueryFilter::except`], and send it after by [`World::move_to`].
    ///
    /// Gravity and what moves the ground are the game's: `world.body(..)?.velocity_at(ground.point)` is what to add on a
    /// lift.
    #[must_use]
    pub fn move_character(&self, mover: &Mover, state: &MoverState, filter: QueryFilter) -> Moved {
        let probe = mover.probe(state.position);
        let mut walk =
            Walk { world: self, mover, filter, probe, on_ground: state.is_on_ground(), surfaces: Vec::new() };
        walk.push_out();
        let rate = Fx::from_num(self.state.config.tick_rate);
        let part = |speed: Fx| fx_div(speed, rate).unwrap_or(Fx::ZERO);
        walk.slide(Vec2::new(part(state.velocity.x), part(state.velocity.y)));
        let ground = if state.velocity.y <= Fx::ZERO { walk.ground() } else { None };
        let velocity = walk.velocity_left(state.velocity, ground.is_some());
        Moved {
            state: MoverState { position: walk.probe.position(), velocity, ground },
            met: walk.surfaces.into_iter().map(|(_, plane)| plane).collect(),
        }
    }
}

/// What a surface is to a character.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Surface {
    Ground,
    /// The edge of a step, which it slides up.
    Step,
    /// A slope that is too steep.
    Steep,
    /// A wall or a ceiling.
    Wall,
}

/// A character on its way through a tick.
struct Walk<'a> {
    world: &'a World,
    mover: &'a Mover,
    filter: QueryFilter,
    probe: Probe,
    on_ground: bool,
    surfaces: Vec<(Surface, MoverPlane)>,
}

impl Walk<'_> {
    /// Leaves what has come over the character, as far as nothing is in the way.
    fn push_out(&mut self) {
        for _ in 0..TURNS_MAX {
            let mut planes = self.world.collide_mover(&self.probe, Fx::ZERO, self.filter);
            planes
                .retain(|plane| plane.separation < Fx::ZERO && !self.passes(plane.shape, plane.normal, true));
            if planes.is_empty() {
                return;
            }
            for plane in &mut planes {
                plane.separation = plane.separation.saturating_sub(SKIN);
            }
            let out = solve_planes(Vec2::ZERO, &mut planes);
            let travelled = self.cast(out).map_or(out, |(travelled, _)| travelled);
            if travelled.length() < LEFT_OVER {
                return;
            }
            self.advance(travelled);
        }
    }

    /// Goes along a translation and whatever surfaces leave of it.
    fn slide(&mut self, translation: Vec2<Fx>) {
        let mut left = translation;
        for _ in 0..TURNS_MAX {
            if left.length() < LEFT_OVER {
                return;
            }
            let Some((travelled, plane)) = self.cast(left) else { return self.advance(left) };
            self.advance(travelled);
            left -= travelled;
            let surface = self.surface(&plane);
            self.surfaces.push((surface, plane));
            let n = plane.normal.widen();
            if matches!(surface, Surface::Ground | Surface::Step) {
                self.on_ground = true;
                if left.y <= Fx::ZERO {
                    left = Vec2::new(n.y, -n.x).scale(left.x);
                }
            }
            left = clipped(self.stopped_by_steep(left), self.limits(true));
        }
    }

    /// What is left of a vector when slopes that are too steep are walls: it is not turned up along them.
    fn stopped_by_steep(&self, v: Vec2<Fx>) -> Vec2<Fx> {
        let against = |(surface, plane): &(Surface, MoverPlane)| {
            *surface == Surface::Steep && (plane.normal.x < 0) != (v.x < 0) && plane.normal.x != 0
        };
        if self.surfaces.iter().any(against) { Vec2::new(Fx::ZERO, v.y) } else { v }
    }

    /// The normals against which a movement ends, or a velocity, which ground does not take.
    fn limits(&self, ground_too: bool) -> impl Iterator<Item = Vec2<Unit>> + Clone {
        self.surfaces.iter().flat_map(move |(surface, plane)| {
            let wall = if plane.normal.x < 0 { -Vec2::X } else { Vec2::X };
            let (own, upright) = match surface {
                Surface::Ground | Surface::Step => (ground_too.then_some(plane.normal), None),
                Surface::Steep => (Some(plane.normal), Some(wall)),
                Surface::Wall => (Some(plane.normal), None),
            };
            own.into_iter().chain(upright)
        })
    }

    /// What surfaces have left of a velocity.
    fn velocity_left(&self, velocity: Vec2<Fx>, lands: bool) -> Vec2<Fx> {
        let left = clipped(self.stopped_by_steep(velocity), self.limits(false));
        if lands { Vec2::new(left.x, left.y.max(Fx::ZERO)) } else { left }
    }

    /// The ground below, to which a character that has been on it goes down.
    fn ground(&mut self) -> Option<MoverPlane> {
        if !self.on_ground {
            return None;
        }
        if let Some((Surface::Step, plane)) = self.surfaces.last() {
            return Some(*plane);
        }
        let down = Vec2::new(Fx::ZERO, -self.mover.snap_distance.max(SKIN + SKIN));
        let (travelled, plane) = self.cast(down)?;
        let stands = matches!(self.surface(&plane), Surface::Ground | Surface::Step);
        if stands {
            self.advance(travelled);
        }
        stands.then_some(plane)
    }

    fn surface(&self, plane: &MoverPlane) -> Surface {
        if self.mover.is_ground(plane.normal) {
            Surface::Ground
        } else if self.on_ground && self.is_step(plane) {
            Surface::Step
        } else if plane.normal.y > 0 {
            Surface::Steep
        } else {
            Surface::Wall
        }
    }

    /// Whether there is ground just behind a surface, higher than the feet but not by more than a step.
    fn is_step(&self, plane: &MoverPlane) -> bool {
        let Vec2 { x, y } = plane.normal;
        // A ceiling is none, but the normal of a wall may be rounded downwards.
        if y < -SLOPE_ROUNDING || x == 0 || self.mover.step_height == Fx::ZERO {
            return false;
        }
        let feet = self.probe.posed().bounds.lower.y;
        let onwards = if x < 0 { STEP_DEPTH } else { -STEP_DEPTH };
        let top = feet.saturating_add(self.mover.step_height);
        let above = Vec2::new(plane.point.x.saturating_add(onwards), top);
        let here = Vec2::new(self.probe.position().x, top);
        if self.world.cast_ray_any(here, above - here, self.filter) {
            return false;
        }
        let down = Vec2::new(Fx::ZERO, SKIN + SKIN - self.mover.step_height);
        let found = self.world.cast_ray(above, down, self.filter);
        found.is_some_and(|hit| self.mover.is_ground(hit.normal))
    }

    /// How far the character gets, and what is there.
    fn cast(&self, translation: Vec2<Fx>) -> Option<(Vec2<Fx>, MoverPlane)> {
        let stops = |shape, normal, [other, own]: [&Core; 2]| {
            !self.passes(shape, normal, distance(other, own).distance < Fx::ZERO)
        };
        let hit = self.world.first_along(&self.probe, translation, self.filter, stops)?;
        let (push_limit, push) = (Fx::MAX, Fx::ZERO);
        let (shape, normal, separation, point) = (hit.shape, hit.normal, SKIN, hit.point);
        Some((hit.travelled, MoverPlane { shape, normal, separation, point, push_limit, push }))
    }

    fn advance(&mut self, by: Vec2<Fx>) {
        self.probe = self.probe.at(self.probe.position() + by);
    }

    /// Whether the character goes through a shape that is solid from one side, on which it is not; which it is not
    /// either before it has left it.
    fn passes(&self, id: ShapeId, normal: Vec2<Unit>, overlaps: bool) -> bool {
        let Some(shape) = self.world.shape(id) else { return true };
        let one_sided = matches!(shape.geometry(), Geometry::Link { sides: Sides::Right, .. });
        let leaves = shape.one_way().zip(self.world.body(shape.body())).map(|(direction, body)| {
            let upright: Unit = Rot::from_angle(body.angle() + direction).apply(Vec2::X).dot(normal);
            upright < Unit::lit("0.5")
        });
        overlaps && (one_sided || leaves.is_some()) || leaves == Some(true)
    }
}
