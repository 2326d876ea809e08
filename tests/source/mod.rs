//! Source files as tokens, for tests that check rules of the code base.

use std::fs;
use std::path::{Path, PathBuf};

pub(crate) struct Source {
    /// Relative to the root of the repository, with `/` on every system.
    pub(crate) path: String,
    pub(crate) text: String,
}

/// A word or a punctuation mark.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Token {
    pub(crate) text: String,
    pub(crate) line: usize,
}

/// Files below a folder that have one of these extensions (`""` for no extension), sorted by path.
pub(crate) fn files(folder: &str, extensions: &[&str]) -> Vec<Source> {
    let root = &lockstep2d_tests::root();
    let mut paths = Vec::new();
    collect(&root.join(folder), extensions, &mut paths);
    paths.sort();
    let read = |path: PathBuf| {
        let text = fs::read_to_string(&path).expect("source files are UTF-8");
        let parts: Vec<_> = path.strip_prefix(root).expect("below the root").iter().collect();
        let parts: Vec<_> = parts.iter().map(|part| part.to_string_lossy()).collect();
        Source { path: parts.join("/"), text }
    };
    paths.into_iter().map(read).collect()
}

fn collect(folder: &Path, extensions: &[&str], paths: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).expect("a folder of the repository") {
        let path = entry.expect("a readable folder").path();
        if path.is_dir() {
            collect(&path, extensions, paths);
        } else if path
            .extension()
            .map_or(extensions.contains(&""), |found| extensions.iter().any(|wanted| found == *wanted))
        {
            paths.push(path);
        }
    }
}

/// Splits Rust code into words, `::` and single punctuation marks. A quoted literal becomes one token, whose text is
/// only the opening quote. A raw string becomes one token with its whole text. Comments produce no tokens.
pub(crate) fn tokens(code: &str) -> Vec<Token> {
    let mut found = Vec::new();
    let (mut rest, mut line) = (code, 1);
    while let Some(first) = rest.chars().next() {
        let length = token_length(rest, first);
        let (token, after) = rest.split_at(length);
        let text = match first {
            '"' | '\'' if !token.starts_with("'_") => &token[..1],
            _ => token,
        };
        if !(first.is_whitespace() || token.starts_with("//") || token.starts_with("/*")) {
            found.push(Token { text: text.into(), line });
        }
        line += token.matches('\n').count();
        rest = after;
    }
    found
}

fn token_length(rest: &str, first: char) -> usize {
    let is_word = |c: char| c.is_alphanumeric() || c == '_';
    let word = rest.find(|c| !is_word(c)).unwrap_or(rest.len());
    let after_word = &rest[word..];
    match first {
        _ if rest.starts_with("//") => rest.find('\n').unwrap_or(rest.len()),
        _ if rest.starts_with("/*") => block_comment(rest),
        _ if rest.starts_with("::") => 2,
        '"' => 1 + quoted(&rest[1..], '"'),
        '\'' => char_or_lifetime(rest),
        'r' | 'b' if matches!(&rest[..word], "r" | "br") && after_word.starts_with(['"', '#']) => {
            let hashes = after_word.len() - after_word.trim_start_matches('#').len();
            let end = format!("\"{}", &after_word[..hashes]);
            let text = after_word[hashes..].strip_prefix('"').map(|text| text.find(&end));
            // `r#name` is a raw identifier.
            text.map_or(word, |found| word + hashes + 1 + found.expect("the end of a raw string") + end.len())
        }
        _ if is_word(first) => word,
        _ => first.len_utf8(),
    }
}

fn block_comment(rest: &str) -> usize {
    let (mut depth, mut at) = (0, 0);
    while at < rest.len() {
        let bytes = &rest.as_bytes()[at..];
        let step = usize::from(bytes.starts_with(b"/*") || bytes.starts_with(b"*/"));
        depth += usize::from(bytes.starts_with(b"/*"));
        depth -= usize::from(bytes.starts_with(b"*/"));
        at += 1 + step;
        if depth == 0 {
            break;
        }
    }
    at
}

/// Length up to and including the closing quote.
fn quoted(text: &str, quote: char) -> usize {
    let mut escaped = false;
    for (at, c) in text.char_indices() {
        if c == quote && !escaped {
            return at + 1;
        }
        escaped = c == '\\' && !escaped;
    }
    text.len()
}

/// Length of a literal such as `'a'` or `'\n'`, or 1 for the quote of a lifetime.
fn char_or_lifetime(rest: &str) -> usize {
    let mut chars = rest.chars().skip(1);
    match (chars.next(), chars.next()) {
        (Some('\\'), _) | (Some(_), Some('\'')) => 1 + quoted(&rest[1..], '\''),
        _ => 1,
    }
}
