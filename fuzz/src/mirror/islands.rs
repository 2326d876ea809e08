//! Sleeping islands.

use lockstep2d::body::BodyKind;
use serde::{Deserialize, Serialize};

use super::State;
use crate::source::Source;

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Island {
    bodies: Vec<u32>,
}

impl State {
    pub(super) fn alter_sleep(&mut self, source: &mut Source<'_>) -> Option<()> {
        match source.below(5) {
            0 | 1 => {
                let index = self.bodies.pick(source)?;
                self.put_to_sleep(index)
            }
            2 => {
                let island = self.islands.pick(source)?;
                self.wake(island)
            }
            3 => {
                let (from, to) = (self.islands.pick(source)?, self.islands.pick(source)?);
                self.merge(from, to)
            }
            _ => {
                // A body of an island with several bodies gets an island of its own.
                let island = self.islands.pick(source)?;
                let slots = &mut self.islands.get(island)?.bodies;
                let at = source.below(slots.len());
                let slot = (slots.len() > 1).then(|| slots.remove(at))?;
                let own = self.islands.add(Island { bodies: vec![slot] });
                self.bodies.get(slot as usize)?.island = Some(own);
                Some(())
            }
        }
    }

    fn put_to_sleep(&mut self, index: usize) -> Option<()> {
        let body = self.bodies.get(index)?;
        let able = body.kind == BodyKind::Dynamic && body.enabled && body.island.is_none();
        able.then_some(())?;
        (body.velocity, body.spin, body.force, body.torque) = ((0, 0), 0, (0, 0), 0);
        body.rest_ticks = 0;
        let island = self.islands.add(Island { bodies: vec![index as u32] });
        self.bodies.get(index)?.island = Some(island);
        self.config.sleeping = true;
        Some(())
    }

    fn wake(&mut self, island: usize) -> Option<()> {
        for slot in self.islands.remove(island)?.bodies {
            self.bodies.get(slot as usize)?.island = None;
        }
        Some(())
    }

    fn merge(&mut self, from: usize, to: usize) -> Option<()> {
        (from != to).then_some(())?;
        let moved = self.islands.remove(from)?.bodies;
        let handle = self.islands.handle(to);
        for &slot in &moved {
            self.bodies.get(slot as usize)?.island = Some(handle);
        }
        let island = self.islands.get(to)?;
        island.bodies.extend(moved);
        island.bodies.sort_unstable();
        Some(())
    }
}
