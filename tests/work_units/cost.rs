//! Measures the time per work unit that the setup and the ticks of a game take.

use std::time::{Duration, Instant};

use lockstep2d::lockstep::{Sandbox, SandboxSetup};
use lockstep2d::replay::{Limits, Recording, Step, VerifiedReplay, verify};
use lockstep2d::world::{Command, Config};

/// Largest cost in nanoseconds per unit. Builds with debug assertions are allowed three times as much.
const MAX: u128 = if cfg!(debug_assertions) { 3000 } else { 1000 };

/// Shortest time that is judged. In a shorter time, the overhead of a tick counts more than its work.
const JUDGED: Duration = Duration::from_millis(10);

/// Processor time of this thread, or elapsed time where the system does not report it.
pub(super) fn computed() -> Duration {
    let known = std::fs::read_to_string("/proc/thread-self/schedstat").ok();
    let nanoseconds = known.as_deref().and_then(|text| text.split(' ').next()?.parse().ok());
    static START: std::sync::LazyLock<Instant> = std::sync::LazyLock::new(Instant::now);
    nanoseconds.map_or_else(|| START.elapsed(), Duration::from_nanos)
}

/// Commands of a tick, given its number.
pub(super) type Script<'a> = Box<dyn Fn(u64) -> Vec<Command> + 'a>;

/// Largest number of times that a pair of short commands is repeated in a tick. So many commands still fit into one
/// block of a file.
const COMMANDS_MAX: usize = 300_000;

/// Maximum number of times that the size of a case is doubled, until a tick takes long enough to be judged.
const DOUBLED_MAX: u32 = 7;

#[derive(Clone, Copy, Debug)]
pub(super) struct Cost {
    units: u64,
    time: Duration,
}

impl Cost {
    fn per_unit(&self) -> u128 {
        self.time.as_nanos() / u128::from(self.units.max(1))
    }
}

pub(super) fn setup(commands: Vec<Command>, config: Config) -> SandboxSetup {
    SandboxSetup { config, commands }
}

pub(super) fn record(setup: &SandboxSetup, ticks: u64, script: &Script<'_>) -> Vec<u8> {
    let mut recording = Recording::<Sandbox>::start(setup, 60).expect("a setup that can start");
    for tick in 0..ticks {
        recording.step(&[script(tick)]).expect("commands that can be recorded");
    }
    recording.finish().expect("a replay")
}

/// Limits on the total work only.
fn limits(total_work: u64) -> Limits {
    Limits {
        tick_work: u64::MAX,
        total_work,
        file_bytes: u64::MAX,
        block_bytes: u32::MAX,
        ..Limits::default()
    }
}

/// Cost of the setup, and cost of the tick with the highest cost per unit. Each is the lowest of three runs.
fn costs(file: &[u8]) -> [Cost; 2] {
    let mut best: Option<[Cost; 2]> = None;
    for _ in 0..3 {
        let start = computed();
        let mut play =
            VerifiedReplay::<Sandbox>::open(file, &limits(u64::MAX)).expect("a replay that can start");
        let begun = Cost { units: play.work(), time: computed() - start };
        let mut worst = Cost { units: 1, time: Duration::ZERO };
        loop {
            let (before, start) = (play.work(), computed());
            if play.step().expect("a replay that can be played") == Step::Ended {
                break;
            }
            let cost = Cost { units: play.work() - before, time: computed() - start };
            if cost.time >= JUDGED && cost.per_unit() >= worst.per_unit() {
                worst = cost;
            }
        }
        best = Some(best.map_or([begun, worst], |[setup, tick]| {
            [
                if begun.time < setup.time { begun } else { setup },
                if worst.per_unit() < tick.per_unit() { worst } else { tick },
            ]
        }));
    }
    best.expect("three runs")
}

/// Setup, number of ticks and commands.
pub(super) type Case<'a> = (SandboxSetup, u64, Script<'a>);

/// Doubles the size of a case until a tick takes long enough to be judged. Returns a description of the case if it is
/// too expensive, or if no size has such a tick, because the case would then test nothing.
pub(super) fn too_expensive<'a>(name: &str, size: i64, case: impl Fn(i64) -> Case<'a>) -> Option<String> {
    for doubled in 0..=DOUBLED_MAX {
        let size = size << doubled;
        let (setup, ticks, script) = case(size);
        let file = record(&setup, ticks, &script);
        let parts = costs(&file);
        if parts[1].time >= JUDGED {
            let name = format!("{name}, size {size}");
            return judge(&name, parts).or_else(|| stopped_late(&name, &file));
        }
    }
    Some(format!("{name}: no tick takes {JUDGED:?}, so that nothing is judged"))
}

/// Repeats commands until they take most of the time of a tick. Returns a description of the case if it is too
/// expensive.
pub(super) fn too_expensive_commands(name: &str, setup: &SandboxSetup, once: &[Command]) -> Option<String> {
    let tick_of = |repeats: usize| {
        let script = |_| once.iter().cycle().take(repeats * once.len()).cloned().collect();
        let file = record(setup, 1, &(Box::new(script) as Script<'_>));
        (costs(&file), file)
    };
    // The commands have to take at least as long as the rest of the tick. The rest takes no longer than a tick that
    // executes the commands once.
    let least = 2 * tick_of(1).0[1].time + JUDGED;
    for repeats in [10, 100, 1000, 10_000, 100_000, COMMANDS_MAX] {
        let (parts, file) = tick_of(repeats);
        // If commands are too cheap to reach this time, the tick with the most commands is judged.
        if parts[1].time >= least || (repeats == COMMANDS_MAX && parts[1].time >= JUDGED) {
            let name = format!("{name}, {repeats} times");
            return judge(&name, parts).or_else(|| stopped_late(&name, &file));
        }
    }
    Some(format!("{name}: no tick takes {JUDGED:?}, so that nothing is judged"))
}

/// Prints the costs. Returns a description of the case if a cost is too high.
fn judge(name: &str, parts: [Cost; 2]) -> Option<String> {
    let mut wrong = None;
    for (part, cost) in ["setup", "tick"].into_iter().zip(parts) {
        println!("{name}, {part}: {} units, {:?}, {} ns per unit", cost.units, cost.time, cost.per_unit());
        if cost.time >= JUDGED && cost.per_unit() > MAX {
            wrong = Some(format!("{name}, {part}: {cost:?}, {} ns per unit", cost.per_unit()));
        }
    }
    wrong
}

/// Verifies a file with limits of a half, a fifth and a twentieth of its work. The setup alone may exceed such a limit.
/// Returns a description of the case if verification stops later than the units allow.
fn stopped_late(name: &str, file: &[u8]) -> Option<String> {
    let needed = {
        let limits = limits(u64::MAX);
        let mut play = VerifiedReplay::<Sandbox>::open(file, &limits).expect("a replay that can start");
        while play.step().expect("a replay that can be played") != Step::Ended {}
        play.work()
    };
    for part in [2, 5, 20] {
        let (limit, start) = (needed / part, computed());
        let verdict = verify::<Sandbox>(file, &limits(limit));
        let cost = Cost { units: limit, time: computed() - start };
        println!(
            "{name}, stopped at {limit} of {needed} units: {:?}, {} ns per unit",
            cost.time,
            cost.per_unit()
        );
        if verdict.name() != "limit_exceeded" {
            return Some(format!("{name}: {verdict} in place of a limit of {limit} units"));
        }
        if cost.time >= JUDGED && cost.per_unit() > MAX {
            return Some(format!("{name}, limit {limit}: {cost:?}, {} ns per unit", cost.per_unit()));
        }
    }
    None
}
