//! Games with their own rules: recording, verification, seeking.

use std::collections::BTreeMap;

use lockstep2d::hash::StateHash;
use lockstep2d::math::Rng;

use super::{done, take};
use crate::*;

const TICKS: u64 = 500;
const PLAYERS: usize = 3;

/// A game whose state is a weighted sum of the inputs of each player, and the number of absences, summed over players
/// and ticks.
#[derive(Clone, Default, PartialEq, Eq, Debug)]
struct Sums {
    sums: [u64; PLAYERS],
    absences: u64,
}

impl Sums {
    fn step(&mut self, inputs: &[u8], absent: u64) {
        for (sum, input) in self.sums.iter_mut().zip(inputs.chunks_exact(2)) {
            *sum = sum.wrapping_mul(3).wrapping_add(u64::from(input[0]) + u64::from(input[1]));
        }
        self.absences += u64::from(absent.count_ones());
    }

    fn hash(&self) -> RawHash {
        RawHash::of(StateHash::of(&(self.sums, self.absences)))
    }
}

/// Inputs of a tick, and a bit for each absent player. The inputs and the bits change every eight ticks.
fn inputs_at(tick: u64) -> ([u8; 2 * PLAYERS], u64) {
    let mut rng = Rng::new(tick / 8);
    let absent = u64::from(rng.next_u32() % 8) & u64::from(rng.next_u32());
    let mut inputs = [0; 2 * PLAYERS];
    for (seat, input) in inputs.chunks_exact_mut(2).enumerate() {
        if absent >> seat & 1 == 0 {
            input.copy_from_slice(&rng.next_u32().to_le_bytes()[..2]);
        }
    }
    (inputs, absent)
}

/// The ticks of a recorder so far as a replay; `taken` are the bytes taken from the recorder.
fn so_far(recorder: u32, taken: &[u8], hash: RawHash) -> Vec<u8> {
    let mut bytes = 0;
    done(ls2d_recorder_so_far(recorder, In::of(&hash), Out::of(&mut bytes)));
    [taken, &take(bytes)].concat()
}

/// Records a game with two claims. Returns the file, and the state before the first tick and after each tick.
fn record(interval: u32) -> (Vec<u8>, Vec<Sums>) {
    let mut game = Sums::default();
    let (mut recorder, mut bytes) = (0, 0);
    let (rules, start) = (b"sums", game.hash());
    done(ls2d_recorder_new(
        In::all(rules),
        rules.len(),
        1,
        3,
        60,
        2,
        In::null(),
        0,
        In::of(&start),
        interval,
        Out::of(&mut recorder),
    ));
    let (mut states, mut taken) = (vec![game.clone()], Vec::new());
    for tick in 0..TICKS {
        if tick == TICKS / 2 {
            let part = so_far(recorder, &taken, game.hash());
            done(ls2d_recorder_take(recorder, Out::of(&mut bytes)));
            taken = take(bytes);
            assert_eq!(so_far(recorder, &taken, game.hash()), part);
            assert_eq!(played(&part, &[]), (MATCH, tick));
        }
        let (inputs, absent) = inputs_at(tick);
        let mut due = 0;
        done(ls2d_recorder_record(recorder, In::all(&inputs), inputs.len(), absent, Out::of(&mut due)));
        game.step(&inputs, absent);
        if due == 1 {
            done(ls2d_recorder_checkpoint(recorder, In::of(&game.hash())));
        }
        states.push(game.clone());
    }
    for (name, number) in CLAIMS {
        done(ls2d_recorder_claim(recorder, In::all(name.as_bytes()), name.len(), number));
    }
    let again = ls2d_recorder_claim(recorder, In::all(b"score"), 5, 9);
    assert_eq!(again, Status::Value as i32, "a second claim of the same name");
    let whole = so_far(recorder, &taken, game.hash());
    done(ls2d_recorder_finish(recorder, In::of(&game.hash()), Out::of(&mut bytes)));
    assert_eq!([taken, take(bytes)].concat(), whole);
    let finished = ls2d_recorder_so_far(recorder, In::of(&game.hash()), Out::of(&mut bytes));
    assert_eq!(finished, Status::Record as i32);
    done(ls2d_free(recorder));
    (whole, states)
}

