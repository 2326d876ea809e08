//! A game that exposes its world for reading only (`Game::world`).

use lockstep2d::body::{BodyDef, Geometry, ShapeDef};
use lockstep2d::fx;
use lockstep2d::hash::StateHash;
use lockstep2d::lockstep::{Game, RulesId, SetupError};
use lockstep2d::replay::Recording;
use lockstep2d::world::{Snapshot, World};
use lockstep2d_cli::{Exit, Tool};

use crate::{Folder, run_tool_of};

/// A ball that falls.
struct Ball(World);

impl Game for Ball {
    type Setup = ();
    type Input = ();
    type Save = Snapshot;

    const RULES: RulesId = RulesId { name: "ball", version: 1 };

    fn new(_: &()) -> Result<Self, SetupError> {
        let mut world = World::default();
        let ball = ShapeDef::new(Geometry::circle(fx!(0.5)).unwrap());
        world.spawn(&BodyDef::dynamic(), &[ball]).unwrap();
        Ok(Ball(world))
    }

    fn players(&self) -> u32 {
        1
    }

    fn tick_rate(&self) -> u32 {
        60
    }

    fn step(&mut self, _: &[()]) {
        self.0.step();
    }

    fn state_hash(&self) -> StateHash {
        self.0.state_hash()
    }

    fn save(&self) -> Snapshot {
        self.0.save()
    }

    fn load(&mut self, save: &Snapshot) {
        self.0.restore(save);
    }

    fn work(&self, _: &[()]) -> u64 {
        self.0.work(0, 0)
    }

    fn world(&self) -> Option<&World> {
        Some(&self.0)
    }
}

#[test]
fn a_world_for_reading_is_enough_for_pictures_and_counts() {
    let folder = Folder::new("only-world");
    let mut recording = Recording::<Ball>::start(&(), 10).unwrap();
    (0..20).for_each(|_| recording.step(&[()]).unwrap());
    let file = folder.write("a.replay", &recording.finish().unwrap());
    let run = |arguments: &[&str]| run_tool_of(&Tool::<Ball>::new(), arguments);
    let picture = run(&["export", &file, "--svg"]);
    assert!(picture.out.contains("<svg"), "{}", picture.err);
    assert!(run(&["stats", &file]).out.contains("\nbodies "), "{}", run(&["stats", &file]).out);
    assert_eq!(run(&["verify", &file, "--max-bodies", "0"]).exit, Exit::NoMatch);
    assert_eq!(run(&["verify", &file, "--max-bodies", "1"]).exit, Exit::Success);
}
