//! A character's move in a tick: it is carried by its ground, pushed out of shapes, moved along its velocity, and put
//! down on the ground.

use alloc::vec::Vec;

use super::character::{Mover, MoverState, in_tick};
use super::mover_planes::{MoverPlane, along_surface, clipped, solve_planes};
use super::seam::Rest;
use super::step_edge::Surface;
use super::{InitialOverlap, Probe, QueryFilter};
use crate::body::{BodyId, BodyKind, Handle, ShapeId};
use crate::collision::{SKIN, SupportShape, distance};
use crate::fx;
use crate::math::{Fx, Rot, Unit, Vec2};
use crate::world::World;

/// Largest number of casts in one stage of a move: carrying the character, pushing it out, sliding, or snapping to the
/// ground.
const TURNS_MAX: u32 = 8;

/// Length in metres below which the rest of a translation is dropped.
const LEFT_OVER: Fx = fx!(0.000001);

/// Largest distance in metres between a character and ground on which it stands: the gap of casts and its rounding.
const STANDING: Fx = fx!(0.000105);

/// Largest ratio of a push to the deepest overlap. Out of a flat wedge, the character would have to move further to the
/// side. It therefore stays where it is and is crushed: in a wedge of less than 15 degrees if one of the sides overlaps
/// it, and of less than 29 degrees if both do.
const PUSH_MAX: i64 = 4;

/// Effect on a cast of the shapes that overlap the character.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Overlaps {
    /// An overlapping shape stops a cast that would move deeper into it.
    Stop,
    /// Shapes of fixed bodies stop a cast that goes deeper. Other overlapping shapes, such as the next car of a train,
    /// let the cast pass. They have moved over the character, and push it out after it has been carried.
    Pass,
}

/// A body that carries the character, and the velocity of this body under the character's feet in m/s.
#[derive(Clone, Copy)]
pub(super) struct Carrier {
    body: BodyId,
    velocity: Vec2<Fx>,
}

pub(super) struct Walk<'a> {
    pub(super) world: &'a World,
    pub(super) mover: &'a Mover,
    pub(super) filter: QueryFilter,
    /// The state at the start of the move.
    pub(super) from: MoverState,
    pub(super) probe: Probe,
    pub(super) on_ground: bool,
    /// Normal of the ground that the character walks along.
    along: Option<Vec2<Unit>>,
    /// Height in metres gained by walking.
    climbed: Fx,
    /// Largest upward speed in m/s at which ground has pushed the character.
    lifted: Fx,
    surfaces: Vec<(Surface, MoverPlane)>,
}

impl<'a> Walk<'a> {
    pub(super) fn new(world: &'a World, mover: &'a Mover, from: &MoverState, filter: QueryFilter) -> Self {
        Walk {
            world,
            mover,
            filter: filter.initial_overlap(InitialOverlap::Resist),
            from: *from,
            probe: mover.probe(from.position),
            on_ground: from.is_on_ground(),
            along: None,
            climbed: Fx::ZERO,
            lifted: Fx::ZERO,
            surfaces: Vec::new(),
        }
    }

    pub(super) fn position(&self) -> Vec2<Fx> {
        self.probe.position()
    }

    pub(super) fn met(self) -> Vec<MoverPlane> {
        self.surfaces.into_iter().map(|(_, plane)| plane).collect()
    }

    /// Moves the character by as much as the point of its ground under its feet has moved since the last move. Shapes
    /// of other bodies deflect this movement. Returns `None` if the body of the ground no longer exists or is disabled.
    pub(super) fn carry(&mut self, ground: &MoverPlane) -> Option<Carrier> {
        let body = self.world.body(ground.body).filter(|body| body.is_enabled())?;
        let turned = body.angle() - ground.body_angle;
        let arm = ground.point - ground.body_position;
        let arm_now = Rot::from_angle(turned).apply_wide(arm);
        let by = if turned.to_bits() == 0 {
            body.position() - ground.body_position
        } else {
            body.position() + arm_now - ground.point
        };
        self.ride(by, ground.body);
        // The velocity of the body is preferred, because its displacement may cover several ticks or a teleport. If the
        // velocity of a kinematic body is 0, the displacement counts as the displacement in one tick. This is meant for
        // a body moved by `World::move_to`, but also applies to a body at rest that `World::set_transform` has placed
        // elsewhere.
        let mut velocity = body.velocity_at(ground.point);
        if velocity == Vec2::ZERO && body.kind() == BodyKind::Kinematic {
            let rate = i64::from(self.world.state.config.tick_rate);
            velocity = Vec2::new(by.x.saturating_mul_int(rate), by.y.saturating_mul_int(rate));
            // When the character landed, the velocity of such a body was unknown, so the character's velocity is made
            // relative to it only now.
            if self.from.has_landed {
                self.from.velocity.x = taken_along(self.from.velocity.x, velocity.x);
            }
        }
        Some(Carrier { body: ground.body, velocity })
    }

