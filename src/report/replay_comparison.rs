//! Comparison of two replays with different setups or inputs, both simulated by the running engine.
//!
//! With equal setups, only the game of A is simulated while the states and inputs of both sides are equal. With
//! different setups, both games are simulated, because they can continue differently from equal states.

use alloc::format;

use super::candidate;
use super::compare::CompareError;
use super::comparison::{Comparison, Side};
use super::evidence::SideEvidence;
use super::phases::TickPhases;
use crate::inspect::{differences, fields};
use crate::lockstep::Game;
use crate::replay::{Limits, RawReplay, Step, Verdict};

pub(super) fn run<G: Game>(
    known: &[SideEvidence<'_>; 2],
    limits: &Limits,
    found: &mut Comparison,
) -> Result<(), CompareError> {
    let open = |side: Side| {
        let refused = |verdict| CompareError::Replay { side, verdict };
        RawReplay::<G>::open(known[side.index()].replay, limits).map_err(refused)
    };
    let mut comparison = ReplayComparison { a: open(Side::A)?, b: open(Side::B)?, found };
    comparison.compare(0)?;
    while comparison.found.first_different.is_none() {
        match comparison.step() {
            Ok(Step::Ticked) => {}
            Ok(Step::Ended) => break,
            Err(ReplayComparisonError::Compare(error)) => return Err(error),
            Err(ReplayComparisonError::Verdict(side, verdict)) => {
                let tick = comparison.played();
                comparison.found.notes.push(format!("{side} cannot be played beyond tick {tick}: {verdict}"));
                break;
            }
        }
    }
    let played = comparison.played();
    comparison.found.simulated = Some(played);
    Ok(())
}

enum ReplayComparisonError {
    Compare(CompareError),
    Verdict(Side, Verdict),
}

impl From<CompareError> for ReplayComparisonError {
    fn from(error: CompareError) -> Self {
        ReplayComparisonError::Compare(error)
    }
}

struct ReplayComparison<'f, 'a, G: Game> {
    a: RawReplay<'a, G>,
    b: RawReplay<'a, G>,
    found: &'f mut Comparison,
}

impl<G: Game> ReplayComparison<'_, '_, G> {
    /// Number of ticks that both sides have played.
    fn played(&self) -> u64 {
        self.a.tick().min(self.b.tick())
    }

    /// Plays a tick on both sides. If the setups are equal, the states before the tick are equal too: with equal inputs
    /// only A's game is played, otherwise B's game first loads the state of A's game.
    fn step(&mut self) -> Result<Step, ReplayComparisonError> {
        let of = |side| move |verdict| ReplayComparisonError::Verdict(side, verdict);
        let a = self.a.read_inputs().map_err(of(Side::A))?;
        let b = self.b.read_inputs().map_err(of(Side::B))?;
        if (a, b) != (Step::Ticked, Step::Ticked) {
            return Ok(Step::Ended);
        }
        let is_shared = self.found.setup.is_empty();
        if is_shared && self.a.encoded() == self.b.encoded() {
            self.a.play().map_err(of(Side::A))?;
            self.b.skip();
            self.found.last_equal = Some(self.a.tick());
            return Ok(Step::Ticked);
        }
        let before = self.a.game().save();
        if is_shared {
            self.b.game_mut().load(&before);
        }
        let before = [before, self.b.game().save()];
        self.a.play().map_err(of(Side::A))?;
        self.b.play().map_err(of(Side::B))?;
        self.compare(self.a.tick())?;
        if self.found.first_different.is_some() {
            let [a, b] = [(&mut self.a, &before[0]), (&mut self.b, &before[1])].map(|(raw, before)| {
                let inputs = raw.inputs().to_vec();
                let game = raw.game_mut();
                game.load(before);
                TickPhases::of(game, &inputs)
            });
            self.found.stage = a.parting(&b);
        }
        Ok(Step::Ticked)
    }

    fn compare(&mut self, tick: u64) -> Result<(), CompareError> {
        let (a, b) = (self.a.game(), self.b.game());
        if a.state_hash() == b.state_hash() {
            self.found.last_equal = Some(tick);
            return Ok(());
        }
        self.found.first_different = Some(tick);
        self.found.tick = Some(tick);
        self.found.subjects = candidate::subjects(differences(&fields(&a.save())?, &fields(&b.save())?));
        Ok(())
    }
}
