//! A yard full of balls and boxes that players push.

use lockstep2d::body::{BodyDef, Geometry, Polygon, ShapeDef, WorldError};
use lockstep2d::fx;
use lockstep2d::hash::StateHash;
use lockstep2d::lockstep::{Game, History, RulesId, SetupError};
use lockstep2d::math::{Fx, Rng, Vec2};
use lockstep2d::replay::Recorder;
use lockstep2d::report::{Desync, DesyncReport};
use lockstep2d::world::{BodyField, Config, Snapshot, World};
use serde::{Deserialize, Serialize};

pub(crate) const PLAYERS: u32 = 3;

/// Number of dynamic bodies.
pub(crate) const BODIES: usize = 60;

pub(crate) struct Yard {
    pub(crate) world: World,
    pushes: u64,
}

#[derive(Clone, Serialize, Deserialize)]
pub(crate) struct YardSave {
    world: Snapshot,
    pushes: u64,
}

impl Yard {
    fn build(seed: u64) -> Result<Self, WorldError> {
        let mut world = World::new(Config { sleeping: false, ..Config::default() })?;
        for (x, y, w, h) in [(0, -1, 6, 1), (-6, 5, 1, 7), (6, 5, 1, 7)] {
            let wall = ShapeDef::new(Polygon::rectangle(Fx::from_num(w), Fx::from_num(h))?);
            world.spawn(&BodyDef::fixed().position((Fx::from_num(x), Fx::from_num(y))), &[wall])?;
        }
        let mut rng = Rng::new(seed);
        for number in 0..BODIES {
            let size = fx!(0.3) + Fx::from_bits(i64::from(rng.next_u32() >> 4));
            let shape = if number % 2 == 0 {
                Geometry::circle(size)?
            } else {
                Polygon::rectangle(size, size)?.into()
            };
            let (column, row) = (number % 8, number / 8);
            let x = Fx::from_num(column) - fx!(3.5) + Fx::from_bits(i64::from(rng.next_u32() >> 6));
            let body = BodyDef::dynamic().position((x, Fx::from_num(row) + fx!(0.5)));
            world.spawn(&body, &[ShapeDef::new(shape)])?;
        }
        Ok(Yard { world, pushes: 0 })
    }
}

impl Game for Yard {
    type Setup = u64;
    type Input = u8;
    type Save = YardSave;

    const RULES: RulesId = RulesId { name: "yard", version: 1 };

    fn new(seed: &u64) -> Result<Self, SetupError> {
        Yard::build(*seed).map_err(|error| SetupError { why: error.to_string() })
    }

    fn players(&self) -> u32 {
        PLAYERS
    }

    fn tick_rate(&self) -> u32 {
        60
    }

    fn step(&mut self, inputs: &[u8]) {
        for (player, &input) in inputs.iter().enumerate() {
            let body = self.world.bodies().nth(3 + player * 7).map(|(id, _)| id);
            if let Some(body) = body.filter(|_| input > 0) {
                let push = Vec2::new(Fx::from(input) - fx!(128), fx!(90));
                self.pushes += u64::from(self.world.apply_force_to_centre(body, push).is_ok());
            }
        }
        self.world.step();
    }

    fn state_hash(&self) -> StateHash {
        StateHash::of_digests([self.world.state_hash(), StateHash::of(&self.pushes)])
    }

    fn save(&self) -> YardSave {
        YardSave { world: self.world.save(), pushes: self.pushes }
    }

    fn load(&mut self, save: &YardSave) {
        self.world.restore(&save.world);
        self.pushes = save.pushes;
    }

    fn work(&self, _: &[u8]) -> u64 {
        4000
    }

    fn world_mut(&mut self) -> Option<&mut World> {
        Some(&mut self.world)
    }
}

