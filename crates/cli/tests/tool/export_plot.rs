//! `export --plot`: the SVG is well-formed XML, and its curves agree with the worlds and with theory.
#![expect(
    clippy::disallowed_types,
    clippy::float_arithmetic,
    reason = "plots are drawn and read back as floats"
)]

use lockstep2d::lockstep::Sandbox;
use lockstep2d::replay::{Limits, Step, VerifiedReplay};
use lockstep2d_cli::Exit;

use crate::{Folder, golden, run_sandbox};

/// Names of all start tags. Checks that elements are closed and quotes balanced.
fn elements(xml: &str) -> Vec<&str> {
    let (mut open, mut found, mut rest) = (Vec::new(), Vec::new(), xml);
    while let Some((before, after)) = rest.split_once('<') {
        assert!(!before.contains('>'), "{before:?}");
        let (tag, after) = after.split_once('>').unwrap();
        rest = after;
        if let Some(name) = tag.strip_prefix('/') {
            assert_eq!(open.pop(), Some(name));
            continue;
        }
        assert_eq!(tag.matches('"').count() % 2, 0, "{tag}");
        let name = tag.split([' ', '\n', '/']).next().unwrap();
        found.push(name);
        if !tag.ends_with('/') {
            open.push(name);
        }
    }
    assert!(open.is_empty() && rest.trim().is_empty(), "{open:?} {rest:?}");
    found
}

/// Values of a curve in its unit, from its pixels and the labels of its axis.
fn curve(svg: &str, name: &str) -> Vec<f64> {
    let panels = svg.split("<g>").skip(1);
    let panel = panels.into_iter().find(|panel| panel.contains(&format!("class=\"{name}\""))).unwrap();
    let after = |text: &str, before: &str| -> f64 {
        let text = text.split_once(before).unwrap().1;
        let end = text.find(|c: char| !(c.is_ascii_digit() || c == '.' || c == '-')).unwrap();
        text[..end].parse().unwrap()
    };
    let lines: Vec<&str> = panel.lines().filter(|line| line.contains("text-anchor=\"end\"")).collect();
    let number = |line: &str| (after(line, "<path d=\"M72 "), after(line, "font-size=\"11\">"));
    let ((y0, low), (y1, high)) = (number(lines[0]), number(lines[lines.len() - 1]));
    let polyline =
        panel.split_once(&format!("class=\"{name}\" points=\"")).unwrap().1.split('"').next().unwrap();
    let points = polyline.split(' ').map(|point| point.split_once(',').unwrap().1.parse::<f64>().unwrap());
    points.map(|y| low + (y - y0) / (y1 - y0) * (high - low)).collect()
}

#[test]
fn a_misleading_file_name_is_not_in_the_title() {
    let folder = Folder::new("plot-name");
    let file = folder.write("a\u{9b}2J\u{202e}b\u{7f}.replay", &std::fs::read(golden("free_fall")).unwrap());
    let outcome = run_sandbox(&["export", &file, "--plot", "--to", "2"]);
    assert_eq!(outcome.exit, Exit::Success, "{}", outcome.err);
    assert!(outcome.out.contains("a\u{fffd}2J\u{fffd}b\u{fffd}"), "{}", &outcome.out[..500]);
    elements(&outcome.out);
}

fn plot(scene: &str, arguments: &[&str]) -> String {
    let file = golden(scene);
    let command = ["export", &file, "--plot"];
    let outcome = run_sandbox(&command.into_iter().chain(arguments.iter().copied()).collect::<Vec<_>>());
    assert_eq!((outcome.exit, outcome.err.as_str()), (Exit::Success, ""));
    outcome.out
}

fn extremes(values: &[f64]) -> (f64, f64) {
    (values.iter().copied().fold(f64::MAX, f64::min), values.iter().copied().fold(f64::MIN, f64::max))
}

#[test]
fn it_is_xml_with_a_curve_for_everything() {
    let svg = plot("ragdoll", &[]);
    let found = elements(&svg);
    assert_eq!(found.iter().filter(|name| **name == "polyline").count(), 7);
    for words in [
        "energy</tspan> in J",
        "overlap</tspan> in mm",
        "contact points",
        "awake bodies",
        "joint gap</tspan> in mm",
        "time in s",
    ] {
        assert!(svg.contains(words), "{words}");
    }
    let without_joints = plot("box_stack", &["--width", "400", "--height", "300"]);
    assert_eq!(elements(&without_joints).iter().filter(|name| **name == "polyline").count(), 6);
    assert!(without_joints.contains("width=\"400\" height=\"300\""));
    elements(&plot("free_fall", &["--from", "7", "--to", "7"]));
}

