use super::*;

/// In each round one member stores the number of the round, and all members read it after a barrier.
#[test]
fn nobody_leaves_before_the_last_has_arrived() {
    const MEMBERS: usize = 4;
    let (barrier, turn) = (Barrier::new(MEMBERS), AtomicUsize::new(0));
    std::thread::scope(|scope| {
        for member in 0..MEMBERS {
            let (barrier, turn) = (&barrier, &turn);
            scope.spawn(move || {
                for round in 0..200 {
                    if round % MEMBERS == member {
                        turn.store(round, Ordering::Relaxed);
                    }
                    barrier.wait();
                    assert_eq!(turn.load(Ordering::Relaxed), round);
                    barrier.wait();
                }
            });
        }
    });
}

#[test]
fn a_member_that_panics_frees_the_others() {
    let barrier = &Barrier::new(2);
    let others = std::thread::scope(|scope| {
        let waits = scope.spawn(|| {
            let _guard = Guard(barrier);
            barrier.wait();
        });
        let panics = scope.spawn(|| {
            let _guard = Guard(barrier);
            panic!("planted");
        });
        [waits.join().is_err(), panics.join().is_err()]
    });
    assert_eq!(others, [true, true]);
}
