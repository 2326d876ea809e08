//! Working memory: whatever a tick may throw away. Clearing it before any tick changes no hash.

use alloc::vec::Vec;
use core::cell::LazyCell;

use super::continuous::Swept;
use super::events::Events;
use super::islands::{Roster, UnionFind};
use super::joint_links::JointLinks;
use super::manifolds::Found;
use super::moves::Origins;
use super::outlook::Outlook;
use super::pairs::Merged;
use super::state::State;
use super::stats::StepStats;
use crate::body::{Body, BodyKind, Geometry, Handle, Pose, Shape, ShapeId};
use crate::collision::{AxisHint, BroadPhase, BroadPhaseKind, Contact, Pair, PosedShape, SmallBoxes};
use crate::fx;
use crate::lanes::prefetch;
use crate::math::{Aabb, Fx, Vec2};
use crate::solver::{Solver, TouchingPair};

/// Caches, buffers and results of the last tick.
#[derive(Clone, Debug)]
pub(crate) struct Scratch {
    pub(crate) broad_phase: BroadPhase,
    /// The boxes of fixed bodies once more: all that most fast bodies are swept against.
    pub(crate) fixed: BroadPhase,
    pub(crate) poses: Poses,
    /// What has changed since the last look at the pairs.
    pub(crate) changes: Changes,
    pub(crate) roster: Roster,
    pub(crate) links: JointLinks,
    /// Whether there may be kinematic bodies.
    pub(crate) kinematic: bool,
    pub(crate) union: UnionFind,
    /// Where the bodies of the roster were at the start of the tick.
    pub(crate) starts: Vec<Pose>,
    /// The fast bullets of the tick.
    pub(crate) bullets: Vec<Swept>,
    /// The boxes that a tick begins with, where they are others.
    pub(crate) refitted: Vec<(u32, Aabb)>,
    pub(crate) pairs: Vec<Pair>,
    /// Pairs of body slots whose joint keeps them from colliding, sorted; and whether joints have changed since.
    pub(crate) joined: Vec<Pair>,
    pub(crate) joined_stale: bool,
    pub(crate) fresh: Vec<Contact>,
    pub(crate) merged: Merged,
    pub(crate) parked: Vec<Contact>,
    pub(crate) ended: Vec<Contact>,
    /// For each contact, the axis that separated it in the last tick.
    pub(crate) hints: Vec<AxisHint>,
    /// What the narrow phase of the last tick has found, and the parts of it that its jobs have put together.
    pub(crate) found: Found,
    pub(crate) found_parts: Vec<Found>,
    /// What touched in the tick before, sorted by pair: most of it still does, with the same surface.
    pub(crate) touched: Vec<TouchingPair>,
    /// Whether surfaces may have changed since.
    pub(crate) surfaces_stale: bool,
    pub(crate) solver: Solver,
    pub(crate) origins: Origins,
    pub(crate) events: Events,
    pub(crate) stats: StepStats,
}

/// A contact that approaches fast enough to be a hit.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Approaching {
    pub(crate) contact: u32,
    pub(crate) event: super::events::HitEvent,
}

/// Where pairs may have come or gone since the last look at them.
#[derive(Clone, Debug, Default)]
pub(crate) struct Changes {
    /// Anywhere: the caches are new.
    pub(crate) everything: bool,
    /// Resting contacts may have an active body again, or may have ended.
    pub(crate) resting: bool,
    /// Pairs that might touch may not do so any more.
    pub(crate) rules: bool,
    /// Slots of shapes with another fat box, or whose body has begun or ceased to be active.
    pub(crate) shapes: Vec<u32>,
    /// The box of each shape when the pairs were last looked at: of two that overlapped then, nothing is new. Nowhere
    /// if the shape has another reason to have other pairs.
    seen: Vec<Aabb>,
}

impl Changes {
    pub(crate) fn any(&self) -> bool {
        self.everything || self.resting || self.rules || !self.shapes.is_empty()
    }

