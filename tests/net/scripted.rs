//! Drives `Driver` without a clock or network, through random legal sequences of GGRS requests drawn from a seed.
//!
//! Each peer of a match has its own script. All scripts share the true inputs and the frames at which players leave.

use ggrs::{GameStateCell, GgrsRequest, InputStatus};
use lockstep2d::hash::StateHash;
use lockstep2d::math::Rng;
use lockstep2d::net::{Divergence, Driver, GgrsConfig, Wire};
use lockstep2d::replay::{Limits, Verdict, verify};
use lockstep2d::report::{Blame, DesyncReport, Evidence, compare};

use super::pushers::{Pushers, Setup, bot};
use super::sweep;

type Request = GgrsRequest<GgrsConfig<Pushers, u32>>;

/// Ground truth: the real inputs, and the frames at which players leave.
struct Truth {
    setup: Setup,
    frames: u32,
    /// For each player, the first frame without it; `u32::MAX` if it stays.
    leaves: Vec<u32>,
}

impl Truth {
    fn new(rng: &mut Rng) -> Self {
        let frames = 40 + rng.below(60);
        let players = 2 + rng.below(3);
        let setup = Setup { players, tick_rate: 60, seed: rng.next_u64() };
        let leave = |_| if rng.chance(1, 8) { rng.below(frames) } else { u32::MAX };
        Truth { setup, frames, leaves: (0..players).map(leave).collect() }
    }

    fn input(&self, player: u32, frame: u32) -> (u8, InputStatus) {
        if frame >= self.leaves[player as usize] {
            (0, InputStatus::Disconnected)
        } else {
            (bot(player, frame.into()), InputStatus::Confirmed)
        }
    }
}

/// One peer: the inputs that it has received and those that it has predicted.
struct Script<'a> {
    truth: &'a Truth,
    rng: Rng,
    /// Largest number of predicted frames; 0 in lockstep.
    window: u32,
    /// Next frame to play.
    frame: u32,
    /// For each player, the number of frames whose inputs have arrived.
    known: Vec<u32>,
    /// Inputs that each frame was last played with.
    played: Vec<Vec<(u8, InputStatus)>>,
}

impl<'a> Script<'a> {
    fn new(truth: &'a Truth, window: u32, seed: u64) -> Self {
        let known = vec![0; truth.setup.players as usize];
        Script { truth, rng: Rng::new(seed), window, frame: 0, known, played: vec![] }
    }

    /// Returns the number of frames whose inputs have arrived from all players.
    fn confirmed(&self) -> u32 {
        self.known.iter().copied().min().unwrap_or(0).min(self.frame)
    }

    fn guess(&self, player: u32, frame: u32) -> (u8, InputStatus) {
        let known = self.known[player as usize];
        match known.checked_sub(1) {
            _ if frame < known => self.truth.input(player, frame),
            Some(last) => match self.truth.input(player, last) {
                (_, InputStatus::Disconnected) => (0, InputStatus::Disconnected),
                (input, _) => (input, InputStatus::Predicted),
            },
            None => (0, InputStatus::Predicted),
        }
    }

    fn play(&mut self, driver: &Driver<Pushers>, frame: u32) -> Request {
        let players = 0..self.truth.setup.players;
        let inputs: Vec<_> = players.map(|player| self.guess(player, frame)).collect();
        self.played.truncate(frame as usize);
        self.played.push(inputs.clone());
        // A peer sends its own hash; all peers have the same hash here.
        let wire = |(input, status)| (Wire { checksum: driver.local_input(input).checksum, input }, status);
        GgrsRequest::AdvanceFrame { inputs: inputs.into_iter().map(wire).collect() }
    }

    fn save(frame: u32) -> Request {
        GgrsRequest::SaveGameState { cell: GameStateCell::default(), frame: i32::try_from(frame).unwrap() }
    }

