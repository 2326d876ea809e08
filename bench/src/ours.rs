//! Adapter from lockstep2d to the benchmark's interface.

use anyhow::{Context, Result, anyhow, ensure};
use lockstep2d::body::BodyKind;
use lockstep2d::world::{Config, Snapshot, World};

use crate::engine::{BodyState, Contacts, Counts, Engine, SAVES, float, floats};
use crate::script::Event;

pub struct Ours {
    world: World,
    saves: [Option<Snapshot>; SAVES],
}

impl Ours {
    pub fn new(config: &Config, threads: usize) -> Result<Self> {
        let mut world = World::new(*config).map_err(|error| anyhow!("{error}"))?;
        ensure!(world.set_threads(threads), "lockstep2d cannot use {threads} threads");
        Ok(Ours { world, saves: Default::default() })
    }
}

impl Engine for Ours {
    fn apply(&mut self, (command, outcome): &Event) -> Result<()> {
        let made = self.world.execute(command).map_err(|error| anyhow!("{error}"))?;
        ensure!(made == *outcome, "the command gave {made:?}, but {outcome:?} was recorded");
        Ok(())
    }

    fn step(&mut self) {
        self.world.step();
    }

    fn bodies(&self) -> Vec<BodyState> {
        let moving = self.world.bodies().filter(|(_, body)| body.kind() != BodyKind::Fixed);
        let state = moving.map(|(_, body)| BodyState {
            dynamic: body.is_dynamic(),
            awake: body.is_enabled() && !body.is_asleep(),
            mass: float(body.mass()),
            centre: floats(body.centre_of_mass()),
            velocity: floats(body.velocity()),
        });
        state.collect()
    }

    fn counts(&self) -> Counts {
        let world = &self.world;
        Counts { bodies: world.body_count(), shapes: world.shape_count(), joints: world.joint_count() }
    }

    fn contacts(&self) -> Contacts {
        let mut found = Contacts::default();
        for contact in self.world.contacts() {
            let points = contact.manifold.points();
            found.pairs += usize::from(!points.is_empty());
            let depths = points.iter().map(|point| -point.separation.to_num::<f64>());
            found.deepest = depths.fold(found.deepest, f64::max);
        }
        found
    }

    fn joint_gap(&self) -> Option<f64> {
        let gaps = self.world.joints().filter_map(|(id, _)| {
            let (a, b) = self.world.joint_anchors(id)?;
            Some(float(a.distance(b)))
        });
        gaps.max_by(f64::total_cmp)
    }

    fn save(&mut self, slot: usize) {
        match &mut self.saves[slot] {
            Some(save) => self.world.save_into(save),
            empty => *empty = Some(self.world.save()),
        }
    }

    fn saved_bytes(&self, _: usize) -> usize {
        self.world.to_bytes().len()
    }

    fn held_bytes(&self, slot: usize) -> usize {
        self.saves[slot].as_ref().map_or(0, |save| save.rollback_bytes())
    }

    fn restore(&mut self, slot: usize) -> Result<()> {
        self.world.restore(self.saves[slot].as_ref().context("nothing is saved")?);
        Ok(())
    }

    fn checksum(&self, _: usize) -> u128 {
        self.world.state_hash().0
    }

    fn hash(&self) -> Option<u128> {
        Some(self.world.state_hash().0)
    }
}
