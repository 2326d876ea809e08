//! Tests that the engines start from equal worlds and continue from a save, and that each line of JSON has its fields.

use crate::compare::{self, Plan};
use crate::engine::{Engine, Inventory, Kind};
use crate::measure::{end_state, keeping, run};
use crate::script::{SCENES, Script};
use indicatif::ProgressBar;

/// A scene to which the commands of all recorded ticks were applied, without a step.
fn built(kind: Kind, script: &Script) -> Box<dyn Engine> {
    let mut engine = kind.build(script, 1).unwrap();
    for event in script.ticks.iter().flatten() {
        engine.apply(event).unwrap();
    }
    engine
}

#[test]
fn adapters_build_the_same_worlds() {
    for name in SCENES {
        let script = Script::of_scene(name, Some(1)).unwrap();
        let ours = built(Kind::Ours, &script);
        for kind in [Kind::Box2d, Kind::Rapier] {
            let peer = built(kind, &script);
            let at = format!("{name} in {}", kind.name());
            assert_eq!(peer.counts(), ours.counts(), "{at}");
            let (our_bodies, their_bodies) = (ours.bodies(), peer.bodies());
            assert_eq!(their_bodies.len(), our_bodies.len(), "{at}");
            for (a, b) in our_bodies.iter().zip(&their_bodies) {
                assert_eq!(a.dynamic, b.dynamic, "{at}");
                let difference = (a.velocity[0] - b.velocity[0]).hypot(a.velocity[1] - b.velocity[1]);
                assert!(difference < 1e-5, "{at}: {a:?} {b:?}");
            }
        }
    }
}

#[test]
fn places_and_masses_agree_after_a_step() {
    for name in SCENES {
        let script = Script::of_scene(name, Some(1)).unwrap();
        let [ours, peers @ ..] = Kind::ALL.map(|kind| run(kind, &script, 1).unwrap().1);
        for peer in &peers {
            let (our_inventory, inventory) = (Inventory::of(&*ours), Inventory::of(&**peer));
            assert!(our_inventory.is_like(&inventory), "{name}: {our_inventory:?}, {inventory:?}");
            for (a, b) in ours.bodies().iter().zip(peer.bodies()) {
                let distance = (a.centre[0] - b.centre[0]).hypot(a.centre[1] - b.centre[1]);
                // The bodies of the spinner overlap at the start, so the engines move them differently.
                assert!(!a.dynamic || distance < 0.02 || name == "spinner", "{name}: {a:?}, {b:?}");
            }
        }
    }
}

#[test]
fn a_pyramid_stands_in_every_engine() {
    let script = Script::of_scene("large_pyramid", Some(60)).unwrap();
    let ends = Kind::ALL.map(|kind| end_state(&*run(kind, &script, 1).unwrap().1));
    for end in &ends {
        assert!((end.top / ends[1].top - 1.0).abs() < 0.01, "{ends:?}");
        assert!(end.bottom > 0.45 && end.contacts == 14950, "{ends:?}");
    }
}

#[test]
fn every_engine_continues_from_what_it_saved() {
    let script = Script::of_scene("tumbler", Some(90)).unwrap();
    for kind in Kind::ALL {
        let mut engine = run(kind, &script, 1).unwrap().1;
        let after = |engine: &mut dyn Engine| {
            (0..10).for_each(|_| engine.step());
            engine.bodies().iter().map(|body| body.centre).collect::<Vec<_>>()
        };
        engine.save(0);
        let first = after(&mut *engine);
        engine.restore(0).unwrap();
        assert!(after(&mut *engine) == first, "{}", kind.name());
        let keeping = keeping(&mut *engine).unwrap();
        assert!(keeping.bytes_per_body > 50.0 && keeping.save_ms > 0.0, "{keeping:?}");
        let held = engine.held_bytes(0) / engine.bodies().len();
        assert!((20..4000).contains(&held), "{}: {held} bytes per body", kind.name());
    }
}

#[test]
fn json_lines_have_what_they_promise() {
    let plan = Plan { rounds: 2, threads: 1, steps: Some(3) };
    let result = compare::scene("tumbler", plan, &ProgressBar::hidden()).unwrap();
    let line = compare::line(&result).unwrap();
    assert!(!line.contains('\n'));
    let value: serde_json::Value = serde_json::from_str(&line).unwrap();
    assert_eq!(value["scene"], "tumbler");
    for number in ["ms", "vs_box2d", "vs_rapier", "box2d_ms", "rapier_ms"] {
        assert!(value[number].as_f64().unwrap() > 0.0, "{number}");
    }
    assert!(value["end"]["box2d"]["top"].is_f64() && value["keeping"]["ours"]["hash_ms"].is_f64());
    let summary: serde_json::Value =
        serde_json::from_str(&compare::line(&compare::summary(&[result])).unwrap()).unwrap();
    assert_eq!(summary["summary"], true);
    let [mean, only] =
        [&summary["geomean_vs_box2d"], &value["vs_box2d"]].map(|number| number.as_f64().unwrap());
    assert!((mean / only - 1.0).abs() < 1e-9);
}
