//! Links between documents lead to files and headings that exist, and the table of contents has every page.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").canonicalize().expect("the repository")
}

/// Adds all Markdown files below a folder to `found`, except those in hidden folders, `target` and `node_modules`.
fn documents(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        let name = path.file_name().and_then(|name| name.to_str()).unwrap_or_default();
        let skipped = name.starts_with('.') || ["target", "node_modules"].contains(&name);
        if path.is_dir() && !skipped {
            documents(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "md") {
            found.push(path);
        }
    }
}

/// The lines of a document outside of code blocks.
fn prose(text: &str) -> impl Iterator<Item = &str> {
    let mut in_code = false;
    text.lines().filter(move |line| {
        let is_fence = line.trim_start().starts_with("```");
        in_code ^= is_fence;
        !in_code && !is_fence
    })
}

/// Returns the targets of the links in a document, except for links to other sites.
fn links(text: &str) -> Vec<&str> {
    let parts = prose(text).flat_map(|line| line.split("](").skip(1));
    parts
        .filter_map(|rest| rest.split_once(')'))
        .map(|(link, _)| link)
        .filter(|link| !link.contains("://"))
        .collect()
}

/// Returns the anchors of the headings of a document: the texts that links have after `#`.
fn headings(text: &str) -> BTreeSet<String> {
    let headings = prose(text).filter(|line| line.starts_with('#'));
    headings
        .map(|line| {
            let kept = line.trim_start_matches('#').trim().to_lowercase();
            let kept = kept.chars().filter(|c| c.is_alphanumeric() || " -_".contains(*c));
            kept.map(|c| if c == ' ' { '-' } else { c }).collect()
        })
        .collect()
}

/// Returns the links of a document whose file or heading does not exist.
fn broken<'a>(path: &Path, text: &'a str) -> Vec<&'a str> {
    let is_broken = |link: &&str| {
        let (file, heading) = link.split_once('#').unwrap_or((link, ""));
        let target = if file.is_empty() { path.to_owned() } else { path.with_file_name("").join(file) };
        !target.exists()
            || !heading.is_empty()
                && !fs::read_to_string(target).is_ok_and(|text| headings(&text).contains(heading))
    };
    links(text).into_iter().filter(is_broken).collect()
}

#[test]
fn links_lead_somewhere() {
    let mut paths = Vec::new();
    documents(&root(), &mut paths);
    assert!(paths.len() > 20, "only {} documents", paths.len());
    let mut all = Vec::new();
    for path in &paths {
        let text = fs::read_to_string(path).expect("a document");
        all.extend(broken(path, &text).into_iter().map(|link| format!("{}: {link}", path.display())));
    }
    assert!(all.is_empty(), "{all:#?}");
}

#[test]
fn a_broken_link_is_noticed() {
    let text = "[here](README.md) [gone](gone.md) [no heading](README.md#gone)\n```\n[code](gone.md)\n```";
    assert_eq!(broken(&root().join("x.md"), text), ["gone.md", "README.md#gone"]);
}

#[test]
fn the_table_of_contents_has_every_page() {
    let docs = root().join("docs");
    let mut paths = Vec::new();
    documents(&docs, &mut paths);
    let contents = fs::read_to_string(docs.join("SUMMARY.md")).expect("the table of contents");
    let listed: BTreeSet<PathBuf> = links(&contents).into_iter().map(|link| docs.join(link)).collect();
    let pages = paths.into_iter().filter(|path| !path.ends_with("SUMMARY.md"));
    let missing: Vec<_> = pages.filter(|path| !listed.contains(path)).collect();
    assert!(missing.is_empty(), "{missing:?}");
}
