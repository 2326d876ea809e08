//! Paths between the modules of a crate, and the files that they lead to.

use std::collections::{BTreeMap, BTreeSet};

use crate::source::{Source, Token, tokens};

#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct PathUse {
    /// Path from the root of the crate, as in `["world", "cache", "Scratch"]`.
    pub(crate) path: Vec<String>,
    pub(crate) line: usize,
    /// Name that a `pub use` exports.
    reexport: Option<String>,
    /// Whether the module itself uses the name of a `pub use`.
    is_used_here: bool,
}

/// Modules of a crate. Files and inline modules named `tests` are left out.
pub(crate) struct Crate {
    modules: BTreeMap<Vec<String>, Vec<PathUse>>,
}

impl Crate {
    /// Reads files, each given by its module path and text.
    pub(crate) fn new(files: &[(Vec<String>, String)]) -> Self {
        let names: BTreeSet<Vec<String>> = files.iter().map(|(place, _)| place.clone()).collect();
        let read = |(place, text): &(Vec<String>, String)| {
            let paths = paths_of(&tokens(text), place, &|child| names.contains(child));
            (place.clone(), paths)
        };
        let files = files.iter().filter(|(place, _)| place.last().is_none_or(|name| name != "tests"));
        Crate { modules: files.map(read).collect() }
    }

    /// Modules in whose files a module's file uses an item, each with the line of the path. A path through a re-export
    /// leads to the file that defines the item. The re-export itself counts only if its module uses the name.
    pub(crate) fn dependencies(&self, place: &[String]) -> Vec<(Vec<String>, usize)> {
        let paths = self.modules[place].iter().filter(|path| path.reexport.is_none() || path.is_used_here);
        let resolved = paths.map(|path| (self.resolve(&path.path, 0), path.line));
        resolved.filter(|(used, _)| used != place && !used.is_empty()).collect()
    }

    pub(crate) fn modules(&self) -> impl Iterator<Item = &Vec<String>> {
        self.modules.keys()
    }

    /// The module in whose file the item is defined.
    fn resolve(&self, path: &[String], depth: usize) -> Vec<String> {
        assert!(depth < 20, "{path:?} is re-exported in a circle");
        let mut place = Vec::new();
        for (at, name) in path.iter().enumerate() {
            place.push(name.clone());
            if self.modules.contains_key(&place) {
                continue;
            }
            place.pop();
            let uses = self.modules.get(&place).map_or(&[][..], Vec::as_slice);
            let Some(found) = uses.iter().find(|found| found.reexport.as_ref() == Some(name)) else { break };
            let rest = path[at + 1..].iter().cloned();
            let target: Vec<String> = found.path.iter().cloned().chain(rest).collect();
            return self.resolve(&target, depth + 1);
        }
        place
    }

    /// Groups of files that depend on each other in a circle.
    pub(crate) fn circles(&self) -> Vec<BTreeSet<Vec<String>>> {
        let reached = |from: &Vec<String>| {
            let (mut seen, mut open) = (BTreeSet::new(), vec![from.clone()]);
            while let Some(place) = open.pop() {
                let known = |used: &Vec<String>| self.modules.contains_key(used);
                let used = self.dependencies(&place).into_iter().map(|(used, _)| used).filter(known);
                open.extend(used.filter(|used| seen.insert(used.clone())));
            }
            seen
        };
        let reached: BTreeMap<_, _> = self.modules().map(|place| (place.clone(), reached(place))).collect();
        let mutual = |a: &Vec<String>| -> BTreeSet<Vec<String>> {
            reached[a]
                .iter()
                .filter(|b| reached.get(*b).is_some_and(|back| back.contains(a)))
                .cloned()
                .collect()
        };
        let groups: BTreeSet<_> = reached.keys().map(mutual).filter(|group| group.len() > 1).collect();
        groups.into_iter().collect()
    }
}

/// Module path of a file: `["world", "step"]` for `src/world/step.rs` and `src/world/step/mod.rs`, empty for the root.
pub(crate) fn module_of(path: &str) -> Vec<String> {
    let path = path.trim_start_matches("src/").trim_end_matches(".rs");
    let parts = path.split('/').filter(|part| !matches!(*part, "mod" | "lib"));
    parts.map(String::from).collect()
}

pub(crate) fn modules(files: &[Source]) -> Vec<(Vec<String>, String)> {
    files.iter().map(|file| (module_of(&file.path), file.text.clone())).collect()
}

