//! Characters: shapes that a game moves by its own rules, and that slide along the surfaces they meet.
//!
//! A move is a cast. At a hit, the rest of the translation is deflected along the surface, and is cast again. Casts
//! stop 0.1 mm before they touch, so that walking does not move a character into a shape. Planes, as in Box2D's
//! `b2SolvePlanes`, push the character out of shapes that have moved over it. They are not used for moves, because a
//! character that slides along planes stops at corners that it would just miss.
//!
//! The slope distinguishes ground from walls. On ground a character stands without sliding, and walks at the same speed
//! at any slope. Along other surfaces it slides without being deflected upwards. If it walks into a wall, the rest of
//! the walk is dropped.
//!
//! A character stores the pose that the body of its ground had at the last move. The next move first displaces the
//! character by as much as the point under its feet has moved since then. The velocity of the body would not be
//! sufficient: it is 0 after [`World::move_to`], and does not give the displacement of a platform that turns or stops.
//! A character that leaves its ground takes the velocity of the body along. If the velocity of a kinematic body is 0,
//! the character takes the body's displacement since the last move instead, as if it were the displacement in one tick.
//! The velocity of such a body is therefore known only in the move after a landing.

use alloc::vec::Vec;

use serde::{Deserialize, Serialize};

use super::mover_planes::MoverPlane;
use super::walk::Walk;
use super::{Probe, QueryFilter};
use crate::body::{Geometry, GeometryError, ShapeId};
use crate::fx;
use crate::math::{Angle, Fx, Unit, Vec2, fx_div};
use crate::world::World;

/// Tolerance for comparisons with the cosine of the steepest slope that is ground. It allows for the rounding of
/// normals and for the 0.1 mm gap of casts.
pub(super) const SLOPE_ROUNDING: Unit = Unit::lit("0.0005");

/// Largest step height and snap distance in metres.
const HEIGHT_MAX: Fx = fx!(100);

/// Geometry and abilities of a character. The character is upright, and `y` is up.
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
    /// A character that stands on slopes up to 45 degrees, climbs no steps, and follows ground down by 0.1 m in a tick.
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

    /// Sets the steepest slope that is ground, measured from level. Angles from 90 to 270 degrees count as 90 degrees.
    #[must_use]
    pub fn slope_max(mut self, slope: Angle) -> Self {
        self.ground_cosine = slope.cos().max(Unit::ZERO);
        self
    }

    /// Sets the largest height, in metres, of steps that the character climbs without a jump. Clamped to between 0 and
    /// 100 m.
    #[must_use]
    pub fn step_height(mut self, height: Fx) -> Self {
        self.step_height = height.clamp(Fx::ZERO, HEIGHT_MAX);
        self
    }

    /// Sets the largest drop of the ground, in metres, that the character follows within a tick. Clamped to between 0
    /// and 100 m. The distance should be at least the distance walked per tick times the tangent of the steepest slope,
    /// and at least the height of steps to walk down.
    #[must_use]
    pub fn snap_distance(mut self, distance: Fx) -> Self {
        self.snap_distance = distance.clamp(Fx::ZERO, HEIGHT_MAX);
        self
    }

    /// Returns the geometry with its origin at a position in the world, in metres.
    #[must_use]
    pub fn probe(&self, position: impl Into<Vec2<Fx>>) -> Probe {
        let position = position.into();
        Probe::of(self.geometry, position)
    }

    pub(super) fn step_max(&self) -> Fx {
        self.step_height
    }

    pub(super) fn snap_max(&self) -> Fx {
        self.snap_distance
    }

    pub(super) fn is_ground(&self, normal: Vec2<Unit>) -> bool {
        normal.y > 0 && normal.y.saturating_add(SLOPE_ROUNDING) >= self.ground_cosine
    }
}