    /// Keeps what is to be looked at, without what has been seen.
    pub(crate) fn keep(&self, pending: &mut Self) {
        let Changes { everything, resting, rules, shapes, seen: _ } = self;
        (pending.everything, pending.resting, pending.rules) = (*everything, *resting, *rules);
        pending.shapes.clone_from(shapes);
    }

    /// Takes over what was to be looked at when a snapshot was made, for a state that has been brought back.
    pub(crate) fn resume(&mut self, pending: &Self, boxes: &BroadPhase, slot_count: usize) {
        let Changes { everything, resting, rules, shapes, seen } = self;
        (*everything, *resting, *rules) = (pending.everything, pending.resting, pending.rules);
        shapes.clone_from(&pending.shapes);
        seen.clear();
        seen.extend((0u32..).take(slot_count).map(|slot| boxes.fat(slot)));
        for &slot in shapes.iter() {
            if let Some(seen) = seen.get_mut(slot as usize) {
                *seen = Aabb::NOWHERE;
            }
        }
    }

    /// The pairs have been looked at.
    pub(crate) fn settle(&mut self, boxes: &BroadPhase, slot_count: usize) {
        self.seen.resize(slot_count, Aabb::NOWHERE);
        if self.everything {
            self.seen.iter_mut().zip(0..).for_each(|(seen, slot)| *seen = boxes.fat(slot));
        }
        for &slot in &self.shapes {
            self.seen[slot as usize] = boxes.fat(slot);
        }
        (self.everything, self.resting, self.rules) = (false, false, false);
        self.shapes.clear();
    }

    /// The shapes of a body have another reason to have other pairs than another fat box.
    pub(crate) fn body(&mut self, body: &Body) {
        for id in body.shapes() {
            self.shapes.push(id.slot());
            if let Some(seen) = self.seen.get_mut(id.slot() as usize) {
                *seen = Aabb::NOWHERE;
            }
        }
    }

    /// Whether a shape has another reason to have other pairs than another fat box.
    pub(crate) fn is_new(&self, slot: u32) -> bool {
        self.seen.get(slot as usize).is_none_or(|seen| *seen == Aabb::NOWHERE)
    }

    /// Whether the boxes of two shapes overlapped already when the pairs were last looked at.
    pub(crate) fn has_seen(&self, (a, b): Pair) -> bool {
        match (self.seen.get(a as usize), self.seen.get(b as usize)) {
            (Some(a), Some(b)) => a.overlaps(*b),
            _ => false,
        }
    }
}

impl Scratch {
    /// The caches of a state.
    pub(crate) fn new(kind: BroadPhaseKind, state: &State) -> Self {
        let mut scratch = Scratch {
            broad_phase: BroadPhase::new(kind),
            fixed: BroadPhase::new(kind),
            poses: Poses::default(),
            changes: Changes { everything: true, ..Changes::default() },
            roster: Roster::default(),
            links: JointLinks::new(state),
            kinematic: state.bodies.iter().any(|(_, body)| body.kind() == BodyKind::Kinematic),
            union: UnionFind::default(),
            starts: Vec::new(),
            bullets: Vec::new(),
            refitted: Vec::new(),
            pairs: Vec::new(),
            joined: Vec::new(),
            joined_stale: true,
            fresh: Vec::new(),
            merged: Merged::default(),
            parked: Vec::new(),
            ended: Vec::new(),
            hints: Vec::new(),
            found: Found::default(),
            found_parts: Vec::new(),
            touched: Vec::new(),
            surfaces_stale: true,
            solver: Solver::default(),
            origins: Origins::default(),
            events: Events::default(),
            stats: StepStats::default(),
        };
        for (id, _) in state.bodies.iter() {
            scratch.poses.pose_body(state, id.slot());
        }
        let boxes = |(id, shape): (ShapeId, &Shape)| (id.slot(), shape.fat);
        let body_of = |shape: &Shape| state.bodies.at(shape.body().slot());
        let enabled = || state.shapes.iter().filter(|(_, shape)| body_of(shape).enabled);
        scratch.broad_phase.refill(enabled().map(boxes));
        for (id, shape) in enabled() {
            scratch.broad_phase.set_kin(id.slot(), shape.filter().kin());
        }
        let is_fixed = |shape: &Shape| body_of(shape).kind() == BodyKind::Fixed;
        scratch.fixed.refill(enabled().filter(|(_, shape)| is_fixed(shape)).map(boxes));
        scratch
    }

