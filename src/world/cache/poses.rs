use alloc::vec::Vec;

use super::motion::MotionCache;
use super::pose_range::PoseRange;
use crate::body::{Body, Geometry, Handle};
use crate::collision::{Pair, PosedShape, SmallBoxes, SupportShape, distance};
use crate::fx;
use crate::math::{Aabb, Fx};
use crate::simd::prefetch;
use crate::threads::split_at_ends;
use crate::world::state::State;

/// Shapes at the poses of their bodies, by slot.
#[derive(Clone, Debug, Default)]
pub(crate) struct Poses {
    shapes: Vec<Option<PosedShape>>,
    motion: MotionCache,
    /// Small boxes in the layout of the SIMD kernel.
    boxes: SmallBoxes,
    /// Extents of the shapes of each body, by body slot.
    extents: Vec<Extents>,
}

/// Bounds of the shapes of a body about its centre of mass, in metres, at any rotation of the body.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Extents {
    /// Smallest radius of the discs inside the solid shapes, one disc for each shape. [`Fx::MAX`] without a solid
    /// shape.
    pub(crate) core: Fx,
    /// Upper bound of the distance from the centre of mass of points that a rotation of the body moves. Of a circle,
    /// only the centre counts, because the circle looks the same at every rotation.
    pub(crate) reach: Fx,
    /// Upper bound of the distance of all points from the centre of mass.
    pub(crate) radius: Fx,
}

impl Extents {
    const NONE: Self = Extents { core: Fx::MAX, reach: Fx::ZERO, radius: Fx::ZERO };

    fn of(state: &State, body: &Body) -> Self {
        let shapes = body.shapes().iter().map(|id| state.shapes.at(id.slot()));
        shapes.fold(Self::NONE, |extents, shape| {
            // 10 µm of slack for the rounding of posed vertices.
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
    /// Poses the shapes of a body after an edit.
    pub(crate) fn pose_body(&mut self, state: &State, slot: u32) {
        self.shapes.resize_with(state.shapes.slot_count(), || None);
        self.boxes.resize(state.shapes.slot_count());
        self.extents.resize(state.bodies.slot_count(), Extents::NONE);
        let body = state.bodies.at(slot);
        let rotation = body.rotation();
        for &id in body.shapes() {
            let shape = state.shapes.at(id.slot());
            let posed = PosedShape::new(&shape.def, body, rotation);
            self.motion.set_shape(id.slot(), shape, body, &posed);
            self.boxes.place(id.slot(), &posed, posed.as_centred_box(&shape.def, body));
            self.shapes[id.slot() as usize] = Some(posed);
        }
        self.extents[slot as usize] = Extents::of(state, body);
    }

    /// Divides the shapes into ranges that end at the given slots. Returns the extents of all bodies as well.
    pub(crate) fn split(
        &mut self,
        ends: impl Iterator<Item = u32> + Clone,
    ) -> (impl Iterator<Item = PoseRange<'_>>, &[Extents]) {
        let Poses { shapes, motion, boxes, extents } = self;
        let firsts = core::iter::once(0).chain(ends.clone());
        let ends = ends.map(|end| end as usize);
        let shapes = split_at_ends(shapes, ends.clone()).zip(motion.split_shapes(ends.clone()));
        let parts = firsts.zip(shapes).zip(boxes.split(ends));
        (parts.map(|((first, (shapes, motion)), boxes)| PoseRange { first, shapes, motion, boxes }), extents)
    }

    pub(crate) fn whole(&mut self) -> PoseRange<'_> {
        self.split(core::iter::once(u32::MAX)).0.next().expect("a part for each end")
    }

    pub(crate) fn has(&self, shape: u32) -> bool {
        self.shapes.get(shape as usize).is_some_and(Option::is_some)
    }

    pub(crate) fn extents(&self, body: u32) -> Extents {
        self.extents[body as usize]
    }

    #[inline]
    pub(crate) fn motion(&self) -> &MotionCache {
        &self.motion
    }

    pub(super) fn motion_mut(&mut self) -> &mut MotionCache {
        &mut self.motion
    }

    pub(super) fn motion_and_extents(&mut self) -> (&mut MotionCache, &[Extents]) {
        (&mut self.motion, &self.extents)
    }

    #[inline]
    pub(crate) fn boxes(&self) -> &SmallBoxes {
        &self.boxes
    }

    #[inline]
    pub(crate) fn prefetch(&self, shape: u32) {
        prefetch(&self.shapes[shape as usize]);
    }

    /// Whether two shapes are at most `reach` metres apart.
    pub(crate) fn are_within(&self, (a, b): Pair, reach: Fx) -> bool {
        let (a, b) = (self.at(a), self.at(b));
        a.bounds.expanded(reach).overlaps(b.bounds)
            && distance(&SupportShape::of(a, b.centre), &SupportShape::of(b, b.centre)).distance <= reach
    }

    #[inline]
    pub(crate) fn at(&self, shape: u32) -> &PosedShape {
        self.shapes[shape as usize].as_ref().expect("every shape is posed when it is added")
    }
}