    fn ride(&mut self, translation: Vec2<Fx>, carrier: BodyId) {
        let mut left = translation;
        let mut normals: Vec<Vec2<Unit>> = Vec::new();
        for _ in 0..TURNS_MAX {
            if left == Vec2::ZERO {
                return;
            }
            let hit = self.cast_among(&self.probe, left, Overlaps::Pass, Some(carrier));
            let Some((travelled, plane)) = hit else { return self.advance(left) };
            self.advance(travelled);
            normals.push(plane.normal);
            // A slope that is too steep to stand on does not deflect a rider upwards.
            if plane.normal.y > 0 && !self.mover.is_ground(plane.normal) {
                normals.push(upright(plane.normal));
            }
            left = clipped(left - travelled, normals.iter().copied());
        }
    }

    /// Moves the character out of overlapping shapes. Surfaces that it meets deflect it: a box pushes it along the
    /// floor or up a ramp. A character that other shapes hold fast stays where it is.
    pub(super) fn push_out(&mut self) {
        let rate = i64::from(self.world.state.config.tick_rate);
        let mut met: Vec<MoverPlane> = Vec::new();
        for _ in 0..TURNS_MAX {
            let mut planes = self.world.collide_mover(&self.probe, Fx::ZERO, self.filter);
            planes.retain(|plane| {
                plane.separation < Fx::ZERO && !self.passes(plane.shape, plane.normal, plane.separation)
            });
            let mut deepest = Fx::ZERO;
            for plane in &mut planes {
                if self.mover.is_ground(plane.normal) {
                    self.on_ground = true;
                    let speed = plane.separation.saturating_mul_int(-rate);
                    self.lifted = self.lifted.max(plane.normal.widen().scale(speed).y);
                }
                plane.separation = plane.separation.saturating_sub(SKIN);
                deepest = deepest.min(plane.separation);
            }
            if planes.is_empty() {
                return;
            }
            planes.extend_from_slice(&met);
            let out = solve_planes(Vec2::ZERO, &mut planes);
            if !(LEFT_OVER..=deepest.saturating_mul_int(-PUSH_MAX)).contains(&out.length()) {
                return;
            }
            let hit = self.cast(out);
            let travelled = hit.map_or(out, |(travelled, _)| travelled);
            self.advance(travelled);
            for plane in &mut met {
                plane.separation = plane.height(travelled);
            }
            // The cast has stopped about [`SKIN`] before this surface. Separations here are measured from that gap, so
            // this one is 0.
            met.extend(hit.map(|(_, plane)| MoverPlane { separation: Fx::ZERO, ..plane }));
        }
    }

    /// Moves the character at its own velocity plus the surface speed of a belt: along the ground, or freely.
    pub(super) fn walk(&mut self) {
        let translation = in_tick(self.world, self.from.velocity);
        let Some(ground) = self.from.ground else { return self.slide(translation) };
        let belt = Vec2::new(self.belt(&ground), Fx::ZERO);
        let belt = in_tick(self.world, belt).x;
        if self.rises() || !self.mover.is_ground(ground.normal) {
            return self.slide(translation + along_surface(ground.normal, belt));
        }
        let start = self.position().y;
        self.along = Some(ground.normal);
        self.slide(along_surface(ground.normal, translation.x.saturating_add(belt)));
        self.climbed = (self.position().y - start).max(Fx::ZERO);
    }

