//! Runs all seeds without the fuzzer. This is for machines without a nightly compiler, and for coverage.

use lockstep2d_fuzz::{
    broad_phases, bytes, hulls, lockstep, manifolds, matches, maths, pairs, questions, reports, snapshots,
    verdicts,
};

/// Runs the seeds of a target. There must be more than five.
fn run<T>(target: &str, run: impl Fn(&[u8]) -> T) {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("seeds").join(target);
    let mut count = 0;
    for entry in std::fs::read_dir(folder).expect("seeds for each target") {
        let bytes = std::fs::read(entry.expect("readable").path()).expect("readable");
        run(&bytes);
        count += 1;
    }
    assert!(count > 5, "only {count} seeds for {target}");
}

#[test]
fn scenes() {
    run("determinism", lockstep::run);
    run("broad_phase", broad_phases::run);
    run("queries", questions::run);
}

#[test]
fn files_of_scenes() {
    run("replays", verdicts::run);
    run("snapshots", snapshots::run);
    run("reports", reports::run);
    run("matches", matches::run);
}

#[test]
fn plain_bytes() {
    run("replay_bytes", bytes::replay::run);
    run("snapshot_bytes", bytes::snapshot::run);
    run("report_bytes", bytes::report::run);
    run("session", bytes::session::run);
}

#[test]
fn exact_numbers() {
    run("math", maths::run);
    run("hull", hulls::run);
    run("manifold", manifolds::run);
    run("pairs", pairs::run);
}