const CLAIMS: [(&str, i64); 2] = [("score", -17), ("absences", 40)];

fn open(file: &[u8]) -> u32 {
    let mut replay = 0;
    done(ls2d_replay_open(In::all(file), file.len(), In::null(), Out::of(&mut replay), Out::null()));
    replay
}

fn verdict(replay: u32, hash: RawHash) -> RawVerdict {
    let mut verdict = RawVerdict { kind: 99, reserved: 0, ticks: 0, hash };
    done(ls2d_replay_verdict(replay, In::of(&hash), Out::of(&mut verdict)));
    verdict
}

fn play(file: &[u8], claims: &[(&str, i64)]) -> u32 {
    let (kind, ticks) = played(file, claims);
    assert_eq!(ticks, TICKS);
    kind
}

fn played(file: &[u8], claims: &[(&str, i64)]) -> (u32, u64) {
    let replay = open(file);
    let mut game = Sums::default();
    done(ls2d_replay_check(replay, In::of(&game.hash())));
    let (mut inputs, mut size, mut absent) = ([0; 2 * PLAYERS], 0, 0);
    loop {
        let (buffer, capacity) = (Out::all(&mut inputs), 2 * PLAYERS);
        let status = ls2d_replay_next(replay, buffer, capacity, Out::of(&mut size), Out::of(&mut absent));
        if status == Status::None as i32 {
            break;
        }
        done(status);
        game.step(&inputs[..size], absent);
        done(ls2d_replay_check(replay, In::of(&game.hash())));
    }
    for (name, number) in claims {
        done(ls2d_replay_claim(replay, In::all(name.as_bytes()), name.len(), *number));
    }
    let RawVerdict { kind, ticks, .. } = verdict(replay, game.hash());
    done(ls2d_free(replay));
    (kind, ticks)
}

#[test]
fn claims_and_absent_players_are_recorded_and_verified() {
    let (file, _) = record(60);
    assert_eq!(play(&file, &CLAIMS), MATCH);
    assert_eq!(play(&file, &[("absences", 40), ("score", -16)]), CLAIM_MISMATCH);
    assert_eq!(play(&file, &CLAIMS[..1]), CLAIM_MISMATCH);
    let replay = open(&file);
    for (index, (name, number)) in [CLAIMS[1], CLAIMS[0]].into_iter().enumerate() {
        let (mut bytes, mut stated) = (0, 0);
        let index = u32::try_from(index).unwrap();
        done(ls2d_replay_claim_at(replay, index, Out::of(&mut bytes), Out::of(&mut stated)));
        assert_eq!((take(bytes), stated), (name.as_bytes().to_vec(), number));
    }
    let mut bytes = 0;
    assert_eq!(ls2d_replay_claim_at(replay, 2, Out::of(&mut bytes), Out::null()), Status::None as i32);
    done(ls2d_free(replay));
}

struct Player {
    replay: u32,
    game: Sums,
    saves: BTreeMap<u32, Sums>,
    played: u64,
}

impl Player {
    fn new(file: &[u8]) -> Self {
        Player { replay: open(file), game: Sums::default(), saves: BTreeMap::new(), played: 0 }
    }

