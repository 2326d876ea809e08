//! Rules that no lint checks, each with a canary that violates it.

mod source;

use source::{Source, Token, files, tokens};

/// Largest number of lines of a file. A longer file has more than one subject.
const LINES_MAX: usize = 400;

/// Words that the library may not use, and why.
const BANNED: &[(&str, &str)] = &[
    ("f32", "floating point differs between machines"),
    ("f64", "floating point differs between machines"),
    ("HashMap", "its iteration order is random"),
    ("HashSet", "its iteration order is random"),
    ("Instant", "time is a parameter"),
    ("SystemTime", "time is a parameter"),
    ("unsafe", "only SIMD code needs it"),
    ("todo", "finish it"),
    ("unimplemented", "finish it"),
    ("dbg", "a library does not print"),
    ("print", "a library does not print"),
    ("println", "a library does not print"),
    ("eprint", "a library does not print"),
    ("eprintln", "a library does not print"),
];

const FLOATS: &[&str] = &["f32", "f64"];
/// Folders that may use floats: drawing is not simulation, and a serializer must implement methods for floats.
const ALLOWED_FLOATS: &[&str] = &["src/draw/", "src/inspect/serializer.rs"];

/// File that may read the clock, to measure whether ticks take less time on one thread or on all.
const ALLOWED_CLOCK: &str = "src/threads/team.rs";

/// Files that may use `unsafe`: for SIMD instructions, prefetches, and data shared between threads.
const ALLOWED_UNSAFE: &[&str] = &[
    "src/simd/x86.rs",
    "src/simd/x86/avx2.rs",
    "src/simd/x86/avx2/rows.rs",
    "src/simd/x86/avx512.rs",
    "src/simd/x86/avx512/division.rs",
    "src/simd/x86/records.rs",
    "src/simd/neon.rs",
    "src/simd/simd128.rs",
    "src/simd/prefetch.rs",
    "src/simd/shared.rs",
];

/// Comment that gives the reason for an `unsafe`.
const REASON: &str = "// SAFETY: ";
/// Largest distance in lines from this comment down to the `unsafe`.
const REASON_ABOVE: usize = 3;

const STATE_FOLDERS: &[&str] = &["src/body/", "src/collision/", "src/simd/", "src/solver/", "src/world/"];

/// Top-level folders in paths that exist on one machine only.
const MACHINE_FOLDERS: &[&str] = &["home", "root", "Users", "tmp", "mnt", "opt", "srv", "var", "work"];

fn fails(files: &[Source], rule: impl Fn(&Source) -> Vec<String>) -> Vec<String> {
    let named = |file: &Source| rule(file).into_iter().map(|what| format!("{}:{what}", file.path)).collect();
    files.iter().flat_map::<Vec<String>, _>(named).collect()
}

fn check(files: &[Source], rule: impl Fn(&Source) -> Vec<String>) {
    assert!(!files.is_empty(), "expected files to check");
    let wrong = fails(files, rule);
    assert!(wrong.is_empty(), "\n{}", wrong.join("\n"));
}

fn canary(path: &str, text: &str, rule: impl Fn(&Source) -> Vec<String>) -> usize {
    fails(&[Source { path: path.into(), text: text.into() }], rule).len()
}

fn too_long(file: &Source) -> Vec<String> {
    let lines = file.text.lines().count();
    if lines > LINES_MAX { vec![format!("{lines}: at most {LINES_MAX} lines")] } else { Vec::new() }
}

fn banned_words(file: &Source) -> Vec<String> {
    let allowed: &[&str] =
        if ALLOWED_FLOATS.iter().any(|path| file.path.starts_with(path)) { FLOATS } else { &[] };
    let why = |token: &Token| {
        let (word, why) = BANNED.iter().find(|(word, _)| *word == token.text)?;
        let allowed = match *word {
            "unsafe" => may_be_unsafe(file),
            "Instant" => file.path == ALLOWED_CLOCK,
            word => allowed.contains(&word),
        };
        (!allowed).then(|| format!("{}: {word}: {why}", token.line))
    };
    tokens(&file.text).iter().filter_map(why).collect()
}

fn may_be_unsafe(file: &Source) -> bool {
    ALLOWED_UNSAFE.contains(&file.path.as_str())
}

/// Uses of `unsafe` without a reason. An `unsafe fn` needs no reason, because its callers give it.
fn unexplained_unsafe(file: &Source) -> Vec<String> {
    let lines: Vec<_> = file.text.lines().collect();
    let explained = |line: usize| {
        lines[line.saturating_sub(1 + REASON_ABOVE)..line].iter().any(|text| text.contains(REASON))
    };
    let tokens = tokens(&file.text);
    let uses = tokens.windows(2).filter(|pair| pair[0].text == "unsafe" && pair[1].text != "fn");
    let wrong = uses.filter(|pair| !explained(pair[0].line));
    wrong.map(|pair| format!("{}: unsafe without a reason", pair[0].line)).collect()
}

