//! For every scene, a second run, and runs with restores from bytes, rollbacks, cleared caches or another broad phase,
//! have the hashes and events of the first run after every tick. The last hash is the one in `tests/goldens.txt`.

use std::sync::{LazyLock, OnceLock};

use lockstep2d::collision::BroadPhaseKind;
use lockstep2d::hash::StateHash;
use lockstep2d::lockstep::{Game, Sandbox};
use lockstep2d::world::{Events, World};
use lockstep2d_scenes::{ALL, Scene};
use lockstep2d_tests::{goldens, sweep};

struct Trace {
    hashes: Vec<StateHash>,
    events: Vec<Events>,
}

/// Hashes and events of a run. `perturb` is called before each tick. It does something that must not affect results.
fn trace(scene: &Scene, ticks: u64, mut perturb: impl FnMut(u64, &mut Sandbox)) -> Trace {
    let mut game =
        Sandbox::new(&scene.setup(lockstep2d_tests::SEED)).expect("the scenes of this crate are valid");
    let mut trace = Trace { hashes: vec![game.state_hash()], events: vec![] };
    for tick in 0..ticks {
        perturb(tick, &mut game);
        let commands = scene.commands(tick, &game);
        game.step(&[commands]);
        trace.hashes.push(game.state_hash());
        trace.events.push(game.world().events().clone());
    }
    assert_eq!(game.world().validate(), Ok(()), "{}", scene.name);
    assert_eq!(game.world().faults(), 0, "{}", scene.name);
    assert_eq!(game.refused(), 0, "{}", scene.name);
    trace
}

fn assert_same(scene: &Scene, what: &str, trace: &Trace, reference: &Trace) {
    assert!(reference.hashes.len() >= trace.hashes.len(), "{}: nothing to compare with", scene.name);
    let pairs = trace.hashes.iter().zip(&reference.hashes);
    let differing = pairs.enumerate().find(|(_, (a, b))| a != b).map(|(tick, _)| tick);
    assert_eq!(differing, None, "{}: {what} changes the hash after this tick", scene.name);
    let pairs = trace.events.iter().zip(&reference.events);
    let differing = pairs.enumerate().find(|(_, (a, b))| a != b).map(|(tick, _)| tick + 1);
    assert_eq!(differing, None, "{}: {what} changes the events of this tick", scene.name);
}

/// Largest number of ticks of a scene that are compared in the long run.
const TICKS_MAX: u64 = 300;

/// The trace of an undisturbed run up to the tick of the golden. It is computed once for all tests.
fn undisturbed(scene: &Scene) -> &'static Trace {
    static TRACES: LazyLock<Vec<OnceLock<Trace>>> =
        LazyLock::new(|| ALL.iter().map(|_| OnceLock::new()).collect());
    let place = ALL.iter().position(|other| other.name == scene.name).expect("a scene of this crate");
    TRACES[place].get_or_init(|| trace(scene, scene.golden_ticks, |_, _| {}))
}

/// Calls `hold` for every scene, with a number of ticks and the undisturbed trace. The number of ticks is that of the
/// scene's golden, but at most [`TICKS_MAX`] in the long run, and otherwise at most 150, or 30 for a large scene.
fn each_scene(hold: impl Fn(&Scene, u64, &Trace) + Sync) {
    sweep::for_each(ALL.iter().collect(), |scene| {
        let ticks_max = sweep::size(TICKS_MAX, if shape_count(scene) > 2000 { 30 } else { 150 });
        hold(scene, scene.golden_ticks.min(ticks_max), undisturbed(scene));
    });
}

fn shape_count(scene: &Scene) -> usize {
    let start =
        Sandbox::new(&scene.setup(lockstep2d_tests::SEED)).expect("the scenes of this crate are valid");
    start.world().shape_count()
}

#[test]
fn two_runs_agree() {
    each_scene(|scene, ticks, reference| {
        assert_same(scene, "a second run", &trace(scene, ticks, |_, _| {}), reference)
    });
}

/// Before each tick, the world is decoded from its bytes. In the short run, this happens before every fifth tick of a
/// large scene.
#[test]
fn restoring_from_bytes_continues_bit_identically() {
    each_scene(|scene, ticks, reference| {
        let stride = if shape_count(scene) > 2000 { sweep::size(1, 5) } else { 1 };
        let through_bytes = |tick: u64, game: &mut Sandbox| {
            if !tick.is_multiple_of(stride) {
                return;
            }
            let bytes = game.world().to_bytes();
            let world = World::from_bytes(&bytes).expect("its own bytes");
            assert_eq!(world.to_bytes(), bytes, "{}: one state has one encoding", scene.name);
            *game.world_mut() = world;
        };
        assert_same(scene, "a restore from bytes", &trace(scene, ticks, through_bytes), reference);
    });
}

#[test]
fn rolling_back_and_forth_changes_nothing() {
    each_scene(|scene, ticks, reference| {
        let back_and_forth = |tick: u64, game: &mut Sandbox| {
            if tick.is_multiple_of(7) {
                let save = game.save();
                for ahead in 0..3 {
                    let commands = scene.commands(tick + ahead, game);
                    game.step(&[commands]);
                }
                game.load(&save);
            }
        };
        assert_same(scene, "a rollback", &trace(scene, ticks, back_and_forth), reference);
    });
}

#[test]
fn scratch_may_be_cleared_before_any_tick() {
    each_scene(|scene, ticks, reference| {
        let clear = |tick: u64, game: &mut Sandbox| {
            if tick.is_multiple_of(3) {
                game.world_mut().clear_scratch();
            }
        };
        assert_same(scene, "cleared scratch", &trace(scene, ticks, clear), reference);
    });
}

#[test]
fn the_broad_phase_makes_no_difference() {
    each_scene(|scene, ticks, reference| {
        // Brute force compares each shape with every other one, which is slow for large scenes.
        let ticks = if shape_count(scene) > 2000 { 5 } else { ticks };
        let brute_force = |tick: u64, game: &mut Sandbox| {
            if tick == 0 {
                game.world_mut().set_broad_phase(BroadPhaseKind::BruteForce);
            }
        };
        assert_same(scene, "brute force", &trace(scene, ticks, brute_force), reference);
    });
}

/// Comparisons of two runs miss an error that affects both in the same way. A committed hash catches it.
#[test]
fn every_scene_ends_in_its_golden() {
    let goldens = goldens();
    let listed: Vec<(&str, u64)> =
        goldens.iter().map(|golden| (golden.scene.as_str(), golden.ticks)).collect();
    let complete = listed.iter().copied().eq(ALL.iter().map(|scene| (scene.name, scene.golden_ticks)));
    let mut wrong = Vec::new();
    for scene in ALL {
        let end = undisturbed(scene).hashes.last().expect("at least one").to_string();
        let golden = goldens.iter().find(|golden| golden.scene == scene.name);
        if !complete || golden.is_none_or(|golden| golden.hash != end) {
            wrong.push(format!("{} {} {} {end}", lockstep2d::SEMANTICS, scene.name, scene.golden_ticks));
        }
    }
    assert!(
        wrong.is_empty(),
        "the arithmetic has changed. If this is intended: raise lockstep2d::SEMANTICS, add these lines to \
         tests/goldens.txt, record replays/ again (`replays/record`), and say \"hashes change: yes\" \
         in CHANGELOG.md.\n{}",
        wrong.join("\n")
    );
}
