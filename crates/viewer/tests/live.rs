//! Live worlds. The replay of a session verifies, whatever the user does in it.

#![expect(clippy::unwrap_used, reason = "a failed unwrap fails the test")]

use lockstep2d::body::{BodyDef, BodyId, BodyKind, Geometry, ShapeDef};
use lockstep2d::fx;
use lockstep2d::lockstep::{Game, Sandbox, SandboxSetup};
use lockstep2d::math::{Fx, Rng, Vec2};
use lockstep2d::replay::{Limits, Verdict, verify};
use lockstep2d::world::{Command, Config, World};
use lockstep2d_scenes::Scene;
use lockstep2d_viewer::Source;
use lockstep2d_viewer::live::{Act, Aim, Form, Live, Playground};

const SCENES: [&str; 10] = [
    "free_fall",
    "box_stack",
    "pyramid",
    "hundred_polygons",
    "spawning",
    "chain",
    "character",
    "ragdoll",
    "bridge",
    "game",
];

fn open(scene: &str, seed: u64) -> Live {
    Live::scene(Scene::find(scene).unwrap(), seed).unwrap()
}

/// Checks that the saved replay verifies and covers every recorded tick.
fn check_replay(live: &mut Live, what: &str) {
    let file = live.save_replay().unwrap().unwrap();
    let (here, ticks) = (live.tick(), live.recorded());
    assert_eq!(live.waiting(), 0, "queued acts would be carried out when seeking to the end");
    live.seek(ticks).unwrap();
    let expected = Verdict::Match { ticks, hash: live.hash() };
    assert_eq!(verify::<Sandbox>(&file, &Limits::default()), expected, "{what}");
    live.seek(here).unwrap();
}

/// A random point, mostly near a body.
fn somewhere(rng: &mut Rng, world: &World) -> Vec2<Fx> {
    let count = u32::try_from(world.body_count()).unwrap();
    let offset = |rng: &mut Rng, by: Fx| Vec2::new(rng.range(-by, by), rng.range(-by, by));
    if count == 0 || rng.chance(1, 8) {
        return offset(rng, fx!(30));
    }
    let (_, body) = world.bodies().nth(rng.below(count) as usize).unwrap();
    body.position() + offset(rng, fx!(0.5))
}

fn random_act(rng: &mut Rng, world: &World) -> Act {
    let at = somewhere(rng, world);
    let aim = Aim { at, within: rng.range(fx!(0), fx!(0.5)) };
    match rng.below(12) {
        0..=2 => Act::Grab(aim),
        3..=5 => Act::DragTo(at),
        6 | 7 => Act::Release,
        8 => {
            let way = Vec2::new(rng.range(fx!(-2), fx!(2)), rng.range(fx!(-2), fx!(2)));
            Act::Spawn { form: Form::ALL[rng.below(4) as usize], at, to: at + way }
        }
        9 => Act::Delete(aim),
        10 => Act::Gravity(Vec2::new(rng.range(fx!(-10), fx!(10)), rng.range(fx!(-20), fx!(10)))),
        _ => Act::explode(at),
    }
}

/// Plays, acts, seeks and saves at random. Returns how many of its forward seeks dropped recorded ticks, and after how
/// many of them a body was held.
fn play_about(live: &mut Live, seed: u64, ticks: u64) -> (usize, usize) {
    let rng = &mut Rng::new(seed);
    let (mut played, mut cuts, mut held) = (0, 0, 0);
    while played < ticks {
        match rng.below(20) {
            0..=7 => {
                let act = random_act(rng, live.world());
                live.act(act);
            }
            8 => live.seek(rng.below_u64(live.recorded() + 1)).unwrap(),
            9 => live.seek(live.tick().saturating_sub(u64::from(rng.below(10)))).unwrap(),
            10 if live.waiting() == 0 => check_replay(live, "in between"),
            _ => {
                let before = live.recorded();
                let by = u64::from(1 + rng.below(12));
                live.seek(live.tick() + by).unwrap();
                cuts += usize::from(live.recorded() < before);
                held += usize::from(live.held().is_some());
                played += by;
            }
        }
    }
    (cuts, held)
}

#[test]
fn a_hundred_random_sessions_verify() {
    let (mut cuts, mut held) = (0, 0);
    for seed in 0..100 {
        let scene = SCENES[usize::try_from(seed).unwrap() % SCENES.len()];
        let mut live = open(scene, seed);
        let found = play_about(&mut live, seed, 250);
        (cuts, held) = (cuts + found.0, held + found.1);
        play(&mut live, 1);
        check_replay(&mut live, &format!("{scene}, seed {seed}"));
    }
    assert!(cuts > 100 && held > 100, "recording cut {cuts} times, body held {held} times");
}

