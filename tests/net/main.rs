//! Matches over networks that lose, delay, double and reorder packets, and peers that come and go.

#![expect(clippy::unwrap_used, reason = "what fails here is the test")]
#![expect(clippy::disallowed_types, reason = "GGRS reads the clock, and so matches take their time")]

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
