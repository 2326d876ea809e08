//! Sweeps check one property in many cases. `cargo test` runs a sample of the cases. With `LOCKSTEP2D_LONG=1`, as in
//! `.ci/long`, it runs all cases.

use std::sync::Mutex;
use std::thread;

/// Whether sweeps run at full size.
pub fn is_long() -> bool {
    std::env::var_os("LOCKSTEP2D_LONG").is_some_and(|value| value == "1")
}

/// `full` in the long run, otherwise `sampled`.
pub fn size<T>(full: T, sampled: T) -> T {
    if is_long() { full } else { sampled }
}

/// All cases in the long run; otherwise the first, every `stride`th after it, and the last. If the cases are all
/// combinations of several parameters, choose a stride that is coprime to the number of values of each parameter: a
/// large sample then contains every value of every parameter.
pub fn sample<T>(cases: impl IntoIterator<Item = T>, stride: usize) -> Vec<T> {
    let cases: Vec<T> = cases.into_iter().collect();
    let (last, stride) = (cases.len().saturating_sub(1), size(1, stride));
    let chosen = |(at, _): &(usize, T)| at.is_multiple_of(stride) || *at == last;
    cases.into_iter().enumerate().filter(chosen).map(|(_, case)| case).collect()
}

/// Checks each case, on as many threads as there are processors.
///
/// # Panics
///
/// If a check panics. The other threads check the remaining cases first.
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

/// Checks all cases at the same time, for checks that mostly wait.
///
/// # Panics
///
/// If a check panics. All other cases are checked first.
pub fn at_once<T: Send>(cases: impl IntoIterator<Item = T>, check: impl Fn(T) + Sync) {
    let check = &check;
    thread::scope(|scope| {
        for case in cases {
            scope.spawn(move || check(case));
        }
    });
}