    /// Receives random inputs, resimulates frames that were played with wrong predictions, and plays the next frame if
    /// the mode allows it. Requests are issued one at a time because the hashes in them depend on earlier ones.
    fn turn(&mut self, driver: &mut Driver<Pushers>) {
        for player in 0..self.known.len() {
            let more = self.rng.below(4);
            let behind = if self.window == 0 { 1 } else { 6 };
            self.known[player] = (self.known[player] + more).min(self.frame + behind).min(self.truth.frames);
        }
        let is_wrong = |frame: &u32| {
            let players = 0..self.truth.setup.players;
            players.zip(&self.played[*frame as usize]).any(|(player, (input, status))| {
                let (now, status_now) = self.guess(player, *frame);
                let gone = |status| status == InputStatus::Disconnected;
                now != *input || gone(status_now) != gone(*status)
            })
        };
        if let Some(first) = (0..self.frame).find(is_wrong) {
            let end = self.frame;
            let load: Request = GgrsRequest::LoadGameState {
                cell: GameStateCell::default(),
                frame: i32::try_from(first).unwrap(),
            };
            driver.fulfil(vec![load]).unwrap();
            for frame in first..end {
                if self.rng.chance(1, 2) {
                    driver.fulfil(vec![Self::save(frame)]).unwrap();
                }
                let play = self.play(driver, frame);
                driver.fulfil(vec![play]).unwrap();
            }
        }
        driver.commit(self.confirmed().into()).unwrap();
        let may = if self.window == 0 {
            self.known.iter().all(|known| *known > self.frame)
        } else {
            self.frame < self.confirmed() + self.window
        };
        if may && self.frame < self.truth.frames {
            let play = self.play(driver, self.frame);
            driver.fulfil(vec![Self::save(self.frame), play]).unwrap();
            self.frame += 1;
        }
    }
}

/// Returns the report that a peer would write if another peer reported a different hash.
fn report(driver: &Driver<Pushers>, confirmed: u32) -> DesyncReport {
    let tick = u64::from(confirmed);
    let said = Divergence { tick, seat: 1, ours: StateHash::of(&0), theirs: StateHash::of(&1) };
    driver.report(&said, vec![0], tick)
}

fn check(seed: u64) {
    let mut rng = Rng::new(seed);
    let truth = Truth::new(&mut rng);
    let mut replays = Vec::new();
    for peer in 0..3 {
        let window = [0, 8, 1 + rng.below(12)][peer];
        let mut driver = Driver::<Pushers>::start(&truth.setup, 1 + rng.below(30)).unwrap();
        if window == 0 {
            driver = driver.with_echo(1 + u64::from(rng.below(10)));
        }
        let mut script = Script::new(&truth, window, rng.next_u64());
        let mut halfway = None;
        while script.confirmed() < truth.frames {
            script.turn(&mut driver);
            // Comparing reports is slow, so only every tenth seed does it.
            if seed.is_multiple_of(10) && script.frame >= truth.frames / 2 {
                halfway.get_or_insert_with(|| report(&driver, script.confirmed()));
            }
        }
        driver.commit(truth.frames.into()).unwrap();
        assert_eq!(
            driver.take_divergences(),
            [],
            "seed {seed}: a divergence was reported although all peers agree"
        );
        assert_eq!(driver.committed(), u64::from(truth.frames));
        let replay = [driver.take_replay(), driver.finish().unwrap()].concat();
        let verdict = verify::<Pushers>(&replay, &Limits::default());
        let Verdict::Match { .. } = verdict else { panic!("seed {seed}, peer {peer}: {verdict}") };
        if let Some(halfway) = halfway {
            let [halfway, whole] = [Evidence::Report(Box::new(halfway)), Evidence::Replay(replay.clone())];
            let told = compare::<Pushers>(&halfway, &whole, &Limits::default()).unwrap();
            assert_eq!(
                told.blame,
                Blame::Nobody,
                "seed {seed}, peer {peer}: expected no blame, as only predicted frames differ: {told:?}"
            );
        }
        replays.push(format!("{verdict}"));
    }
    assert!(replays.iter().all(|verdict| *verdict == replays[0]), "seed {seed}: {replays:?}");
}

#[test]
fn a_thousand_scripts_end_alike() {
    sweep::for_each(sweep::sample(0..1000, 7), check);
}