    /// Puts the character down on the ground, if it was on ground or has met ground in this move. A character that has
    /// walked off the ground falls.
    pub(super) fn ground(&mut self, carrier: Option<Carrier>) -> Option<MoverPlane> {
        let walked = self.along.is_some();
        let found = self.find_ground().filter(|plane| !self.leaves(plane));
        // If the character was in the air, it has already moved by the vertical part of its velocity.
        if found.is_none() && walked && self.from.is_on_ground() {
            self.along = None;
            self.slide(Vec2::new(Fx::ZERO, in_tick(self.world, self.from.velocity).y));
        }
        found.map(|mut plane| {
            if let Some(carrier) = carrier.filter(|carrier| carrier.body == plane.body) {
                plane.velocity = carrier.velocity + along_surface(plane.normal, self.belt(&plane));
            }
            plane
        })
    }

    /// The part of the velocity that surfaces do not stop, relative to the ground if there is one.
    pub(super) fn velocity_left(&self, ground: Option<&MoverPlane>, carrier: Option<Carrier>) -> Vec2<Fx> {
        let left = clipped(self.stopped_by_steep(self.from.velocity), self.limits(false));
        match (&self.from.ground, ground) {
            (Some(_), Some(_)) => Vec2::new(left.x, left.y.max(Fx::ZERO)),
            (None, Some(new)) => Vec2::new(taken_along(left.x, new.velocity.x), Fx::ZERO),
            (Some(old), None) => {
                let belt = along_surface(old.normal, self.belt(old));
                left + carrier.map_or(old.velocity, |carrier| carrier.velocity + belt)
            }
            (None, None) => left,
        }
    }

    fn rises(&self) -> bool {
        self.from.velocity.y > Fx::ZERO
    }

    fn leaves(&self, plane: &MoverPlane) -> bool {
        let ground = if self.from.is_on_ground() { Fx::ZERO } else { plane.velocity.y.max(self.lifted) };
        self.from.velocity.y > ground
    }

