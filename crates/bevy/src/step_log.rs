//! [`StepLog`]: a record of the steps of a game, from which its views and events are made.
//!
//! Drivers load states and play ticks again in any order. The game itself fills the log, so views and events do not
//! depend on the driver.

use std::collections::{BTreeMap, VecDeque};

use lockstep2d::body::BodyId;
use lockstep2d::world::World;

use crate::events::{LoggedEvent, each_event};
use crate::poses::Poses;
use crate::views::Identity;

/// A tick, as a number of ticks since the start of an epoch. A new epoch begins after a seek, and after a load of a
/// state that is from an earlier epoch or was decoded from bytes. The tick at the start of an epoch may be unknown
/// until the driver sets it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Stamp {
    epoch: u32,
    ticks: u64,
}

/// An event. `announced` is the tick of its [`PredictedEvent`](crate::PredictedEvent), if this message was sent. A
/// later rollback may have moved the event to another tick.
#[derive(Clone, Copy, Debug)]
struct Entry {
    event: LoggedEvent,
    announced: Option<u64>,
}

/// An announced event whose tick was rolled back.
#[derive(Clone, Copy, Debug)]
struct Withdrawn {
    event: LoggedEvent,
    /// Tick of the [`PredictedEvent`](crate::PredictedEvent).
    announced: u64,
}

/// Identity of a body that has a view, and the tick at which the identity was taken.
#[derive(Debug)]
pub(crate) struct Shown {
    at: Stamp,
    pub(crate) identity: Identity,
}

/// A tick to return to: see [`StepLog::return_to`].
#[derive(Debug)]
pub(crate) struct Mark {
    stamp: Stamp,
    pending: VecDeque<Entry>,
}

/// Largest number of ticks by which a rollback may move an event without making it a new event.
const SAME_EVENT_TICKS: u64 = 16;

#[derive(Debug, Default)]
pub(crate) struct StepLog {
    epoch: u32,
    ticks: u64,
    /// Tick at which each epoch begins. `None` if it is unknown.
    bases: Vec<Option<u64>>,
    /// Unconfirmed events, in order, with ticks since the start of the epoch.
    pending: VecDeque<Entry>,
    /// Events that were announced, and whose ticks were rolled back. They have not happened again.
    withdrawn: Vec<Withdrawn>,
    pub(crate) before: Poses,
    pub(crate) after: Poses,
    is_after_stale: bool,
    shown: Option<Stamp>,
    /// Poses after the tick `shown`, if a rollback has played this tick again.
    pub(crate) shown_again: Option<Poses>,
    /// Bodies that have views, but whose ids may now belong to other bodies: bodies that a loaded state lacks, and all
    /// bodies from before a seek.
    pub(crate) missing: BTreeMap<BodyId, Shown>,
    /// Number of ticks played since the last frame, including repeated ones.
    pub(crate) stepped: u32,
    /// Largest number of ticks by which a load went back since the last frame.
    pub(crate) replayed: u32,
    /// State at which the log was suspended. `None` while the log records.
    suspended_at: Option<Stamp>,
    /// Tick of the world before the step.
    world_tick: Option<u64>,
}

impl Entry {
    /// The event as a withdrawn event, if it was announced.
    fn withdrawn(self) -> Option<Withdrawn> {
        let Entry { event, announced } = self;
        announced.map(|announced| Withdrawn { event, announced })
    }
}

impl StepLog {
    pub(crate) fn new(world: Option<&World>) -> Self {
        let mut log = StepLog { bases: vec![Some(0)], ..StepLog::default() };
        log.refresh(world);
        log
    }

    pub(crate) const fn stamp(&self) -> Stamp {
        Stamp { epoch: self.epoch, ticks: self.ticks }
    }

    pub(crate) fn before_step(&mut self, world: Option<&World>) {
        self.world_tick = world.map(World::tick);
        if self.suspended_at.is_none() {
            if self.is_after_stale {
                self.after.capture(world);
            }
            core::mem::swap(&mut self.before, &mut self.after);
            self.is_after_stale = false;
        }
    }