/// State of a character, which the game stores, saves and hashes.
///
/// ```
/// # use lockstep2d::{body::{BodyDef, Geometry, Polygon, ShapeDef}, world::World};
/// use lockstep2d::world::{Mover, MoverState};
/// use lockstep2d::{codec, fx, math::Vec2};
/// # let mut world = World::default();
/// # let floor = ShapeDef::new(Polygon::rectangle(fx!(50), fx!(1))?);
/// # world.spawn(&BodyDef::fixed().position((fx!(0), fx!(-1))), &[floor])?;
/// # let mover = Mover::new(Geometry::capsule((fx!(0), fx!(0.3)), (fx!(0), fx!(1.5)), fx!(0.3))?)?;
/// let start = MoverState { velocity: Vec2::new(fx!(0), fx!(-1)), ..MoverState::at(Vec2::ZERO) };
/// let mut player = world.move_character(&mover, &start, Default::default()).state;
/// // The player jumps only from ground.
/// if player.is_on_ground() {
///     player.velocity.y = fx!(5);
/// }
/// let player = world.move_character(&mover, &player, Default::default()).state;
/// assert!(!player.is_on_ground() && player.position.y > fx!(0));
/// // The game saves it together with the world.
/// assert_eq!(codec::decode(&codec::encode(&player)), Ok(player));
/// # Ok::<(), lockstep2d::body::WorldError>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct MoverState {
    /// Position in the world, in metres, of the origin of the geometry's coordinates. For a geometry whose lowest point
    /// is (0, 0), that is the position of the feet.
    pub position: Vec2<Fx>,
    /// Velocity in m/s: relative to the ground while the character stands on ground, otherwise in the world. A
    /// character that leaves the ground takes the velocity of the ground with it.
    pub velocity: Vec2<Fx>,
    /// The ground that the character stands on, if any.
    pub ground: Option<MoverPlane>,
    /// Whether the last move brought the character from the air onto ground. The next move then makes `velocity.x`
    /// relative to ground that [`World::move_to`] moves, because the velocity of such ground is not known before.
    pub has_landed: bool,
    /// Shapes that are solid from one side, and that the character overlaps. It passes through them until it has left
    /// them. All links of a chain share one entry. If the list is full, the character passes through all such shapes
    /// that it overlaps.
    pub passing: [Option<ShapeId>; MoverState::PASSING_MAX],
}

impl MoverState {
    /// Largest number of entries in [`MoverState::passing`].
    pub const PASSING_MAX: usize = 8;

    /// A character at rest in the air.
    #[must_use]
    pub const fn at(position: Vec2<Fx>) -> Self {
        let velocity = Vec2::new(Fx::ZERO, Fx::ZERO);
        let passing = [None; Self::PASSING_MAX];
        MoverState { position, velocity, ground: None, has_landed: false, passing }
    }

    /// Whether the character stands on ground.
    #[must_use]
    pub const fn is_on_ground(&self) -> bool {
        self.ground.is_some()
    }
}

/// Result of a character's move.
///
/// ```
/// # use lockstep2d::{body::{BodyDef, Geometry, Polygon, ShapeDef}, world::World};
/// use lockstep2d::world::{Moved, Mover, MoverState};
/// use lockstep2d::{fx, math::Vec2};
/// # let mut world = World::default();
/// # let mover = Mover::new(Geometry::capsule((fx!(0), fx!(0.3)), (fx!(0), fx!(1.5)), fx!(0.3))?)?;
/// let wall = ShapeDef::new(Polygon::rectangle(fx!(0.5), fx!(3))?);
/// let wall = world.spawn(&BodyDef::fixed().position((fx!(1), fx!(0))), &[wall])?;
/// let running = MoverState { velocity: Vec2::new(fx!(30), fx!(0)), ..MoverState::at(Vec2::ZERO) };
/// // It runs into a wall. `met` has the surfaces that it touched.
/// let Moved { state, met } = world.move_character(&mover, &running, Default::default());
/// assert!(met.iter().any(|plane| plane.body == wall && plane.normal == -Vec2::X));
/// assert_eq!(state.velocity.x, fx!(0));
/// # Ok::<(), lockstep2d::body::WorldError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Moved {
    /// The new state.
    pub state: MoverState,
    /// The surfaces that the character has met, in order.
    pub met: Vec<MoverPlane>,
}

