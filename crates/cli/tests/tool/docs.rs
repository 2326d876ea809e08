//! The console examples of `docs/REPLAYS.md` are run and print what the page shows.

use std::path::Path;
use std::process::Command;

use crate::Folder;

/// A shell command and its expected output. A line `...` stands for any number of lines.
struct Example {
    line: String,
    output: Vec<String>,
}

fn examples(text: &str) -> Vec<Example> {
    let mut examples: Vec<Example> = Vec::new();
    let mut is_inside = false;
    for line in text.lines() {
        if line.starts_with("```") {
            is_inside = line == "```console";
        } else if let Some(line) = line.strip_prefix("$ ").filter(|_| is_inside) {
            examples.push(Example { line: line.into(), output: Vec::new() });
        } else if is_inside {
            examples.last_mut().unwrap().output.push(line.into());
        }
    }
    examples
}

/// Whether `lines` match the expected output.
fn fits(expected: &[String], lines: &[&str]) -> bool {
    match expected.split_first() {
        None => lines.is_empty(),
        Some((first, rest)) if first == "..." => (0..=lines.len()).any(|skip| fits(rest, &lines[skip..])),
        Some((first, rest)) => lines.first() == Some(&first.as_str()) && fits(rest, &lines[1..]),
    }
}

#[test]
fn elisions_stand_for_any_lines() {
    let lines = |text: &str| text.split(' ').map(String::from).collect::<Vec<_>>();
    for (expected, found, fit) in
        [("a b", "a b", true), ("a b", "a", false), ("a ... d", "a b c d", true), ("... b", "a b c", false)]
    {
        assert_eq!(fits(&lines(expected), &found.split(' ').collect::<Vec<_>>()), fit, "{expected}, {found}");
    }
}

#[cfg(unix)]
#[test]
fn the_documentation_shows_what_is_printed() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let text = std::fs::read_to_string(root.join("docs/REPLAYS.md")).unwrap();
    let folder = Folder::new("docs");
    for link in ["replays", "games"] {
        std::os::unix::fs::symlink(root.join(link).canonicalize().unwrap(), folder.path(link)).unwrap();
    }
    let tool = Path::new(env!("CARGO_BIN_EXE_lockstep2d")).parent().unwrap().display();
    let path = format!("{tool}:{}", std::env::var("PATH").unwrap());
    let examples = examples(&text);
    assert!(examples.len() > 15, "only {} examples were found", examples.len());
    for Example { line, output } in examples {
        let done = Command::new("sh")
            .args(["-c", &format!("{line} 2>&1")])
            .current_dir(folder.path(""))
            .env("PATH", &path)
            .output()
            .unwrap();
        let found = String::from_utf8(done.stdout).unwrap();
        let lines: Vec<&str> = found.lines().collect();
        assert!(
            fits(&output, &lines),
            "$ {line}\n{found}\nis not what docs/REPLAYS.md has:\n{}",
            output.join("\n")
        );
    }
}
