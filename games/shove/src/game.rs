//! [`Shove`]: the game as an implementation of [`Game`].

use lockstep2d::body::{Body, BodyId, ShapeId, WorldError};
use lockstep2d::fx;
use lockstep2d::hash::StateHash;
use lockstep2d::lockstep::{Game, RulesId, SetupError};
use lockstep2d::math::{Fx, Unit, Vec2, fx_mul};
use lockstep2d::world::{Snapshot, World};
use serde::{Deserialize, Serialize};

use crate::arena::{self, Role};
use crate::pad::Pad;
use crate::rules::Rules;
use crate::setup::Setup;

/// Acceleration of a player, in m/s².
const ACCELERATION: Fx = fx!(9);
/// Velocity change of a dash, in m/s.
const DASH: Fx = fx!(8);
/// Smallest number of ticks between two dashes of a player, unless a plate recharges the dash.
const RECHARGE: u8 = 75;
/// Velocity change by a bumper, in m/s.
const KICK: Fx = fx!(5);

/// State of a match.
#[derive(Clone, Debug)]
pub struct Shove {
    pub(crate) setup: Setup,
    pub(crate) world: World,
    pub(crate) rules: Rules,
}

/// Saved state of a match.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Save {
    world: Snapshot,
    rules: Rules,
}

impl Save {
    /// Number of bytes that this save does not share with other saves.
    #[must_use]
    pub fn rollback_bytes(&self) -> usize {
        self.world.rollback_bytes() + size_of::<Rules>()
    }
}

impl Shove {
    /// Accelerates the player of a seat.
    fn drive(&mut self, seat: usize, pad: Pad) -> Result<(), WorldError> {
        let Some(seat) = self.rules.seats.get_mut(seat) else { return Ok(()) };
        seat.recharge = seat.recharge.saturating_sub(1);
        let (Some(id), Some(direction)) = (seat.body, pad.direction()) else { return Ok(()) };
        let Some(mass) = self.world.body(id).map(Body::mass) else { return Ok(()) };
        let direction = direction.widen();
        self.world.apply_force_to_centre(id, direction.scale(fx_mul(mass, ACCELERATION)))?;
        if pad.has(Pad::DASH) && seat.recharge == 0 {
            seat.recharge = RECHARGE;
            self.world.apply_impulse_to_centre(id, direction.scale(fx_mul(mass, DASH)))?;
        }
        Ok(())
    }

    fn owner(&self, shape: ShapeId) -> Option<(BodyId, Role)> {
        let id = self.world.shape(shape)?.body();
        Some((id, Role::of(self.world.body(id)?)))
    }

    /// Kicks the bodies that have hit a bumper.
    fn kick(&mut self) -> Result<(), WorldError> {
        let kicked = |shape, bumper, away: Vec2<Unit>| {
            let ((body, _), (_, role)) = (self.owner(shape)?, self.owner(bumper)?);
            (role == Role::Bumper).then_some((body, away))
        };
        let hits = self.world.events().hits.iter();
        let kicked: Vec<_> = hits
            .filter_map(|hit| {
                let (a, b) = (hit.shape_a, hit.shape_b);
                kicked(b, a, hit.normal).or_else(|| kicked(a, b, -hit.normal))
            })
            .collect();
        for (body, away) in kicked {
            let mass = self.world.body(body).map_or(Fx::ZERO, Body::mass);
            self.world.apply_impulse_to_centre(body, away.widen().scale(fx_mul(mass, KICK)))?;
        }
        Ok(())
    }

    /// Recharges the dash of players that have entered a plate.
    fn charge(&mut self) {
        for event in &self.world.events().sensor_begin {
            if let Some((_, Role::Player(seat))) = self.owner(event.visitor)
                && let Some(seat) = self.rules.seats.get_mut(usize::from(seat))
            {
                seat.recharge = 0;
            }
        }
    }

    /// Advances the rules and accelerates the players. Stops at the first change that the world refuses, which may
    /// happen after an untrusted save has been loaded.
    fn try_step(&mut self, pads: &[Pad]) -> Result<(), WorldError> {
        self.rules.advance(&mut self.world, self.setup.rounds)?;
        if self.rules.is_on() {
            for (seat, &pad) in pads.iter().enumerate() {
                self.drive(seat, pad)?;
            }
        }
        Ok(())
    }
}

impl Game for Shove {
    type Setup = Setup;
    type Input = Pad;
    type Save = Save;

    const RULES: RulesId = RulesId { name: "shove", version: 1 };

    fn new(setup: &Setup) -> Result<Self, SetupError> {
        setup.check()?;
        let world = arena::build().map_err(|error| SetupError { why: error.to_string() })?;
        Ok(Shove { setup: *setup, world, rules: Rules::new(setup.seed) })
    }

    fn players(&self) -> u32 {
        self.setup.seats.into()
    }

    fn tick_rate(&self) -> u32 {
        arena::TICK_RATE
    }

    fn step(&mut self, inputs: &[Pad]) {
        for seat in 0..self.seats() {
            let present = inputs.get(seat).is_some_and(|pad| !pad.is_absent());
            self.rules.seat(&mut self.world, seat, present);
        }
        let pads = &inputs[..inputs.len().min(self.seats())];
        // The error can be ignored, because every machine stops at the same refused change.
        let _ = self.try_step(pads);
        self.world.step();
        self.charge();
        let _ = self.kick();
        let fallen = arena::drop_outside(&mut self.world, arena::radius(self.rules.rings));
        self.rules.fall(&fallen);
    }

    fn state_hash(&self) -> StateHash {
        StateHash::of_digests([self.world.state_hash(), StateHash::of(&self.rules)])
    }

    fn save(&self) -> Save {
        Save { world: self.world.save(), rules: self.rules.clone() }
    }

    fn load(&mut self, save: &Save) {
        self.world.restore(&save.world);
        self.rules.clone_from(&save.rules);
    }

    fn world(&self) -> Option<&World> {
        Some(&self.world)
    }

    fn world_mut(&mut self) -> Option<&mut World> {
        Some(&mut self.world)
    }

    /// `(bodies + shapes + pairs + joints) * sub-steps * iterations + shapes²`. The last term is for the search for new
    /// pairs. `bodies` and `shapes` are the world's limits instead of the current numbers, because a new round may add
    /// all players and crates.
    fn work(&self, _: &[Pad]) -> u64 {
        let count = |n: usize| u64::try_from(n).unwrap_or(u64::MAX);
        let limits = self.world.config();
        let bodies = u64::from(limits.body_limit) + u64::from(limits.shape_limit);
        let constraints = count(self.world.pair_count()).saturating_add(count(self.world.joint_count()));
        let shapes = u64::from(limits.shape_limit);
        let rounds = u64::from(limits.solver.sub_steps) * u64::from(limits.solver.iterations);
        bodies
            .saturating_add(constraints)
            .saturating_mul(rounds)
            .saturating_add(shapes.saturating_mul(shapes))
    }

    fn absent() -> Pad {
        Pad::ABSENT
    }

    fn claims(&self) -> Vec<(String, i64)> {
        let scores = (1..).zip(self.players_in_order());
        scores.map(|(number, player)| (format!("score {number}"), player.score.into())).collect()
    }
}
