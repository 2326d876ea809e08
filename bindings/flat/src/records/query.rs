//! Queries and their results.

use lockstep2d::body::{BodyId, Geometry, ShapeDef};
use lockstep2d::math::{Aabb, Fx};
use lockstep2d::world::{CastHit, ClosestPoints, InitialOverlap, Probe, QueryFilter, RayHit};

use super::shape::RawShapeDef;
use super::{check_flags, check_reserved, check_size, has, size};
use crate::border::In;
use crate::describe::{constants, records};
use crate::numbers::{RawAngle, RawBody, RawFx, RawShape, RawVec2};
use crate::status::{Outcome, value};

constants! {
    /// `ls2d_query_filter.flags`: the query sees sensors.
    QUERY_SENSORS = 1, "LS2D_QUERY_SENSORS";
    /// `ls2d_query_filter.initial_overlap`: a ray reports shapes that it starts in. A cast reports such a shape only if
    /// it would move deeper into the shape.
    OVERLAP_RESIST = 0, "LS2D_OVERLAP_RESIST";
    /// `ls2d_query_filter.initial_overlap`: rays and casts report shapes that they start in.
    OVERLAP_REPORT = 1, "LS2D_OVERLAP_REPORT";
    /// `ls2d_query_filter.initial_overlap`: rays and casts do not see shapes that they start in.
    OVERLAP_IGNORE = 2, "LS2D_OVERLAP_IGNORE";
}

records! {
    /// Selects the shapes that a query sees. A null pointer stands for the defaults of `ls2d_query_filter_init`.
    struct RawQueryFilter = "ls2d_query_filter" {
        /// Size of this struct in bytes.
        size: u32,
        /// Flags: `LS2D_QUERY_SENSORS` or 0.
        flags: u32,
        /// Treatment of shapes that a ray or a cast starts in: `LS2D_OVERLAP_RESIST` and so on.
        initial_overlap: u32,
        /// Number of bodies in `except`, at most 8.
        except_count: u32,
        /// Categories of the query: a shape is seen only if its `mask` has one of them.
        category: u64,
        /// Categories of shapes that the query sees.
        mask: u64,
        /// Bodies that the query does not see.
        except: [RawBody; 8],
    }

    /// Hit of a ray.
    struct RawRayHit = "ls2d_ray_hit" {
        /// The shape that the ray meets.
        shape: RawShape,
        /// Body of that shape.
        body: RawBody,
        /// Fraction of the translation at the hit, 0 to 1.
        fraction: RawFx,
        /// Point in the world, in metres.
        point: RawVec2,
        /// Outward normal of the surface; zero if the ray starts inside.
        normal: RawVec2,
        /// 1 if the ray starts inside the shape, otherwise 0.
        starts_inside: u64,
    }

    /// Hit of a moving probe.
    struct RawCastHit = "ls2d_cast_hit" {
        /// The shape that the probe meets.
        shape: RawShape,
        /// Body of that shape.
        body: RawBody,
        /// Fraction of the translation at the hit, 0 to 1.
        fraction: RawFx,
        /// Displacement of the probe up to the hit, in metres.
        travelled: RawVec2,
        /// Point on the surface of that shape, in the world, in metres.
        point: RawVec2,
        /// Outward normal of the surface at that point.
        normal: RawVec2,
        /// 1 if the shapes overlap at the start, otherwise 0.
        starts_inside: u64,
    }

    /// The shape nearest to a point.
    struct RawClosest = "ls2d_closest_point" {
        /// The nearest shape.
        shape: RawShape,
        /// Body of that shape.
        body: RawBody,
        /// Distance in metres, negative if the given point is inside the shape.
        distance: RawFx,
        /// Point on the surface, in the world, in metres.
        point: RawVec2,
        /// Unit vector from the given point to the shape.
        normal: RawVec2,
    }

    /// An axis-aligned box.
    struct RawAabb = "ls2d_aabb" {
        /// Lower left corner in metres.
        lower: RawVec2,
        /// Upper right corner in metres.
        upper: RawVec2,
    }

    /// A shape that is not in the world, for casts and overlaps.
    struct RawProbe = "ls2d_probe" {
        /// Size of this struct in bytes.
        size: u32,
        /// Rotation.
        angle: RawAngle,
        /// Position of the shape's centre in the world, in metres.
        position: RawVec2,
        /// Geometry of the probe; other fields of the definition have no effect.
        shape: RawShapeDef,
    }
}

