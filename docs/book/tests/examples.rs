//! The types that a game's author meets first have an example in their documentation.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

/// Public types that need an example.
const MAIN: &[&str] = &[
    "Aabb",
    "Angle",
    "Area",
    "Body",
    "BodyDef",
    "Chain",
    "CheckOptions",
    "Command",
    "Config",
    "ContactView",
    "Distance",
    "Events",
    "Explosion",
    "Filter",
    "FixedTimestep",
    "Game",
    "Gear",
    "Geometry",
    "History",
    "InputLog",
    "JointDef",
    "Layers",
    "Limits",
    "MassSource",
    "Material",
    "Motor",
    "Mover",
    "Name",
    "Network",
    "Peer",
    "PeerOptions",
    "Polygon",
    "Prismatic",
    "Probe",
    "Pulley",
    "QueryFilter",
    "Recorder",
    "Recording",
    "Revolute",
    "Rng",
    "Rot",
    "Sandbox",
    "Sealed",
    "ShapeDef",
    "Snapshot",
    "SolverSettings",
    "StateHash",
    "Threshold",
    "Timeline",
    "Transform",
    "Transport",
    "Vec2",
    "Verdict",
    "View",
    "Weld",
    "Wheel",
    "World",
];

/// Adds the public types of all files below a folder, each with whether its documentation has an example.
fn types(folder: &Path, found: &mut BTreeMap<String, bool>) {
    for entry in fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            types(&path, found);
        } else {
            types_of(&fs::read_to_string(&path).expect("a source file"), found);
        }
    }
}

fn types_of(text: &str, found: &mut BTreeMap<String, bool>) {
    let mut has_example = false;
    for line in text.lines() {
        let head =
            ["pub struct ", "pub enum ", "pub trait "].into_iter().find_map(|head| line.strip_prefix(head));
        if let Some(rest) = head {
            let name = rest.split(|c: char| !c.is_alphanumeric()).next().unwrap_or_default();
            *found.entry(name.into()).or_default() |= has_example;
        }
        // Attributes and ordinary comments may stand between the documentation and the type.
        let is_attribute = line.starts_with("#[") || line.starts_with("// ");
        has_example =
            is_attribute && has_example || line.starts_with("///") && (has_example || line.contains("```"));
    }
}

#[test]
fn main_types_have_an_example() {
    let mut found = BTreeMap::new();
    types(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../../src"), &mut found);
    let without: Vec<_> = MAIN.iter().filter(|&&name| found.get(name) != Some(&true)).collect();
    assert!(without.is_empty(), "no example: {without:?}");
}

#[test]
fn a_missing_example_is_noticed() {
    let mut found = BTreeMap::new();
    types_of("/// A.\n/// ```\n/// ```\n#[derive(Debug)]\npub struct A;\n/// B.\npub enum B {}", &mut found);
    assert_eq!(found.into_iter().collect::<Vec<_>>(), [("A".into(), true), ("B".into(), false)]);
}
