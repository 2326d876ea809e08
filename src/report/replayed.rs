//! Simulates the inputs of the files again, and compares the states with the hashes of both sides.

use alloc::format;
use alloc::string::String;
use alloc::vec::Vec;

use super::candidate::{self, WrongTick};
use super::compare::CompareError;
use super::comparison::{Blame, Comparison, Side};
use super::evidence::SideEvidence;
use super::origin;
use super::stage::Stage;
use crate::codec;
use crate::inspect::{differences, fields};
use crate::lockstep::Game;
use crate::replay::{Limits, RawReplay, Step};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Effort {
    /// Plays all ticks for which either side has data, up to the first different input. The search for an explanation
    /// has a fixed limit, [`candidate::WORK_MAX`].
    Thorough,
    /// Plays until all of these conditions hold: a side has diverged; no difference is suspected
    /// ([`Beside::suspected`]); further ticks would provide no more states for the comparison, because the states of
    /// both sides are available or the file of the diverged side has no further save. The rerun and the search together
    /// take at most two and a half times the work of all ticks.
    Bounded,
}

pub(super) fn run<G: Game>(
    known: &[SideEvidence<'_>; 2],
    limits: &Limits,
    effort: Effort,
    found: &mut Comparison,
) -> Result<(), CompareError> {
    play::<G>(known, limits, effort, found)?;
    found.blame = match [found.trajectories[0].diverges, found.trajectories[1].diverges] {
        _ if found.simulated.is_none() => Blame::Unknown,
        [None, None] => Blame::Nobody,
        [Some(_), None] => Blame::Side(Side::A),
        [None, Some(_)] => Blame::Side(Side::B),
        [Some(_), Some(_)] => Blame::Both,
    };
    Ok(())
}

fn play<G: Game>(
    known: &[SideEvidence<'_>; 2],
    limits: &Limits,
    effort: Effort,
    found: &mut Comparison,
) -> Result<(), CompareError> {
    // The states are expected to differ after the first different input, so they are compared only up to this input.
    let horizon = found.input.as_ref().map_or(u64::MAX, |input| input.tick);
    compare_directly(known, horizon, found);
    let side = if known[0].ticks < known[1].ticks { Side::B } else { Side::A };
    let replay = known[side.index()].replay;
    if replay.is_empty() {
        found.notes.push("there are no inputs to simulate again, so the diverged side is unknown".into());
        if let Some(first) = found.first_different {
            compare_saves_alone::<G>(known, first, found)?;
        }
        return Ok(());
    }
    let raw =
        RawReplay::<G>::open(replay, limits).map_err(|verdict| CompareError::Replay { side, verdict })?;
    let until = known[0].last().max(known[1].last()).min(horizon);
    Beside {
        known,
        limits,
        effort,
        found,
        side,
        setup_work: raw.work(),
        raw,
        previous: None,
        wrong: None,
        suspected: None,
        states: None,
        presumed: None,
        obstacle: None,
    }
    .run(until)
}

/// Compares the hashes of both sides without simulation, up to the first difference.
fn compare_directly(known: &[SideEvidence<'_>; 2], horizon: u64, found: &mut Comparison) {
    let mut ticks: Vec<u64> = known.iter().flat_map(|known| known.ticks_known()).collect();
    ticks.sort_unstable();
    ticks.dedup();
    for tick in ticks.into_iter().filter(|tick| *tick <= horizon) {
        match known[0].same(&known[1], tick) {
            Some(true) => found.last_equal = Some(tick),
            Some(false) => {
                found.first_different = Some(tick);
                return;
            }
            None => {}
        }
    }
}

fn decode<G: Game>(side: Side, tick: u64, bytes: &[u8]) -> Result<G::Save, String> {
    codec::decode(bytes)
        .map_err(|error| format!("the state of {side} after tick {tick} cannot be read: {error}"))
}

fn compare_saves_alone<G: Game>(
    known: &[SideEvidence<'_>; 2],
    first: u64,
    found: &mut Comparison,
) -> Result<(), CompareError> {
    let in_both = |tick: &u64| known[1].saves.contains_key(tick);
    let tick = known[0].saves.range(first..).map(|(tick, _)| *tick).find(in_both);
    let Some(tick) = tick else {
        found.notes.push("the files do not contain the states that differ".into());
        return Ok(());
    };
    let state = |side: Side| decode::<G>(side, tick, known[side.index()].saves[&tick]);
    match (state(Side::A), state(Side::B)) {
        (Ok(a), Ok(b)) => {
            found.tick = Some(tick);
            found.subjects = candidate::subjects(differences(&fields(&a)?, &fields(&b)?));
        }
        (Err(obstacle), _) | (_, Err(obstacle)) => found.notes.push(obstacle),
    }
    Ok(())
}

struct States<S> {
    tick: u64,
    states: [S; 2],
    /// The side that has no hash for this tick and is presumed not to have diverged. The presumption is right if the
    /// side equals the rerun at this tick or later, because a diverged side does not converge again.
    presumed: Option<Side>,
}

struct Beside<'a, 'k, G: Game> {
    known: &'a [SideEvidence<'k>; 2],
    limits: &'a Limits,
    effort: Effort,
    found: &'a mut Comparison,
    /// The side whose replay is played.
    side: Side,
    raw: RawReplay<'k, G>,
    setup_work: u64,
    /// State of the rerun before the current tick.
    previous: Option<G::Save>,
    /// The tick of the first divergence from the rerun.
    wrong: Option<WrongTick<G>>,
    /// A tick at which only one side is known to differ from the rerun, for the first time. The other side, which is
    /// given here, has not diverged before, and its file has no hash for this tick. Its next hash decides: if the hash
    /// equals the rerun, the sides differ at this tick, because a diverged side does not converge again. Otherwise both
    /// sides may have diverged in the same way.
    suspected: Option<(u64, Side)>,
    /// The states of both sides at the first different tick for which both are available.
    states: Option<States<G::Save>>,
    /// Like `states`, but the state of one side is presumed to be the state of the rerun.
    presumed: Option<States<G::Save>>,
    /// Error message of the first save that could not be decoded.
    obstacle: Option<String>,
}

impl<G: Game> Beside<'_, '_, G> {
    fn run(mut self, until: u64) -> Result<(), CompareError> {
        let equal = self.found.last_equal.take();
        loop {
            self.look();
            if self.raw.tick() >= until || self.is_enough() {
                break;
            }
            self.previous = self.wrong.is_none().then(|| self.raw.game().save());
            match self.raw.step() {
                Ok(Step::Ticked) => {}
                Ok(Step::Ended) => break,
                // Without a difference so far, an incomplete rerun would look like equal trajectories.
                Err(verdict) if self.found.first_different.is_none() && self.diverged().is_none() => {
                    return Err(CompareError::Replay { side: self.side, verdict });
                }
                Err(verdict) => {
                    let tick = self.raw.tick();
                    self.found.notes.push(format!("the rerun ends after tick {tick}: {verdict}"));
                    break;
                }
            }
        }
        self.found.simulated = Some(self.raw.tick());
        let unsettled = self.suspected.map(|(tick, _)| tick).filter(|tick| equal < Some(*tick));
        self.found.first_different = self.found.first_different.or(unsettled);
        // The hashes of the files may also be equal at ticks after the end of the rerun.
        let equal = equal.filter(|equal| self.found.first_different.is_none_or(|first| *equal < first));
        self.found.last_equal = self.found.last_equal.max(equal);
        self.conclude()
    }

    fn is_enough(&self) -> bool {
        let tick = self.raw.tick();
        let has_told = |side: Side| self.known[side.index()].saves.range(tick..).next().is_none();
        self.effort == Effort::Bounded
            && self.suspected.is_none()
            && self.diverged().is_some_and(|side| self.states.is_some() || has_told(side))
    }

    fn diverged(&self) -> Option<Side> {
        let has_diverged = |side: &Side| self.found.trajectories[side.index()].diverges.is_some();
        Side::BOTH.into_iter().find(has_diverged)
    }

    fn look(&mut self) {
        let (tick, hash) = (self.raw.tick(), self.raw.game().state_hash());
        let had = [0, 1].map(|side: usize| self.known[side].had(tick, hash));
        for (known, (trajectory, had)) in self.known.iter().zip(self.found.trajectories.iter_mut().zip(had)) {
            match had {
                Some(true) if trajectory.diverges.is_none() => trajectory.equal_until = Some(tick),
                Some(false) if trajectory.diverges.is_none() => {
                    trajectory.diverges = Some(tick);
                    let before = self.previous.take();
                    let wrong = known.said(tick);
                    let was_right = tick.checked_sub(1).filter(|last| trajectory.equal_until == Some(*last));
                    if let ((Some(before), Some(wrong)), Some(last)) = ((before, wrong), was_right) {
                        let inputs = self.raw.inputs().to_vec();
                        let phases = known.phases.get(&tick).copied().cloned();
                        self.wrong = Some(WrongTick { tick: last, before, inputs, wrong, phases });
                    }
                }
                _ => {}
            }
        }
        self.settle(had);
        let is_after = self.found.first_different.is_some_and(|first| first <= tick);
        if (is_after || self.suspected.is_some()) && self.states.is_none() {
            self.take_states(had);
        }
    }

    /// Updates the last equal and the first different tick.
    fn settle(&mut self, had: [Option<bool>; 2]) {
        let tick = self.raw.tick();
        let direct = self.known[0].same(&self.known[1], tick);
        let differ = direct == Some(false) || had.contains(&Some(false)) && had.contains(&Some(true));
        let settled = self.suspected.take_if(|(_, side)| had[side.index()].is_some());
        let confirmed = settled.filter(|(_, side)| had[side.index()] == Some(true)).map(|(tick, _)| tick);
        let first = [self.found.first_different, confirmed, differ.then_some(tick)];
        self.found.first_different = first.into_iter().flatten().min();
        if self.found.first_different.is_some_and(|first| first <= tick) {
            return;
        }
        if had == [Some(true); 2] || direct == Some(true) {
            self.found.last_equal = Some(tick);
        }
        if self.suspected.is_none() && had.contains(&Some(false)) {
            let has_diverged = |side: Side| self.found.trajectories[side.index()].diverges.is_some();
            let is_silent = |side: &Side| had[side.index()].is_none() && !has_diverged(*side);
            self.suspected = Side::BOTH.into_iter().find(is_silent).map(|side| (tick, side));
        }
    }

    fn take_states(&mut self, had: [Option<bool>; 2]) {
        let tick = self.raw.tick();
        let mut states = Vec::new();
        let mut presumed = self.suspected.map(|(_, side)| side);
        for (side, had) in Side::BOTH.into_iter().zip(had) {
            let own = self.known[side.index()].saves.get(&tick);
            states.push(match (own, had) {
                (_, Some(true)) => self.raw.game().save(),
                (None, None) if presumed.is_none_or(|presumed| presumed == side) => {
                    presumed = Some(side);
                    self.raw.game().save()
                }
                (None, _) => return,
                (Some(bytes), _) => match decode::<G>(side, tick, bytes) {
                    Ok(save) => save,
                    Err(obstacle) => {
                        self.obstacle.get_or_insert(obstacle);
                        return;
                    }
                },
            });
        }
        let Ok(states) = states.try_into() else {
            return;
        };
        let states = States { tick, states, presumed };
        if presumed.is_some() {
            self.presumed.get_or_insert(states);
        } else {
            self.states = Some(states);
        }
    }

    fn conclude(self) -> Result<(), CompareError> {
        let Beside {
            known, limits, effort, found, raw, setup_work, wrong, states, presumed, obstacle, ..
        } = self;
        found.notes.extend(obstacle);
        let trajectories = &found.trajectories;
        let came_later = |states: &States<G::Save>| {
            states.presumed.is_some_and(|side| trajectories[side.index()].equal_until >= Some(states.tick))
        };
        match presumed.filter(came_later).or(states) {
            Some(States { tick, states: [a, b], .. }) => {
                found.tick = Some(tick);
                found.subjects = candidate::subjects(differences(&fields(&a)?, &fields(&b)?));
            }
            None => {
                if let Some(first) = found.first_different {
                    compare_saves_alone::<G>(known, first, found)?;
                }
            }
        }
        let Some(wrong) = wrong else {
            return Ok(());
        };
        let work = match effort {
            Effort::Thorough => candidate::WORK_MAX,
            Effort::Bounded => {
                let played = raw.work() - setup_work;
                let whole = (played / raw.tick().max(1)).saturating_mul(raw.ticks());
                (whole.saturating_mul(5) / 2).saturating_sub(played)
            }
        };
        let mut game = raw.into_game();
        if let Some(theirs) = &wrong.phases {
            origin::find(&wrong, theirs, &mut game, found)?;
        }
        // Searches for a flipped bit if phase digests are missing, or if the states diverged before the world's step
        // and their differences at its start are unknown.
        if found.stage.is_none_or(|stage| stage == Stage::BeforeStep) && found.began.is_empty() {
            candidate::explain(&wrong, game, work.min(limits.total_work), found)?;
        }
        Ok(())
    }
}
