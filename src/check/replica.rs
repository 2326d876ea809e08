use alloc::boxed::Box;
use alloc::string::{String, ToString};
use alloc::vec::Vec;

use super::byte_swap::ByteSwaps;
use super::checker::{another, step};
use super::finding::{Fault, Finding};
use super::options::{CheckOptions, Variant};
use super::rollback::Past;
use crate::codec;
use crate::hash::StateHash;
use crate::lockstep::Game;
use crate::world::PhaseDigest;

pub(super) struct Now<'a, G: Game> {
    pub(super) setup: &'a G::Setup,
    pub(super) options: &'a CheckOptions,
    pub(super) straight: &'a G,
    pub(super) inputs: &'a [G::Input],
    pub(super) hash: StateHash,
    pub(super) tick: u64,
    /// Digests of the phases of the tick, if phases are compared.
    pub(super) phases: &'a [PhaseDigest],
    /// The claims, once the game has ended.
    pub(super) claims: Vec<(String, i64)>,
}

/// A second instance of the game, which plays one variant beside the reference run.
pub(super) struct Replica<G: Game> {
    pub(super) variant: Variant,
    game: G,
    pub(super) steps: u64,
    past: Past<G>,
    byte_swaps: ByteSwaps<G>,
}

impl<G: Game> Replica<G> {
    pub(super) fn begin(variant: Variant, now: &Now<'_, G>) -> Result<Self, Box<Finding>> {
        let mut game = another::<G>(now.setup, variant, now.tick)?;
        if now.tick > 0 {
            game.load(&now.straight.save());
        }
        let (past, byte_swaps) = (Past::default(), ByteSwaps::default());
        let mut replica = Replica { variant, game, steps: 0, past, byte_swaps };
        if variant != Variant::HashUnpolled {
            replica.compare(now)?;
        }
        replica.perturb(now)?;
        Ok(replica)
    }

    /// Plays the tick of the reference run, compares the results, and performs the variant's extra operation.
    pub(super) fn step(&mut self, now: &Now<'_, G>) -> Result<(), Box<Finding>> {
        self.arrange();
        if self.variant == Variant::Again {
            // The reference run calls `work` before each tick, so this variant does the same.
            let _work = self.game.work(now.inputs);
        }
        let phases = step(&mut self.game, now.inputs, now.options.phases);
        self.steps += 1;
        if self.variant == Variant::HashUnpolled {
            return Ok(());
        }
        let apart = phases.iter().zip(now.phases).find(|(a, b)| a != b);
        if let Some((logged, _)) = apart {
            let is_same = self.game.state_hash() == now.hash;
            let fault = if is_same { Fault::Phase } else { Fault::Hash };
            let finding = self.finding(fault, now).with_saves(&now.straight.save(), &self.game.save());
            return Err(Box::new(Finding { phase: logged.phase, ..finding }));
        }
        self.compare(now)?;
        self.perturb(now)
    }

    pub(super) fn finish(&mut self, now: &Now<'_, G>) -> Result<(), Box<Finding>> {
        match self.variant {
            Variant::HashUnpolled => self.compare(now),
            Variant::Again if self.game.claims() != now.claims => {
                Err(Box::new(self.finding(Fault::Answers { of: "claims" }, now)))
            }
            Variant::ByteSwapped => self.byte_swaps.finish(&self.game, now, &mut self.steps),
            _ => Ok(()),
        }
    }

    fn compare(&self, now: &Now<'_, G>) -> Result<(), Box<Finding>> {
        if self.game.state_hash() == now.hash {
            return Ok(());
        }
        let finding = self.finding(Fault::Hash, now);
        Err(Box::new(finding.with_saves(&now.straight.save(), &self.game.save())))
    }

    fn finding(&self, fault: Fault, now: &Now<'_, G>) -> Finding {
        Finding::new(self.variant, fault, now.tick)
    }

    /// Configures the world for the variant. Called before every tick, because a game may replace its world.
    fn arrange(&mut self) {
        let Some(world) = self.game.world_mut() else {
            return;
        };
        match self.variant {
            Variant::Backend(backend) if world.backend() != backend => {
                let _is_available = world.set_backend(backend);
            }
            Variant::BroadPhase(kind) if world.tick() == 0 || self.steps == 0 => world.set_broad_phase(kind),
            #[cfg(feature = "parallel")]
            Variant::Threads(count) if world.threads() != count => {
                let _are_available = world.force_threads(count);
            }
            _ => {}
        }
    }

    fn perturb(&mut self, now: &Now<'_, G>) -> Result<(), Box<Finding>> {
        let is_due = now.options.is_due(now.tick);
        match self.variant {
            Variant::HashPolled => self.ask(now),
            Variant::Reloaded if is_due => self.reload(now),
            Variant::RolledBack => self.past.perturb(&mut self.game, now, &mut self.steps),
            Variant::ByteSwapped => self.byte_swaps.perturb(&self.game, now, &mut self.steps),
            Variant::ClearedScratch if is_due => {
                if let Some(world) = self.game.world_mut() {
                    world.clear_scratch();
                }
                Ok(())
            }
            _ => Ok(()),
        }
    }

    fn ask(&self, now: &Now<'_, G>) -> Result<(), Box<Finding>> {
        let answers = || {
            let game = &self.game;
            (game.state_hash(), game.work(now.inputs), game.claims(), codec::encode(&game.save()))
        };
        let (a, b) = (answers(), answers());
        let same =
            [("state_hash", a.0 == b.0), ("work", a.1 == b.1), ("claims", a.2 == b.2), ("save", a.3 == b.3)];
        match same.into_iter().find(|(_, same)| !same) {
            Some((of, _)) => Err(Box::new(self.finding(Fault::Answers { of }, now))),
            None => self.compare(now),
        }
    }

    fn reload(&mut self, now: &Now<'_, G>) -> Result<(), Box<Finding>> {
        let save = self.game.save();
        let bytes = codec::encode(&save);
        let decoded: G::Save = match codec::decode(&bytes) {
            Ok(decoded) => decoded,
            Err(error) => {
                let fault = Fault::Unreadable { why: error.to_string() };
                return Err(Box::new(self.finding(fault, now)));
            }
        };
        if codec::encode(&decoded) != bytes {
            return Err(Box::new(self.finding(Fault::Encoding, now).with_saves(&save, &decoded)));
        }
        let mut fresh = another::<G>(now.setup, self.variant, now.tick)?;
        fresh.load(&decoded);
        let again = fresh.save();
        if fresh.state_hash() != now.hash {
            return Err(Box::new(self.finding(Fault::Loaded, now).with_saves(&save, &again)));
        }
        if codec::encode(&again) != bytes {
            return Err(Box::new(self.finding(Fault::SavedAgain, now).with_saves(&save, &again)));
        }
        self.game = fresh;
        Ok(())
    }
}
