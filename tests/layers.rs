//! Module layering: each module of the library uses only the modules below it. The test reads `use` lines and paths in
//! the code, including unit tests, and fails on any path that leads to a higher layer.
//!
//! ```text
//!           net
//!          report   check
//! scenes   replay
//!       \  /
//!     lockstep   draw
//!            \  /
//!           world
//!           solver
//!         collision
//!            body
//!            lanes
//! math, hash, codec, threads, inspect
//! ```

mod source;

use source::{Token, files, tokens};

/// Every module of the library with the modules that it may use besides itself.
const LAYERS: &[(&str, &[&str])] = &[
    ("math", &[]),
    ("codec", &[]),
    ("hash", &["codec"]),
    ("threads", &[]),
    ("inspect", &["math"]),
    ("lanes", &["math"]),
    ("body", &["math", "codec", "hash"]),
    ("collision", &["math", "codec", "hash", "lanes", "body"]),
    ("solver", &["math", "codec", "hash", "threads", "lanes", "body", "collision"]),
    ("world", &["math", "codec", "hash", "threads", "lanes", "body", "collision", "solver"]),
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
    ("net", &["math", "codec", "hash", "lockstep", "replay", "report"]),
    ("scenes", &["math", "codec", "hash", "body", "collision", "solver", "world", "lockstep"]),
];

/// Items of the crate root that are not modules: every module may use them.
const ROOT: &[&str] = &["fx", "SEMANTICS"];

#[test]
fn every_module_uses_only_the_layers_below_it() {
    let mut wrong = Vec::new();
    let mut checked = 0;
    for file in files("src", &["rs"]) {
        let place = module_of(&file.path);
        // The root declares all modules and contains nothing else.
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

/// The canary: a forbidden use must be found in every form that a path can have.
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
        "fn f() { let slash = '\"'; crate::scenes::f() }",
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
    assert_eq!(found(&["replay", "verdict"], "use crate::scenes::ALL;"), 1, "scenes and replay are siblings");
    assert_eq!(found(&["toys"], ""), 1, "a module without a layer is an error");
}

/// Returns the path of a file's module: `world`, `step` for `src/world/step.rs`. The path of the root is empty.
fn module_of(path: &str) -> Vec<String> {
    let path = path.trim_start_matches("src/").trim_end_matches(".rs");
    let parts = path.split('/').filter(|part| !matches!(*part, "mod" | "lib"));
    parts.map(String::from).collect()
}

/// Returns the forbidden uses in a module, each as `line: message`.
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

/// Returns every name that follows a path to the crate root: `crate::`, or as many `super::` as lead to the root.
/// `depth` is the number of modules between the file and the root.
fn used_from_root(tokens: &[Token], depth: usize) -> Vec<Token> {
    let text = |at: usize| tokens.get(at).map_or("", |token| token.text.as_str());
    let mut used = Vec::new();
    // For each open brace: whether it opens an inline module.
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

/// Returns the first names of a path's tails: `a` of `a::b`, `a` and `c` of `{a::{b, x}, c}`.
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
