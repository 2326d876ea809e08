//! Compares the reports of two peers. One of them may have diverged, or may have forged its report.

use lockstep2d::codec;
use lockstep2d::hash::StateHash;
use lockstep2d::lockstep::{Game, History, Sandbox, SandboxSetup};
use lockstep2d::replay::Recorder;
use lockstep2d::report::{Blame, Desync, DesyncReport, Evidence, Side, compare};
use lockstep2d::world::{BodyField, Command};
use serde::{Deserialize, Serialize};

use crate::forge::{Forged, mutate};
use crate::generator;
use crate::source::Source;
use crate::verdicts;

/// Size of the header: magic, format, semantics, length.
const HEADER_LEN: usize = 24;
const HASH_LEN: usize = 16;

/// The bytes of a report between its header and its hash, as described in `docs/FORMAT.md`.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Body {
    rules: (String, u32),
    players: u32,
    seats: Vec<u32>,
    tick: u64,
    hashes: Vec<Option<StateHash>>,
    history: Vec<(u64, StateHash)>,
    saves: Vec<(u64, Vec<u8>)>,
    phases: Vec<(u64, Phases)>,
    replay: Vec<u8>,
}

/// The phase digests of a tick, and the state of the world at the start of the tick's last step.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Phases {
    digests: Vec<StateHash>,
    /// Patches (offset and new bytes) that turn the world's bytes after the previous tick into those at the start of
    /// the step.
    start: Vec<(u64, Vec<u8>)>,
    /// Number of bytes of the world at the start of the step.
    length: u64,
}

/// The bit that flips on one side.
#[derive(Clone, Copy)]
struct Flip {
    tick: u64,
    body: usize,
    field: BodyField,
    bit: u32,
}

struct Trajectory {
    setup: SandboxSetup,
    inputs: Vec<Vec<Command>>,
    interval: u32,
}

/// Compares the reports of two peers. The first peer may have diverged or forged its report, and the second
/// is correct. Returns a name for the result.
///
/// # Panics
/// If an unchanged report within the limits is refused, or a report with a wrong hash is accepted. Also if the
/// comparison blames the correct side, or if the blame depends on the order of the sides.
pub fn run(bytes: &[u8]) -> &'static str {
    let mut source = Source::new(bytes);
    let way = source.below(8);
    let limits = verdicts::limits();
    let trajectory = Trajectory::record(&mut source);
    let flip = Flip {
        tick: source.below(trajectory.inputs.len()) as u64,
        body: source.below(3),
        field: source.pick(&BodyField::ALL),
        bit: source.below(32) as u32,
    };
    let right = Evidence::Report(Box::new(trajectory.report(&mut source, None)));
    let report = trajectory.report(&mut source, (way != 0).then_some(flip));
    let original = report.to_bytes();
    let mut file = original.clone();
    match way {
        0 | 1 => {}
        2 => mutate(&mut source, &mut file),
        3 => {
            let mut body = file[HEADER_LEN..file.len() - HASH_LEN].to_vec();
            mutate(&mut source, &mut body);
            file = seal(&file, &body);
        }
        4 => file = report.replay().to_vec(),
        _ => {
            let body = &file[HEADER_LEN..file.len() - HASH_LEN];
            let mut body: Body = codec::decode(body).expect("the layout of a report");
            for _ in 0..=source.below(3) {
                forge(&mut source, &mut body, report.replay());
            }
            file = seal(&file, &codec::encode(&body));
        }
    }
    let changed = file != original;
    let left = match Evidence::read(file, &limits) {
        Ok(left) => left,
        Err(error) => {
            assert!(
                changed || original.len() as u64 > limits.file_bytes,
                "a peer's own report must be valid: {error}"
            );
            return "refused";
        }
    };
    assert!(way != 2 || !changed, "a changed report must be refused");
    let found = match compare::<Sandbox>(&left, &right, &limits) {
        Ok(found) => found,
        Err(_) => return "not compared",
    };
    // Side B is correct, so the comparison must not blame it.
    assert!(!matches!(found.blame, Blame::Side(Side::B) | Blame::Both), "{found:?}");
    let mirrored = compare::<Sandbox>(&right, &left, &limits).map(|found| found.blame);
    let same = match (found.blame, &mirrored) {
        (Blame::Side(side), Ok(Blame::Side(mirrored))) => side != *mirrored,
        (blame, Ok(mirrored)) => blame == *mirrored,
        (_, Err(_)) => false,
    };
    assert!(same, "the blame is {:?}, but {mirrored:?} with the sides exchanged", found.blame);
    match found.blame {
        Blame::Nobody => "nobody",
        Blame::Side(_) if found.explanation.is_some() => "explained",
        Blame::Side(_) => "blamed",
        Blame::Both | Blame::Unknown => "unknown",
    }
}

