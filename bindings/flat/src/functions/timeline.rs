//! Seeking in replays of worlds.

use lockstep2d::lockstep::Sandbox;
use lockstep2d::replay::{SeekError, Step, Timeline, TimelineOptions};
use self_cell::self_cell;

use super::replay::{limits_of, set_opened};
use crate::border::{In, Out};
use crate::describe::api;
use crate::records::{RawLimits, RawVerdict};
use crate::status::{Failure, Outcome, Status};
use crate::table::{self, with};

type Seekable<'a> = Timeline<'a, Sandbox>;

self_cell! {
    pub(crate) struct SandboxTimeline {
        owner: Vec<u8>,
        #[not_covariant]
        dependent: Seekable,
    }
}

fn failed(error: &SeekError) -> Failure {
    let status = match error {
        SeekError::NoSuchTick { .. } => Status::Value,
        _ => Status::Record,
    };
    Failure::new(status, error.to_string())
}

/// Calls `by`, which moves the timeline. Fails with `LS2D_NONE` if there is no further tick.
fn go(timeline: u32, by: impl FnOnce(&mut Seekable<'_>) -> Result<Step, SeekError>) -> Outcome {
    with(timeline, |timeline: &mut SandboxTimeline| {
        match timeline.with_dependent_mut(|_, timeline| by(timeline)) {
            Ok(Step::Ticked) => Ok(()),
            Ok(Step::Ended) => Err(Failure::none()),
            Err(error) => Err(failed(&error)),
        }
    })
}

api! {
    /// Opens a replay of a world for seeking to any of its ticks. The replay may come from an untrusted source. Tick t
    /// is the state after t ticks. A null `limits` stands for the default limits. If the replay cannot be played, its
    /// verdict is written, and the result is `LS2D_RECORD`. Other failures write no verdict.
    fn ls2d_timeline_open(
        data: In<'_, u8>,
        size: usize,
        limits: In<'_, RawLimits>,
        timeline: Out<'_, u32>,
        verdict: Out<'_, RawVerdict>,
    ) {
        let (mut timeline, mut verdict) = (timeline, verdict);
        timeline.set(0)?;
        let limits = limits_of(&limits)?;
        let file = data.slice(size)?.to_vec();
        let options = TimelineOptions::default();
        let opened = SandboxTimeline::try_new(file, |file| Seekable::open(file, &options, &limits));
        set_opened(opened, &mut timeline, &mut verdict)
    }

    /// The current tick, and the number of ticks. Each pointer may be null.
    fn ls2d_timeline_ticks(timeline: u32, tick: Out<'_, u64>, ticks: Out<'_, u64>) {
        let (mut tick, mut ticks) = (tick, ticks);
        with(timeline, |timeline: &mut SandboxTimeline| {
            let (at, all) = timeline.with_dependent(|_, timeline| (timeline.tick(), timeline.ticks()));
            tick.set_if_wanted(at)?;
            ticks.set_if_wanted(all)
        })
    }

    /// Goes to a tick. If the replay cannot be played up to this tick (a checkpoint differs, inputs are not valid, or a
    /// limit is exceeded), the result is `LS2D_RECORD`, and the timeline stays at the last tick played. Later seeks to
    /// the tick at which playing failed, or beyond it, fail without moving. Earlier ticks remain reachable.
    fn ls2d_timeline_seek(timeline: u32, tick: u64) {
        go(timeline, |timeline| timeline.seek(tick).map(|()| Step::Ticked))
    }

    /// Goes forward by a tick. `LS2D_NONE` at the end.
    fn ls2d_timeline_step(timeline: u32) {
        go(timeline, |timeline| timeline.step())
    }

    /// Goes back by a tick. `LS2D_NONE` at the start.
    fn ls2d_timeline_step_back(timeline: u32) {
        go(timeline, |timeline| timeline.step_back())
    }

    /// Makes a copy of the world at the current tick, to draw and query it.
    fn ls2d_timeline_world(timeline: u32, world: Out<'_, u32>) {
        let mut world = world;
        world.check()?;
        let copy = with(timeline, |timeline: &mut SandboxTimeline| {
            Ok(timeline.with_dependent(|_, timeline| timeline.game().world().clone()))
        })?;
        world.set(table::add(copy)?)
    }
}
