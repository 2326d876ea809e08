//! [`in_order`]: runs tasks on several threads and shows the results in the order of the tasks, with bounded memory.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, mpsc};
use std::thread;
use std::time::Duration;

/// Most tasks that are started before the result of the first of them is shown. Their results are held in memory while
/// a long task runs.
const AHEAD_MAX: u64 = 1024;

/// Interval of `show(None)` calls while there is no result.
const MOMENT: Duration = Duration::from_millis(100);

/// Stack size of a thread in bytes: that of a main thread, which a game may rely on. Untouched pages take no memory.
const STACK_BYTES: usize = 8 << 20;

/// Calls `work` with each of `tasks` on `jobs` threads, and `show` with the results in the order of the tasks. While
/// there is no result, calls `show` with `None` from time to time.
///
/// After an error of `show`, `stop` is set and no more tasks are started. Long-running work should check `stop`.
///
/// # Errors
/// The error of `show`.
pub(super) fn in_order<T: Send, R: Send, E>(
    jobs: usize,
    tasks: impl Iterator<Item = T>,
    work: impl Fn(T) -> R + Sync,
    stop: &AtomicBool,
    mut show: impl FnMut(Option<R>) -> Result<(), E>,
) -> Result<(), E> {
    let (task_sender, task_receiver) = mpsc::channel::<(u64, T)>();
    let (result_sender, result_receiver) = mpsc::channel::<(u64, R)>();
    let task_receiver = Mutex::new(task_receiver);
    let worker = |results: mpsc::Sender<(u64, R)>| {
        while let Some((number, task)) = next(&task_receiver, stop) {
            if results.send((number, work(task))).is_err() {
                break;
            }
        }
    };
    thread::scope(|scope| {
        let mut workers = Vec::new();
        for _ in 0..jobs {
            let (worker, results) = (&worker, result_sender.clone());
            let builder = thread::Builder::new().stack_size(STACK_BYTES);
            match builder.spawn_scoped(scope, move || worker(results)) {
                Ok(handle) => workers.push(handle),
                // The system refuses more threads: continue with fewer.
                Err(_) => break,
            }
        }
        if workers.is_empty() {
            return tasks.map(&work).try_for_each(|result| show(Some(result)));
        }
        let is_any_gone = || workers.iter().any(thread::ScopedJoinHandle::is_finished);
        let mut order = Order { tasks: tasks.fuse(), begun: 0, shown: 0, waiting: BTreeMap::new() };
        let result = order.run(&task_sender, &result_receiver, is_any_gone, &mut show);
        if result.is_err() {
            stop.store(true, Ordering::Relaxed);
        }
        drop(task_sender);
        result
    })
}

/// Waits for the next task. Returns `None` when there are no more tasks, or after `stop`.
fn next<T>(tasks: &Mutex<mpsc::Receiver<T>>, stop: &AtomicBool) -> Option<T> {
    let task = tasks.lock().ok()?.recv().ok()?;
    (!stop.load(Ordering::Relaxed)).then_some(task)
}

/// The progress of the work, and results that are not yet shown.
struct Order<I, R> {
    tasks: I,
    begun: u64,
    shown: u64,
    /// Results that wait for earlier results.
    waiting: BTreeMap<u64, R>,
}

impl<T, R, I: Iterator<Item = T>> Order<I, R> {
    fn run<E>(
        &mut self,
        tasks: &mpsc::Sender<(u64, T)>,
        results: &mpsc::Receiver<(u64, R)>,
        is_any_gone: impl Fn() -> bool,
        show: &mut impl FnMut(Option<R>) -> Result<(), E>,
    ) -> Result<(), E> {
        loop {
            // Start one task per iteration, so that listing a large folder does not delay results.
            let room = self.begun - self.shown < AHEAD_MAX;
            let is_begun = room && self.begin(tasks);
            if !is_begun && self.begun == self.shown {
                return Ok(());
            }
            let wait = if is_begun { Duration::ZERO } else { MOMENT };
            match results.recv_timeout(wait) {
                Ok((number, result)) => {
                    self.waiting.insert(number, result);
                }
                // A worker ends early only because of a bug. Its result would never arrive.
                Err(_) if !is_begun && is_any_gone() => return Ok(()),
                Err(_) if !is_begun => show(None)?,
                Err(_) => {}
            }
            while let Some(result) = self.waiting.remove(&self.shown) {
                show(Some(result))?;
                self.shown += 1;
            }
        }
    }

    /// Starts one more task. Returns false if there is none.
    fn begin(&mut self, tasks: &mpsc::Sender<(u64, T)>) -> bool {
        let Some(task) = self.tasks.next() else {
            return false;
        };
        let is_sent = tasks.send((self.begun, task)).is_ok();
        self.begun += u64::from(is_sent);
        is_sent
    }
}

#[cfg(test)]
mod tests {
    use std::io;
    use std::sync::atomic::AtomicU64;

    use super::*;

    /// Work whose duration depends on the number.
    fn work(number: u64) -> u64 {
        let mut value = number;
        for _ in 0..(number * 7919 % 13) * 2000 {
            value = std::hint::black_box(value.wrapping_mul(3).wrapping_add(1));
        }
        number * number
    }

    #[test]
    fn results_come_in_the_order_of_the_tasks() {
        for jobs in [1, 2, 3, 8] {
            for count in [0, 1, 5, 3000] {
                let (begun, mut shown) = (AtomicU64::new(0), Vec::new());
                let task = |number| {
                    begun.fetch_add(1, Ordering::Relaxed);
                    work(number)
                };
                let stop = AtomicBool::new(false);
                let show = |result: Option<u64>| -> io::Result<()> {
                    shown.extend(result);
                    Ok(())
                };
                in_order(jobs, 0..count, task, &stop, show).unwrap();
                assert_eq!(shown, (0..count).map(|number| number * number).collect::<Vec<_>>());
                assert_eq!(begun.into_inner(), count);
            }
        }
    }

    #[test]
    fn no_more_is_begun_than_can_be_held() {
        // The first task waits until as many tasks are started as the limit allows.
        let begun = AtomicU64::new(0);
        let (all, limit) = (4 * AHEAD_MAX, AHEAD_MAX);
        let task = |number: u64| {
            begun.fetch_add(1, Ordering::Relaxed);
            while number == 0 && begun.load(Ordering::Relaxed) < limit {
                thread::yield_now();
            }
            if number == 0 {
                thread::sleep(Duration::from_millis(50));
                assert_eq!(begun.load(Ordering::Relaxed), limit);
            }
        };
        let stop = AtomicBool::new(false);
        in_order(2, 0..all, task, &stop, |_| -> io::Result<()> { Ok(()) }).unwrap();
        assert_eq!(begun.load(Ordering::Relaxed), all);
    }

    #[test]
    fn what_cannot_be_shown_ends_it() {
        let (stop, mut shown) = (AtomicBool::new(false), 0);
        let show = |result: Option<u64>| {
            shown += u64::from(result.is_some());
            if shown == 10 { Err(io::Error::from(io::ErrorKind::BrokenPipe)) } else { Ok(()) }
        };
        let error = in_order(2, 0.., work, &stop, show).unwrap_err();
        assert_eq!((error.kind(), shown), (io::ErrorKind::BrokenPipe, 10));
        assert!(stop.into_inner());
    }
}
