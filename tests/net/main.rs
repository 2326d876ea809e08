//! Whole matches over networks that lose, delay, duplicate and reorder packets, with peers that join and leave.

#![expect(clippy::unwrap_used, reason = "a failed unwrap fails the test")]
#![expect(clippy::disallowed_types, reason = "GGRS reads the clock, so matches run in real time")]

mod comings;
mod disasters;
mod divergence;
mod goings;
mod hostile;
mod matches;
mod oddities;
mod patience;
mod pushers;
mod scripted;
#[path = "../common/sweep.rs"]
mod sweep;
mod table;