pub(crate) fn inputs_at(tick: u64, player: u64) -> u8 {
    let mut rng = Rng::new(tick / 9 * 3 + player);
    rng.next_u32().to_le_bytes()[0]
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum When {
    Before,
    After,
}

/// A bit flip that happens whenever its tick is simulated.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Flip {
    pub(crate) tick: u64,
    pub(crate) when: When,
    /// Index of the body among the dynamic bodies.
    pub(crate) body: usize,
    pub(crate) field: BodyField,
    pub(crate) bit: u32,
}

impl Flip {
    /// Flips the bit. Returns the body's path, or `None` if the world refuses the flip.
    pub(crate) fn apply(&self, game: &mut Yard) -> Option<String> {
        let body = game.world.bodies().filter(|(_, body)| body.is_dynamic()).nth(self.body)?.0;
        game.world.flip_bit(body, self.field, self.bit).ok()?;
        Some(format!("world.bodies.body {body}"))
    }
}

/// A peer without a network.
pub(crate) struct Peer {
    pub(crate) game: Yard,
    pub(crate) history: History<Yard>,
    recorder: Recorder<Yard>,
    replay: Vec<u8>,
    flips: Vec<Flip>,
    pub(crate) tick: u64,
    /// Path of the body whose bit flipped.
    pub(crate) flipped: Option<String>,
}

impl Peer {
    pub(crate) fn new(seed: u64, flips: impl IntoIterator<Item = Flip>) -> Self {
        Peer::with_checkpoints(25, seed, flips)
    }

    /// `interval` is the number of ticks between two checkpoints of the replay.
    pub(crate) fn with_checkpoints(interval: u32, seed: u64, flips: impl IntoIterator<Item = Flip>) -> Self {
        let flips = flips.into_iter().collect();
        let (mut recorder, game) = Recorder::<Yard>::start(&seed, interval).expect("a valid setup");
        let mut history = History::new(&game);
        history.push(0, game.save(), game.state_hash());
        let replay = recorder.take_bytes();
        Peer { game, history, recorder, replay, flips, tick: 0, flipped: None }
    }

    /// Simulates a tick without recording it.
    fn play(&mut self, inputs: &[u8]) {
        let next = self.tick + 1;
        self.flip(next, When::Before);
        self.game.step(inputs);
        self.flip(next, When::After);
        self.tick = next;
        self.history.push(next, self.game.save(), self.game.state_hash());
    }

    fn flip(&mut self, tick: u64, when: When) {
        for flip in self.flips.iter().filter(|flip| flip.tick == tick && flip.when == when) {
            self.flipped = flip.apply(&mut self.game);
        }
    }

    fn inputs(&self) -> Vec<u8> {
        (0..u64::from(PLAYERS)).map(|player| inputs_at(self.tick, player)).collect()
    }

    /// Simulates and records a tick. Before every seventh tick, it simulates four ticks with predicted inputs and rolls
    /// them back.
    pub(crate) fn advance(&mut self) {
        let start = self.tick;
        if start % 7 == 3 {
            (0..4).for_each(|_| self.play(&[9; PLAYERS as usize]));
            self.tick = start;
            self.history.truncate(start);
            let past = self.history.get(start).expect("four ticks ago");
            self.game.load(&past.save.clone());
        }
        let inputs = self.inputs();
        self.recorder.record(&inputs).expect("valid inputs");
        self.play(&inputs);
        self.recorder.checkpoint(self.game.state_hash());
        self.replay.extend(self.recorder.take_bytes());
    }

    pub(crate) fn replay(&self) -> Vec<u8> {
        [self.replay.as_slice(), &self.recorder.so_far(self.game.state_hash())].concat()
    }

    pub(crate) fn report(&self, seat: u32, tick: u64, hashes: Vec<Option<StateHash>>) -> DesyncReport {
        let found = Desync { players: PLAYERS, tick, known: u64::MAX, seats: vec![seat], hashes };
        DesyncReport::new(&found, &self.history, self.replay())
    }
}