/// Uses of `usize` and `isize`, whose width depends on the machine, in types that derive `Serialize`.
fn machine_width_in_state(file: &Source) -> Vec<String> {
    let tokens = tokens(&file.text);
    let mut wrong = Vec::new();
    for at in 0..tokens.len() {
        if tokens[at].text != "derive" {
            continue;
        }
        let is = |word: &'static str| move |token: &&Token| token.text == word;
        let list = tokens[at..].iter().take_while(|token| token.text != ")");
        if list.filter(is("Serialize")).count() == 0 {
            continue;
        }
        // The item ends with its closing brace, or with a semicolon.
        let mut depth = 0;
        let item = tokens[at..].iter().skip_while(|token| token.text != "]").skip(1).take_while(|token| {
            depth += i32::from(matches!(token.text.as_str(), "{" | "(" | "["));
            depth -= i32::from(matches!(token.text.as_str(), "}" | ")" | "]"));
            depth > 0 || !matches!(token.text.as_str(), "}" | ";")
        });
        let sized = item.filter(|token| matches!(token.text.as_str(), "usize" | "isize"));
        wrong.extend(sized.map(|token| format!("{}: {} in encoded state", token.line, token.text)));
    }
    wrong
}

fn machine_paths(file: &Source) -> Vec<String> {
    let mut wrong = Vec::new();
    for (line, text) in (1..).zip(file.text.lines()) {
        for folder in MACHINE_FOLDERS {
            let path = format!("/{folder}/");
            let starts =
                |at: usize| !text[..at].ends_with(|c: char| c.is_alphanumeric() || "._-/}*".contains(c));
            if text.match_indices(&path).any(|(at, _)| starts(at)) {
                wrong.push(format!("{line}: a path that depends on the machine, {path}"));
            }
        }
    }
    wrong
}

#[test]
fn files_are_short() {
    for folder in ["src", "crates/cli", "crates/render", "crates/scenes", "games", "tests"] {
        check(&files(folder, &["rs"]), too_long);
    }
    assert_eq!(canary("src/a.rs", &"\n".repeat(LINES_MAX), too_long), 0);
    assert_eq!(canary("src/a.rs", &"\n".repeat(LINES_MAX + 1), too_long), 1);
}

#[test]
fn nothing_in_the_library_or_the_scenes_differs_between_machines_or_prints() {
    for folder in ["src", "crates/scenes"] {
        check(&files(folder, &["rs"]), banned_words);
    }
    assert_eq!(
        canary("src/a.rs", "let x: f32 = 0.5;\nlet m = std::collections::HashMap::new();", banned_words),
        2
    );
    assert_eq!(
        canary("src/a.rs", "// an f32, unsafe\n/* f64 /* f64 */ f64 */ let s = \"f64\";", banned_words),
        0
    );
    assert_eq!(canary("src/a.rs", "unsafe { dbg!(1) }", banned_words), 2);
    assert_eq!(canary("src/draw/svg.rs", "fn f(x: f64) { println!() }", banned_words), 1);
}

#[test]
fn unsafe_is_where_it_may_be_and_says_why() {
    let files = files("src", &["rs"]);
    check(&files, unexplained_unsafe);
    for path in ALLOWED_UNSAFE {
        let file = files.iter().find(|file| file.path == *path).expect("a file of the list");
        assert!(
            tokens(&file.text).iter().any(|token| token.text == "unsafe"),
            "{path} no longer needs unsafe"
        );
    }
    let path = ALLOWED_UNSAFE[0];
    assert_eq!(canary(path, "unsafe { a() }", banned_words), 0);
    assert_eq!(canary("src/simd/mod.rs", "unsafe { a() }", banned_words), 1);
    assert_eq!(canary(path, "unsafe { a() }", unexplained_unsafe), 1);
    assert_eq!(canary(path, "// SAFETY: there.\nunsafe { a() }", unexplained_unsafe), 0);
    assert_eq!(canary(path, "// SAFETY: there.\n\n\n\nunsafe { a() }", unexplained_unsafe), 1);
    assert_eq!(canary(path, "unsafe fn f() {}", unexplained_unsafe), 0);
}

#[test]
fn state_has_the_same_width_everywhere() {
    let state = files("src", &["rs"]).into_iter();
    let state: Vec<_> =
        state.filter(|file| STATE_FOLDERS.iter().any(|folder| file.path.starts_with(folder))).collect();
    check(&state, machine_width_in_state);
    let derived = "#[derive(Clone, Serialize)]\npub struct A<'a> {\n  b: &'a [u8],\n  c: [usize; 2],\n}";
    assert_eq!(canary("src/body/a.rs", derived, machine_width_in_state), 1);
    assert_eq!(
        canary("src/body/a.rs", "#[derive(Serialize)] struct A([u8; 2], usize);", machine_width_in_state),
        1
    );
    let other =
        "#[derive(Serialize)] struct A { b: u8 }\n#[derive(Clone)] struct B { c: usize }\nfn f(n: usize) {}";
    assert_eq!(canary("src/body/a.rs", other, machine_width_in_state), 0);
}

#[test]
fn nothing_names_a_folder_of_one_machine() {
    for folder in ["src", "crates/cli", "crates/render", "games", "tests", "docs", ".ci"] {
        check(&files(folder, &["rs", "toml", "md", ""]), machine_paths);
    }
    let path = |folder: &str| format!("read(\"/{folder}/me/a.replay\")");
    assert_eq!(canary("src/a.rs", &path("home"), machine_paths), 1);
    assert_eq!(canary("docs/A.md", "replays/home/a and https://example.org/home/", machine_paths), 0);
}
