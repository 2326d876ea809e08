//! [`Comparison`]: a second replay drawn over the first, and their first difference.

use lockstep2d::body::{Body, BodyId};
use lockstep2d::inspect::{differences, fields};
use lockstep2d::world::World;

use super::player::slice_of;
use crate::source::Source;

/// A source that is compared with the shown source at the same tick.
pub(super) struct Comparison {
    pub(super) other: Box<dyn Source>,
    /// Further copies of both sources, which search for the first difference. `None` when the search has ended.
    scouts: Option<[Box<dyn Source>; 2]>,
    /// Whether only the worlds are compared, because one source is a snapshot, which does not contain the state of the
    /// game's own rules.
    only_worlds: bool,
    pub(super) first: Option<First>,
    searched: u64,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct First {
    pub(super) tick: u64,
    /// First body that differs. `None` if only other state differs.
    pub(super) body: Option<BodyId>,
    /// First differing field of `body`. If no body differs, the first differing field of the game's own state.
    pub(super) field: String,
}

impl Comparison {
    pub(super) fn new(other: Box<dyn Source>, mut scouts: [Box<dyn Source>; 2]) -> Self {
        // The hash of a snapshot is the hash of its world. The hash of a game also includes the state of its rules.
        let only_worlds = scouts.iter_mut().any(|scout| scout.hash() == scout.world().state_hash());
        Comparison { other, scouts: Some(scouts), only_worlds, first: None, searched: 0 }
    }

    /// Continues the search by a limited number of ticks.
    pub(super) fn think(&mut self) {
        let Some([a, b]) = &mut self.scouts else { return };
        let (mut left, first) = (slice_of(a.world()), a.first());
        while left > 0 {
            left -= 1;
            let is_equal = match self.only_worlds {
                true => a.world().state_hash() == b.world().state_hash(),
                false => a.hash() == b.hash(),
            };
            if !is_equal {
                self.first = Some(First::between(a.as_mut(), b.as_mut()));
                self.scouts = None;
                return;
            }
            let next = a.tick() + 1;
            let ends = [&*a, &*b].map(|scout| scout.ticks().unwrap_or(u64::MAX));
            let further = next <= ends[0].min(ends[1]);
            if !further || a.seek(next).is_err() || b.seek(next).is_err() {
                self.searched = next - 1;
                self.scouts = None;
                return;
            }
        }
        self.searched = a.tick().max(first);
    }

    pub(super) fn status(&self) -> String {
        let name = self.other.name();
        match (&self.first, &self.scouts) {
            (Some(First { tick, field, .. }), _) => {
                format!("{name}: first difference at tick {tick}: {field}")
            }
            (None, Some(_)) => format!("{name}: compared up to tick {}, no difference", self.searched),
            (None, None) => format!("{name}: identical up to tick {}", self.searched),
        }
    }
}

impl First {
    fn between(a: &mut dyn Source, b: &mut dyn Source) -> Self {
        let tick = a.tick();
        let own = first_of_own(&a.state(), &b.state());
        let (a, b) = (a.world(), b.world());
        let body = differing(a, b).next();
        let field = match body {
            None => own.unwrap_or_else(|| "all bodies are equal, other state differs".into()),
            Some(id) => format!("body {}: {}", a.body_label(id), first_field(a.body(id), b.body(id))),
        };
        First { tick, body, field }
    }
}

/// Bodies that differ between two worlds, in slot order.
pub(super) fn differing<'a>(a: &'a World, b: &'a World) -> impl Iterator<Item = BodyId> + 'a {
    let not_in_b = a.bodies().filter(|&(id, body)| b.body(id) != Some(body)).map(|(id, _)| id);
    let only_in_b = b.bodies().filter(|&(id, _)| a.body(id).is_none()).map(|(id, _)| id);
    let mut ids: Vec<BodyId> = not_in_b.chain(only_in_b).collect();
    ids.sort_unstable();
    ids.into_iter()
}

/// First differing field of the game's own state, with both values.
fn first_of_own(a: &[(String, String)], b: &[(String, String)]) -> Option<String> {
    let (ours, theirs) = a.iter().zip(b).find(|(ours, theirs)| ours != theirs)?;
    Some(format!("{}: {} | {}", ours.0, ours.1, theirs.1))
}

fn first_field(a: Option<&Body>, b: Option<&Body>) -> String {
    let (Some(a), Some(b)) = (a, b) else {
        return format!("only in the {}", if a.is_some() { "first" } else { "second" });
    };
    let (a, b) = (fields(a).unwrap_or_default(), fields(b).unwrap_or_default());
    differences(&a, &b).first().map(|difference| difference.to_string()).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use lockstep2d::hash::StateHash;

    use super::*;
    use crate::source::SourceError;

    /// A world that stands still for 100 ticks. Only the ticks up to `end` can be sought.
    struct Still {
        world: World,
        tick: u64,
        end: u64,
    }

    impl Source for Still {
        fn name(&self) -> &str {
            "still"
        }
        fn world(&mut self) -> &World {
            &self.world
        }
        fn hash(&self) -> StateHash {
            StateHash(0)
        }
        fn tick(&self) -> u64 {
            self.tick
        }
        fn ticks(&self) -> Option<u64> {
            Some(100)
        }
        fn tick_rate(&self) -> u32 {
            60
        }
        fn seek(&mut self, tick: u64) -> Result<(), SourceError> {
            self.tick = tick.min(self.end);
            if tick <= self.end { Ok(()) } else { Err(SourceError("not reached".into())) }
        }
    }

    #[test]
    fn a_tick_that_one_source_does_not_reach_is_not_compared() {
        for ends in [[100, 40], [40, 100], [40, 40]] {
            let still =
                |end| -> Box<dyn Source> { Box::new(Still { world: World::default(), tick: 0, end }) };
            let mut comparison = Comparison::new(still(100), ends.map(still));
            while comparison.scouts.is_some() {
                comparison.think();
            }
            assert_eq!(comparison.status(), "still: identical up to tick 40", "{ends:?}");
        }
    }
}
