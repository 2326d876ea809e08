//! [`run`]: runs tasks on several threads and shows the results, with bounded memory.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, mpsc};
use std::thread;
use std::time::Duration;

/// Maximum number of started tasks whose results are not yet shown. It bounds the number of results in memory: with
/// [`Order::Tasks`], a result waits until the results of all earlier tasks are shown.
const AHEAD_MAX: u64 = 1024;

/// Longest wait for a result before [`Sink::pause`] is called.
const MOMENT: Duration = Duration::from_millis(100);

/// Stack size of a thread in bytes. Games may rely on this size, because it is usual for a main thread.
const STACK_BYTES: usize = 8 << 20;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Order {
    /// Results are shown in the order of the tasks. A long task delays the results of later tasks.
    Tasks,
    Completion,
}

pub(super) trait Sink<R> {
    /// Type of the errors that end the run.
    type Error;

    fn result(&mut self, result: R) -> Result<(), Self::Error>;

    /// Called after each wait for a result, whether or not one has arrived. A wait takes at most [`MOMENT`]. If this
    /// function returns [`Pause::End`], the run ends.
    fn pause(&mut self) -> Result<Pause, Self::Error>;

    /// Called when [`Pause::End`] has ended the run and all waiting results were shown. Tasks may still be running.
    fn end(&mut self);
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Pause {
    Continue,
    End,
}

/// Calls `work` with each of `tasks` on `jobs` threads, and `sink` with the results. If the system refuses to create
/// some of the threads, fewer are used. If it refuses all, the tasks run on the thread of the caller, and
/// [`Sink::pause`] is not called.
///
/// After an error of `sink` or a [`Pause::End`], no more tasks are started, and `stop` is set so that running tasks
/// end.
pub(super) fn run<T: Send, R: Send, S: Sink<R>>(
    jobs: usize,
    order: Order,
    tasks: impl Iterator<Item = T>,
    work: impl Fn(T) -> R + Sync,
    stop: &AtomicBool,
    sink: &mut S,
) -> Result<(), S::Error> {
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
                // Continues with fewer threads.
                Err(_) => break,
            }
        }
        if workers.is_empty() {
            return tasks.map(&work).try_for_each(|result| sink.result(result));
        }
        let is_any_gone = || workers.iter().any(thread::ScopedJoinHandle::is_finished);
        let mut run = Run { tasks: tasks.fuse(), order, begun: 0, shown: 0, waiting: BTreeMap::new() };
        let result = run.run(&task_sender, &result_receiver, is_any_gone, sink);
        if !matches!(result, Ok(Pause::Continue)) {
            stop.store(true, Ordering::Relaxed);
        }
        if matches!(result, Ok(Pause::End)) {
            sink.end();
        }
        drop(task_sender);
        result.map(|_| ())
    })
}

/// Waits for the next task. Returns `None` if there are no more, or if `stop` is set.
fn next<T>(tasks: &Mutex<mpsc::Receiver<T>>, stop: &AtomicBool) -> Option<T> {
    let task = tasks.lock().ok()?.recv().ok()?;
    (!stop.load(Ordering::Relaxed)).then_some(task)
}

struct Run<I, R> {
    tasks: I,
    order: Order,
    begun: u64,
    shown: u64,
    /// Results that wait until all earlier results are shown, by the numbers of their tasks.
    waiting: BTreeMap<u64, R>,
}

impl<T, R, I: Iterator<Item = T>> Run<I, R> {
    fn run<S: Sink<R>>(
        &mut self,
        tasks: &mpsc::Sender<(u64, T)>,
        results: &mpsc::Receiver<(u64, R)>,
        is_any_gone: impl Fn() -> bool,
        sink: &mut S,
    ) -> Result<Pause, S::Error> {
        loop {
            // Starts one task per iteration, so that listing a large folder does not delay results.
            let room = self.begun - self.shown < AHEAD_MAX;
            let is_begun = room && self.begin(tasks);
            if !is_begun && self.begun == self.shown {
                return Ok(Pause::Continue);
            }
            let wait = if is_begun { Duration::ZERO } else { MOMENT };
            match results.recv_timeout(wait) {
                Ok((_, result)) if self.order == Order::Completion => {
                    sink.result(result)?;
                    self.shown += 1;
                }
                Ok((number, result)) => {
                    self.waiting.insert(number, result);
                }
                // A thread ends early only because of a bug. The result of its task will never arrive, so the run ends.
                Err(_) if !is_begun && is_any_gone() => return Ok(Pause::Continue),
                Err(_) => {}
            }
            while let Some(result) = self.waiting.remove(&self.shown) {
                sink.result(result)?;
                self.shown += 1;
            }
            if sink.pause()? == Pause::End {
                let held = std::mem::take(&mut self.waiting).into_values();
                held.chain(results.try_iter().map(|(_, result)| result))
                    .try_for_each(|result| sink.result(result))?;
                return Ok(Pause::End);
            }
        }
    }

