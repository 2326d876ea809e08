//! A game with a mistake, for `docs/FUZZING.md`: two players walk over a field and pick fruit.
//!
//! The mistake: the fruit is in a `HashMap`, whose iteration order is random, and a player that reaches for fruit gets
//! the first piece nearby in this order.

use lockstep2d::hash::StateHash;
use lockstep2d::lockstep::{Game, RulesId, SetupError};
use lockstep2d::math::Rng;
use serde::{Deserialize, Serialize};

/// The mistake: a map with a random iteration order.
#[expect(clippy::disallowed_types, reason = "the planted mistake that fuzzing has to find")]
type Fruit = std::collections::HashMap<(i16, i16), u32>;

/// Input of one player for one tick.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Action {
    /// Does nothing.
    #[default]
    Rest,
    /// Walks by up to one step along each axis.
    Walk {
        /// Sign of the step to the right.
        x: i8,
        /// Sign of the step upwards.
        y: i8,
    },
    /// Picks a piece of fruit at most two steps away along each axis.
    Reach,
}

/// Two players and the remaining fruit.
pub struct Harvest {
    players: [Player; 2],
    fruit: Fruit,
    rng: Rng,
    tick: u64,
}

/// Position of a player and the weight of the picked fruit.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct Player {
    x: i16,
    y: i16,
    weight: u64,
}

/// Complete copy of the state.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Save {
    players: [Player; 2],
    /// Places and weights of the fruit, sorted, so that equal states have the same encoding.
    fruit: Vec<((i16, i16), u32)>,
    rng: Rng,
    tick: u64,
}

/// Steps from the centre to the edge of the field.
const EDGE: i16 = 12;
/// Maximum number of pieces of fruit.
const FRUIT_MAX: usize = 40;

impl Game for Harvest {
    type Setup = u64;
    type Input = Action;
    type Save = Save;

    const RULES: RulesId = RulesId { name: "harvest", version: 1 };

    fn new(seed: &u64) -> Result<Self, SetupError> {
        let player = |x| Player { x, y: 0, weight: 0 };
        Ok(Harvest {
            players: [player(-EDGE), player(EDGE)],
            fruit: Fruit::new(),
            rng: Rng::new(*seed),
            tick: 0,
        })
    }

    fn players(&self) -> u32 {
        2
    }

    fn tick_rate(&self) -> u32 {
        30
    }

    fn step(&mut self, inputs: &[Action]) {
        if self.tick.is_multiple_of(4) && self.fruit.len() < FRUIT_MAX {
            let place = (self.somewhere(), self.somewhere());
            let weight = 1 + self.rng.below(100);
            self.fruit.entry(place).or_insert(weight);
        }
        for (player, input) in self.players.iter_mut().zip(inputs) {
            match *input {
                Action::Rest => {}
                Action::Walk { x, y } => {
                    player.x = (player.x + i16::from(x.signum())).clamp(-EDGE, EDGE);
                    player.y = (player.y + i16::from(y.signum())).clamp(-EDGE, EDGE);
                }
                Action::Reach => {
                    let is_near = |(x, y): (i16, i16)| (x - player.x).abs() <= 2 && (y - player.y).abs() <= 2;
                    // Here the mistake has its effect: which piece is found first depends on the random order.
                    let found = self.fruit.keys().copied().find(|place| is_near(*place));
                    let weight = found.and_then(|place| self.fruit.remove(&place));
                    player.weight += u64::from(weight.unwrap_or(0));
                }
            }
        }
        self.tick += 1;
    }

    fn state_hash(&self) -> StateHash {
        StateHash::of(&self.save())
    }

    fn save(&self) -> Save {
        let mut fruit: Vec<_> = self.fruit.iter().map(|(place, weight)| (*place, *weight)).collect();
        fruit.sort_unstable();
        Save { players: self.players, fruit, rng: self.rng.clone(), tick: self.tick }
    }

    fn load(&mut self, save: &Save) {
        let Save { players, fruit, rng, tick } = save.clone();
        *self = Harvest { players, fruit: fruit.into_iter().collect(), rng, tick };
    }

    fn work(&self, _: &[Action]) -> u64 {
        1 + self.fruit.len() as u64
    }
}

impl Harvest {
    fn somewhere(&mut self) -> i16 {
        let width = u32::from(EDGE.unsigned_abs()) * 2 + 1;
        i16::try_from(self.rng.below(width)).unwrap_or(0) - EDGE
    }
}
