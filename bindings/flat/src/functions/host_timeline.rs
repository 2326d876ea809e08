//! Seeking in replays of games whose rules are written in another language. The calling program, the host, fulfils
//! requests, as in a match.

use super::host_replay::HostReplay;
use crate::border::Out;
use crate::describe::api;
use crate::records::{REQUEST_ADVANCE, REQUEST_CHECKSUM, REQUEST_LOAD, REQUEST_SAVE, RawRequest};
use crate::status::{Failure, Outcome, Status, value};
use crate::table::with;

impl HostReplay {
    fn request(&self) -> Outcome<RawRequest> {
        if let Some(failed) = &self.failed
            && self.target >= failed.ticks()
        {
            return Err(Failure::new(Status::Record, failed.to_string()));
        }
        let latest = self.saved.range(..=self.target).next_back().copied();
        if self.target < self.tick {
            let failure = || value("without an earlier saved state, the tick to go to", self.target);
            return request(REQUEST_LOAD, latest.ok_or_else(failure)?, 0);
        }
        // A step of one tick is simulated even if the state after it is saved, so that the game can show the events of
        // the tick.
        if let Some(latest) = latest.filter(|&latest| latest > self.tick && self.target - self.tick > 1) {
            return request(REQUEST_LOAD, latest, 0);
        }
        let kind = if self.compared != Some(self.tick) && self.checkpoint().is_some() {
            REQUEST_CHECKSUM
        } else if self.tick.is_multiple_of(self.interval) && !self.saved.contains(&self.tick) {
            REQUEST_SAVE
        } else if self.tick < self.target {
            REQUEST_ADVANCE
        } else {
            return Err(Failure::none());
        };
        request(kind, self.tick, self.run().map_or(0, |run| run.absent))
    }

    /// Updates the position after a request. A checksum request changes nothing, and is repeated until the host passes
    /// the hash.
    fn fulfil(&mut self, request: RawRequest) {
        match request.kind {
            REQUEST_LOAD => (self.tick, self.compared) = (request.tick.into(), None),
            REQUEST_SAVE => _ = self.saved.insert(self.tick),
            REQUEST_ADVANCE => self.tick += 1,
            _ => {}
        }
    }
}

fn request(kind: u32, tick: u64, absent: u64) -> Outcome<RawRequest> {
    let tick = u32::try_from(tick).map_err(|_| value("the tick of a request", tick))?;
    let absent = if kind == REQUEST_ADVANCE { absent } else { 0 };
    Ok(RawRequest { kind, tick, absent, guessed: 0 })
}

api! {
    /// Starts seeking to the state after `tick` ticks. `ls2d_replay_next_request` then returns the requests that lead
    /// to this state. Before the first request, the game has to be in its first state.
    fn ls2d_replay_seek(replay: u32, tick: u64) {
        with(replay, |replay: &mut HostReplay| {
            if tick > replay.ticks {
                let text = format!("there are {} ticks, and no tick {tick}", replay.ticks);
                return Err(Failure::new(Status::Value, text));
            }
            replay.target = tick;
            Ok(())
        })
    }

    /// The next request of a seek. Save, load and advance are fulfilled as in a match. To fulfil
    /// `LS2D_REQUEST_CHECKSUM`, pass the hash of the current state to `ls2d_replay_check`. Returns `LS2D_NONE` when the
    /// tick of `ls2d_replay_seek` is reached, and `LS2D_RECORD` if the game has diverged from the file at or before
    /// this tick.
    fn ls2d_replay_next_request(
        replay: u32,
        request: Out<'_, RawRequest>,
        inputs: Out<'_, u8>,
        capacity: usize,
        size: Out<'_, usize>,
    ) {
        let (mut request, mut inputs, mut size) = (request, inputs, size);
        request.check()?;
        with(replay, |replay: &mut HostReplay| {
            let next = replay.request()?;
            let played = if next.kind == REQUEST_ADVANCE { replay.inputs() } else { Vec::new() };
            inputs.set_all(capacity, &mut size, &played)?;
            replay.fulfil(next);
            request.set(next)
        })
    }

    /// Sets the interval in ticks at which seeking saves the state. The default is 60 ticks, or a 256th of the ticks of
    /// the replay if that is more.
    fn ls2d_replay_set_interval(replay: u32, ticks: u32) {
        with(replay, |replay: &mut HostReplay| {
            if ticks == 0 {
                return Err(value("the interval", ticks));
            }
            replay.interval = ticks.into();
            Ok(())
        })
    }
}
