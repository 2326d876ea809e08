//! Work units bound the time of random worlds: no setup and no tick may take more than a microsecond per unit, or three
//! with debug assertions. `WORLDS` sets the number of worlds, 200 by default.

use std::time::{Duration, Instant};

use lockstep2d::lockstep::Sandbox;
use lockstep2d::math::Rng;
use lockstep2d::replay::{Limits, Recording, Step, VerifiedReplay};
use lockstep2d_fuzz::source::Source;
use lockstep2d_fuzz::{generator, verdicts};

/// Maximum time per unit of work, in nanoseconds: 3000 in a build with debug assertions, and 1000 in one without.
const MAX: u128 = if cfg!(debug_assertions) { 3000 } else { 1000 };

/// A setup or a tick that takes at least this time is compared with [`MAX`] by itself. Shorter ones count only in the
/// total of their file.
const JUDGED: Duration = Duration::from_micros(50);

/// Number of times that each file is played. For the setup and for each tick, only the shortest time counts, because
/// other load on the machine makes some runs slower.
const RUNS: usize = 5;

/// Maximum number of ticks of a world.
const TICKS: u64 = 60;

/// Cost of a setup, of a tick, or of several of them: the units of work, and the time taken.
#[derive(Clone, Copy, Debug)]
struct Cost {
    units: u64,
    time: Duration,
}

impl Cost {
    fn per_unit(&self) -> u128 {
        self.time.as_nanos() / u128::from(self.units.max(1))
    }
}

/// A replay of the scene that the bytes describe, with further commands.
fn record(bytes: &[u8]) -> Vec<u8> {
    let mut source = Source::new(bytes);
    let (setup, mut generator) = verdicts::scene(&mut source);
    let mut recording = Recording::<Sandbox>::start(&setup, 60).expect("a valid setup");
    let mut cost = 0;
    for tick in 0..TICKS {
        let world = recording.game().world();
        let commands = if tick % 3 == 0 { Vec::new() } else { generator.tick(&mut source, world) };
        recording.step(&[commands]).expect("inputs that can be recorded");
        cost += generator::cost(recording.game().world());
        if cost > 300_000 {
            break;
        }
    }
    recording.finish().expect("the sandbox has no claims")
}

/// The costs of the setup and of each tick in one run.
fn play(file: &[u8]) -> Vec<Cost> {
    let limits = Limits { tick_work: u64::MAX, total_work: u64::MAX, ..Limits::default() };
    let start = Instant::now();
    let mut play = VerifiedReplay::<Sandbox>::open(file, &limits).expect("a replay that can start");
    let mut costs = vec![Cost { units: play.work(), time: start.elapsed() }];
    loop {
        let (before, start) = (play.work(), Instant::now());
        if play.step().expect("a replay that can be played") == Step::Ended {
            return costs;
        }
        costs.push(Cost { units: play.work() - before, time: start.elapsed() });
    }
}

/// The costs of the setup and of each tick, each from its fastest run.
fn costs(file: &[u8]) -> Vec<Cost> {
    let mut best = play(file);
    for _ in 1..RUNS {
        for (best, cost) in best.iter_mut().zip(play(file)) {
            assert_eq!(best.units, cost.units, "units do not depend on the run");
            best.time = best.time.min(cost.time);
        }
    }
    best
}

#[test]
fn no_unit_of_a_random_world_takes_more_than_a_microsecond() {
    let worlds = std::env::var("WORLDS").map_or(200, |worlds| worlds.parse().expect("a number"));
    let (mut judged, mut worst, mut wrong) = (0, Cost { units: 1, time: Duration::ZERO }, Vec::new());
    let mut all = Cost { units: 0, time: Duration::ZERO };
    for seed in 0..worlds {
        let mut rng = Rng::new(seed);
        let bytes: Vec<u8> = (0..4000).map(|_| rng.next_u32() as u8).collect();
        let parts = costs(&record(&bytes));
        let whole = parts.iter().fold(Cost { units: 0, time: Duration::ZERO }, |sum, part| Cost {
            units: sum.units + part.units,
            time: sum.time + part.time,
        });
        all = Cost { units: all.units + whole.units, time: all.time + whole.time };
        let long = parts.iter().enumerate().filter(|(_, part)| part.time >= JUDGED);
        for (part, cost) in long.map(|(at, cost)| (Some(at), *cost)).chain([(None, whole)]) {
            judged += 1;
            if cost.per_unit() > worst.per_unit() {
                worst = cost;
                println!("world {seed}, part {part:?}: {cost:?}, {} ns per unit", cost.per_unit());
            }
            if cost.per_unit() > MAX {
                wrong.push((seed, part, cost, cost.per_unit()));
            }
        }
    }
    println!("{worlds} worlds, {judged} parts judged, {} ns per unit in the mean: {all:?}", all.per_unit());
    assert!(judged > 5 * worlds, "only {judged} parts are long enough to be judged");
    assert!(wrong.is_empty(), "{wrong:#?}");
}