#[test]
fn curves_have_the_extremes_of_what_they_show() {
    let file = std::fs::read(golden("ragdoll")).unwrap();
    let mut replay = VerifiedReplay::<Sandbox>::open(&file, &Limits::default()).unwrap();
    let (mut kinetic, mut overlap, mut points, mut gap) =
        (vec![0.0f64], vec![0.0f64], vec![0u64], vec![0.0f64]);
    while replay.step() == Ok(Step::Ticked) {
        let world = replay.game().world();
        kinetic.push(world.bodies().map(|(_, body)| body.kinetic_energy().to_num::<f64>()).sum());
        let depths = world.contacts().flat_map(|contact| contact.manifold.points());
        overlap.push(depths.map(|point| -point.separation.to_num::<f64>() * 1000.0).fold(0.0, f64::max));
        points.push(world.stats().points.into());
        let errors = world.joints().filter_map(|(id, _)| world.joint_error(id));
        gap.push(errors.map(|error| error.to_num::<f64>() * 1000.0).fold(0.0, f64::max));
    }
    let svg = plot("ragdoll", &[]);
    let points: Vec<f64> = points.iter().map(|&points| points as f64).collect();
    for (name, expected) in [("kinetic", &kinetic), ("overlap", &overlap), ("points", &points), ("gap", &gap)]
    {
        let found = curve(&svg, name);
        assert_eq!(found.len(), expected.len(), "{name}");
        let (_, highest) = extremes(expected);
        // Coordinates have a resolution of 0.01 pixels, and a panel is some 110 pixels high.
        let tolerance = highest / 2000.0;
        for (tick, (found, expected)) in found.iter().zip(expected).enumerate() {
            assert!((found - expected).abs() <= tolerance, "{name} at tick {tick}: {found}, not {expected}");
        }
        let tick = expected.iter().position(|value| *value == highest).unwrap();
        assert!(svg.contains(&format!(" at tick {tick}</tspan>")), "{name}: {highest} at {tick}");
    }
}

/// The integrator's error in the energy after a time t is `m g² t h / 2`, with the time step h. This is the kinetic
/// energy times `h / t`.
#[test]
fn energy_in_free_fall_is_constant() {
    let svg = plot("free_fall", &[]);
    let (low, high) = extremes(&curve(&svg, "total"));
    let (_, kinetic) = extremes(&curve(&svg, "kinetic"));
    assert!(kinetic > 0.0);
    assert!(high - low < kinetic * 0.02, "total from {low} to {high}, kinetic up to {kinetic}");
    let (still, fast) = (curve(&svg, "kinetic")[0], curve(&svg, "kinetic").pop().unwrap());
    assert!(still < fast / 100.0, "kinetic from {still} to {fast}");
}

/// At the turning points of a pendulum, its kinetic energy is nearly 0. So its potential energy varies as much as its
/// kinetic energy.
#[test]
fn energy_of_a_pendulum_goes_back_and_forth() {
    let svg = plot("pendulum", &[]);
    let (total, kinetic, potential) =
        (curve(&svg, "total"), curve(&svg, "kinetic"), curve(&svg, "potential"));
    let (low, high) = extremes(&total);
    let (_, fastest) = extremes(&kinetic);
    assert!(high - low < fastest * 0.05, "total from {low} to {high}, kinetic up to {fastest}");
    let (lowest, highest) = extremes(&potential);
    assert!(
        ((highest - lowest) - fastest).abs() < fastest * 0.05,
        "potential from {lowest} to {highest}, kinetic up to {fastest}"
    );
    let turns = kinetic.windows(3).filter(|w| w[1] <= w[0] && w[1] < w[2] && w[1] < fastest / 20.0).count();
    assert!(turns >= 2, "it turns {turns} times");
}

#[test]
fn the_same_replay_gives_the_same_plot() {
    assert!(plot("bridge", &[]) == plot("bridge", &[]));
}

/// `docs/pictures/make` reproduces the SVGs byte for byte.
#[cfg(unix)]
#[test]
fn the_pictures_of_the_documentation_can_be_made_anew() {
    let folder = crate::Folder::new("pictures");
    let kept = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/pictures");
    let made = std::process::Command::new(kept.join("make"))
        .arg(folder.path(""))
        .env("LOCKSTEP2D", env!("CARGO_BIN_EXE_lockstep2d"))
        .status()
        .unwrap();
    assert!(made.success());
    let mut total = 0;
    for entry in std::fs::read_dir(kept).unwrap() {
        let name = entry.unwrap().file_name().into_string().unwrap();
        if name == "make" {
            continue;
        }
        let read = |path: &str| std::fs::read(path).unwrap();
        let kept = read(&format!("{}/../../docs/pictures/{name}", env!("CARGO_MANIFEST_DIR")));
        let anew = read(&folder.path(&name));
        total += kept.len();
        if name.ends_with(".svg") {
            assert!(kept == anew, "{name} is not what docs/pictures/make makes: run it");
        } else {
            // Raster pictures may differ a little, because they are drawn with floats.
            assert_eq!(kept[..10], anew[..10], "{name}");
            assert!(kept.len().abs_diff(anew.len()) < kept.len() / 5, "{name}");
        }
    }
    assert!(total < 3_000_000, "{total} bytes of pictures");
}
