//! Many files made of a few good ones, and what has come of them.

use std::collections::BTreeMap;
use std::time::Duration;

use lockstep2d::lockstep::Game;
use lockstep2d::math::Rng;
use lockstep2d::replay::{Limits, Reader, TickInputs, Verdict, verify};

use crate::memory;
use crate::mutation::{below, mutate, repair};

/// A hang.
const SECONDS_MAX: u64 = 5;
/// Most memory that reading or playing one of these files may take at one time.
const MEMORY_MAX: usize = 32 << 20;
/// Largest files that most mutations are tried on, and how often a larger one is taken: once in so many times.
const SMALL: usize = 6000;
const LARGE_ONE_IN: u32 = 50;
/// What a verdict was given on, apart from the bytes.
#[derive(PartialEq, Eq)]
struct Course {
    setup: Vec<u8>,
    inputs: Vec<Vec<u8>>,
    verdict: Verdict,
}

impl Course {
    fn of(file: &[u8], verdict: Verdict) -> Course {
        let limits = Limits::default();
        let setup = Reader::open(file, &limits).unwrap().header().setup.to_vec();
        let mut ticks = TickInputs::open(file, &limits).unwrap();
        let mut inputs = Vec::new();
        while let Some(run) = ticks.next_tick().unwrap() {
            inputs.push(run.encoded.to_vec());
        }
        Course { setup, inputs, verdict }
    }
}

/// What has come of many files.
#[derive(Default)]
pub(crate) struct Figures {
    pub(crate) answers: BTreeMap<String, u64>,
    slowest: Duration,
    /// Most bytes at one time, and the same in multiples of a file's bytes.
    memory: usize,
    multiple: usize,
}

impl Figures {
    /// Reads a file, looks at clock and memory, and counts the answer.
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

/// How long this thread has computed, which the load of the machine does not change.
fn time_used() -> Duration {
    let figures = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap_or_default();
    match figures.split(' ').next().and_then(|nanoseconds| nanoseconds.parse().ok()) {
        Some(nanoseconds) => Duration::from_nanos(nanoseconds),
        None => started().elapsed(),
    }
}

#[expect(clippy::disallowed_types, reason = "a hang is a matter of time")]
fn started() -> std::time::Instant {
    static START: std::sync::OnceLock<std::time::Instant> = std::sync::OnceLock::new();
    *START.get_or_init(std::time::Instant::now)
}

/// How many files a test makes: `few`, unless told otherwise.
pub(crate) fn files_wanted(few: u64) -> u64 {
    std::env::var("MUTATIONS").ok().and_then(|count| count.parse().ok()).unwrap_or(few)
}

/// Changes one of some files in one to three ways, and repairs half of them.
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

/// Changes replays and verifies them: what is a match has the setup, the inputs, the ticks and the end of one of them.
pub(crate) fn check_replays<G: Game>(originals: &[Vec<u8>], few: u64) {
    let limits = Limits::default();
    let verdicts = originals.iter().map(|file| (file, verify::<G>(file, &limits)));
    let courses: Vec<_> = verdicts.map(|(file, verdict)| Course::of(file, verdict)).collect();
    let (mut rng, mut figures) = (Rng::new(1), Figures::default());
    for number in 0..files_wanted(few) {
        let file = mutated(&mut rng, originals);
        let name = |verdict: &Verdict| verdict.name().to_string();
        let verdict = figures.count(&file, || verify::<G>(&file, &limits), name);
        if verdict.is_match() {
            let course = Course::of(&file, verdict);
            assert!(courses.contains(&course), "file {number} is a match of its own");
        }
    }
    figures.print("replays");
    for verdict in ["match", "diverged", "incomplete", "malformed"] {
        assert!(figures.answers.contains_key(verdict), "no file is {verdict}: {:?}", figures.answers);
    }
}