/// After a seek back, a tick has the same hash as before.
#[test]
fn going_back_shows_what_was_there() {
    for seed in 0..6 {
        let scene = SCENES[usize::try_from(seed).unwrap()];
        let mut live = open(scene, seed);
        let mut seen = vec![live.hash()];
        let rng = &mut Rng::new(seed);
        for _ in 0..200 {
            if rng.chance(1, 4) {
                let act = random_act(rng, live.world());
                live.act(act);
            }
            live.seek(live.tick() + 1).unwrap();
            seen.push(live.hash());
        }
        for _ in 0..60 {
            let tick = rng.below_u64(201);
            live.seek(tick).unwrap();
            assert_eq!((live.tick(), live.hash()), (tick, seen[usize::try_from(tick).unwrap()]), "{scene}");
        }
        assert_eq!(live.recorded(), 200, "seeking without acts should not cut the recording");
        check_replay(&mut live, scene);
    }
}

/// A circle of radius 0.5 m at (0, 2), without gravity.
fn one_disc() -> (Live, BodyId) {
    let disc = ShapeDef::new(Geometry::circle(fx!(0.5)).unwrap());
    let spawn = Command::Spawn { body: BodyDef::dynamic().position((fx!(0), fx!(2))), shapes: vec![disc] };
    let config = Config { gravity: Vec2::ZERO, ..Config::default() };
    let mut live = Live::new("one disc", &SandboxSetup { config, commands: vec![spawn] }).unwrap();
    let id = live.world().bodies().next().unwrap().0;
    (live, id)
}

fn play(live: &mut Live, ticks: u64) {
    for _ in 0..ticks {
        live.seek(live.tick() + 1).unwrap();
    }
}

fn place(live: &mut Live, id: BodyId) -> Vec2<Fx> {
    live.world().body(id).unwrap().position()
}

fn anchors(live: &mut Live) -> usize {
    live.world().bodies().filter(|(_, body)| body.kind() == BodyKind::Kinematic).count()
}

const MIDDLE: Vec2<Fx> = Vec2::new(fx!(0), fx!(2));
const ELSEWHERE: Vec2<Fx> = Vec2::new(fx!(3), fx!(4));

#[test]
fn a_dragged_body_comes_along_and_is_thrown() {
    let (mut live, disc) = one_disc();
    live.act(Act::Grab(Aim::at(MIDDLE)));
    live.act(Act::DragTo(ELSEWHERE));
    play(&mut live, 3);
    assert_eq!(live.held().map(|held| (held.body, held.towards)), Some((disc, ELSEWHERE)));
    play(&mut live, 60);
    assert!(place(&mut live, disc).distance(ELSEWHERE) < fx!(0.01));
    live.act(Act::DragTo(Vec2::new(fx!(-3), fx!(4))));
    play(&mut live, 5);
    live.act(Act::Release);
    play(&mut live, 1);
    let thrown = live.world().body(disc).unwrap().velocity();
    assert!(thrown.x < fx!(-5), "{thrown:?}");
    play(&mut live, 10);
    assert_eq!((anchors(&mut live), live.world().joint_count(), live.held()), (0, 0, None));
    assert_eq!(
        live.world().body(disc).unwrap().velocity(),
        thrown,
        "a released body should keep its velocity"
    );
    check_replay(&mut live, "thrown");
}

#[test]
fn a_click_that_is_shorter_than_a_tick_leaves_nothing_behind() {
    let (mut live, _) = one_disc();
    live.act(Act::Grab(Aim::at(MIDDLE)));
    live.act(Act::Release);
    play(&mut live, 3);
    assert_eq!((anchors(&mut live), live.world().body_count(), live.held()), (0, 1, None));
}

#[test]
fn the_hand_is_empty_when_what_it_held_is_gone() {
    let (mut live, _) = one_disc();
    live.act(Act::Grab(Aim::at(MIDDLE)));
    play(&mut live, 5);
    assert!(live.held().is_some());
    live.act(Act::Delete(Aim::at(MIDDLE)));
    play(&mut live, 2);
    assert_eq!((live.held(), live.world().body_count(), live.world().joint_count()), (None, 0, 0));
    let (mut live, _) = one_disc();
    live.act(Act::Grab(Aim::at(MIDDLE)));
    live.act(Act::Delete(Aim::at(MIDDLE)));
    play(&mut live, 3);
    assert_eq!((live.held(), live.world().body_count()), (None, 0));
}

