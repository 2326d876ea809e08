//! Characters: shapes that a game moves by its own rules instead of forces, and that slide along the surfaces they
//! meet.
//!
//! A move is a cast. At a hit the rest of the translation is deflected along the surface and cast again, until nothing
//! is left. Casts are exact and stop 0.1 mm before they touch, so that a character never enters a shape. Planes, as in
//! Box2D's `b2SolvePlanes`, are used only to push the character out of shapes that have moved over it: sliding along
//! planes instead of casting would stop it at corners that it just misses.
//!
//! Ground and wall differ by the slope alone. On ground a character stands without sliding, and walks at the same speed
//! as on level ground. Along any other surface it slides, and never upwards.

use alloc::vec::Vec;

use serde::{Deserialize, Serialize};

use super::mover_planes::{MoverPlane, clipped, solve_planes};
use super::{Probe, QueryFilter};
use crate::body::{Geometry, GeometryError, ShapeId, Sides};
use crate::collision::{SKIN, SupportShape, distance};
use crate::fx;
use crate::math::{Angle, Fx, Rot, Unit, Vec2, fx_div};
use crate::world::World;

/// Largest number of deflections in a tick, and of attempts to push a character out of overlaps.
const TURNS_MAX: u32 = 8;

/// Translations shorter than this, in metres, are dropped.
const LEFT_OVER: Fx = fx!(0.000001);

/// Tolerance on the cosine of the steepest ground, for the rounding of normals and the 0.1 mm gap of casts.
const SLOPE_ROUNDING: Unit = Unit::lit("0.0005");

/// Distance in metres behind the edge of a step at which there has to be ground.
const STEP_DEPTH: Fx = fx!(0.02);

/// Largest step height and snap distance in metres.
const HEIGHT_MAX: Fx = fx!(100);

/// Geometry and abilities of a character. It is upright, and `y` is up.
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
#[doc(alias = "character controller")]
#[derive(Clone, Copy, Debug)]
pub struct Mover {
    geometry: Geometry,
    /// Cosine of the steepest slope that is ground.
    ground_cosine: Unit,
    step_height: Fx,
    snap_distance: Fx,
}

impl Mover {
    /// A character that stands on slopes up to 45 degrees, climbs no steps, and follows ground that falls by up to 0.1
    /// m in a tick.
    ///
    /// # Errors
    /// [`GeometryError`] if the size of the geometry is out of range.
    pub fn new(geometry: impl Into<Geometry>) -> Result<Self, GeometryError> {
        let geometry = geometry.into();
        geometry.validate()?;
        let mover =
            Mover { geometry, ground_cosine: Unit::ZERO, step_height: Fx::ZERO, snap_distance: fx!(0.1) };
        Ok(mover.slope_max(Angle::EIGHTH))
    }

    /// Sets the steepest slope that is ground, measured from level. Angles above 90 degrees count as 90 degrees.
    #[must_use]
    pub fn slope_max(mut self, slope: Angle) -> Self {
        self.ground_cosine = slope.cos().max(Unit::ZERO);
        self
    }

    /// Sets the height in metres of steps that it climbs without a jump, clamped to 0 to 100.
    #[must_use]
    pub fn step_height(mut self, height: Fx) -> Self {
        self.step_height = height.clamp(Fx::ZERO, HEIGHT_MAX);
        self
    }

    /// Sets the distance in metres by which the ground may fall within a tick while the character still follows it,
    /// clamped to 0 to 100. It should be at least the distance per tick times the steepest slope, and the height of
    /// steps down.
    #[must_use]
    pub fn snap_distance(mut self, distance: Fx) -> Self {
        self.snap_distance = distance.clamp(Fx::ZERO, HEIGHT_MAX);
        self
    }

    /// Its geometry at a position in the world, in metres, for queries.
    #[must_use]
    pub fn probe(&self, position: Vec2<Fx>) -> Probe {
        Probe::of(self.geometry, position)
    }

    fn is_ground(&self, normal: Vec2<Unit>) -> bool {
        normal.y > 0 && normal.y.saturating_add(SLOPE_ROUNDING) >= self.ground_cosine
    }
}

/// Position, velocity and ground of a character: data that the game stores, saves and hashes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct MoverState {
    /// Position of its geometry's centre in the world, in metres.
    pub position: Vec2<Fx>,
    /// Velocity in m/s.
    pub velocity: Vec2<Fx>,
    /// The ground that it stands on, if any.
    pub ground: Option<MoverPlane>,
}

impl MoverState {
    /// A character at rest in the air.
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

/// Result of a character's move.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Moved {
    /// The new state. Its velocity is what the surfaces have left of the old one; ground only stops a fall.
    pub state: MoverState,
    /// The surfaces that the character has met, in order.
    pub met: Vec<MoverPlane>,
}

impl World {
    /// Moves a character for one tick at its velocity, among the shapes that a filter sees at their current poses. The
    /// world does not change. To let the character push bodies or be seen by queries, give it a kinematic body, leave
    /// that body out by [`QueryFilter::except`], and let it follow by [`World::move_to`].
    ///
    /// The game adds gravity and the velocity of moving ground, which is `world.body(..)?.velocity_at(ground.point)`.
    #[must_use]
    #[doc(alias = "move_and_slide")]
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

/// Kind of a surface for a character.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Surface {
    Ground,
    /// The edge of a step, which the character slides up.
    Step,
    /// A slope that is too steep to stand on.
    Steep,
    /// A wall or a ceiling.
    Wall,
}

/// A move in progress.
struct Walk<'a> {
    world: &'a World,
    mover: &'a Mover,
    filter: QueryFilter,
    probe: Probe,
    on_ground: bool,
    surfaces: Vec<(Surface, MoverPlane)>,
}

impl Walk<'_> {
    /// Moves the character out of shapes that overlap it, as far as nothing is in the way.
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

    /// Moves along a translation, deflected by the surfaces that are met.
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

    /// Removes the horizontal component of a vector that points into a slope that is too steep, so that it is not
    /// deflected upwards.
    fn stopped_by_steep(&self, v: Vec2<Fx>) -> Vec2<Fx> {
        let against = |(surface, plane): &(Surface, MoverPlane)| {
            *surface == Surface::Steep && (plane.normal.x < 0) != (v.x < 0) && plane.normal.x != 0
        };
        if self.surfaces.iter().any(against) { Vec2::new(Fx::ZERO, v.y) } else { v }
    }

    /// The normals that limit a translation, with ground, or a velocity, without ground.
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

    /// The velocity that the surfaces leave over.
    fn velocity_left(&self, velocity: Vec2<Fx>, lands: bool) -> Vec2<Fx> {
        let left = clipped(self.stopped_by_steep(velocity), self.limits(false));
        if lands { Vec2::new(left.x, left.y.max(Fx::ZERO)) } else { left }
    }

    /// Finds the ground below a character that was on ground, and moves down to it.
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

    /// Whether there is ground just behind a surface, above the feet by at most the step height.
    fn is_step(&self, plane: &MoverPlane) -> bool {
        let Vec2 { x, y } = plane.normal;
        // A ceiling is no step, but the normal of a wall may be rounded downwards.
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

    /// Casts the character along a translation. Returns the displacement up to the first hit, and the surface there.
    fn cast(&self, translation: Vec2<Fx>) -> Option<(Vec2<Fx>, MoverPlane)> {
        let stops = |shape, normal, [other, own]: [&SupportShape; 2]| {
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

    /// Whether the character passes through a shape that is solid from one side only: it is on the other side, or still
    /// overlaps the shape.
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