    /// Brings the broad phase in line with a state that it has not followed: `refitted` has the boxes that are others, and
    /// `redefined` the slots of shapes that may have come or gone, or whose bodies are other ones.
    pub(crate) fn set_boxes(&mut self, state: &State, redefined: &[u32]) {
        let Scratch { broad_phase, fixed, refitted, .. } = self;
        for &slot in redefined {
            let shape = state.shapes.get_slot(slot).filter(|_| state.body_of(slot).enabled);
            match shape {
                Some(shape) if broad_phase.fat(slot) != Aabb::NOWHERE => refitted.push((slot, shape.fat)),
                Some(shape) => broad_phase.set(slot, shape.fat),
                None => broad_phase.remove(slot),
            }
            if let Some(shape) = shape {
                broad_phase.set_kin(slot, shape.filter().kin());
            }
            match shape {
                Some(shape) if state.body_of(slot).kind() == BodyKind::Fixed => fixed.set(slot, shape.fat),
                _ => fixed.remove(slot),
            }
        }
        // Disabled bodies have boxes too.
        refitted.retain(|&(slot, _)| broad_phase.fat(slot) != Aabb::NOWHERE);
        broad_phase.set_many(refitted);
    }

    /// Drops what is known of the last tick only: the state is now that of another one.
    pub(crate) fn reset_results(&mut self) {
        self.forget_contacts();
        self.surfaces_stale = true;
        self.ended.clear();
        self.events.clear();
        self.stats = StepStats::default();
    }

    /// Brings the caches in line with the place of a body's shapes.
    pub(crate) fn place(&mut self, state: &State, slot: u32) {
        self.poses.pose_body(state, slot);
        let body = state.bodies.at(slot);
        for id in body.shapes().iter().filter(|_| body.enabled) {
            let shape = state.shapes.at(id.slot());
            let fat = shape.fat;
            self.broad_phase.set(id.slot(), fat);
            self.broad_phase.set_kin(id.slot(), shape.filter().kin());
            match body.kind() {
                BodyKind::Fixed => self.fixed.set(id.slot(), fat),
                BodyKind::Kinematic | BodyKind::Dynamic => self.fixed.remove(id.slot()),
            }
        }
    }

    /// Hides a shape from whatever looks for boxes.
    pub(crate) fn remove_box(&mut self, shape: u32) {
        self.broad_phase.remove(shape);
        self.fixed.remove(shape);
    }

    /// Drops what is found by a contact's place in the state, because places have changed.
    pub(crate) fn forget_contacts(&mut self) {
        self.found.clear();
        self.hints.clear();
    }
}

/// Shapes in world axes, by slot.
#[derive(Clone, Debug, Default)]
pub(crate) struct Poses {
    shapes: Vec<Option<PosedShape>>,
    /// The same shapes as their pairs see them first.
    pub(super) outlook: Outlook,
    /// And those of them that are collided in lanes.
    pub(super) boxes: SmallBoxes,
    /// By body slot.
    extents: Vec<Extents>,
}

/// How large the shapes of a body are about its centre of mass, in metres. Turning does not change it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Extents {
    /// The radius of a disc inside the thinnest of its solid shapes; the largest number if there are none.
    pub(crate) core: Fx,
    /// No point of a shape is farther than this, but for those of discs, which are where they were when they turn.
    pub(crate) reach: Fx,
    /// No point of a shape is farther than this.
    pub(crate) radius: Fx,
}

