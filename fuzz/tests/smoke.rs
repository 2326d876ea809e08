//! A few hundred random inputs for each target, without the fuzzer: that the targets themselves work, and that
//! their scenes are full of contacts.

use lockstep2d::math::Rng;
use lockstep2d_fuzz::{lockstep, snapshots, verdicts};

fn random_inputs(count: u64) -> impl Iterator<Item = Vec<u8>> {
    (0..count).map(|seed| {
        let mut rng = Rng::new(seed);
        (0..200 + rng.below(1500)).map(|_| rng.next_u32() as u8).collect()
    })
}

#[test]
fn scenes_run_the_same_in_every_way_and_touch_a_lot() {
    let (mut touching, mut ticks, mut done, mut refused, mut faulty) = (0, 0, 0, 0, 0);
    let mut touched_runs = 0;
    for input in random_inputs(300) {
        let seen = lockstep::run(&input);
        touching += seen.touching;
        ticks += seen.ticks;
        done += seen.done;
        refused += seen.refused;
        faulty += u64::from(seen.faults > 0);
        touched_runs += u64::from(seen.touching > 100);
    }
    println!(
        "{ticks} ticks, {touching} touching, {touched_runs} runs with >100, {done} done, {refused} refused, {faulty} runs with faults"
    );
    assert!(touching > 300 * 500, "only {touching} touching contacts");
}

#[test]
fn changed_snapshots_are_refused_or_live_on() {
    let accepted = random_inputs(500).filter(|input| snapshots::run(input)).count();
    println!("{accepted} accepted");
    assert!(accepted > 20, "only {accepted} of 500 accepted; 36 when this was written");
}

#[test]
fn changed_replays_never_match() {
    let mut names = std::collections::BTreeMap::new();
    for input in random_inputs(500) {
        *names.entry(verdicts::run(&input).name()).or_insert(0) += 1;
    }
    println!("{names:?}");
    assert!(names.len() >= 4, "{names:?}");
}
