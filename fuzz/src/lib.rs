//! What the fuzz targets share: a generator of scenes and commands, the checks they hold worlds to, a forger of
//! replays and a counting allocator. `README.md` says how to run them.

pub mod allocations;
pub mod forge;
pub mod generator;
pub mod lockstep;
pub mod shapes;
pub mod snapshots;
pub mod source;
pub mod verdicts;
