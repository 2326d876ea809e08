//! Threads that share a tick. The number of threads changes the speed, never the result, because between two barriers
//! no thread reads anything that another thread writes.
//!
//! A team runs the parallel stages of a tick: the calling thread and the threads of a pool, each on its own part. They
//! wait for each other at barriers, about a hundred times in a tick. A barrier costs about 0.1 microseconds. A fork and
//! join of tasks would cost 1 to 50 microseconds.

#[cfg(test)]
mod tests;

#[cfg(feature = "parallel")]
mod barrier;
#[cfg(feature = "parallel")]
mod pace;
#[cfg(feature = "parallel")]
mod team;

use core::ops::Range;

#[cfg(feature = "parallel")]
use barrier::Barrier;
#[cfg(feature = "parallel")]
use team::Team;

/// Minimum number of active bodies for a tick on several threads. With fewer bodies, barriers take more time than a
/// second thread saves.
#[cfg(feature = "parallel")]
const BODIES_MIN: usize = 256;

/// Threads of a world. More than one thread needs the feature `parallel`.
#[derive(Clone, Debug, Default)]
pub(crate) struct Threads {
    #[cfg(feature = "parallel")]
    team: Option<alloc::sync::Arc<Team>>,
}

/// The rule by which several threads share ticks.
#[cfg(feature = "parallel")]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Sharing {
    /// Ticks with at least [`BODIES_MIN`] active bodies run on one thread or on all, whichever was faster in earlier
    /// ticks, except for a few trials.
    Adaptive,
    /// The threads share every tick with at least [`BODIES_MIN`] active bodies.
    Always,
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct Member<'a> {
    /// `None` for a thread that works alone.
    #[cfg(feature = "parallel")]
    barrier: Option<&'a Barrier>,
    #[cfg(not(feature = "parallel"))]
    _unused: core::marker::PhantomData<&'a ()>,
}

impl Member<'_> {
    pub(crate) const ALONE: Self = Member {
        #[cfg(feature = "parallel")]
        barrier: None,
        #[cfg(not(feature = "parallel"))]
        _unused: core::marker::PhantomData,
    };

    /// Whether no other thread works on the stage.
    #[cfg(feature = "parallel")]
    pub(crate) fn is_alone(self) -> bool {
        self.barrier.is_none()
    }

    #[cfg(not(feature = "parallel"))]
    #[expect(clippy::unused_self, reason = "same signature as with the feature")]
    pub(crate) const fn is_alone(self) -> bool {
        true
    }

    /// Waits until every other member of the team has called this method as often as this member.
    pub(crate) fn wait(self) {
        #[cfg(feature = "parallel")]
        if let Some(barrier) = self.barrier {
            barrier.wait();
        }
    }
}

/// A value that the members of a team write and read in turn, with a barrier in between.
#[cfg(feature = "parallel")]
pub(crate) struct TeamLock<T>(std::sync::RwLock<T>);

#[cfg(not(feature = "parallel"))]
pub(crate) struct TeamLock<T>(core::cell::RefCell<T>);

#[cfg(feature = "parallel")]
impl<T> TeamLock<T> {
    pub(crate) fn new(value: T) -> Self {
        TeamLock(std::sync::RwLock::new(value))
    }

    pub(crate) fn read(&self) -> impl core::ops::Deref<Target = T> {
        self.0.read().unwrap_or_else(std::sync::PoisonError::into_inner)
    }

    pub(crate) fn write(&self) -> impl core::ops::DerefMut<Target = T> {
        self.0.write().unwrap_or_else(std::sync::PoisonError::into_inner)
    }
}

#[cfg(not(feature = "parallel"))]
impl<T> TeamLock<T> {
    pub(crate) fn new(value: T) -> Self {
        TeamLock(core::cell::RefCell::new(value))
    }

    pub(crate) fn read(&self) -> impl core::ops::Deref<Target = T> {
        self.0.borrow()
    }

    pub(crate) fn write(&self) -> impl core::ops::DerefMut<Target = T> {
        self.0.borrow_mut()
    }
}

/// The part of `0..len` that one of `count` members works on. The part ends at a multiple of `unit` or at `len`.
pub(crate) fn part_of(len: usize, unit: usize, member: usize, count: usize) -> Range<usize> {
    let units = len.div_ceil(unit);
    let end = |member: usize| (units * member / count * unit).min(len);
    end(member)..end(member + 1)
}

/// Divides a slice at the given ends. An end beyond the slice counts as the end of the slice.
pub(crate) fn split_at_ends<T>(
    slice: &mut [T],
    ends: impl Iterator<Item = usize>,
) -> impl Iterator<Item = &mut [T]> {
    let (mut rest, mut start) = (slice, 0);
    ends.map(move |end| {
        let len = end.saturating_sub(start).min(rest.len());
        let (part, others) = core::mem::take(&mut rest).split_at_mut(len);
        (rest, start) = (others, start + len);
        part
    })
}

impl Threads {
    /// Starts `count - 1` threads in addition to the calling one. Returns `None` if they cannot be started.
    #[cfg(feature = "parallel")]
    pub(crate) fn new(count: usize, sharing: Sharing) -> Option<Self> {
        match count {
            0 | 1 => Some(Threads::default()),
            count => Some(Threads { team: Some(alloc::sync::Arc::new(Team::new(count, sharing)?)) }),
        }
    }

    /// Number of threads, including the calling one.
    #[cfg(feature = "parallel")]
    pub(crate) fn count(&self) -> usize {
        self.team.as_ref().map_or(1, |team| team.count())
    }

    #[cfg(not(feature = "parallel"))]
    #[expect(clippy::unused_self, reason = "same signature as with the feature")]
    pub(crate) const fn count(&self) -> usize {
        1
    }

    /// Runs a tick of a world with `bodies` active bodies. The argument of `tick` is the number of parts to pass to
    /// [`Self::run_team`].
    #[cfg(feature = "parallel")]
    pub(crate) fn run_tick<R>(&self, bodies: usize, tick: impl FnOnce(usize) -> R) -> R {
        match &self.team {
            Some(team) if bodies >= BODIES_MIN => team.run_tick(bodies, tick),
            _ => tick(1),
        }
    }

    #[cfg(not(feature = "parallel"))]
    #[expect(clippy::unused_self, reason = "same signature as with the feature")]
    pub(crate) fn run_tick<R>(&self, _bodies: usize, tick: impl FnOnce(usize) -> R) -> R {
        tick(1)
    }

    /// Runs `work` on each of at most [`Self::count`] parts, at the same time, one thread for each. Returns the sum of
    /// the results.
    #[cfg(feature = "parallel")]
    pub(crate) fn run_team<P: Send>(
        &self,
        mut parts: impl Iterator<Item = P>,
        work: impl Fn(P, Member<'_>) -> u64 + Sync,
    ) -> u64 {
        let Some(first) = parts.next() else { return 0 };
        match (parts.next(), &self.team) {
            (Some(second), Some(team)) => team.run(first, core::iter::once(second).chain(parts), work),
            (other, _) => {
                assert!(other.is_none(), "there should be at most as many parts as threads");
                work(first, Member::ALONE)
            }
        }
    }

    #[cfg(not(feature = "parallel"))]
    #[expect(clippy::unused_self, reason = "same signature as with the feature")]
    pub(crate) fn run_team<P>(
        &self,
        parts: impl Iterator<Item = P>,
        work: impl Fn(P, Member<'_>) -> u64,
    ) -> u64 {
        parts.map(|part| work(part, Member::ALONE)).sum()
    }
}
