//! Sweeps check one property in many cases. `cargo test` runs a sample of each sweep; with `LOCKSTEP2D_LONG=1` in the
//! environment, as set by `.ci/long`, every sweep runs at full size.

use std::sync::Mutex;
use std::thread;

/// Whether sweeps run at full size.
pub fn is_long() -> bool {
    std::env::var_os("LOCKSTEP2D_LONG").is_some_and(|value| value == "1")
}

/// Returns `full` in the long run and `sampled` otherwise.
pub fn size<T>(full: T, sampled: T) -> T {
    if is_long() { full } else { sampled }
}

/// Returns all cases in the long run; otherwise the first, every `stride`th after it, and the last. If the cases are
/// all combinations of some parameters, a sample that is large enough contains every value of every parameter, provided
/// that the stride has no common divisor with any parameter's number of values.
pub fn sample<T>(cases: impl IntoIterator<Item = T>, stride: usize) -> Vec<T> {
    let cases: Vec<T> = cases.into_iter().collect();
    let (last, stride) = (cases.len().saturating_sub(1), size(1, stride));
    let chosen = |(at, _): &(usize, T)| at.is_multiple_of(stride) || *at == last;
    cases.into_iter().enumerate().filter(chosen).map(|(_, case)| case).collect()
}

/// Checks each case, as many at a time as there are processors. This is for checks that spend their time on
/// computation.
///
/// # Panics
///
/// If a check panics. The threads on which no check panics check the remaining cases first.
pub fn for_each<T: Send>(cases: Vec<T>, check: impl Fn(T) + Sync) {
    let processors = thread::available_parallelism().map_or(1, usize::from);
    let workers = processors.min(cases.len());
    let cases = Mutex::new(cases.into_iter());
    let next = || cases.lock().expect("no check holds the lock").next();
    thread::scope(|scope| {
        for _ in 0..workers {
            scope.spawn(|| {
                while let Some(case) = next() {
                    check(case);
                }
            });
        }
    });
}

/// Checks all cases at the same time. This is for checks that mostly wait for a clock.
///
/// # Panics
///
/// If a check panics, after all other cases have been checked.
pub fn at_once<T: Send>(cases: impl IntoIterator<Item = T>, check: impl Fn(T) + Sync) {
    let check = &check;
    thread::scope(|scope| {
        for case in cases {
            scope.spawn(move || check(case));
        }
    });
}
