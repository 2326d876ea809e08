//! Minimises a failing log: delta debugging over ticks, then over inputs.

use alloc::boxed::Box;
use alloc::vec::Vec;

use super::checker::{Checked, Checker, another};
use super::failure::Failure;
use super::finding::{Fault, Finding};
use super::log::{Inputs, Log};
use super::options::{CheckOptions, Variant};
use crate::lockstep::Game;
use crate::replay::{Recording, Verdict, verify};

/// Number of replicas of [`Variant::Again`] that are played to detect a random failure.
const AGAIN: usize = 4;

pub(super) fn run<G: Game>(
    setup: &G::Setup,
    log: &Log<G>,
    options: &CheckOptions,
) -> Result<Checked, Box<Finding>> {
    run_counted(setup, log, options, &mut 0)
}

fn run_counted<G: Game>(
    setup: &G::Setup,
    log: &Log<G>,
    options: &CheckOptions,
    simulated: &mut u64,
) -> Result<Checked, Box<Finding>> {
    let options = &options.for_ticks(log.len().min(options.to));
    let refused = |why| Box::new(Finding::new(Variant::Again, Fault::Refused { why }, 0));
    let mut checker = Checker::<G>::new(setup, options).map_err(|error| refused(error.why))?;
    let ticks = log.ticks.iter().zip(0..options.to).map(|(inputs, _)| inputs);
    let checked = { ticks }.try_for_each(|inputs| checker.step(inputs)).and_then(|()| checker.end());
    *simulated = simulated.saturating_add(checker.simulated());
    let mut checked = checked?;
    if options.variants.contains(&Variant::Recorded) {
        *simulated = simulated.saturating_add(2 * checked.ticks);
        record(setup, log, options, checker.game())?;
        checked.variants.push(Variant::Recorded);
    }
    Ok(checked)
}

/// Records and verifies the log. `last` is the game at the end of the reference run.
fn record<G: Game>(
    setup: &G::Setup,
    log: &Log<G>,
    options: &CheckOptions,
    last: &G,
) -> Result<(), Box<Finding>> {
    let found = |fault, tick| Err(Box::new(Finding::new(Variant::Recorded, fault, tick)));
    let compare = |reference: &G, recorded: &G, tick| {
        if reference.state_hash() == recorded.state_hash() {
            return Ok(());
        }
        let finding = Finding::new(Variant::Recorded, Fault::Hash, tick);
        Err(Box::new(finding.with_saves(&reference.save(), &recorded.save())))
    };
    let mut recording = match Recording::<G>::start(setup, log.interval) {
        Ok(recording) => recording,
        Err(error) => return found(Fault::Unrecordable(error), 0),
    };
    // The recorded game starts from the setup as a verifier decodes it, which may give another state.
    compare(&another::<G>(setup, Variant::Recorded, 0)?, recording.game(), 0)?;
    for (inputs, tick) in log.ticks.iter().zip(0..options.to) {
        if let Err(error) = recording.step(inputs) {
            return Err(Finding::in_next(Variant::Recorded, Fault::Unrecordable(error), tick));
        }
    }
    let ticks = recording.ticks();
    compare(last, recording.game(), ticks)?;
    let file = match recording.finish() {
        Ok(file) => file,
        Err(error) => return found(Fault::Unrecordable(error), ticks),
    };
    match verify::<G>(&file, &options.limits) {
        Verdict::Match { .. } => Ok(()),
        Verdict::Diverged { last_equal, first_different } => {
            found(Fault::Verdict(Verdict::Diverged { last_equal, first_different }), first_different)
        }
        verdict => found(Fault::Verdict(verdict), ticks),
    }
}

/// Turns a finding into a failure with a minimised replay.
pub(super) fn minimise<G: Game>(
    setup: &G::Setup,
    log: &Log<G>,
    finding: Finding,
    options: &CheckOptions,
) -> Failure {
    if options.budget == 0 {
        let cut = first(log, finding.played);
        let (minimised, replay) = (finding.clone(), cut.record(setup));
        return Failure { finding, minimised, replay, ticks: cut.len(), failed: (1, 1) };
    }
    let mut search = Search { setup, options: options.clone(), spent: 0, need: 0 };
    let variant = finding.variant;
    // A random failure can appear in any variant, so [`Variant::Again`] is tried first.
    let (finding, best) = [Variant::Again, variant]
        .into_iter()
        .find_map(|variant| search.begin(log, variant, &finding))
        .unwrap_or_else(|| (finding.clone(), Attempt { ticks: log.ticks.clone(), finding, failed: 0 }));
    // The runs so far only measured how often the log fails. They do not count, because for a long log they would use
    // up the whole budget.
    search.spent = 0;
    let best = if search.need > 0 { search.shrink(log, best) } else { best };
    let log = log.of(best.ticks);
    Failure {
        finding,
        minimised: best.finding,
        replay: log.record(setup),
        ticks: log.len(),
        failed: (best.failed, options.repeats.max(1)),
    }
}

/// The first ticks of a log, at least one.
fn first<G: Game>(log: &Log<G>, ticks: u64) -> Log<G> {
    log.of(log.ticks.iter().zip(0..ticks.max(1)).map(|(inputs, _)| inputs.clone()).collect())
}

struct Attempt<G: Game> {
    ticks: Vec<Inputs<G>>,
    finding: Finding,
    failed: u32,
}

struct Search<'s, G: Game> {
    setup: &'s G::Setup,
    options: CheckOptions,
    spent: u64,
    /// Number of runs of a candidate log that have to fail before the log counts as failing.
    need: u32,
}

