//! Mutates valid files, and counts the answers of their readers.

use std::collections::BTreeMap;
use std::time::Duration;

use lockstep2d::lockstep::Game;
use lockstep2d::math::Rng;
use lockstep2d::replay::{Limits, Reader, TickInputs, Verdict, verify};

use crate::memory;
use crate::mutation::{below, mutate, repair};

/// Time limit for reading or simulating one file, in seconds.
const SECONDS_MAX: u64 = 5;
/// Largest memory use for one file in bytes.
const MEMORY_MAX: usize = 32 << 20;
/// Largest size of a small file, in bytes.
const SMALL: usize = 6000;
/// One in this number of mutated files is made from an original that is not small.
const LARGE_ONE_IN: u32 = 50;
/// Decoded content of a replay.
#[derive(PartialEq, Eq)]
struct Trajectory {
    setup: Vec<u8>,
    inputs: Vec<Vec<u8>>,
    verdict: Verdict,
}

impl Trajectory {
    fn of(file: &[u8], verdict: Verdict) -> Trajectory {
        let limits = Limits::default();
        let setup = Reader::open(file, &limits).unwrap().header().setup.to_vec();
        let mut ticks = TickInputs::open(file, &limits).unwrap();
        let mut inputs = Vec::new();
        while let Some(run) = ticks.next_tick().unwrap() {
            inputs.push(run.encoded.to_vec());
        }
        Trajectory { setup, inputs, verdict }
    }
}

#[derive(Default)]
pub(crate) struct Figures {
    pub(crate) answers: BTreeMap<String, u64>,
    slowest: Duration,
    /// Largest memory use in bytes.
    memory: usize,
    /// Largest memory use as a multiple of the file's size. Files below 1000 bytes count as 1000.
    multiple: usize,
}

impl Figures {
    /// Reads a file, checks the time and the memory that this takes, and counts the answer.
    pub(crate) fn count<T>(
        &mut self,
        file: &[u8],
        read: impl FnOnce() -> T,
        name: impl FnOnce(&T) -> String,
    ) -> T {
        let start = time_used();
        let (answer, peak) = memory::peak_of(read);
        let time = time_used() - start;
        let words = name(&answer);
        if time >= Duration::from_secs(SECONDS_MAX) || peak > MEMORY_MAX {
            let path = std::env::temp_dir().join("lockstep2d-mutated");
            std::fs::write(&path, file).unwrap();
            panic!("{time:?} and {peak} bytes for {} bytes, {words}: {}", file.len(), path.display());
        }
        self.slowest = self.slowest.max(time);
        self.memory = self.memory.max(peak);
        self.multiple = self.multiple.max(peak / file.len().max(1000));
        *self.answers.entry(words).or_default() += 1;
        answer
    }

    pub(crate) fn print(&self, what: &str) {
        let Figures { answers, slowest, memory, multiple } = self;
        println!(
            "{what}: {answers:?}; slowest {slowest:?}, most memory {memory} bytes, {multiple} times the file at most"
        );
    }
}

/// CPU time of this thread, or elapsed time where the system does not report it.
fn time_used() -> Duration {
    let figures = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap_or_default();
    match figures.split(' ').next().and_then(|nanoseconds| nanoseconds.parse().ok()) {
        Some(nanoseconds) => Duration::from_nanos(nanoseconds),
        None => started().elapsed(),
    }
}

#[expect(clippy::disallowed_types, reason = "detecting hangs needs the clock")]
fn started() -> std::time::Instant {
    static START: std::sync::OnceLock<std::time::Instant> = std::sync::OnceLock::new();
    *START.get_or_init(std::time::Instant::now)
}

/// Number of files for a test: `MUTATIONS` if it is set, otherwise `few`.
pub(crate) fn files_wanted(few: u64) -> u64 {
    std::env::var("MUTATIONS").ok().and_then(|count| count.parse().ok()).unwrap_or(few)
}

/// Returns a random original with one to three random changes. In half of the cases, checksums are then repaired.
pub(crate) fn mutated(rng: &mut Rng, originals: &[Vec<u8>]) -> Vec<u8> {
    let (small, large): (Vec<_>, Vec<_>) = originals.iter().partition(|file| file.len() <= SMALL);
    let kind = if rng.below(LARGE_ONE_IN) == 0 && !large.is_empty() { large } else { small };
    let mut file = kind[below(rng, kind.len())].clone();
    for _ in 0..[1, 1, 1, 1, 2, 3][below(rng, 6)] {
        if !file.is_empty() {
            mutate(rng, &mut file, originals);
        }
    }
    if rng.below(2) == 0 {
        repair(&mut file);
    }
    file
}

/// Verifies mutated replays. Expects that each one with the verdict `Match` has the setup, inputs and verdict of an
/// original.
pub(crate) fn check_replays<G: Game>(originals: &[Vec<u8>], few: u64) {
    let limits = Limits::default();
    let verdicts = originals.iter().map(|file| (file, verify::<G>(file, &limits)));
    let trajectories: Vec<_> = verdicts.map(|(file, verdict)| Trajectory::of(file, verdict)).collect();
    let (mut rng, mut figures) = (Rng::new(1), Figures::default());
    for number in 0..files_wanted(few) {
        let file = mutated(&mut rng, originals);
        let name = |verdict: &Verdict| verdict.name().to_string();
        let verdict = figures.count(&file, || verify::<G>(&file, &limits), name);
        if verdict.is_match() {
            let trajectory = Trajectory::of(&file, verdict);
            assert!(
                trajectories.contains(&trajectory),
                "file {number} is accepted, but differs from every original"
            );
        }
    }
    figures.print("replays");
    for verdict in ["match", "diverged", "incomplete", "malformed"] {
        assert!(
            figures.answers.contains_key(verdict),
            "expected a file with the verdict {verdict}: {:?}",
            figures.answers
        );
    }
}