    pub(crate) fn after_step(&mut self, world: Option<&World>) {
        self.ticks += 1;
        if self.suspended_at.is_some() {
            return;
        }
        self.stepped += 1;
        self.after.capture(world);
        if self.shown == Some(self.stamp()) {
            self.shown_again = Some(self.after.clone());
        }
        // A body keeps its view if, after the tick at which its identity was taken has been played again, it still has
        // this identity. Changes in later ticks do not matter.
        let (now, is_same) = (self.stamp(), |body, shown: &Shown| shown.identity.is_of(world, body));
        self.missing.retain(|body, shown| shown.at != now || !is_same(*body, shown));
        // Some games do not step their world in every tick, for example in a pause between rounds.
        let Some(world) = world.filter(|world| Some(world.tick()) != self.world_tick) else { return };
        let (pending, withdrawn) = (&mut self.pending, &mut self.withdrawn);
        each_event(world, self.ticks, &mut |event| {
            // If an event occurs again, it takes over the announcement of the withdrawn event that is alike and nearest
            // in time. Of two such events at the same distance, the older one is chosen.
            let distance = |other: &Withdrawn| other.event.tick.abs_diff(event.tick);
            let alike = withdrawn
                .iter()
                .enumerate()
                .filter(|(_, other)| other.event.is_alike(&event) && distance(other) <= SAME_EVENT_TICKS);
            let same = alike.min_by_key(|(_, other)| (distance(other), other.event.tick));
            let announced = same.map(|(place, _)| place).map(|place| withdrawn.remove(place).announced);
            pending.push_back(Entry { event, announced });
        });
    }

    /// Returns the identities of all bodies. Must be called before a load or a seek, to pass the result to
    /// [`StepLog::loaded`] or [`StepLog::relocate`].
    pub(crate) fn leave(&self, world: Option<&World>) -> Vec<(BodyId, Shown)> {
        let is_recorded = self.suspended_at.is_none() && !self.is_after_stale;
        let Some(world) = world.filter(|_| is_recorded) else { return Vec::new() };
        let shown = |body| Some((body, Shown { at: self.stamp(), identity: Identity::of(world, body)? }));
        world.bodies().filter_map(|(body, _)| shown(body)).collect()
    }

    /// Must be called after a load. `stamp` is `None` if the state was decoded from bytes.
    pub(crate) fn loaded(&mut self, stamp: Option<Stamp>, world: Option<&World>, left: Vec<(BodyId, Shown)>) {
        let known = stamp.filter(|stamp| stamp.epoch == self.epoch);
        let back = match known {
            Some(stamp) => self.ticks.saturating_sub(stamp.ticks),
            None => self.begin_epoch(stamp),
        };
        self.ticks = known.map_or(0, |stamp| stamp.ticks);
        if self.suspended_at.is_some() {
            return;
        }
        self.replayed = self.replayed.max(u32::try_from(back).unwrap_or(u32::MAX));
        while self.pending.back().is_some_and(|entry| entry.event.tick > self.ticks) {
            let last = self.pending.pop_back();
            self.withdrawn.extend(last.and_then(Entry::withdrawn));
        }
        let exists = |body| world.is_some_and(|world| world.body(body).is_some());
        self.miss(left.into_iter().filter(|(body, _)| !exists(*body)));
        self.is_after_stale = true;
    }

    fn miss(&mut self, bodies: impl IntoIterator<Item = (BodyId, Shown)>) {
        for (body, shown) in bodies {
            // If there is an entry for this id already, it stays: it belongs to the body that the view has shown since
            // the last frame.
            self.missing.entry(body).or_insert(shown);
        }
    }

    /// Begins an epoch at a loaded state. Returns 0, because this load does not count as a rollback.
    fn begin_epoch(&mut self, stamp: Option<Stamp>) -> u64 {
        let base = stamp.and_then(|stamp| Some(self.base_of(stamp.epoch)? + stamp.ticks));
        self.bases.push(base);
        self.epoch = u32::try_from(self.bases.len() - 1).unwrap_or(u32::MAX);
        if self.suspended_at.is_some() {
            return 0;
        }
        self.withdrawn.extend(self.pending.drain(..).filter_map(Entry::withdrawn));
        // In the new epoch, withdrawn events count as events of tick 0.
        self.withdrawn.iter_mut().for_each(|withdrawn| withdrawn.event.tick = 0);
        (self.shown, self.shown_again) = (None, None);
        0
    }

    fn base_of(&self, epoch: u32) -> Option<u64> {
        self.bases.get(epoch as usize).copied().flatten()
    }

    /// Sets the number of ticks played, unless it is already known in this epoch.
    pub(crate) fn set_tick(&mut self, tick: u64) {
        let base = self.bases.get_mut(self.epoch as usize);
        base.map(|base| base.get_or_insert(tick.saturating_sub(self.ticks)));
    }

    /// Number of ticks played at the start of the epoch. 0 if it is unknown.
    fn base(&self) -> u64 {
        self.base_of(self.epoch).unwrap_or(0)
    }

    /// Records no events or poses until [`StepLog::resume`] or [`StepLog::relocate`].
    pub(crate) fn suspend(&mut self) {
        self.suspended_at = Some(self.stamp());
    }

