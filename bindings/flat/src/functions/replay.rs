//! Recording and verification of worlds whose only inputs are commands.

use lockstep2d::lockstep::{Game, Sandbox, SandboxSetup};
use lockstep2d::replay::{self, Limits, Mismatch, Recording, Verdict};
use lockstep2d::world::{Config, World};

use super::host_recorder::HostGame;
use crate::border::{In, Out};
use crate::describe::api;
use crate::records::{RawConfig, RawLimits, RawVerdict};
use crate::status::{Failure, Outcome, Status, note};
use crate::table::{self, Commands, Kind, with, with_two};

/// A recording of a world; `None` once it is finished.
pub(crate) struct SandboxRecorder(Option<Recording<Sandbox>>);

impl SandboxRecorder {
    fn get(&mut self) -> Outcome<&mut Recording<Sandbox>> {
        self.0.as_mut().ok_or_else(finished)
    }
}

pub(super) fn finished() -> Failure {
    Failure::new(Status::Record, "the recording is finished")
}

/// Reads limits. A null pointer stands for the default limits.
pub(super) fn limits_of(limits: &In<'_, RawLimits>) -> Outcome<Limits> {
    if limits.is_null() { Ok(Limits::default()) } else { limits.get()?.limits() }
}

/// Writes a handle, or the verdict on a file that cannot be played.
pub(super) fn set_opened<T: Kind>(
    opened: Result<T, Verdict>,
    handle: &mut Out<'_, u32>,
    verdict: &mut Out<'_, RawVerdict>,
) -> Outcome {
    match opened {
        Ok(opened) => handle.set(table::add(opened)?),
        Err(found) => {
            verdict.set_if_wanted(RawVerdict::of(&found))?;
            Err(Failure::new(Status::Record, found.to_string()))
        }
    }
}

api! {
    /// Sets the default limits of a replay, which allow a day of play at 60 ticks per second. With these limits, a
    /// malicious file can take hours to verify: a server should set narrower limits.
    fn ls2d_limits_init(limits: Out<'_, RawLimits>) {
        let mut limits = limits;
        limits.set(RawLimits::of(&Limits::default()))
    }

    /// Creates a world, sets it up with the list `commands`, and starts recording it, with a checkpoint every
    /// `interval` ticks. A null `config` stands for the default settings.
    fn ls2d_recording_new(config: In<'_, RawConfig>, commands: u32, interval: u32, recording: Out<'_, u32>) {
        let mut recording = recording;
        recording.check()?;
        let config = if config.is_null() { Config::default() } else { config.get()?.config()? };
        let commands = with(commands, |Commands(list)| Ok(list.clone()))?;
        let started = Recording::start(&SandboxSetup { config, commands }, interval)?;
        recording.set(table::add(SandboxRecorder(Some(started)))?)
    }

    /// Executes and empties a list of commands, and advances the recorded world by one tick. Skips commands that the
    /// world refuses.
    fn ls2d_recording_step(recording: u32, commands: u32) {
        with_two(recording, commands, |recording: &mut SandboxRecorder, Commands(list)| {
            recording.get()?.step(&[std::mem::take(list)])?;
            Ok(())
        })
    }

    /// Makes a copy of the recorded world, to draw and query it.
    fn ls2d_recording_world(recording: u32, world: Out<'_, u32>) {
        let mut world = world;
        world.check()?;
        let copy: World =
            with(recording, |recording: &mut SandboxRecorder| Ok(recording.get()?.game().world().clone()))?;
        world.set(table::add(copy)?)
    }

    /// Returns the bytes finished since the last call, which the caller appends to the file.
    fn ls2d_recording_take(recording: u32, bytes: Out<'_, u32>) {
        let mut bytes = bytes;
        bytes.check()?;
        let take = || with(recording, |recording: &mut SandboxRecorder| Ok(recording.get()?.take_bytes()));
        bytes.set(table::add_taken(take)?)
    }

    /// Ends a recording, and returns the remaining bytes.
    fn ls2d_recording_finish(recording: u32, bytes: Out<'_, u32>) {
        let mut bytes = bytes;
        bytes.check()?;
        let take = |SandboxRecorder(recording): &mut SandboxRecorder| {
            Ok(recording.take().ok_or_else(finished)?.finish()?)
        };
        bytes.set(table::add_taken(|| with(recording, take))?)
    }

    /// Verifies a replay of a world. The replay may come from an untrusted source. A null `limits` stands for the
    /// default limits. `ls2d_last_error` returns the verdict in words.
    fn ls2d_replay_verify(data: In<'_, u8>, size: usize, limits: In<'_, RawLimits>, verdict: Out<'_, RawVerdict>) {
        let mut verdict = verdict;
        verdict.check()?;
        let found = replay::verify::<Sandbox>(data.slice(size)?, &limits_of(&limits)?);
        note(Failure::new(Status::Ok, text_of(&found)));
        verdict.set(RawVerdict::of(&found))
    }
}

/// The verdict in words. For a replay of a game that a host simulates, the text adds that only the program of this game
/// can play it.
fn text_of(found: &Verdict) -> String {
    match found {
        Verdict::Unverifiable { why: Mismatch::Rules { file, .. } } if file.0 == HostGame::RULES.name => {
            format!("{found}; {:?} stands for rules in the game's own program, which has to play it", file.0)
        }
        _ => found.to_string(),
    }
}
