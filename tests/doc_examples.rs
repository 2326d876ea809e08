//! Every public type is shown in use by an example of the documentation.
//!
//! A type is shown if Rust code in the documentation of its own top-level module uses its name. Each crate other than
//! `lockstep2d` counts as one module. Uses in imports, hidden lines, comments and literals do not count. All types that
//! are declared `pub` count as public, because the lint `unreachable_pub` makes sure that users can name them.

mod source;

use std::collections::{BTreeMap, BTreeSet};

use source::{Source, files, tokens};

const FOLDERS: &[&str] = &["src", "crates/cli/src", "crates/render/src", "crates/viewer/src"];

/// Types that need no example: module, name, reason.
const WITHOUT: &[(&str, &str, &str)] = &[
    ("replay", "KeyframesFlaw", "printed as the reason in a `KeyframesError`, not handled"),
    ("report", "ReportFlaw", "printed as the reason in a `ReportError`, not handled"),
    ("crates/cli", "RandomError", "opaque: printed when the system has no random numbers"),
];

/// First line of a macro call that declares a public type. The name of the type is alone on a later line of the call.
const TYPE_MACRO: &str = "define_handle! {";

#[derive(Default)]
struct Module {
    types: Vec<String>,
    /// All words in the code of the examples, without imports.
    shown: BTreeSet<String>,
}

fn read(text: &str, module: &mut Module) {
    let (mut code, mut in_code, mut in_block) = (String::new(), false, false);
    let (mut hidden, mut in_macro) = (false, false);
    for line in text.lines().map(str::trim) {
        if let Some(doc) = line.strip_prefix("///").or(line.strip_prefix("//!")) {
            let doc = doc.strip_prefix(' ').unwrap_or(doc);
            if let Some(kind) = doc.trim_start().strip_prefix("```") {
                (in_block, in_code) = (!in_block, !in_block && is_tested(kind));
            } else if in_code && !is_hidden_line(doc) {
                code += doc;
                code.push('\n');
            }
            continue;
        }
        let name = declared(line).or_else(|| in_macro.then(|| line.to_string()).filter(|name| is_name(name)));
        module.types.extend(name.filter(|_| !hidden));
        in_macro = line == TYPE_MACRO || in_macro && line != "}";
        hidden = line == "#[doc(hidden)]" || hidden && line.starts_with("#[");
    }
    let mut in_import = false;
    for token in tokens(&code) {
        in_import |= token.text == "use";
        if !in_import {
            module.shown.insert(token.text.clone());
        }
        in_import &= token.text != ";";
    }
}

/// Whether `cargo test --doc` compiles a code block with this info string.
fn is_tested(kind: &str) -> bool {
    kind.split(',').all(|word| matches!(word.trim(), "" | "rust" | "no_run" | "should_panic"))
}

fn is_hidden_line(line: &str) -> bool {
    let line = line.trim_start();
    line == "#" || line.starts_with("# ")
}

fn declared(line: &str) -> Option<String> {
    let rest = ["struct ", "enum ", "trait ", "union "].iter().find_map(|kind| {
        let line = line.strip_prefix("pub ")?;
        line.strip_prefix("unsafe ").unwrap_or(line).strip_prefix(kind)
    })?;
    let name: String = rest.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
    Some(name).filter(|name| is_name(name))
}

fn is_name(text: &str) -> bool {
    text.starts_with(char::is_uppercase) && text.chars().all(|c| c.is_alphanumeric() || c == '_')
}

fn modules(files: &[Source]) -> BTreeMap<String, Module> {
    let mut modules = BTreeMap::<String, Module>::new();
    for file in files {
        let name = match (file.path.strip_prefix("src/"), file.path.split_once("/src/")) {
            (Some(path), _) => path.split('/').next().unwrap_or(path).trim_end_matches(".rs"),
            (None, Some((name, _))) => name,
            (None, None) => &file.path,
        };
        read(&file.text, modules.entry(name.into()).or_default());
    }
    modules
}

/// Types that no example shows, with their modules.
fn not_shown(modules: &BTreeMap<String, Module>) -> Vec<(&str, &str)> {
    let missing = modules.iter().flat_map(|(name, module)| {
        let types = module.types.iter().filter(|found| !module.shown.contains(*found));
        types.map(|found| (name.as_str(), found.as_str()))
    });
    missing.collect()
}

#[test]
fn every_public_type_is_shown() {
    let all: Vec<_> = FOLDERS.iter().flat_map(|folder| files(folder, &["rs"])).collect();
    let modules = modules(&all);
    let count: usize = modules.values().map(|module| module.types.len()).sum();
    // A smaller count means that declarations are not recognised.
    assert!(count > 200, "only {count} public types");
    let missing = not_shown(&modules);
    let excused: Vec<_> = WITHOUT.iter().map(|&(module, name, _)| (module, name)).collect();
    let wrong: Vec<_> = missing.iter().filter(|found| !excused.contains(found)).collect();
    assert!(wrong.is_empty(), "{} of {count} types are in no example: {wrong:#?}", wrong.len());
    let idle: Vec<_> = excused.iter().filter(|found| !missing.contains(found)).collect();
    assert!(idle.is_empty(), "exceptions for types that are shown or do not exist: {idle:?}");
}

#[test]
fn a_missing_example_is_noticed() {
    let missing = |text: &str| {
        let modules = modules(&[Source { path: "src/body/a.rs".into(), text: text.into() }]);
        not_shown(&modules).into_iter().map(|(_, name)| name.to_string()).collect::<Vec<_>>()
    };
    let example =
        |code: &str| format!("/// A.\n/// ```\n/// {code}\n/// ```\n#[derive(Debug)]\npub struct A;");
    assert_eq!(missing(&example("let a = A;")), [""; 0]);
    for code in ["use a::A;", "# let a = A;", "// A", "print(\"A\");", "let a = Abc;"] {
        assert_eq!(missing(&example(code)), ["A"], "{code}");
    }
    assert_eq!(missing(&example("let a = A;").replacen("```", "```text", 1)), ["A"]);
    assert_eq!(missing("pub(crate) struct A;\n#[doc(hidden)]\n#[derive(Debug)]\npub enum B {}"), [""; 0]);
    assert_eq!(missing("    pub trait A<T> {}\npub unsafe trait B {}"), ["A", "B"]);
    assert_eq!(missing("define_handle! {\n    /// A.\n    A\n}\nOther"), ["A"]);
}
