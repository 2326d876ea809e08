//! The table of samples names every test of this binary, and no other.

use std::collections::BTreeSet;

/// Words of the form `module::function` in backquotes.
fn named(page: &str) -> BTreeSet<String> {
    page.split('`').filter(|word| word.contains("::") && is_test_name(word)).map(str::to_owned).collect()
}

/// Whether a word can be the name of a test. Names of types begin with a capital letter.
fn is_test_name(word: &str) -> bool {
    word.chars().all(|c| c.is_ascii_lowercase() || c == '_' || c == ':')
}

fn tests_of(module: &str, source: &str) -> Vec<String> {
    let name = |after: &str| after.trim_start().strip_prefix("fn ")?.split('(').next().map(str::to_owned);
    source.split("#[test]").skip(1).filter_map(name).map(|name| format!("{module}::{name}")).collect()
}

#[test]
fn the_page_of_samples_names_every_test() {
    let root = lockstep2d_tests::root();
    let mut written = BTreeSet::new();
    for entry in std::fs::read_dir(root.join("tests/samples")).expect("this folder") {
        let path = entry.expect("readable").path();
        let module = path.file_stem().and_then(|stem| stem.to_str()).expect("a name");
        if module != "table" {
            written.extend(tests_of(module, &std::fs::read_to_string(&path).expect("readable")));
        }
    }
    let page = std::fs::read_to_string(root.join("docs/SAMPLES.md")).expect("readable");
    assert!(written.len() > 100, "{} tests", written.len());
    assert_eq!(named(&page), written);
}

#[test]
fn a_missing_name_is_noticed() {
    assert_eq!(tests_of("a", "#[test]\nfn b() {}\n\nfn c() {}\n"), ["a::b"]);
    assert_eq!(named("| `a::b`, `World::save` |"), BTreeSet::from(["a::b".to_owned()]));
}