impl Trajectory {
    fn record(source: &mut Source<'_>) -> Self {
        let (setup, mut generator) = verdicts::scene(source);
        let interval = 1 + source.below(9) as u32;
        let mut game = Sandbox::new(&setup).expect("a valid setup");
        let mut inputs = vec![];
        for _ in 0..1 + source.below(12) {
            let commands = match inputs.last() {
                Some(last) if !source.one_in(2) => Vec::clone(last),
                _ => generator.tick(source, game.world()),
            };
            game.step(std::slice::from_ref(&commands));
            inputs.push(commands);
            if generator::cost(game.world()) > 5_000 {
                break;
            }
        }
        Trajectory { setup, inputs, interval }
    }

    fn report(&self, source: &mut Source<'_>, flip: Option<Flip>) -> DesyncReport {
        let (mut recorder, mut game) =
            Recorder::<Sandbox>::start(&self.setup, self.interval).expect("a valid setup");
        let mut history = History::<Sandbox>::of_ticks(16);
        history.push(0, game.save(), game.state_hash());
        for (tick, commands) in (0..).zip(&self.inputs) {
            if let Some(flip) = flip.filter(|flip| flip.tick == tick)
                && let world = game.world_mut()
                && let Some(body) = { world.bodies().map(|(id, _)| id).nth(flip.body) }
            {
                let _ = world.flip_bit(body, flip.field, flip.bit);
            }
            let inputs =
                recorder.record(std::slice::from_ref(commands)).expect("inputs that can be recorded");
            game.step(inputs);
            let hash = game.state_hash();
            recorder.checkpoint(hash);
            history.push(tick + 1, game.save(), hash);
        }
        let tick = self.inputs.len() as u64;
        let desync = Desync { players: 1, tick, known: tick, seats: vec![0], hashes: vec![] };
        let replay = recorder.so_far(game.state_hash());
        let saves_max = if source.one_in(4) { source.below(20_000) } else { 40_000 };
        DesyncReport::within(saves_max, &desync, &history, replay)
    }
}

/// Replaces the body of a report, and corrects its length and its hash.
fn seal(file: &[u8], body: &[u8]) -> Vec<u8> {
    let mut sealed = file[..HEADER_LEN - 8].to_vec();
    sealed.extend((body.len() as u64).to_le_bytes());
    sealed.extend(body);
    let hash = StateHash::of_bytes(&sealed);
    sealed.extend(hash.0.to_le_bytes());
    sealed
}

/// Makes one random change to the body of a report. `replay` is the correct replay of the report.
fn forge(source: &mut Source<'_>, body: &mut Body, replay: &[u8]) {
    let at = source.below(body.history.len());
    match source.below(13) {
        0 => body.players = source.pick(&[0, 2, 64, 65, u32::MAX]),
        1 => body.seats = (0..source.below(3)).map(|_| source.below(4) as u32).collect(),
        2 => body.tick = source.edge().to_bits() as u64,
        3 => body.hashes = vec![Some(StateHash::of(&source.byte())); source.below(4)],
        4 if !body.history.is_empty() => body.history[at].1 = StateHash::of(&source.byte()),
        5 if !body.history.is_empty() => drop(body.history.remove(at)),
        6 => {
            let tick = source.pick(&[1, 5, 20, u64::MAX - 1, u64::MAX]);
            body.history.push((tick, StateHash::of(&source.byte())));
            if source.one_in(2) {
                body.saves.push((tick, vec![0; source.below(100)]));
            }
        }
        7 => body.replay.clear(),
        8 => {
            let mut forged = Forged::take_apart(replay);
            for _ in 0..=source.below(2) {
                forged.change(source);
            }
            body.replay = forged.put_together();
        }
        9 => mutate(source, &mut body.replay),
        12 if !body.history.is_empty() => {
            let digests = vec![StateHash(1); source.pick(&[0, 1, 8, 16, 1025])];
            let at_byte = source.pick(&[0, 24, 100, 1000, u64::MAX]);
            let length = source.pick(&[0, 500, 2000, u64::MAX]);
            let start = vec![(at_byte, vec![source.byte(); source.below(9)])];
            body.phases.push((body.history[at].0, Phases { digests, start, length }));
        }
        _ if !body.saves.is_empty() => {
            let at = source.below(body.saves.len());
            mutate(source, &mut body.saves[at].1);
        }
        _ => body.rules.1 += 1,
    }
}
