//! The commands, one file each, with the same functions in the same order: `command` describes its arguments,
//! `arguments` takes them from what clap matched, `run` does it.

pub(crate) mod bisect;
pub(crate) mod diff;
pub(crate) mod export;
pub(crate) mod fork;
pub(crate) mod heavy;
pub(crate) mod inspect;
pub(crate) mod record;
pub(crate) mod scenes;
pub(crate) mod seek;
pub(crate) mod stats;
pub(crate) mod trace;
pub(crate) mod trim;
pub(crate) mod verify;

use clap::{ArgMatches, FromArgMatches};

/// The arguments that were matched against the same type's description.
fn from_matches<T: FromArgMatches>(matches: &ArgMatches) -> T {
    T::from_arg_matches(matches).expect("clap matched what this type describes")
}
