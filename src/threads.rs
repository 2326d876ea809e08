//! Threads to share the work of a tick among. How many there are changes how fast, never what: work is divided into
//! jobs that do not look at each other's results.

/// The threads of a world: its own one only, unless the feature `parallel` is on and more are asked for.
#[derive(Clone, Debug, Default)]
pub(crate) struct Threads {
    #[cfg(feature = "parallel")]
    pool: Option<alloc::sync::Arc<rayon::ThreadPool>>,
}

/// How many jobs to make for each thread: more than one, because some take longer than others.
const JOBS_PER_THREAD: usize = 4;

impl Threads {
    /// A number of threads, at least 1.
    #[cfg(feature = "parallel")]
    pub(crate) fn new(count: usize) -> Option<Self> {
        if count <= 1 {
            return Some(Threads::default());
        }
        let pool = rayon::ThreadPoolBuilder::new().num_threads(count).build().ok()?;
        Some(Threads { pool: Some(alloc::sync::Arc::new(pool)) })
    }

    /// How many there are.
    #[cfg(feature = "parallel")]
    pub(crate) fn count(&self) -> usize {
        self.pool.as_ref().map_or(1, |pool| pool.current_num_threads())
    }

    /// How many there are.
    #[cfg(not(feature = "parallel"))]
    #[expect(clippy::unused_self, reason = "the same function as with the feature")]
    pub(crate) const fn count(&self) -> usize {
        1
    }

    /// How many of `count` things one job should do, and never fewer than `least`: all of them for one thread.
    pub(crate) fn share(&self, count: usize, least: usize) -> usize {
        match self.count() {
            1 => count.max(1),
            threads => count.div_ceil(threads * JOBS_PER_THREAD).max(least),
        }
    }

    /// Does something on one of the threads. Jobs that are handed out from there cost much less than from elsewhere.
    #[cfg(feature = "parallel")]
    pub(crate) fn install(&self, work: impl FnOnce() + Send) {
        match &self.pool {
            Some(pool) => pool.install(work),
            None => work(),
        }
    }

    /// Does something on one of the threads.
    #[cfg(not(feature = "parallel"))]
    #[expect(clippy::unused_self, reason = "the same function as with the feature")]
    pub(crate) fn install(&self, work: impl FnOnce() + Send) {
        work();
    }

    /// Does every job, in an order that is not said, and returns the sum of what they count.
    #[cfg(feature = "parallel")]
    pub(crate) fn run<J: Send>(
        &self,
        jobs: impl Iterator<Item = J> + Send,
        work: impl Fn(J) -> u64 + Sync,
    ) -> u64 {
        use core::sync::atomic::{AtomicU64, Ordering};

        let Some(pool) = &self.pool else { return jobs.map(work).sum() };
        let mut jobs = jobs;
        let Some(first) = jobs.next() else { return 0 };
        // A single job, as small worlds have, is not worth waking another thread for.
        let Some(second) = jobs.next() else { return work(first) };
        let (work, total) = (&work, &AtomicU64::new(0));
        pool.scope(|scope| {
            for job in [first, second].into_iter().chain(jobs) {
                scope.spawn(move |_| {
                    total.fetch_add(work(job), Ordering::Relaxed);
                });
            }
        });
        total.load(Ordering::Relaxed)
    }

    /// Does every job, in an order that is not said, and returns the sum of what they count.
    #[cfg(not(feature = "parallel"))]
    #[expect(clippy::unused_self, reason = "the same function as with the feature")]
    pub(crate) fn run<J: Send>(
        &self,
        jobs: impl Iterator<Item = J> + Send,
        work: impl Fn(J) -> u64 + Sync,
    ) -> u64 {
        jobs.map(work).sum()
    }
}
