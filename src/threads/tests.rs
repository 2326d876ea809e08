use super::*;

#[test]
fn parts_cover_everything_once_and_end_at_whole_units() {
    for (len, unit, count) in [(0, 8, 3), (5, 8, 3), (64, 8, 4), (100, 8, 3), (7, 1, 9)] {
        let mut end = 0;
        for member in 0..count {
            let part = part_of(len, unit, member, count);
            assert_eq!(part.start, end);
            assert!(part.end == len || part.end.is_multiple_of(unit), "{part:?} of {len}");
            end = part.end;
        }
        assert_eq!(end, len);
    }
}

#[test]
fn slices_are_divided_at_their_ends() {
    let mut numbers = [0, 1, 2, 3, 4];
    let parts: std::vec::Vec<_> = split_at_ends(&mut numbers, [2, 2, 4, usize::MAX].into_iter()).collect();
    assert_eq!(parts, [&[0, 1][..], &[], &[2, 3], &[4]]);
}

#[cfg(feature = "parallel")]
mod team {
    use std::panic::{AssertUnwindSafe, catch_unwind};
    use std::sync::atomic::{AtomicU64, Ordering};

    use super::super::*;

    const MEMBERS: u64 = 4;

    /// Every member adds its number to each of 20 sums, and reads each sum after a barrier. Returns the number of
    /// members.
    fn add(threads: &Threads) -> u64 {
        let sums = [0; 20].map(AtomicU64::new);
        threads.run_tick(BODIES_MIN, |parts| {
            let parts = u64::try_from(parts).expect("few");
            let seen = threads.run_team(0..parts, |number, member| {
                let mut seen = 0;
                for sum in &sums {
                    sum.fetch_add(number, Ordering::Relaxed);
                    member.wait();
                    seen += sum.load(Ordering::Relaxed);
                }
                seen
            });
            assert_eq!(seen, parts * 20 * (parts * (parts - 1) / 2));
            parts
        })
    }

    #[test]
    fn a_tick_during_another_one_works_alone() {
        let threads = Threads::new(4, Sharing::Always).expect("threads");
        let inner = threads.run_tick(BODIES_MIN, |parts| (parts, add(&threads)));
        assert_eq!(inner, (4, 1));
        std::thread::scope(|scope| {
            for _ in 0..3 {
                let threads = threads.clone();
                scope.spawn(move || (0..50).for_each(|_| assert!([1, 4].contains(&add(&threads)))));
            }
        });
        assert_eq!(add(&threads), 4);
    }

    #[test]
    fn a_panic_reaches_the_caller_and_leaves_the_threads_usable() {
        let threads = Threads::new(4, Sharing::Always).expect("threads");
        for panicking in 0..MEMBERS {
            let result = catch_unwind(AssertUnwindSafe(|| {
                threads.run_tick(BODIES_MIN, |_| {
                    threads.run_team(0..MEMBERS, |number, member| {
                        assert_ne!(number, panicking, "planted");
                        member.wait();
                        0
                    })
                })
            }));
            assert!(result.is_err(), "the panic of member {panicking} is lost");
            assert_eq!(add(&threads), MEMBERS);
        }
    }
}
