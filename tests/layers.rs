//! Each module of the library uses only the modules below it in this picture. The test reads `use` lines and paths,
//! including those in unit tests.
//!
//! Inside the modules of [`FOLDERS`], each folder uses only the folders listed for it, and files of different folders
//! do not depend on each other in a circle. The tests of these two rules ignore unit tests. A path to a re-export
//! counts as a path to the file that defines the item. Calls of methods are not found.
//!
//! ```text
//!             peer
//!          report   check
//!          replay
//!         lockstep   draw
//!                \  /
//!               world
//!              solver
//!             collision
//!               body
//!               simd
//! math, hash, codec, threads, inspect, session
//! ```

#[path = "source/paths.rs"]
mod paths;
mod source;

use paths::{Crate, module_of, modules};
use source::{Token, files, tokens};

type Rules = &'static [(&'static str, &'static [&'static str])];

/// Each module with the modules that it may use.
const LAYERS: Rules = &[
    ("math", &[]),
    ("codec", &[]),
    ("hash", &["codec"]),
    ("threads", &[]),
    ("session", &[]),
    ("inspect", &["math"]),
    ("simd", &["math"]),
    ("body", &["math", "codec", "hash", "threads"]),
    ("collision", &["math", "codec", "hash", "threads", "simd", "body"]),
    ("solver", &["math", "codec", "hash", "threads", "simd", "body", "collision"]),
    ("world", &["math", "codec", "hash", "threads", "simd", "body", "collision", "solver"]),
    ("draw", &["math", "codec", "hash", "body", "collision", "solver", "world"]),
    ("lockstep", &["math", "codec", "hash", "body", "collision", "solver", "world"]),
    ("replay", &["math", "codec", "hash", "body", "collision", "solver", "world", "lockstep"]),
    (
        "report",
        &["math", "codec", "hash", "inspect", "body", "collision", "solver", "world", "lockstep", "replay"],
    ),
    (
        "check",
        &["math", "codec", "hash", "inspect", "body", "collision", "solver", "world", "lockstep", "replay"],
    ),
    (
        "peer",
        &[
            "math",
            "codec",
            "hash",
            "session",
            "body",
            "collision",
            "solver",
            "world",
            "lockstep",
            "replay",
            "report",
        ],
    ),
];

/// Each folder of a module with the folders that it may use. `.` stands for the files outside of folders.
const FOLDERS: &[(&str, Rules)] = &[
    (
        "collision",
        &[
            (".", &[]),
            ("shape", &["."]),
            ("broad_phase", &["."]),
            ("narrow_phase", &[".", "shape"]),
            ("query", &[".", "shape", "narrow_phase"]),
        ],
    ),
    (
        "solver",
        &[
            // The files outside of folders call the stages of a sub-step in order.
            (".", &["contact", "joint", "integrate", "row"]),
            ("row", &["."]),
            ("contact", &[".", "row"]),
            ("joint", &[".", "row"]),
            ("integrate", &["."]),
        ],
    ),
    (
        "world",
        &[
            // The files outside of folders use the packed form of sleeping contacts, the caches and the digest.
            (".", &["cache", "snapshot"]),
            ("cache", &["."]),
            ("islands", &[".", "cache"]),
            ("snapshot", &[".", "cache"]),
            ("edit", &[".", "cache", "islands"]),
            ("query", &["."]),
            ("view", &[".", "cache", "islands"]),
            ("step", &[".", "cache", "islands", "snapshot"]),
        ],
    ),
];

/// Items of the crate root that every module may use.
const ROOT: &[&str] = &["fx", "SEMANTICS"];

#[test]
fn every_module_uses_only_the_layers_below_it() {
    let mut wrong = Vec::new();
    let mut checked = 0;
    for file in files("src", &["rs"]) {
        let place = module_of(&file.path);
        // The root declares all modules.
        if !place.is_empty() {
            checked += 1;
            wrong
                .extend(upward_uses(&place, &file.text).iter().map(|found| format!("{}:{found}", file.path)));
        }
    }
    assert!(checked > 50, "expected more than 50 source files, found {checked}");
    assert!(wrong.is_empty(), "uses that violate the layers in tests/layers.rs:\n{}", wrong.join("\n"));
}

#[test]
fn a_layer_below_lists_no_layer_above_it() {
    for (at, (module, below)) in LAYERS.iter().enumerate() {
        for used in *below {
            let listed_before = LAYERS[..at].iter().any(|(name, _)| name == used);
            assert!(listed_before, "{module} may use {used}, which is not listed before it");
        }
    }
}

#[test]
fn every_folder_uses_only_the_folders_listed_for_it() {
    let sources = Crate::new(&modules(&files("src", &["rs"])));
    let wrong: Vec<_> =
        FOLDERS.iter().flat_map(|&(module, rules)| wrong_uses(&sources, module, rules)).collect();
    assert!(wrong.is_empty(), "paths against the folders of tests/layers.rs:\n{}", wrong.join("\n"));
}

