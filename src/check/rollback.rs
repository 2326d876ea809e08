#[cfg(test)]
mod tests;

use alloc::boxed::Box;
use alloc::collections::VecDeque;
use alloc::vec;
use alloc::vec::Vec;

use super::finding::{Fault, Finding, Guess};
use super::options::{Depths, Variant};
use super::replica::Now;
use crate::hash::StateHash;
use crate::lockstep::Game;

const DEPTH_MAX: u32 = 64;

pub(super) struct Past<G: Game> {
    moments: VecDeque<Moment<G>>,
}

struct Moment<G: Game> {
    inputs: Vec<G::Input>,
    save: G::Save,
    hash: StateHash,
}

impl<G: Game> Default for Past<G> {
    fn default() -> Self {
        Past { moments: VecDeque::new() }
    }
}

type Rollback = (u32, Guess);

impl<G: Game> Past<G> {
    pub(super) fn perturb(
        &mut self,
        game: &mut G,
        now: &Now<'_, G>,
        steps: &mut u64,
    ) -> Result<(), Box<Finding>> {
        let depth_max = now.options.rollback_max.min(DEPTH_MAX);
        if self.moments.len() > depth_max as usize {
            self.moments.pop_front();
        }
        self.moments.push_back(Moment { inputs: now.inputs.to_vec(), save: game.save(), hash: now.hash });
        if !now.options.is_due(now.tick) {
            return Ok(());
        }
        let turn = now.tick / now.options.every.max(1);
        let last = self.moments.len() - 1;
        let earlier = u32::try_from(last).unwrap_or(u32::MAX);
        for (depth, guess) in rollbacks(now.options.depths, depth_max, earlier, turn) {
            *steps += u64::from(depth) * if guess == Guess::Right { 1 } else { 2 };
            self.roll_back(game, last - depth as usize, depth, guess, now)?;
        }
        Ok(())
    }

    /// Rolls back to a moment and plays up to the current tick: first with the predicted inputs, unless these are the
    /// actual inputs, then with the actual inputs.
    fn roll_back(
        &self,
        game: &mut G,
        first: usize,
        depth: u32,
        guess: Guess,
        now: &Now<'_, G>,
    ) -> Result<(), Box<Finding>> {
        let start = &self.moments[first];
        if guess != Guess::Right {
            let guessed = match guess {
                Guess::Held => start.inputs.clone(),
                _ => vec![G::Input::default(); now.inputs.len()],
            };
            game.load(&start.save);
            (0..depth).for_each(|_| game.step(&guessed));
        }
        game.load(&start.save);
        for (moment, left) in self.moments.iter().skip(first).zip((0..=depth).rev()) {
            if left < depth {
                game.step(&moment.inputs);
            }
            if game.state_hash() != moment.hash {
                let fault = if left < depth { Fault::Hash } else { Fault::Loaded };
                let finding = Finding::new(Variant::RolledBack, fault, now.tick - u64::from(left));
                let finding = finding.with_saves(&moment.save, &game.save());
                let rollback = Some((depth, guess));
                return Err(Box::new(Finding { rollback, played: now.tick, ..finding }));
            }
        }
        Ok(())
    }
}

/// The rollbacks to make at a tick. `earlier` is the number of stored states of earlier ticks, which is less than
/// `depth_max` near the start of the log. `turn` counts the ticks with rollbacks.
fn rollbacks(depths: Depths, depth_max: u32, earlier: u32, turn: u64) -> Vec<Rollback> {
    let each = |depth: u32| Guess::ALL.into_iter().map(move |guess| (depth, guess));
    match depths {
        Depths::Each => (1..=depth_max.min(earlier)).flat_map(each).collect(),
        Depths::InTurn => {
            let depth = (1..=depth_max).nth(remainder(turn, depth_max));
            let guess = Guess::ALL[remainder(turn / u64::from(depth_max.max(1)), 3)];
            let possible = depth.map(|depth| depth.min(earlier)).filter(|depth| *depth > 0);
            possible.map(|depth| (depth, guess)).into_iter().collect()
        }
    }
}

fn remainder(turn: u64, of: u32) -> usize {
    usize::try_from(turn % u64::from(of.max(1))).unwrap_or(0)
}
