//! Games with a physics world must not depend on data that is not in the saved state.

use lockstep2d::body::{BodyDef, BodyId, Geometry, Polygon, ShapeDef};
use lockstep2d::check::{CheckOptions, Depths, Fault, Phases, Variant, check, check_replay};
use lockstep2d::fx;
use lockstep2d::hash::StateHash;
use lockstep2d::lockstep::{Game, RulesId, SetupError};
use lockstep2d::math::{Fx, Vec2};
use lockstep2d::world::{Config, Snapshot, World};
use serde::{Deserialize, Serialize};

/// Planted fault. The setup selects it, so that one compiled game serves for all faults.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
enum Mistake {
    None,
    /// The step depends on the world's contacts, which a restore drops.
    Contacts,
    /// The wind is not saved.
    Wind,
}

struct Pit {
    mistake: Mistake,
    world: World,
    ball: BodyId,
    wind: Fx,
    score: u32,
}

impl Game for Pit {
    type Setup = Mistake;
    type Input = bool;
    type Save = (Snapshot, u32);

    const RULES: RulesId = RulesId { name: "pit", version: 1 };

    fn new(&mistake: &Mistake) -> Result<Self, SetupError> {
        let refused = |why| SetupError { why };
        let mut world = World::new(Config::default()).map_err(|error| refused(error.to_string()))?;
        let floor = ShapeDef::new(Polygon::rectangle(fx!(20), fx!(1)).map_err(|e| refused(e.to_string()))?);
        let ball = ShapeDef::new(Geometry::circle(fx!(0.5)).map_err(|e| refused(e.to_string()))?);
        let spawned = world
            .spawn(&BodyDef::fixed().position((fx!(0), fx!(-1))), &[floor])
            .and_then(|_| world.spawn(&BodyDef::dynamic().position((fx!(0), fx!(0.7))), &[ball]));
        let ball = spawned.map_err(|error| refused(error.to_string()))?;
        Ok(Pit { mistake, world, ball, wind: fx!(0), score: 0 })
    }

    fn players(&self) -> u32 {
        1
    }

    fn tick_rate(&self) -> u32 {
        self.world.config().tick_rate
    }

    fn step(&mut self, kicks: &[bool]) {
        if kicks == [true] {
            self.wind += fx!(0.25);
        }
        if self.mistake == Mistake::Contacts && self.world.contacts().count() > 0 {
            self.score += 1;
        }
        if self.mistake == Mistake::Wind {
            let _ball_is_there = self.world.apply_impulse_to_centre(self.ball, Vec2::new(self.wind, fx!(0)));
        }
        self.world.step();
    }

    fn state_hash(&self) -> StateHash {
        StateHash::of_digests([self.world.state_hash(), StateHash::of(&self.score)])
    }

    fn save(&self) -> (Snapshot, u32) {
        (self.world.save(), self.score)
    }

    fn load(&mut self, (world, score): &(Snapshot, u32)) {
        self.world.restore(world);
        self.score = *score;
    }

    fn work(&self, _: &[bool]) -> u64 {
        1
    }

    fn world_mut(&mut self) -> Option<&mut World> {
        Some(&mut self.world)
    }
}

/// Inputs of 60 ticks with a kick in the 31st tick (index 30).
fn inputs() -> Vec<Vec<bool>> {
    (0..60).map(|tick| vec![tick == 30]).collect()
}

#[test]
fn a_good_game_with_a_world_passes() {
    let options = CheckOptions { depths: Depths::Each, phases: Phases::Compared, ..CheckOptions::default() };
    let checked = check::<Pit>(&Mistake::None, &inputs(), &options).unwrap();
    assert!(checked.variants.iter().any(|variant| matches!(variant, Variant::BroadPhase(_))));
    assert_eq!(
        checked.variants.iter().any(|variant| matches!(variant, Variant::Threads(_))),
        cfg!(feature = "parallel")
    );
    assert_eq!(checked.variants.len(), options.variants.len(), "expected all variants to be checked");
}

#[test]
fn who_reads_what_is_no_state_is_found() {
    for variant in [Variant::Reloaded, Variant::RolledBack, Variant::ClearedScratch] {
        let error = check::<Pit>(&Mistake::Contacts, &inputs(), &CheckOptions::default().only(&[variant]))
            .unwrap_err();
        let failure = error.failure().unwrap();
        assert_eq!(
            (failure.minimised.variant, &failure.minimised.fault),
            (variant, &Fault::Hash),
            "{failure}"
        );
        assert_eq!(failure.minimised.differences[0].field().path(), "[1]", "{failure}");
    }
}

/// The report names the body and its velocity. The minimised log has two ticks: one with a kick, and one in which the
/// wind of the kick is missing after a reload.
#[test]
fn the_body_and_the_field_are_named() {
    let options = CheckOptions::default().only(&[Variant::Again, Variant::Reloaded]);
    let error = check::<Pit>(&Mistake::Wind, &inputs(), &options).unwrap_err();
    let failure = error.failure().unwrap();
    assert_eq!((failure.finding.variant, failure.finding.tick), (Variant::Reloaded, 32), "{failure}");
    let paths = failure.finding.differences.iter().map(|difference| difference.field().path());
    assert!({ paths }.any(|path| path == "[0].bodies.body 1v0.velocity.x"), "{failure:?}");
    assert_eq!((failure.ticks, failure.minimised.tick), (2, 2));
    assert!(check_replay::<Pit>(&failure.replay, &CheckOptions::default()).is_err());
}

/// Wind is not saved, so a rollback from the tick of the kick to an earlier tick keeps the wind. The state then differs
/// from the original run in a tick before the kick.
#[test]
fn a_rollback_shows_before_it_has_happened() {
    let error = check::<Pit>(&Mistake::Wind, &inputs(), &CheckOptions::default()).unwrap_err();
    let failure = error.failure().unwrap();
    assert_eq!((failure.finding.variant, failure.finding.played), (Variant::RolledBack, 31), "{failure}");
    assert!(failure.finding.tick < 31, "{failure}");
    assert_eq!((failure.ticks, failure.failed), (1, (4, 4)), "{failure}");
}

/// The states differ before the step, so the report blames no phase of the step.
#[test]
fn a_loss_before_the_step_is_the_fault_of_no_phase() {
    let options =
        CheckOptions { phases: Phases::Compared, ..CheckOptions::default() }.only(&[Variant::Reloaded]);
    let error = check::<Pit>(&Mistake::Wind, &inputs(), &options).unwrap_err();
    let finding = &error.failure().unwrap().finding;
    assert_eq!((finding.tick, finding.phase), (32, None), "{finding}");
}