/// Paths that start with `crate`, `super`, `self` or a child module.
fn paths_of(tokens: &[Token], place: &[String], is_module: &dyn Fn(&Vec<String>) -> bool) -> Vec<PathUse> {
    let text = |at: usize| tokens.get(at).map_or("", |token| token.text.as_str());
    let mut found = Vec::new();
    // For each open brace, the name of the inline module that it opens, if any.
    let mut braces: Vec<Option<String>> = Vec::new();
    // Names that occur outside of paths and tests.
    let mut plain = BTreeSet::new();
    let mut at = 0;
    while at < tokens.len() {
        match text(at) {
            "{" => {
                let is_module = at >= 2 && text(at - 2) == "mod";
                braces.push(is_module.then(|| text(at - 1).to_string()));
            }
            "}" => drop(braces.pop()),
            _ => {}
        }
        let inline: Vec<String> = braces.iter().flatten().cloned().collect();
        // A path in a visibility, as in `pub(in crate::world)`, is not a use.
        let in_visibility = at >= 2 && text(at - 1) == "in" && text(at - 2) == "(";
        let starts = is_name(text(at)) && !in_visibility && (at == 0 || text(at - 1) != "::");
        let is_use = text(at) == "use";
        let is_test = inline.iter().any(|name| name == "tests");
        if is_test || !(is_use || starts && text(at + 1) == "::") {
            if starts && !is_test {
                plain.insert(text(at));
            }
            at += 1;
            continue;
        }
        let reexport = is_use && at > 0 && matches!(text(at - 1), "pub" | ")");
        let first = if is_use { at + 1 } else { at };
        let mut tree = Vec::new();
        let end = read_tree(tokens, first, &[], &mut tree);
        if !is_use {
            plain.insert(text(at));
        }
        let module: Vec<String> = place.iter().cloned().chain(inline).collect();
        for (names, alias) in tree {
            if let Some(path) = absolute(&names, &module, is_module) {
                let (line, reexport) = (tokens[at].line, reexport.then_some(alias));
                found.push(PathUse { path, line, reexport, is_used_here: false });
            }
        }
        at = end.max(at + 1);
    }
    for path in &mut found {
        path.is_used_here = path.reexport.as_ref().is_some_and(|name| plain.contains(name.as_str()));
    }
    found
}

fn is_name(text: &str) -> bool {
    text.starts_with(|c: char| c.is_alphabetic() || c == '_')
}

/// Reads a path or a tree of a `use`. Adds the names of each path, and the name that the path brings into scope.
/// Returns the index of the next token.
fn read_tree(
    tokens: &[Token],
    start: usize,
    prefix: &[String],
    found: &mut Vec<(Vec<String>, String)>,
) -> usize {
    let text = |at: usize| tokens.get(at).map_or("", |token| token.text.as_str());
    let (mut at, mut names) = (start, prefix.to_vec());
    loop {
        if text(at) == "{" {
            at += 1;
            while !matches!(text(at), "}" | "") {
                at = read_tree(tokens, at, &names, found);
                if text(at) == "," {
                    at += 1;
                }
            }
            return at + 1;
        }
        if text(at) == "*" {
            return at + 1;
        }
        if !is_name(text(at)) {
            break;
        }
        names.push(text(at).to_string());
        at += 1;
        if text(at) != "::" {
            break;
        }
        at += 1;
    }
    if names.last().is_some_and(|name| name == "self") {
        names.pop();
    }
    let mut alias = names.last().cloned().unwrap_or_default();
    if text(at) == "as" {
        alias = text(at + 1).to_string();
        at += 2;
    }
    found.push((names, alias));
    at
}

/// Path from the root of the crate. `None` for a path to another crate.
fn absolute(
    names: &[String],
    module: &[String],
    is_module: &dyn Fn(&Vec<String>) -> bool,
) -> Option<Vec<String>> {
    let (mut base, mut rest) = (module.to_vec(), names);
    match names.first()?.as_str() {
        "crate" => (base, rest) = (Vec::new(), &names[1..]),
        "self" => rest = &names[1..],
        "super" => {
            while rest.first().is_some_and(|name| name == "super") {
                base.pop();
                rest = &rest[1..];
            }
        }
        child => {
            base.push(child.to_string());
            if !is_module(&base) {
                return None;
            }
            rest = &names[1..];
        }
    }
    base.extend(rest.iter().cloned());
    Some(base)
}
