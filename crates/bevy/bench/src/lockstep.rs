//! The engine bevy_lockstep2d. Steps and saves the game as the drivers of the plugin do, without an app.

use std::collections::VecDeque;

use bevy_lockstep2d::{Observed, ObservedSave};
use lockstep2d::body::{BodyDef, Polygon, ShapeDef};
use lockstep2d::fx;
use lockstep2d::lockstep::{Game, Sandbox, SandboxSave, SandboxSetup};
use lockstep2d::math::{Angle, Fx, Vec2};
use lockstep2d::world::{BodyPose, Command};

use crate::engine::{DEPTH, Engine};
use crate::scene;

pub struct Lockstep {
    game: Observed<Sandbox>,
    saves: VecDeque<ObservedSave<SandboxSave>>,
}

impl Lockstep {
    pub fn new(bodies: usize) -> Result<Self, Box<dyn std::error::Error>> {
        let floor =
            ShapeDef::new(Polygon::rectangle(Fx::from_num(scene::FLOOR.0), Fx::from_num(scene::FLOOR.1))?);
        let square = ShapeDef::new(Polygon::square(Fx::from_num(scene::HALF))?);
        let pose = |number| {
            let (x, y) = scene::place(number);
            BodyPose { position: Vec2::new(Fx::from_num(x) / 64, Fx::from_num(y) / 64), angle: Angle::ZERO }
        };
        let commands = vec![
            Command::Spawn { body: BodyDef::fixed().position((fx!(0), fx!(-1))), shapes: vec![floor] },
            Command::SpawnEach {
                body: BodyDef::dynamic().never_sleeps(),
                shapes: vec![square],
                poses: (0..bodies).map(pose).collect(),
            },
        ];
        let game = Observed::new(&SandboxSetup { commands, ..SandboxSetup::default() })?;
        Ok(Lockstep { game, saves: VecDeque::new() })
    }
}

impl Engine for Lockstep {
    fn step(&mut self) {
        self.game.step(&[vec![]]);
    }

    fn save(&mut self) {
        if self.saves.len() == DEPTH {
            self.saves.pop_front();
        }
        self.saves.push_back(self.game.save());
    }

    fn load(&mut self) {
        self.saves.truncate(1);
        if let Some(save) = self.saves.front() {
            self.game.load(save);
        }
    }

    fn state(&mut self) -> Vec<u64> {
        let hash = self.game.state_hash().0;
        vec![(hash >> 64) as u64, hash as u64]
    }
}