#[test]
fn files_of_different_folders_form_no_circle() {
    let sources = Crate::new(&modules(&files("src", &["rs"])));
    let wrong: Vec<_> = FOLDERS.iter().flat_map(|&(module, _)| circles(&sources, module)).collect();
    assert!(wrong.is_empty(), "files that depend on each other:\n{}", wrong.join("\n"));
}

/// Planted violations of the folder rules are found.
#[test]
fn wrong_folders_and_circles_are_found() {
    let rules: Rules = &[(".", &["b"]), ("a", &["."]), ("b", &["."])];
    let sources = |files: &[(&str, &str)]| {
        let files: Vec<_> = files.iter().map(|(path, text)| (module_of(path), text.to_string())).collect();
        Crate::new(&files)
    };
    let wrong = |files: &[(&str, &str)]| {
        let sources = sources(files);
        (wrong_uses(&sources, "m", rules).len(), circles(&sources, "m").len())
    };
    let root = ("src/m/mod.rs", "mod a; mod b; pub use b::Shown; pub(crate) use a::x::Inner;");
    let a = ("src/m/a/mod.rs", "mod x;");
    let b = ("src/m/b/mod.rs", "mod y; pub use y::Shown;");
    let with = |x: &'static str, y: &'static str| {
        wrong(&[root, a, b, ("src/m/a/x.rs", x), ("src/m/b/y.rs", y), ("src/m/c.rs", "pub struct Base;")])
    };
    assert_eq!(with("use crate::m::c::Base;", "use super::super::c::Base; pub struct Shown;"), (0, 0));
    for used in [
        "use crate::m::b::Shown;",
        "use crate::m::Shown;",
        "use super::super::b::y::{Shown as Other};",
        "use crate::m::{c::Base, b::{self, Shown}};",
        "fn f() { crate::m::b::y::Shown; }",
    ] {
        let (uses, _) = with(used, "pub struct Shown;");
        assert!(uses > 0, "{used}");
    }
    assert_eq!(with("mod tests { use crate::m::Shown; }", "pub struct Shown;"), (0, 0), "a test");
    // Each of these paths is allowed, but together they form a circle.
    let circle = [root, a, b, ("src/m/b/y.rs", "use crate::m::c::Base; pub struct Shown;")];
    let there = ("src/m/c.rs", "use super::b::Shown; pub struct Base;");
    let there_and_back: Vec<_> = circle.iter().copied().chain([there]).collect();
    assert_eq!(wrong(&there_and_back), (0, 1));
    // A circle through a re-export: the module uses an item of a folder, which uses an item of the module.
    let own = [
        ("src/m/mod.rs", "mod b; pub struct Base(b::Holder);"),
        ("src/m/b/mod.rs", "mod y; pub use y::Shown; pub struct Holder(Shown);"),
        ("src/m/b/y.rs", "use crate::m::Base; pub struct Shown;"),
    ];
    assert_eq!(wrong(&own), (0, 1));
    let unlisted = wrong(&[root, ("src/m/d/x.rs", "use crate::m::c::Base;"), ("src/m/c.rs", "")]);
    assert_eq!(unlisted.0, 1, "a folder without a rule");
    let same_folder = [("src/m/a/x.rs", "use super::z::Z;"), ("src/m/a/z.rs", "use super::x::X;")];
    assert_eq!(wrong(&same_folder), (0, 0), "a circle within a folder");
}

/// Name of a file's folder: `a` for `m/a/x.rs` and `m/a/mod.rs`, `.` for `m/c.rs` and `m/mod.rs`.
fn folder_of<'a>(place: &'a [String], sources: &Crate) -> &'a str {
    let is_folder = |name: &String| {
        place.len() > 2
            || sources.modules().any(|other| other.len() > 2 && other[0] == place[0] && other[1] == *name)
    };
    place.get(1).filter(|name| is_folder(name)).map_or(".", String::as_str)
}

/// Paths to folders that the rules do not allow.
fn wrong_uses(sources: &Crate, module: &str, rules: Rules) -> Vec<String> {
    let mut wrong = Vec::new();
    for place in sources.modules().filter(|place| place.first().is_some_and(|name| name == module)) {
        let folder = folder_of(place, sources);
        let Some((_, allowed)) = rules.iter().find(|(name, _)| *name == folder) else {
            wrong.push(format!("{}: the folder {folder} has no rule", place.join("/")));
            continue;
        };
        for (used, line) in sources.dependencies(place) {
            if used[0] != module {
                continue;
            }
            let other = folder_of(&used, sources);
            if other != folder && !allowed.contains(&other) {
                wrong.push(format!("{}:{line}: {folder} uses {}", place.join("/"), used.join("/")));
            }
        }
    }
    wrong
}