    /// Continues where the log was suspended, after the driver has restored that state.
    pub(crate) fn resume(&mut self) {
        if let Some(Stamp { epoch, ticks }) = self.suspended_at.take() {
            (self.epoch, self.ticks) = (epoch, ticks);
        }
    }

    /// The current tick and the unconfirmed events.
    pub(crate) fn mark(&self) -> Mark {
        Mark { stamp: self.stamp(), pending: self.pending.clone() }
    }

    /// Returns to a mark, after the driver has restored the state at the mark.
    pub(crate) fn return_to(&mut self, mark: Mark, world: Option<&World>) {
        let Mark { stamp: Stamp { epoch, ticks }, pending } = mark;
        (self.epoch, self.ticks, self.pending) = (epoch, ticks, pending);
        self.withdrawn.clear();
        self.refresh(world);
    }

    /// Continues at another tick, without events. Views jump there.
    pub(crate) fn relocate(&mut self, tick: u64, world: Option<&World>, left: Vec<(BodyId, Shown)>) {
        self.suspended_at = None;
        self.bases.push(Some(tick));
        (self.epoch, self.ticks) = (u32::try_from(self.bases.len() - 1).unwrap_or(u32::MAX), 0);
        self.pending.clear();
        self.withdrawn.clear();
        self.miss(left);
        self.refresh(world);
    }

    /// Captures the poses of a state that does not result from a step. Views jump there.
    fn refresh(&mut self, world: Option<&World>) {
        self.after.capture(world);
        self.before = self.after.clone();
        self.is_after_stale = false;
        (self.shown, self.shown_again) = (None, None);
    }

    /// Records that the views show the current tick. If this tick was loaded and not played, captures its poses first.
    pub(crate) fn show(&mut self, world: Option<&World>) {
        if self.is_after_stale {
            self.refresh(world);
        }
        self.shown = Some(self.stamp());
        self.missing.clear();
    }

    /// Returns the events that were not announced before, and marks them as announced.
    pub(crate) fn announce(&mut self) -> Vec<LoggedEvent> {
        let base = self.base();
        let fresh = self.pending.iter_mut().filter(|entry| entry.announced.is_none());
        fresh
            .map(|entry| {
                let tick = base + entry.event.tick;
                entry.announced = Some(tick);
                LoggedEvent { tick, ..entry.event }
            })
            .collect()
    }

    /// Takes the withdrawn events that have not occurred again within [`SAME_EVENT_TICKS`] ticks, or all if no further
    /// tick will be played.
    pub(crate) fn retract(&mut self, has_ended: bool) -> Vec<LoggedEvent> {
        let played = self.ticks;
        let is_over = |withdrawn: &Withdrawn| has_ended || withdrawn.event.tick + SAME_EVENT_TICKS < played;
        let (over, open): (Vec<_>, _) = self.withdrawn.iter().partition(|withdrawn| is_over(withdrawn));
        self.withdrawn = open;
        over.into_iter()
            .map(|Withdrawn { event, announced }: Withdrawn| LoggedEvent { tick: announced, ..event })
            .collect()
    }

    /// Takes the events of the first `ticks` ticks, which are final.
    pub(crate) fn confirm(&mut self, ticks: u64) -> Vec<LoggedEvent> {
        let base = self.base();
        let is_final = |entry: &Entry| base + entry.event.tick <= ticks;
        let count = self.pending.iter().take_while(|entry| is_final(entry)).count();
        let taken = self.pending.drain(..count);
        taken.map(|entry| LoggedEvent { tick: base + entry.event.tick, ..entry.event }).collect()
    }
}

#[cfg(test)]
mod tests {
    use lockstep2d::body::BodyDef;
    use lockstep2d::lockstep::{Game, Sandbox, SandboxSetup};
    use lockstep2d::world::Command;

    use crate::observed::Observed;

    #[test]
    fn a_body_that_changes_in_every_tick_is_the_same_after_a_rollback() {
        let mut game = Observed::<Sandbox>::new(&SandboxSetup::default()).unwrap();
        let start = game.save();
        game.step(&[vec![Command::Spawn { body: BodyDef::dynamic(), shapes: vec![] }]]);
        let body = game.world().unwrap().bodies().next().unwrap().0;
        let change = |user_data| [vec![Command::SetUserData { body, user_data }]];
        game.step(&change(2));
        for (third, strangers) in [(9, 0), (8, 1)] {
            game.load(&start);
            game.step(&[vec![Command::Spawn { body: BodyDef::dynamic(), shapes: vec![] }]]);
            game.step(&change(2));
            game.step(&change(third));
            assert_eq!(game.log().missing.len(), strangers);
        }
    }
}
