//! Commands that teleport bodies or change velocities in a `Sandbox`, and a game whose `load` forgets a part of its
//! state.

use std::time::Duration;

use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_lockstep2d::*;
use lockstep2d::body::{BodyDef, Geometry, Polygon, ShapeDef, WorldError};
use lockstep2d::fx;
use lockstep2d::hash::StateHash;
use lockstep2d::lockstep::{Game, RulesId, Sandbox, SandboxSetup, SetupError};
use lockstep2d::math::{Angle, Vec2 as FixedVec2};
use lockstep2d::world::{Command, Config, Snapshot, World};
use serde::{Deserialize, Serialize};

const TICK: Duration = Duration::from_nanos(16_666_667);

fn app<G: LockstepGame>(game: Lockstep<G>, frame: Duration) -> App {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, LockstepPlugin::<G>::default().pixels_per_metre(1.0)))
        .insert_resource(TimeUpdateStrategy::ManualDuration(frame))
        .insert_resource(game);
    app
}

fn ball() -> ShapeDef {
    ShapeDef::new(Geometry::circle(fx!(0.5)).unwrap())
}

/// Heights of a ball's view after a command, in 80 frames of a quarter of a tick each.
fn heights(command: impl FnOnce(&BodyView) -> Command) -> Vec<f32> {
    heights_beside(vec![], ball(), command)
}

/// Heights of the view of a body with this shape. `commands` create the other bodies of the world.
fn heights_beside(
    mut commands: Vec<Command>,
    shape: ShapeDef,
    command: impl FnOnce(&BodyView) -> Command,
) -> Vec<f32> {
    commands.insert(0, Command::Spawn { body: BodyDef::dynamic(), shapes: vec![shape] });
    let setup = SandboxSetup { commands, ..SandboxSetup::default() };
    let mut app = app(Lockstep::<Sandbox>::local(&setup).unwrap(), TICK / 4);
    (0..20).for_each(|_| app.update());
    let view = app.world().resource::<BodyViews>().iter().next().unwrap().1;
    let command = command(app.world().get::<BodyView>(view).unwrap());
    app.world_mut().resource_mut::<Inputs<Sandbox>>().once(0).push(command);
    let mut height = || {
        app.update();
        app.world().get::<Transform>(view).unwrap().translation.y
    };
    (0..80).map(|_| height()).collect()
}

#[test]
fn a_body_that_is_put_elsewhere_is_not_drawn_on_the_way() {
    let place = FixedVec2::new(fx!(0), fx!(20));
    let heights =
        heights(|view| Command::SetTransform { body: view.body(), position: place, angle: Angle::default() });
    assert!(heights.iter().any(|&y| y < 0.0) && heights.iter().any(|&y| y > 19.0), "{heights:?}");
    assert!(!heights.iter().any(|y| (0.0..=15.0).contains(y)), "{heights:?}");
}

#[test]
fn a_fast_body_is_drawn_on_its_way() {
    let velocity = FixedVec2::new(fx!(0), fx!(300));
    let heights =
        heights(|view| Command::SetVelocity { body: view.body(), velocity, angular_velocity: fx!(0) });
    // The body moves 5 m in a tick, which is 1.25 m in each of four frames.
    let steps = heights.windows(2).map(|pair| pair[1] - pair[0]);
    let largest = steps.fold(0.0_f32, f32::max);
    assert!((1.0..1.5).contains(&largest), "{largest}");
}

#[test]
fn a_fast_body_that_is_stopped_is_drawn_on_its_way() {
    // The ceiling stops the ball at a height of 17.5 m, about 2.6 m above its height at the end of the tick before.
    let solid = ShapeDef::new(Polygon::rectangle(fx!(9), fx!(1)).unwrap());
    let ceiling = BodyDef::fixed().position((fx!(0), fx!(19)));
    let ceiling = Command::Spawn { body: ceiling, shapes: vec![solid] };
    let velocity = FixedVec2::new(fx!(0), fx!(300));
    let set =
        |view: &BodyView| Command::SetVelocity { body: view.body(), velocity, angular_velocity: fx!(0) };
    let heights = heights_beside(vec![ceiling], ball(), set);
    let largest = heights.windows(2).map(|pair| pair[1] - pair[0]).fold(0.0_f32, f32::max);
    assert!((1.0..1.5).contains(&largest), "{heights:?}");
}