/// Circles of files that are not all in one folder.
fn circles(sources: &Crate, module: &str) -> Vec<String> {
    let circles = sources
        .circles()
        .into_iter()
        .map(|circle| circle.into_iter().filter(|place| place[0] == module).collect::<Vec<_>>());
    let spans = |circle: &Vec<Vec<String>>| {
        let folders = circle.iter().map(|place| folder_of(place, sources));
        folders.collect::<std::collections::BTreeSet<_>>().len() > 1
    };
    let named =
        |circle: Vec<Vec<String>>| circle.iter().map(|place| place.join("/")).collect::<Vec<_>>().join(" ");
    circles.filter(spans).map(named).collect()
}

/// Planted violations of the layers are found, with every form of a path.
#[test]
fn wrong_directions_are_found() {
    let found = |place: &[&str], code: &str| {
        let place: Vec<String> = place.iter().map(|&part| part.into()).collect();
        upward_uses(&place, code).len()
    };
    for wrong in [
        "use crate::world::World;",
        "pub(crate) use crate::world::World as Everything;",
        "use crate::{math::Fx, world::World};",
        "use crate::{fx, math::{Fx, Vec2}, lockstep};",
        "fn f() -> u64 { crate::world::World::default().tick() }",
        "use super::super::world::World;",
        "mod tests { use super::super::super::world::World; }",
        "fn f() { let slash = '\"'; crate::report::f() }",
        "use crate::elsewhere::Thing;",
        "use crate::*;",
    ] {
        assert_eq!(found(&["body", "arena"], wrong), 1, "{wrong}");
    }
    for right in [
        "use crate::math::Fx;",
        "use crate::{fx, math::{Fx, world}, codec::{self, encode}};",
        "use super::super::math::Fx;",
        "mod tests { use super::super::world; }",
        "// use crate::world::World;",
        "/// See [`crate::world::World`].\nfn f() -> &'static str { \"crate::world\" }",
        "const PATH: &str = r#\"crate::world\"#;",
        "pub(in crate::body) fn world() {}",
    ] {
        assert_eq!(found(&["body", "arena"], right), 0, "{right}");
    }
    assert_eq!(found(&["draw"], "use crate::lockstep::Game;"), 1, "draw and lockstep are siblings");
    assert_eq!(
        found(&["replay", "verdict"], "use crate::draw::primitives;"),
        1,
        "draw and replay are siblings"
    );
    assert_eq!(found(&["toys"], ""), 1, "a module without a layer is an error");
}

/// Forbidden uses, each as `line: module uses module`.
fn upward_uses(place: &[String], code: &str) -> Vec<String> {
    let module = place[0].as_str();
    let Some((_, below)) = LAYERS.iter().find(|(name, _)| *name == module) else {
        return vec![format!("1: the module {module} has no layer")];
    };
    let allowed = |used: &str| used == module || below.contains(&used) || ROOT.contains(&used);
    let used = used_from_root(&tokens(code), place.len());
    let wrong = used.into_iter().filter(|used| !allowed(&used.text));
    wrong.map(|used| format!("{}: {module} uses {}", used.line, used.text)).collect()
}

/// Every name that follows a path to the crate root: `crate::`, or `depth` times `super::`.
fn used_from_root(tokens: &[Token], depth: usize) -> Vec<Token> {
    let text = |at: usize| tokens.get(at).map_or("", |token| token.text.as_str());
    let mut used = Vec::new();
    // For each open brace, whether it opens an inline module.
    let mut braces = Vec::new();
    for at in 0..tokens.len() {
        match text(at) {
            "{" => braces.push(at >= 2 && text(at - 2) == "mod"),
            "}" => drop(braces.pop()),
            "crate" if text(at + 1) == "::" => used.extend(heads(tokens, at + 2)),
            "super" if at == 0 || text(at - 1) != "::" => {
                let climbed = (at..).step_by(2).take_while(|&at| text(at) == "super" && text(at + 1) == "::");
                let climbed = climbed.count();
                if climbed == depth + braces.iter().filter(|&&inline| inline).count() {
                    used.extend(heads(tokens, at + 2 * climbed));
                }
            }
            _ => {}
        }
    }
    used
}

/// First names of the path or paths that begin at `start`: `a` of `a::b`, `a` and `c` of `{a::{b, x}, c}`.
fn heads(tokens: &[Token], start: usize) -> Vec<Token> {
    if tokens[start].text != "{" {
        return vec![tokens[start].clone()];
    }
    let mut heads = Vec::new();
    let mut depth = 0;
    for pair in tokens[start..].windows(2) {
        match pair[0].text.as_str() {
            "{" => depth += 1,
            "}" => depth -= 1,
            _ => {}
        }
        if depth == 0 {
            break;
        }
        if depth == 1 && matches!(pair[0].text.as_str(), "{" | ",") && pair[1].text != "}" {
            heads.push(pair[1].clone());
        }
    }
    heads
}