    /// Seeks to a tick: fulfils all requests, and returns the last status.
    fn seek(&mut self, tick: u64) -> i32 {
        done(ls2d_replay_seek(self.replay, tick));
        let mut request = RawRequest { kind: 99, tick: 0, absent: 0, guessed: 0 };
        let (mut inputs, mut size) = ([0; 2 * PLAYERS], 0);
        loop {
            let out = (Out::of(&mut request), Out::all(&mut inputs), Out::of(&mut size));
            let status = ls2d_replay_next_request(self.replay, out.0, out.1, 2 * PLAYERS, out.2);
            if status != Status::Ok as i32 {
                return status;
            }
            match request.kind {
                REQUEST_SAVE => _ = self.saves.insert(request.tick, self.game.clone()),
                REQUEST_LOAD => self.game = self.saves[&request.tick].clone(),
                REQUEST_ADVANCE => {
                    self.game.step(&inputs[..size], request.absent);
                    self.played += 1;
                }
                REQUEST_CHECKSUM => {
                    let status = ls2d_replay_check(self.replay, In::of(&self.game.hash()));
                    if status != Status::Ok as i32 {
                        return status;
                    }
                }
                other => panic!("request {other}"),
            }
        }
    }
}

#[test]
fn any_tick_is_reached_from_the_nearest_saved_state() {
    for (block, interval) in [(60, None), (7, Some(50)), (100, Some(1)), (60, Some(1000))] {
        let (file, states) = record(block);
        let mut player = Player::new(&file);
        if let Some(interval) = interval {
            done(ls2d_replay_set_interval(player.replay, interval));
        }
        let interval = u64::from(interval.unwrap_or(60));
        let mut rng = Rng::new(u64::from(block));
        let mut reached = 0;
        for _ in 0..200 {
            let tick = u64::from(rng.next_u32()) % (TICKS + 1);
            let (before, from) = (player.played, reached);
            assert_eq!(player.seek(tick), Status::None as i32);
            assert_eq!(player.game, states[usize::try_from(tick).unwrap()], "tick {tick}");
            reached = reached.max(tick);
            // The seek plays the ticks that were never played before, and fewer than `interval` others.
            let new = reached - from;
            assert!(
                player.played - before < new + interval,
                "{} ticks for {new} new ones",
                player.played - before
            );
        }
        assert_eq!(player.saves.len() as u64, reached / interval + 1);
        for tick in [TICKS, TICKS - 1, TICKS - 2, TICKS] {
            assert_eq!(player.seek(tick), Status::None as i32);
            assert_eq!(player.game, states[usize::try_from(tick).unwrap()]);
        }
        for (name, number) in CLAIMS {
            done(ls2d_replay_claim(player.replay, In::all(name.as_bytes()), name.len(), number));
        }
        assert_eq!(verdict(player.replay, player.game.hash()).kind, MATCH);
        assert_eq!(ls2d_replay_seek(player.replay, TICKS + 1), Status::Value as i32);
        done(ls2d_free(player.replay));
    }
}

#[test]
fn a_game_that_diverges_reaches_earlier_ticks_alone() {
    let (file, states) = record(60);
    let mut player = Player::new(&file);
    assert_eq!(player.seek(200), Status::None as i32);
    player.game.sums[1] += 1;
    assert_eq!(player.seek(300), Status::Record as i32);
    assert_eq!(player.seek(TICKS), Status::Record as i32);
    assert_eq!(player.seek(150), Status::None as i32);
    assert_eq!(player.game, states[150]);
    assert_eq!(verdict(player.replay, player.game.hash()).kind, DIVERGED);
    assert_eq!(verdict(player.replay, player.game.hash()).ticks, 240);
    done(ls2d_free(player.replay));
}

#[test]
fn a_game_whose_saves_lose_state_is_told() {
    let (file, _) = record(60);
    let mut player = Player::new(&file);
    assert_eq!(player.seek(200), Status::None as i32);
    player.saves.values_mut().for_each(|state| state.sums[2] ^= 1);
    for _ in 0..2 {
        assert_eq!(player.seek(130), Status::Record as i32);
        assert!(crate::status::last_text().contains("loses state"), "{}", crate::status::last_text());
    }
    done(ls2d_free(player.replay));
}
