//! Runs most targets without the fuzzer, each with 200 to 20 000 random inputs.

use lockstep2d::math::Rng;
use lockstep2d_fuzz::manifolds::Seen;
use lockstep2d_fuzz::{
    broad_phases, hulls, lockstep, manifolds, matches, maths, pairs, questions, reports, snapshots, verdicts,
};

fn random_inputs(count: u64) -> impl Iterator<Item = Vec<u8>> {
    (0..count).map(|seed| {
        let mut rng = Rng::new(seed);
        (0..200 + rng.below(1500)).map(|_| rng.next_u32() as u8).collect()
    })
}

#[test]
fn scenes_run_the_same_in_every_way_and_touch_a_lot() {
    let (mut touching, mut ticks, mut done, mut refused, mut faulty) = (0, 0, 0, 0, 0);
    let (mut touched_runs, mut full, mut slept, mut noticed, mut hits, mut ordinary) =
        (0, 0, 0, 0, 0, [0; 2]);
    for input in random_inputs(300) {
        let seen = lockstep::run(&input);
        touching += seen.touching;
        ticks += seen.ticks;
        done += seen.done;
        refused += seen.refused;
        faulty += u64::from(seen.faults > 0);
        slept += seen.slept;
        noticed += seen.noticed;
        hits += seen.hits;
        ordinary[usize::from(seen.ordinary && seen.faults > 0)] += u64::from(seen.ordinary);
        touched_runs += u64::from(seen.touching > 100);
        full += u64::from(seen.is_full());
    }
    println!(
        "{ticks} ticks, {touching} touching, {touched_runs} runs with >100, {full} long ones with >=10 at once, {done} done, {refused} refused, {faulty} runs with faults; ordinary ones without and with: {ordinary:?}; {slept} fell asleep, {noticed} noticed, {hits} hits"
    );
    assert!(
        slept > 100 && noticed > 300 && hits > 300,
        "{slept} fell asleep, {noticed} noticed, {hits} hits"
    );
    assert!(touching > 300 * 500, "only {touching} touching contacts");
    assert!(full > 150, "only {full} long runs with ten contacts");
}

#[test]
fn changed_snapshots_are_refused_or_live_on() {
    let accepted = random_inputs(500).filter(|input| snapshots::run(input)).count();
    println!("{accepted} accepted");
    assert!(accepted > 20, "only {accepted} of 500 accepted, expected about 36");
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

#[test]
fn queries_tell_the_truth() {
    let answers: u64 = random_inputs(200).map(|input| questions::run(&input)).sum();
    println!("{answers} answers");
    assert!(answers > 200 * 10, "only {answers} answers");
}

#[test]
fn broad_phases_find_the_same() {
    let pairs: u64 = random_inputs(200).map(|input| broad_phases::run(&input)).sum();
    println!("{pairs} pairs");
    assert!(pairs > 200 * 500, "only {pairs} pairs");
}

#[test]
fn matches_go_on_whatever_comes() {
    let (mut ticks, mut packets, mut stopped, mut diverged, mut late) = (0, 0, 0, 0, 0);
    for input in random_inputs(300) {
        let seen = matches::run(&input);
        ticks += seen.ticks;
        packets += seen.packets;
        stopped += u64::from(seen.stopped);
        diverged += u64::from(seen.diverged);
        late += u64::from(seen.late);
    }
    println!("{ticks} ticks, {packets} packets; of 300 {stopped} stopped, {diverged} diverged, {late} late");
    assert!(ticks > 100 * 50 && packets > 300 * 10, "{ticks} ticks, {packets} packets");
    assert!(late > 50, "{late} late");
}

#[test]
fn reports_tell_the_truth_or_are_refused() {
    let mut seen = std::collections::BTreeMap::new();
    for input in random_inputs(500) {
        *seen.entry(reports::run(&input)).or_insert(0) += 1;
    }
    println!("{seen:?}");
    assert!(seen.len() >= 5, "{seen:?}");
}

#[test]
fn operations_are_exact() {
    let tried: u64 = random_inputs(2000).map(|input| maths::run(&input)).sum();
    println!("{tried} operations");
    assert!(tried > 2000 * 3, "only {tried} operations");
}

#[test]
fn hulls_are_hulls() {
    let hulls = random_inputs(5000).filter(|input| hulls::run(input)).count();
    println!("{hulls} hulls");
    assert!(hulls > 1000, "only {hulls} hulls");
}

#[test]
fn contacts_are_exact() {
    let mut seen = std::collections::BTreeMap::new();
    for input in random_inputs(20_000) {
        *seen.entry(manifolds::run(&input)).or_insert(0) += 1;
    }
    println!("{seen:?}");
    for kind in [Seen::Apart, Seen::Near, Seen::Overlapping] {
        assert!(seen.get(&kind).is_some_and(|count| *count > 50), "{seen:?}");
    }
}

#[test]
fn pairs_depend_on_nothing_else() {
    let contacts: u64 = random_inputs(5000).filter_map(|input| pairs::run(&input)).sum();
    println!("{contacts} contacts");
    assert!(contacts > 2000, "only {contacts} contacts");
}

#[test]
#[should_panic(expected = "tick")]
fn a_planted_fault_is_found() {
    random_inputs(300).for_each(|input| lockstep::run_with_a_fault(&input));
}
