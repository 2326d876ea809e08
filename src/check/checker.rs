#[cfg(test)]
mod tests;

use alloc::boxed::Box;
use alloc::vec;
use alloc::vec::Vec;

use super::finding::{Fault, Finding};
use super::options::{CheckOptions, Phases, Variant};
use super::replica::{Now, Replica};
use crate::hash::StateHash;
use crate::lockstep::{Game, SetupError};
use crate::replay::play_within;
use crate::world::PhaseDigest;

/// Result of a check that found no fault.
///
/// ```
/// use lockstep2d::check::{Checked, CheckOptions, Variant, check};
/// use lockstep2d::lockstep::{Sandbox, SandboxSetup};
/// # use lockstep2d::check::CheckError;
/// // Ten ticks without commands, saved and loaded after each of them.
/// let (setup, inputs) = (SandboxSetup::default(), vec![vec![vec![]]; 10]);
/// let options = CheckOptions::default().only(&[Variant::Reloaded]);
/// let Checked { ticks, variants, .. } = check::<Sandbox>(&setup, &inputs, &options)?;
/// assert_eq!((ticks, variants), (10, vec![Variant::Reloaded]));
/// # Ok::<(), CheckError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Checked {
    /// Number of ticks played.
    pub ticks: u64,
    /// Hash after the last tick.
    pub hash: StateHash,
    /// The variants in which the ticks were played, in addition to the reference run.
    pub variants: Vec<Variant>,
    /// Number of ticks simulated by the reference run and by all variants except [`Variant::Recorded`].
    pub simulated: u64,
}

/// Checks a game while a caller plays it, for callers that do not have all inputs beforehand. Supports all variants
/// except [`Variant::Recorded`].
///
/// Do not use a checker after its first finding.
///
/// ```
/// # use lockstep2d::{body::BodyDef, world::Command};
/// use lockstep2d::check::{Checker, CheckOptions};
/// use lockstep2d::lockstep::{Sandbox, SandboxSetup};
/// // A bot decides by the current state, so its inputs are not known beforehand.
/// let setup = SandboxSetup::default();
/// let mut checker = Checker::<Sandbox>::new(&setup, &CheckOptions::default())?;
/// while checker.tick() < 10 {
///     let is_empty = checker.game().world().body_count() == 0;
///     let spawn = Command::Spawn { body: BodyDef::dynamic(), shapes: vec![] };
///     checker.step(&[if is_empty { vec![spawn] } else { vec![] }]).expect("the same in every variant");
/// }
/// assert_eq!(checker.finish().map(|checked| checked.ticks), Ok(10));
/// # Ok::<(), lockstep2d::lockstep::SetupError>(())
/// ```
pub struct Checker<'s, G: Game> {
    setup: &'s G::Setup,
    options: CheckOptions,
    straight: G,
    hash: StateHash,
    tick: u64,
    work: u64,
    /// Digests of the phases of the last tick, if phases are compared.
    phases: Vec<PhaseDigest>,
    /// The games that play the variants. Empty before the tick at which checking begins.
    replicas: Vec<Replica<G>>,
}

impl<'s, G: Game> Checker<'s, G> {
    /// Creates the game before its first tick.
    ///
    /// # Errors
    /// [`SetupError`] if the setup cannot start a game.
    pub fn new(setup: &'s G::Setup, options: &CheckOptions) -> Result<Self, SetupError> {
        let straight = G::new(setup)?;
        let hash = straight.state_hash();
        let options = options.clone();
        Ok(Checker {
            setup,
            options,
            straight,
            hash,
            tick: 0,
            work: 0,
            phases: Vec::new(),
            replicas: Vec::new(),
        })
    }

    /// The reference run at the current tick.
    #[must_use]
    pub fn game(&self) -> &G {
        &self.straight
    }

    /// Number of ticks played.
    #[must_use]
    pub fn tick(&self) -> u64 {
        self.tick
    }