impl Moved {
    /// Whether the character hangs between two slopes that are both too steep to stand on. It is then not on ground,
    /// but a game should allow it to jump.
    #[must_use]
    pub fn is_wedged(&self) -> bool {
        let leans = |left: bool| {
            let steep = |plane: &MoverPlane| plane.normal.y > SLOPE_ROUNDING && (plane.normal.x < 0) == left;
            self.met.iter().any(steep)
        };
        !self.state.is_on_ground() && leans(true) && leans(false)
    }
}

impl World {
    /// Moves a character for one tick at its velocity, among the shapes that a filter sees. The world does not change.
    /// To let sensors, queries and other bodies notice the character, give it a kinematic body, leave that body out by
    /// [`QueryFilter::except`], and let it follow by [`World::move_to`]. Bodies that the filter sees stop the
    /// character, even if they are light, so the character's kinematic body does not touch and push them. To push them,
    /// apply impulses to the bodies in [`Moved::met`], or leave their category out of the filter's mask.
    ///
    /// The game adds gravity. The ground carries the character by the movement of its body since the last move, and by
    /// the surface speed of a belt. Call this after each [`World::step`]. Otherwise the character lags behind its lift,
    /// and is too fast when it leaves a body that [`World::move_to`] moves: the displacement in several ticks counts as
    /// the displacement in one tick.
    ///
    /// ```
    /// use lockstep2d::body::{BodyDef, Geometry, Polygon, ShapeDef};
    /// use lockstep2d::world::{Mover, MoverState, QueryFilter, World};
    /// use lockstep2d::{fx, math::Vec2};
    /// let mut world = World::default();
    /// let plate = ShapeDef::new(Polygon::rectangle(fx!(2), fx!(0.5))?);
    /// let lift = BodyDef::kinematic().velocity((fx!(1), fx!(2)));
    /// world.spawn(&lift, &[plate])?;
    /// let mover = Mover::new(Geometry::circle(fx!(0.5))?)?;
    /// let mut player = MoverState::at(Vec2::new(fx!(0), fx!(1.01)));
    /// for _ in 0..60 {
    ///     world.step();
    ///     player.velocity.y -= fx!(1 / 6);
    ///     player = world.move_character(&mover, &player, QueryFilter::default()).state;
    /// }
    /// assert!(player.is_on_ground() && (player.position.y - fx!(3)).abs() < fx!(0.001));
    /// assert_eq!(player.velocity.y, fx!(0));
    /// # Ok::<(), lockstep2d::body::WorldError>(())
    /// ```
    #[must_use]
    #[doc(alias = "move_and_slide")]
    #[doc(alias = "moving platform")]
    pub fn move_character(&self, mover: &Mover, state: &MoverState, filter: QueryFilter) -> Moved {
        let mut walk = Walk::new(self, mover, state, filter);
        let carried = state.ground.and_then(|ground| walk.carry(&ground));
        walk.push_out();
        walk.walk();
        let ground = walk.ground(carried);
        let velocity = walk.velocity_left(ground.as_ref(), carried);
        let has_landed = !state.is_on_ground() && ground.is_some();
        let (position, passing) = (walk.position(), walk.passing());
        Moved { state: MoverState { position, velocity, ground, has_landed, passing }, met: walk.met() }
    }
}

/// Converts a velocity in m/s to the displacement in a tick, in metres.
pub(super) fn in_tick(world: &World, velocity: Vec2<Fx>) -> Vec2<Fx> {
    let rate = Fx::from_num(world.state.config.tick_rate);
    let part = |speed: Fx| fx_div(speed, rate).unwrap_or(Fx::ZERO);
    Vec2::new(part(velocity.x), part(velocity.y))
}
