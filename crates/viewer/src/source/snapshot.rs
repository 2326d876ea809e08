//! [`Snapshot`]: a snapshot file as a source. The world is simulated from the tick of the snapshot on.

use std::collections::BTreeMap;

use lockstep2d::hash::StateHash;
use lockstep2d::world::{self, World};

use super::{Source, SourceError};

/// Initial interval between saves, in ticks.
const INTERVAL: u64 = 30;
/// Maximum number of saves. When there are more, every second save is dropped and the interval doubles.
const SAVES_MAX: usize = 256;

/// World of a snapshot, simulated from there on without input. *Tick t* is tick *t* of the world.
///
/// ```
/// use lockstep2d::world::World;
/// use lockstep2d_viewer::{Snapshot, Source};
///
/// let mut world = World::default();
/// world.step();
/// let mut snapshot = Snapshot::new("a world", world);
/// snapshot.seek(10)?;
/// assert_eq!((snapshot.first(), snapshot.tick()), (1, 10));
/// # Ok::<(), lockstep2d_viewer::SourceError>(())
/// ```
pub struct Snapshot {
    name: String,
    world: World,
    first: u64,
    last: u64,
    saves: BTreeMap<u64, world::Snapshot>,
    interval: u64,
}

impl Snapshot {
    /// Shows a world.
    #[must_use]
    pub fn new(name: &str, world: World) -> Self {
        let first = world.tick();
        let saves = BTreeMap::from([(first, world.save())]);
        Snapshot { name: name.into(), world, first, last: first, saves, interval: INTERVAL }
    }

    fn step(&mut self) {
        self.world.step();
        let tick = self.world.tick();
        self.last = self.last.max(tick);
        if (tick - self.first).is_multiple_of(self.interval) && !self.saves.contains_key(&tick) {
            self.saves.insert(tick, self.world.save());
            if self.saves.len() > SAVES_MAX {
                self.interval *= 2;
                let (first, interval) = (self.first, self.interval);
                self.saves.retain(|tick, _| (tick - first).is_multiple_of(interval));
            }
        }
    }
}

impl Source for Snapshot {
    fn name(&self) -> &str {
        &self.name
    }

    fn world(&mut self) -> &World {
        &self.world
    }

    fn hash(&self) -> StateHash {
        self.world.state_hash()
    }

    fn tick(&self) -> u64 {
        self.world.tick()
    }

    fn first(&self) -> u64 {
        self.first
    }

    fn ticks(&self) -> Option<u64> {
        None
    }

    fn recorded(&self) -> u64 {
        self.last
    }

    fn tick_rate(&self) -> u32 {
        self.world.config().tick_rate
    }

    fn seek(&mut self, tick: u64) -> Result<(), SourceError> {
        let tick = tick.max(self.first);
        if tick < self.world.tick() {
            // Plays from an earlier save up to `tick`, so that derived data such as contact points is available.
            let before = tick.saturating_sub(1).max(self.first);
            if let Some((_, save)) = self.saves.range(..=before).next_back() {
                self.world.restore(save);
            }
        }
        while self.world.tick() < tick {
            self.step();
        }
        Ok(())
    }

    fn status(&self) -> String {
        match self.tick() == self.first {
            true => "at the snapshot".into(),
            false => {
                format!("{} ticks after the snapshot, simulated without input", self.tick() - self.first)
            }
        }
    }
}
