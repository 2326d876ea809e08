//! Distances, casts, times of impact and overlaps of two shapes.

mod distance;
mod immersion;
mod ray;
mod shape_cast;
mod time_of_impact;

pub(crate) use distance::{Distance, distance, overlap};
pub(crate) use immersion::{RelativePose, Ring};
pub(crate) use ray::{cast_ray, contains_point};
pub(crate) use shape_cast::{SKIN, ShapeHit, TOLERANCE as SKIN_TOLERANCE, cast_shape, goes_against};
pub(crate) use time_of_impact::{
    StartPolicy, Sweep, TimeOfImpact, first_impact, first_overlap, normal_at, time_of_impact,
};