#[test]
fn who_goes_back_lets_go() {
    let (mut live, _) = one_disc();
    live.act(Act::Grab(Aim::at(MIDDLE)));
    play(&mut live, 20);
    live.seek(10).unwrap();
    assert_eq!(
        (live.held(), anchors(&mut live)),
        (None, 1),
        "the anchor of that tick should still be there, and nothing held"
    );
    // The recorded ticks are played unchanged. The first live tick removes the anchor that is left in the world.
    live.act(Act::DragTo(ELSEWHERE));
    play(&mut live, 10);
    assert_eq!((live.recorded(), anchors(&mut live)), (20, 1));
    play(&mut live, 1);
    assert_eq!((live.recorded(), anchors(&mut live)), (21, 0));
    // The anchor is also removed by an act that drops recorded ticks.
    live.seek(10).unwrap();
    live.act(Act::Gravity(Vec2::new(fx!(0), fx!(-1))));
    play(&mut live, 2);
    assert_eq!((live.recorded(), anchors(&mut live), live.world().joint_count()), (12, 0, 0));
    check_replay(&mut live, "gone back");
}

#[test]
fn only_an_act_that_does_something_cuts_the_recording() {
    let (mut live, _) = one_disc();
    play(&mut live, 30);
    live.seek(10).unwrap();
    live.act(Act::Grab(Aim::at(ELSEWHERE)));
    live.act(Act::Delete(Aim::at(ELSEWHERE)));
    live.act(Act::DragTo(ELSEWHERE));
    live.act(Act::Release);
    play(&mut live, 5);
    assert_eq!((live.tick(), live.recorded(), live.waiting()), (15, 30, 0));
    live.act(Act::explode(ELSEWHERE));
    assert_eq!((live.recorded(), live.waiting()), (30, 1), "the act should wait for the next tick");
    play(&mut live, 1);
    assert_eq!((live.tick(), live.recorded(), live.waiting()), (16, 16, 0));
    live.act(Act::explode(ELSEWHERE));
    live.seek(3).unwrap();
    assert_eq!(live.waiting(), 0, "seeking back should drop queued acts");
}

#[test]
fn what_the_world_refuses_breaks_nothing() {
    let disc = ShapeDef::new(Geometry::circle(fx!(0.5)).unwrap());
    let spawn = Command::Spawn { body: BodyDef::dynamic(), shapes: vec![disc] };
    // The body limit leaves no room for the anchor of the grab.
    let config = Config { body_limit: 1, ..Config::default() };
    let mut live = Live::new("full", &SandboxSetup { config, commands: vec![spawn] }).unwrap();
    live.act(Act::Grab(Aim::at(Vec2::ZERO)));
    live.act(Act::Spawn { form: Form::Box, at: Vec2::ZERO, to: Vec2::ZERO });
    live.act(Act::Gravity(Vec2::new(Fx::MAX, Fx::MIN)));
    let far = Vec2::new(Fx::MAX, Fx::MIN);
    live.act(Act::DragTo(far));
    play(&mut live, 3);
    assert_eq!((live.held(), live.world().body_count(), live.game().refused()), (None, 1, 3));
    for act in [Act::Grab(Aim::at(far)), Act::Delete(Aim { at: far, within: Fx::MAX }), Act::explode(far)] {
        live.act(act);
    }
    play(&mut live, 3);
    check_replay(&mut live, "refused");
}

#[test]
fn a_drag_far_out_of_the_world_is_survived() {
    let (mut live, disc) = one_disc();
    live.act(Act::Grab(Aim::at(MIDDLE)));
    live.act(Act::DragTo(Vec2::new(Fx::MAX, Fx::MIN)));
    play(&mut live, 100);
    assert!(place(&mut live, disc).x > fx!(100));
    live.act(Act::Release);
    play(&mut live, 10);
    check_replay(&mut live, "far out");
}

#[test]
fn a_long_session_is_cheap_to_save_and_to_go_back_in() {
    let mut live = open("box_stack", 0);
    live.seek(5000).unwrap();
    for tick in [4990, 100, 4800, 0, 5000] {
        live.seek(tick).unwrap();
        assert_eq!(live.world().tick(), tick);
    }
    assert_eq!(live.game().tick_rate(), 60);
    check_replay(&mut live, "long");
}