impl<G: Game> Search<'_, G> {
    fn begin(&mut self, log: &Log<G>, variant: Variant, finding: &Finding) -> Option<(Finding, Attempt<G>)> {
        let variants = if variant == Variant::Again { [variant; AGAIN].to_vec() } else { [variant].to_vec() };
        // All other options stay, so that a later check with the caller's options finds the fault in the minimised log.
        self.options = CheckOptions { variants, from: 0, ..self.options.clone() };
        self.need = 1;
        let of_cut = self.attempt(first(log, finding.played).ticks, log);
        // If the failure is random, the whole log may fail more often than a log that was cut after the failing tick.
        self.need = of_cut.as_ref().map_or(0, |found| found.failed) + 1;
        let of_all = match self.need <= self.options.repeats {
            true => self.attempt(log.ticks.clone(), log),
            false => None,
        };
        let found = of_all.or(of_cut);
        self.need = found.as_ref().map_or(0, |found| found.failed);
        let found = found?;
        let finding = if variant == finding.variant { finding.clone() } else { found.finding.clone() };
        Some((finding, found))
    }

    /// Plays a candidate log repeatedly. Returns `None` as soon as it can no longer fail as often as [`Search::need`]
    /// requires. A candidate that fails often enough is cut after its last failing tick. A failure in another variant
    /// does not count: a candidate with more work may exceed a limit, for example.
    fn attempt(&mut self, mut ticks: Vec<Inputs<G>>, log: &Log<G>) -> Option<Attempt<G>> {
        let repeats = self.options.repeats.max(1);
        let candidate = log.of(ticks.clone());
        let (mut failed, mut last): (u32, Option<Box<Finding>>) = (0, None);
        for left in (0..repeats).rev() {
            let result = run_counted(self.setup, &candidate, &self.options, &mut self.spent);
            if let Some(found) = result.err().filter(|found| self.options.variants.contains(&found.variant)) {
                failed += 1;
                if last.as_ref().is_none_or(|last| last.played < found.played) {
                    last = Some(found);
                }
            }
            if failed + left < self.need {
                return None;
            }
        }
        let finding = *last?;
        ticks.truncate(usize::try_from(finding.played.max(1)).unwrap_or(usize::MAX));
        Some(Attempt { ticks, finding, failed })
    }

    fn is_spent(&self) -> bool {
        self.spent >= self.options.budget
    }

    /// Tries to remove ticks, to replace the inputs of all players or of one player by the default, and to repeat the
    /// inputs of the tick before. Continues until the log does not become smaller or the budget is spent.
    fn shrink(&mut self, log: &Log<G>, mut best: Attempt<G>) -> Attempt<G> {
        loop {
            let before = weight(&best.ticks);
            self.pass(log, &mut best, &|ticks, from, to| Some([&ticks[..from], &ticks[to..]].concat()));
            let nothing = log.nothing();
            self.pass(log, &mut best, &|ticks, from, to| replaced(ticks, from, to, |_| nothing.clone()));
            for player in 0..log.players as usize {
                self.pass(log, &mut best, &|ticks, from, to| {
                    replaced(ticks, from, to, |inputs| without(inputs, player))
                });
            }
            self.pass(log, &mut best, &|ticks, from, to| {
                let held = ticks[from.checked_sub(1)?].clone();
                replaced(ticks, from, to, |_| held.clone())
            });
            if self.is_spent() || weight(&best.ticks) >= before {
                return best;
            }
        }
    }

    /// Applies a change to the whole log, then to halves, quarters and so on. Keeps the results that are smaller and
    /// still fail.
    fn pass(&mut self, log: &Log<G>, best: &mut Attempt<G>, change: &Change<'_, G>) {
        let mut size = best.ticks.len();
        while size > 0 {
            // Starts at the end, because early ticks influence more of the game.
            let mut to = best.ticks.len();
            while to > 0 && !self.is_spent() {
                let from = to.saturating_sub(size);
                let changed =
                    change(&best.ticks, from, to).filter(|ticks| weight(ticks) < weight(&best.ticks));
                if let Some(found) = changed.and_then(|ticks| self.attempt(ticks, log)) {
                    *best = found;
                }
                to = from.min(best.ticks.len());
            }
            size /= 2;
        }
    }
}

/// A change of the ticks between two indices. `None` if it is not possible.
type Change<'a, G> = dyn Fn(&[Inputs<G>], usize, usize) -> Option<Vec<Inputs<G>>> + 'a;

fn replaced<I: Clone>(ticks: &[I], from: usize, to: usize, with: impl Fn(&I) -> I) -> Option<Vec<I>> {
    let changed = ticks[from..to].iter().map(with).collect::<Vec<_>>();
    Some([&ticks[..from], &changed, &ticks[to..]].concat())
}

fn without<I: Clone + Default>(inputs: &alloc::rc::Rc<[I]>, player: usize) -> alloc::rc::Rc<[I]> {
    let mut inputs = inputs.to_vec();
    if let Some(input) = inputs.get_mut(player) {
        *input = I::default();
    }
    inputs.into()
}

/// Size of a log: the numbers of ticks, of inputs that are not the default, and of changes between ticks, which are
/// compared in this order.
fn weight<I: Default + PartialEq>(ticks: &[alloc::rc::Rc<[I]>]) -> (usize, usize, usize) {
    let nothing = I::default();
    let inputs = ticks.iter().flat_map(|inputs| inputs.iter());
    let changes = ticks.windows(2).filter(|pair| pair[0] != pair[1]).count();
    (ticks.len(), inputs.filter(|input| **input != nothing).count(), changes)
}
