use super::*;

/// Records ticks that take `alone` milliseconds on the calling thread, or `team` milliseconds on all threads.
/// Returns the number of ticks on all threads.
fn run(pace: &mut Pace, ticks: u32, alone: u64, team: u64) -> u32 {
    let mut shared = 0;
    for _ in 0..ticks {
        let mode = pace.mode();
        shared += u32::from(mode == Mode::Team);
        pace.record(mode, Duration::from_millis(if mode == Mode::Team { team } else { alone }), 1000);
    }
    shared
}

#[test]
fn threads_that_make_ticks_shorter_share_almost_all_ticks() {
    // Trials after 16, 32, 64, 128, 256, 512 and 1024 ticks.
    assert_eq!(run(&mut Pace::new(), 2040, 5, 3), 2040 - 7);
    assert_eq!(run(&mut Pace::new(), 2040, 100, 99), 2040 - 7);
}

#[test]
fn threads_that_make_ticks_longer_share_few_ticks() {
    let shared = run(&mut Pace::new(), 2040, 3, 60);
    assert!((16..16 + 8).contains(&shared), "{shared}");
}

#[test]
fn busy_processors_are_left_to_other_programs() {
    let mut pace = Pace::new();
    run(&mut pace, 1000, 5, 3);
    let shared = run(&mut pace, 600, 5, 40);
    assert!((1..10).contains(&shared), "{shared}");
    run(&mut pace, TRIAL_MAX, 5, 3);
    let shared = run(&mut pace, 100, 5, 3);
    assert!(shared >= 90, "{shared}");
}

/// After a single slow tick, the threads soon share ticks again.
#[test]
fn an_interruption_is_forgotten() {
    let mut pace = Pace::new();
    run(&mut pace, 1000, 5, 3);
    run(&mut pace, 1, 5, 100);
    assert!(run(&mut pace, 100, 5, 3) >= 80);
}

#[test]
fn times_are_compared_per_body() {
    let mut pace = Pace::new();
    run(&mut pace, TRIAL_MIN, 5, 3);
    pace.record(Mode::Alone, Duration::from_millis(5), 1000);
    for bodies in 1000..3000 {
        pace.record(Mode::Team, Duration::from_micros(3 * bodies), usize::try_from(bodies).expect("small"));
    }
    assert_eq!(pace.faster, Mode::Team);
    pace.record(Mode::Team, Duration::MAX, 0);
    assert_eq!(pace.faster, Mode::Alone);
}
