//! Code shared by the fuzz targets. `README.md` explains how to run them.

pub mod allocations;
pub mod broad_phases;
pub mod bytes;
pub mod forge;
pub mod generator;
pub mod hulls;
pub mod joints;
pub mod lockstep;
pub mod manifolds;
pub mod matches;
pub mod maths;
pub mod memory;
pub mod mirror;
pub mod ordinary;
pub mod pairs;
pub mod questions;
pub mod reports;
pub mod settings;
pub mod shapes;
pub mod snapshots;
pub mod source;
pub mod verdicts;