    /// Surface speed of a plane in m/s; 0 if the shape was removed.
    fn belt(&self, plane: &MoverPlane) -> Fx {
        self.world.shape(plane.shape).map_or(Fx::ZERO, |shape| shape.material().surface_speed)
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
            let n = plane.normal;
            match surface {
                Surface::Ground | Surface::Step => {
                    self.on_ground = true;
                    if !self.rises() {
                        // A walk covers the same distance at any slope.
                        let length =
                            self.along.map_or(left.x, |normal| along_surface(normal, Fx::ONE).dot(left));
                        left = along_surface(n, length);
                        self.along = Some(n);
                    }
                }
                // A wall does not deflect a walking character upwards.
                Surface::Steep | Surface::Wall if self.on_ground && !self.rises() => {
                    if (n.x < 0) == (left.x > 0) && n.x != 0 {
                        left = Vec2::new(Fx::ZERO, left.y.min(Fx::ZERO));
                    }
                }
                Surface::Steep | Surface::Wall => {}
            }
            left = clipped(self.stopped_by_steep(left), self.limits(true));
        }
    }

    /// If a vector points into a steep slope, removes its horizontal component. Otherwise the slope would deflect the
    /// vector upwards.
    fn stopped_by_steep(&self, v: Vec2<Fx>) -> Vec2<Fx> {
        let against = |(surface, plane): &(Surface, MoverPlane)| {
            *surface == Surface::Steep && (plane.normal.x < 0) != (v.x < 0) && plane.normal.x != 0
        };
        if self.surfaces.iter().any(against) { Vec2::new(Fx::ZERO, v.y) } else { v }
    }

    /// Normals of the surfaces that limit a translation (if `ground_too`) or a velocity (if not). While the character
    /// walks, the ground along which it walks is the only ground among these surfaces.
    fn limits(&self, ground_too: bool) -> impl Iterator<Item = Vec2<Unit>> + Clone {
        let all_ground = ground_too && self.along.is_none();
        let walls = self.surfaces.iter().flat_map(move |(surface, plane)| {
            let (own, wall) = match surface {
                Surface::Ground | Surface::Step => (all_ground.then_some(plane.normal), None),
                Surface::Steep => (Some(plane.normal), Some(upright(plane.normal))),
                Surface::Wall => (Some(plane.normal), None),
            };
            own.into_iter().chain(wall)
        });
        walls.chain(self.along.filter(|_| ground_too))
    }

    fn find_ground(&mut self) -> Option<MoverPlane> {
        if !self.on_ground || self.from.is_on_ground() && self.rises() {
            return None;
        }
        if let Some((Surface::Step, plane)) = self.surfaces.last() {
            return Some(*plane);
        }
        self.standing().or_else(|| self.snap())
    }

    /// The most level ground that the character touches.
    fn standing(&self) -> Option<MoverPlane> {
        let mut planes = self.world.collide_mover(&self.probe, STANDING, self.filter);
        planes.retain(|plane| !self.passes(plane.shape, plane.normal, plane.separation));
        let of_kind = |kind| planes.iter().filter(move |plane| self.surface(plane) == kind);
        let most_level = of_kind(Surface::Ground).max_by_key(|plane| plane.normal.y);
        most_level.or_else(|| of_kind(Surface::Step).next()).copied()
    }

    /// Moves down to ground within the snap distance plus the height climbed in this walk, sliding along other
    /// surfaces. Without ground the character stays where it is.
    fn snap(&mut self) -> Option<MoverPlane> {
        let start = self.probe;
        let reach = self.mover.snap_max().saturating_add(self.climbed).max(SKIN + SKIN);
        let mut left = Vec2::new(Fx::ZERO, -reach);
        let mut normals: Vec<Vec2<Unit>> = Vec::new();
        for _ in 0..TURNS_MAX {
            let Some((travelled, plane)) = self.cast(left) else { break };
            self.advance(travelled);
            if matches!(self.surface(&plane), Surface::Ground | Surface::Step) {
                return Some(plane);
            }
            normals.push(plane.normal);
            left = clipped(left - travelled, normals.iter().copied());
            if left.length() < LEFT_OVER {
                break;
            }
        }
        self.probe = start;
        None
    }

    /// Casts the character. Returns the displacement up to the first hit, and the surface there.
    fn cast(&self, translation: Vec2<Fx>) -> Option<(Vec2<Fx>, MoverPlane)> {
        self.cast_among(&self.probe, translation, Overlaps::Stop, None)
    }

    pub(super) fn cast_from(&self, probe: &Probe, translation: Vec2<Fx>) -> Option<(Vec2<Fx>, MoverPlane)> {
        self.cast_among(probe, translation, Overlaps::Stop, None)
    }

    fn cast_among(
        &self,
        probe: &Probe,
        translation: Vec2<Fx>,
        overlaps: Overlaps,
        without: Option<BodyId>,
    ) -> Option<(Vec2<Fx>, MoverPlane)> {
        let stops = |shape: ShapeId, normal, [other, own]: [&SupportShape; 2]| {
            let separation = distance(other, own).distance;
            let body = self.world.state.body_of(shape.slot());
            let moved_over =
                overlaps == Overlaps::Pass && separation < Fx::ZERO && body.kind() != BodyKind::Fixed;
            !moved_over
                && without != self.world.shape(shape).map(|shape| shape.body())
                && !self.passes(shape, normal, separation)
        };
        let hit = self.world.first_along(probe, translation, self.filter, Rest::CHARACTER, stops)?;
        Some((hit.travelled, self.world.mover_plane(hit.shape, hit.normal, SKIN, hit.point)))
    }

    fn advance(&mut self, by: Vec2<Fx>) {
        self.probe = self.probe.at(self.probe.position() + by);
    }
}

/// Normal of an upright wall that faces to the same side as a slope.
fn upright(slope: Vec2<Unit>) -> Vec2<Unit> {
    if slope.x < 0 { -Vec2::X } else { Vec2::X }
}

/// Horizontal velocity of a character that lands, relative to the ground: the difference of both velocities, limited to
/// the range between 0 and the character's own velocity. A character that drops straight down on a belt is carried at
/// once. A character that jumps straight up in a moving train lands at rest in the train.
fn taken_along(velocity: Fx, ground: Fx) -> Fx {
    velocity.saturating_sub(ground).clamp(velocity.min(Fx::ZERO), velocity.max(Fx::ZERO))
}