    /// Passes one more task to the threads. Returns `false` if there is none.
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
    use std::sync::atomic::AtomicU64;

    use super::*;

    /// Returns the square of a number, after a delay that depends on the number.
    fn work(number: u64) -> u64 {
        let mut value = number;
        for _ in 0..(number * 7919 % 13) * 2000 {
            value = std::hint::black_box(value.wrapping_mul(3).wrapping_add(1));
        }
        number * number
    }

    #[derive(Default)]
    struct Shown {
        numbers: Vec<u64>,
        /// Number of results that are accepted. A further result is refused with an error.
        most: Option<usize>,
        /// Number of shown results after which [`Sink::pause`] ends the run.
        end_at: Option<usize>,
        is_ended: bool,
    }

    impl Sink<u64> for Shown {
        type Error = &'static str;

        fn result(&mut self, result: u64) -> Result<(), Self::Error> {
            if self.most == Some(self.numbers.len()) {
                return Err("full");
            }
            self.numbers.push(result);
            Ok(())
        }

        fn pause(&mut self) -> Result<Pause, Self::Error> {
            let is_end = self.end_at.is_some_and(|end| self.numbers.len() >= end);
            Ok(if is_end { Pause::End } else { Pause::Continue })
        }

        fn end(&mut self) {
            self.is_ended = true;
        }
    }

    #[test]
    fn every_task_is_done_once_and_shown_in_order() {
        for jobs in [1, 2, 3, 8] {
            for count in [0, 1, 5, 3000] {
                for order in [Order::Tasks, Order::Completion] {
                    let (begun, mut shown) = (AtomicU64::new(0), Shown::default());
                    let task = |number| {
                        begun.fetch_add(1, Ordering::Relaxed);
                        work(number)
                    };
                    run(jobs, order, 0..count, task, &AtomicBool::new(false), &mut shown).unwrap();
                    if order == Order::Completion {
                        shown.numbers.sort_unstable();
                    }
                    assert_eq!(shown.numbers, (0..count).map(|number| number * number).collect::<Vec<_>>());
                    assert_eq!(begun.into_inner(), count);
                }
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
            number
        };
        run(2, Order::Tasks, 0..all, task, &AtomicBool::new(false), &mut Shown::default()).unwrap();
        assert_eq!(begun.load(Ordering::Relaxed), all);
    }

    #[test]
    fn a_long_task_holds_up_nothing_that_is_shown_as_it_comes() {
        // The first task ends after all others.
        let (done, all) = (AtomicU64::new(0), 3 * AHEAD_MAX);
        let task = |number: u64| {
            while number == 0 && done.load(Ordering::Relaxed) < all - 1 {
                thread::yield_now();
            }
            done.fetch_add(1, Ordering::Relaxed);
            number
        };
        let mut shown = Shown::default();
        run(2, Order::Completion, 0..all, task, &AtomicBool::new(false), &mut shown).unwrap();
        assert_eq!((shown.numbers.len() as u64, shown.numbers.last()), (all, Some(&0)));
    }

    #[test]
    fn what_cannot_be_shown_ends_it() {
        let (stop, mut shown) = (AtomicBool::new(false), Shown { most: Some(9), ..Shown::default() });
        assert_eq!(run(2, Order::Tasks, 0.., work, &stop, &mut shown), Err("full"));
        assert_eq!(shown.numbers.len(), 9);
        assert!(stop.into_inner() && !shown.is_ended);
    }

    #[test]
    fn results_that_were_held_are_shown_at_the_end() {
        // The first task runs until it is stopped, so all later results wait for its result.
        let stop = AtomicBool::new(false);
        let done = AtomicU64::new(0);
        struct EndWhenHeld<'a>(Shown, &'a AtomicU64);
        impl Sink<u64> for EndWhenHeld<'_> {
            type Error = &'static str;
            fn result(&mut self, result: u64) -> Result<(), Self::Error> {
                self.0.result(result)
            }
            fn pause(&mut self) -> Result<Pause, Self::Error> {
                let is_end = self.1.load(Ordering::Relaxed) == AHEAD_MAX - 1;
                Ok(if is_end { Pause::End } else { Pause::Continue })
            }
            fn end(&mut self) {
                self.0.end();
            }
        }
        let task = |number: u64| {
            while number == 0 && !stop.load(Ordering::Relaxed) {
                thread::yield_now();
            }
            done.fetch_add(1, Ordering::Relaxed);
            number
        };
        let mut shown = EndWhenHeld(Shown::default(), &done);
        run(2, Order::Tasks, 0.., task, &stop, &mut shown).unwrap();
        // A task is counted as done before its result is sent, so the last result may be missing.
        assert!(
            shown.0.is_ended && shown.0.numbers.len() as u64 >= AHEAD_MAX - 2,
            "{}",
            shown.0.numbers.len()
        );
    }
}