impl RawQueryFilter {
    pub(crate) fn default_filter() -> Self {
        RawQueryFilter {
            size: size::<Self>(),
            flags: 0,
            initial_overlap: OVERLAP_RESIST,
            except_count: 0,
            category: u64::MAX,
            mask: u64::MAX,
            except: [RawBody(0); 8],
        }
    }

    fn filter(&self) -> Outcome<QueryFilter> {
        check_size::<Self>(self.size)?;
        check_flags("the flags of a query", self.flags, QUERY_SENSORS)?;
        let count = usize::try_from(self.except_count).unwrap_or(usize::MAX);
        let except =
            self.except.get(..count).ok_or_else(|| value("the number of bodies to leave out", count))?;
        let mut except_also = [None; QueryFilter::EXCEPT_ALSO_MAX];
        for (place, body) in except_also.iter_mut().zip(except) {
            *place = Some(body.id()?);
        }
        Ok(QueryFilter {
            category: self.category,
            mask: self.mask,
            sensors: has(self.flags, QUERY_SENSORS),
            except: None::<BodyId>,
            except_also,
            initial_overlap: match self.initial_overlap {
                OVERLAP_RESIST => InitialOverlap::Resist,
                OVERLAP_REPORT => InitialOverlap::Report,
                OVERLAP_IGNORE => InitialOverlap::Ignore,
                other => return Err(value("`initial_overlap` of a query", other)),
            },
        })
    }

    pub(crate) fn of(pointer: &In<'_, Self>) -> Outcome<QueryFilter> {
        if pointer.is_null() { Ok(QueryFilter::default()) } else { pointer.get()?.filter() }
    }
}

impl RawProbe {
    pub(crate) fn of_kind(kind: u32) -> Self {
        let shape = ShapeDef::new(Geometry::Circle { radius: Fx::ZERO });
        let shape = RawShapeDef { kind, ..RawShapeDef::of(&shape) };
        RawProbe { size: size::<Self>(), angle: RawAngle(0), position: RawVec2::ZERO, shape }
    }

    pub(crate) fn probe(&self) -> Outcome<Probe> {
        check_size::<Self>(self.size)?;
        check_reserved(self.shape.reserved)?;
        Ok(Probe::new(self.shape.geometry()?, self.position.vec())?.turned(self.angle.angle()))
    }
}

impl RawAabb {
    pub(crate) fn of(aabb: Aabb) -> Self {
        RawAabb { lower: RawVec2::of(aabb.lower), upper: RawVec2::of(aabb.upper) }
    }

    pub(crate) fn aabb(&self) -> Aabb {
        Aabb::new(self.lower.vec(), self.upper.vec())
    }
}

impl RawRayHit {
    pub(crate) fn of(hit: &RayHit, body: RawBody) -> Self {
        RawRayHit {
            shape: RawShape::of(hit.shape),
            body,
            fraction: RawFx::of(hit.fraction),
            point: RawVec2::of(hit.point),
            normal: RawVec2::of_units(hit.normal),
            starts_inside: hit.starts_inside.into(),
        }
    }
}

impl RawCastHit {
    pub(crate) fn of(hit: &CastHit, body: RawBody) -> Self {
        RawCastHit {
            shape: RawShape::of(hit.shape),
            body,
            fraction: RawFx::of(hit.fraction),
            travelled: RawVec2::of(hit.travelled),
            point: RawVec2::of(hit.point),
            normal: RawVec2::of_units(hit.normal),
            starts_inside: hit.starts_inside.into(),
        }
    }
}

impl RawClosest {
    pub(crate) fn of(shape: RawShape, body: RawBody, found: &ClosestPoints) -> Self {
        RawClosest {
            shape,
            body,
            distance: RawFx::of(found.distance),
            point: RawVec2::of(found.point_b),
            normal: RawVec2::of_units(found.normal),
        }
    }
}