impl Extents {
    const NONE: Self = Extents { core: Fx::MAX, reach: Fx::ZERO, radius: Fx::ZERO };

    fn of(state: &State, body: &Body) -> Self {
        let shapes = body.shapes().iter().map(|id| state.shapes.at(id.slot()));
        shapes.fold(Self::NONE, |extents, shape| {
            // Posed vertices are rounded.
            let arm = (shape.offset() - body.local_centre_of_mass()).length().saturating_add(fx!(0.00001));
            let Aabb { lower, upper } = shape.geometry().local_bounds();
            let (size, turning) = match shape.geometry() {
                Geometry::Circle { radius } => (*radius, Fx::ZERO),
                _ => [(-lower).max(upper).length(); 2].into(),
            };
            let core = if shape.is_sensor() { Fx::MAX } else { PosedShape::inner_radius(shape.geometry()) };
            Extents {
                core: extents.core.min(core),
                reach: extents.reach.max(arm.saturating_add(turning)),
                radius: extents.radius.max(arm.saturating_add(size)),
            }
        })
    }
}

impl Poses {
    /// Poses the shapes of a body that has come, has got another shape, or has another mass.
    pub(crate) fn pose_body(&mut self, state: &State, slot: u32) {
        self.shapes.resize_with(state.shapes.slot_count(), || None);
        self.boxes.resize(state.shapes.slot_count());
        self.extents.resize(state.bodies.slot_count(), Extents::NONE);
        let body = state.bodies.at(slot);
        let rotation = body.rotation();
        for &id in body.shapes() {
            let shape = state.shapes.at(id.slot());
            let posed = PosedShape::new(&shape.def, body, rotation);
            self.outlook.place(id.slot(), shape, body, &posed);
            self.boxes.place(id.slot(), &posed, posed.as_centred_box(&shape.def, body));
            self.shapes[id.slot() as usize] = Some(posed);
        }
        self.extents[slot as usize] = Extents::of(state, body);
    }

    /// Takes the shapes of a body along, after it has been shifted and not turned: falling and resting bodies mostly are.
    pub(crate) fn shift_body(&mut self, body: &Body, by: Vec2<Fx>) {
        for &id in body.shapes() {
            let posed =
                self.shapes[id.slot() as usize].as_mut().expect("every shape is posed when it is placed");
            posed.shift(by);
            self.outlook.move_to(id.slot(), posed.bounds);
        }
    }

    /// Poses the shapes of a body again, after it has only been moved.
    pub(crate) fn move_body(&mut self, state: &State, body: &Body) {
        let rotation = LazyCell::new(|| body.rotation());
        for &id in body.shapes() {
            let posed =
                self.shapes[id.slot() as usize].as_mut().expect("every shape is posed when it is placed");
            if let Some(faces) = self.boxes.turn(id.slot(), &rotation) {
                posed.turn_box(&faces, body.centre);
            } else if self.outlook.reach(id.slot()).disc {
                posed.shift(body.centre.wrapping_sub(posed.centre));
            } else {
                posed.renew(&state.shapes.at(id.slot()).def, body, &rotation);
                self.boxes.renew(id.slot(), posed);
            }
            self.outlook.move_to(id.slot(), posed.bounds);
        }
    }

    /// Whether a shape has been posed.
    pub(crate) fn has(&self, slot: u32) -> bool {
        self.shapes.get(slot as usize).is_some_and(Option::is_some)
    }

    /// The extents of the body in an occupied slot.
    pub(crate) fn extents(&self, slot: u32) -> Extents {
        self.extents[slot as usize]
    }

    /// Asks for a shape that will soon be looked at.
    #[inline]
    pub(super) fn prefetch(&self, slot: u32) {
        prefetch(&self.shapes[slot as usize]);
    }

    /// The shape in an occupied slot.
    #[inline]
    pub(crate) fn at(&self, slot: u32) -> &PosedShape {
        self.shapes[slot as usize].as_ref().expect("every shape is posed when it is placed")
    }
}