    /// Number of ticks simulated so far by the reference run and the variants.
    #[must_use]
    pub fn simulated(&self) -> u64 {
        self.tick + self.replicas.iter().map(|replica| replica.steps).sum::<u64>()
    }

    /// Plays one tick in the reference run and, from [`CheckOptions::from`] on, in the variants.
    ///
    /// # Errors
    /// The first [`Finding`].
    pub fn step(&mut self, inputs: &[G::Input]) -> Result<(), Box<Finding>> {
        self.begin()?;
        let Checker { options, straight, work, .. } = self;
        let played = play_within(straight, inputs, &options.limits, work, |game, inputs| {
            step(game, inputs, options.phases)
        });
        self.phases = played
            .map_err(|verdict| Finding::in_next(Variant::Recorded, Fault::Verdict(verdict), self.tick))?;
        self.hash = self.straight.state_hash();
        self.tick += 1;
        let now = Now {
            setup: self.setup,
            options: &self.options,
            straight: &self.straight,
            inputs,
            hash: self.hash,
            tick: self.tick,
            phases: &self.phases,
            claims: Vec::new(),
        };
        self.replicas.iter_mut().try_for_each(|replica| replica.step(&now))
    }

    /// Runs the checks that are only possible at the end.
    ///
    /// # Errors
    /// The first [`Finding`].
    pub fn finish(mut self) -> Result<Checked, Box<Finding>> {
        self.end()
    }

    /// Does the work of [`Checker::finish`]. The ticks that it simulates count in [`Checker::simulated`].
    pub(super) fn end(&mut self) -> Result<Checked, Box<Finding>> {
        self.begin()?;
        let mut replicas = core::mem::take(&mut self.replicas);
        let nothing = self.nothing();
        let now = Now { claims: self.straight.claims(), ..self.now(&nothing) };
        let ended = replicas.iter_mut().try_for_each(|replica| replica.finish(&now));
        self.replicas = replicas;
        ended?;
        let variants = self.replicas.iter().map(|replica| replica.variant).collect();
        Ok(Checked { ticks: self.tick, hash: self.hash, variants, simulated: self.simulated() })
    }

    /// The default input of every player, for places where inputs are required but no tick is played.
    fn nothing(&self) -> Vec<G::Input> {
        vec![G::Input::default(); self.straight.players() as usize]
    }

    fn now<'a>(&'a self, inputs: &'a [G::Input]) -> Now<'a, G> {
        let Checker { setup, options, straight, hash, tick, phases, .. } = self;
        Now { setup, options, straight, inputs, hash: *hash, tick: *tick, phases, claims: Vec::new() }
    }

    /// Starts the replicas at the tick at which checking begins.
    fn begin(&mut self) -> Result<(), Box<Finding>> {
        if self.tick != self.options.from || !self.replicas.is_empty() {
            return Ok(());
        }
        let has_world = self.straight.world_mut().is_some();
        let variants = self.options.variants.clone();
        let variants = variants
            .into_iter()
            .filter(|variant| *variant != Variant::Recorded && (has_world || !variant.needs_world()));
        let nothing = self.nothing();
        let mut replicas = Vec::new();
        for variant in variants {
            let now = self.now(&nothing);
            replicas.push(Replica::begin(variant, &now)?);
        }
        self.replicas = replicas;
        Ok(())
    }
}

/// Plays a tick, and returns the digests of its phases if phases are compared.
pub(super) fn step<G: Game>(game: &mut G, inputs: &[G::Input], phases: Phases) -> Vec<PhaseDigest> {
    if phases == Phases::Compared
        && let Some(world) = game.world_mut()
    {
        world.log_phases();
    }
    game.step(inputs);
    match (phases, game.world_mut()) {
        (Phases::Compared, Some(world)) => world.phase_digests().to_vec(),
        _ => Vec::new(),
    }
}

pub(super) fn another<G: Game>(setup: &G::Setup, variant: Variant, tick: u64) -> Result<G, Box<Finding>> {
    G::new(setup).map_err(|error| Box::new(Finding::new(variant, Fault::Refused { why: error.why }, tick)))
}