#[test]
fn a_body_that_spins_about_a_distant_centre_is_drawn_on_its_way() {
    // The origin moves at 200 m/s on a circle with a radius of 10 m: 3.3 m in a tick, 0.83 m in a frame.
    let ball = ball().offset((fx!(10), fx!(0)));
    let heights = heights_beside(vec![], ball, |view| Command::SetVelocity {
        body: view.body(),
        velocity: FixedVec2::default(),
        angular_velocity: fx!(20),
    });
    let ways = heights.windows(2).map(|pair| (pair[1] - pair[0]).abs());
    let largest = ways.fold(0.0_f32, f32::max);
    assert!((0.6..1.0).contains(&largest), "{heights:?}");
}

/// A game whose world makes four steps in a tick.
struct FourSteps(World);

impl Game for FourSteps {
    type Setup = ();
    type Input = ();
    type Save = Snapshot;
    const RULES: RulesId = RulesId { name: "four-steps", version: 1 };

    fn new((): &()) -> Result<Self, SetupError> {
        let config = Config { tick_rate: 240, ..Config::default() };
        let build = || -> Result<World, WorldError> {
            let mut world = World::new(config)?;
            world.spawn(&BodyDef::dynamic().velocity((fx!(0), fx!(300))), &[ball()])?;
            Ok(world)
        };
        build().map(FourSteps).map_err(|error| SetupError { why: error.to_string() })
    }
    fn players(&self) -> u32 {
        1
    }
    fn tick_rate(&self) -> u32 {
        60
    }
    fn step(&mut self, _: &[()]) {
        (0..4).for_each(|_| self.0.step());
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
        4 * self.0.work(0, 0)
    }
    fn world(&self) -> Option<&World> {
        Some(&self.0)
    }
}

#[test]
fn a_fast_body_is_drawn_on_its_way_if_a_tick_has_several_steps() {
    let mut app = app(Lockstep::<FourSteps>::local(&()).unwrap(), TICK / 4);
    (0..20).for_each(|_| app.update());
    let view = app.world().resource::<BodyViews>().iter().next().unwrap().1;
    let mut height = || {
        app.update();
        app.world().get::<Transform>(view).unwrap().translation.y
    };
    let heights: Vec<f32> = (0..40).map(|_| height()).collect();
    // The body moves 5 m in a tick, which is 1.25 m in each of four frames.
    let largest = heights.windows(2).map(|pair| pair[1] - pair[0]).fold(0.0_f32, f32::max);
    assert!((1.0..1.5).contains(&largest), "{heights:?}");
}

/// A game whose `load` forgets the score.
struct Forgetful {
    score: u32,
    ticks: u32,
}

#[derive(Clone, Serialize, Deserialize)]
struct Save {
    ticks: u32,
}

impl Game for Forgetful {
    type Setup = ();
    type Input = bool;
    type Save = Save;
    const RULES: RulesId = RulesId { name: "forgetful", version: 1 };

    fn new((): &()) -> Result<Self, SetupError> {
        Ok(Forgetful { score: 0, ticks: 0 })
    }
    fn players(&self) -> u32 {
        2
    }
    fn tick_rate(&self) -> u32 {
        60
    }
    fn step(&mut self, inputs: &[bool]) {
        self.ticks += 1;
        self.score += u32::from(inputs[0]);
    }
    fn state_hash(&self) -> StateHash {
        StateHash::of(&(self.ticks, self.score))
    }
    fn save(&self) -> Save {
        Save { ticks: self.ticks }
    }
    fn load(&mut self, save: &Save) {
        self.ticks = save.ticks;
    }
    fn work(&self, _: &[bool]) -> u64 {
        1
    }
}

#[test]
fn a_sync_test_stops_at_state_that_is_not_saved_and_says_so() {
    let mut app = app(Lockstep::<Forgetful>::sync_test(&(), 4).unwrap(), TICK);
    assert_eq!(app.world().resource::<Lockstep<Forgetful>>().seats(), [0, 1]);
    (0..30).for_each(|_| app.update());
    let game = app.world().resource::<Lockstep<Forgetful>>();
    assert!(game.failure().is_none() && game.tick() > 20, "nothing is lost before there is a score");
    *app.world_mut().resource_mut::<Inputs<Forgetful>>().held(0) = true;
    (0..30).for_each(|_| app.update());
    let game = app.world().resource::<Lockstep<Forgetful>>();
    assert!(matches!(game.failure(), Some(LockstepError::SyncTest { .. })), "{:?}", game.failure());
    assert!(game.tick() < 40);
    let failures: Vec<_> = app.world_mut().resource_mut::<Messages<LockstepFailed>>().drain().collect();
    assert!(failures.len() <= 1, "it is sent once: {failures:?}");
}
