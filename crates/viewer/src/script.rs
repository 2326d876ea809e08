//! [`Script`]: user input from a text file.
//!
//! One instruction per line. Empty lines and lines that start with `#` are ignored.
//!
//! | instruction | effect |
//! |---|---|
//! | `press KEY`, `release KEY` | presses or releases a key |
//! | `key KEY` | presses and releases a key |
//! | `move X Y` | moves the pointer to a position, in the units of [`Event::Moved`] |
//! | `down BUTTON`, `up BUTTON` | presses or releases a pointer button: `left`, `middle`, `right` |
//! | `click X Y` | moves the pointer and clicks with the left button |
//! | `wheel NOTCHES` | turns the wheel by this number of notches; positive: away from the user |
//! | `drop PATH` | drops a file on the window |
//! | `frames COUNT` | runs this number of frames of 1/60 s each |
//! | `screenshot PATH` | writes the current picture to a PNG file |
//! | `report` | prints a line with the name, tick, hash and status of what is shown |
//! | `quit` | ends the program |
//!
//! A key is a character, or `space`, `left`, `right`, `up`, `down`, `home`, `end`, `pageup`, `pagedown`, `enter`,
//! `escape`, `delete`, `tab`, `shift` or `control`.

use std::fmt;
use std::str::FromStr;
use std::time::Duration;

use crate::event::{Button, Event, Key};

/// Duration of a frame in a script: 1/60 s.
pub const FRAME: Duration = Duration::from_nanos(16_666_667);

/// Maximum number of frames of a `frames` instruction: one hour at 60 frames a second.
const FRAMES_MAX: u32 = 216_000;

/// Instructions that replace user input.
///
/// ```
/// use lockstep2d_viewer::script::{Script, ScriptError, ScriptFlaw, Step};
///
/// let script = Script::parse("key space\nframes 60\nscreenshot after.png\nquit")?;
/// assert_eq!(script.steps()[2..], [Step::Frames(60), Step::Screenshot("after.png".into()), Step::Quit]);
///
/// let error = ScriptError { line: 2, flaw: ScriptFlaw::UnknownInstruction("frame".into()) };
/// assert_eq!(Script::parse("quit\nframe 60"), Err(error.clone()));
/// assert_eq!(error.to_string(), "line 2: there is no instruction \"frame\"");
/// # Ok::<(), ScriptError>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Script {
    steps: Vec<Step>,
}

/// Instruction of a script.
#[derive(Clone, Debug, PartialEq)]
pub enum Step {
    /// Sends an event to the viewer.
    Event(Event),
    /// Drops this file on the window.
    Drop(String),
    /// Runs this number of frames, [`FRAME`] each.
    Frames(u32),
    /// Writes a picture to this file.
    Screenshot(String),
    /// Prints a line with the name, tick, hash and status of what is shown.
    Report,
    /// Ends the program.
    Quit,
}

impl Script {
    /// Reads a script.
    ///
    /// # Errors
    /// [`ScriptError`] for the first line that is not a valid instruction.
    pub fn parse(text: &str) -> Result<Self, ScriptError> {
        let mut steps = Vec::new();
        for (at, line) in text.lines().enumerate() {
            let line = line.trim();
            if !line.is_empty() && !line.starts_with('#') {
                instruction(line, &mut steps).map_err(|flaw| ScriptError { line: at + 1, flaw })?;
            }
        }
        Ok(Script { steps })
    }

    /// Instructions, in the order in which they run.
    #[must_use]
    pub fn steps(&self) -> &[Step] {
        &self.steps
    }
}

impl FromStr for Script {
    type Err = ScriptError;

    fn from_str(text: &str) -> Result<Self, ScriptError> {
        Script::parse(text)
    }
}

/// Error in a script.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ScriptError {
    /// Line number, counted from 1.
    pub line: usize,
    /// Cause of the error.
    pub flaw: ScriptFlaw,
}

/// Cause of an error in a script.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ScriptFlaw {
    /// Unknown instruction.
    UnknownInstruction(String),
    /// Wrong number of arguments; this number was expected.
    WrongCount(usize),
    /// Unknown key.
    UnknownKey(String),
    /// Unknown button.
    UnknownButton(String),
    /// Not a number, or a number out of range.
    NotANumber(String),
}

impl fmt::Display for ScriptError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "line {}: {}", self.line, self.flaw)
    }
}

impl fmt::Display for ScriptFlaw {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            ScriptFlaw::UnknownInstruction(word) => write!(f, "there is no instruction {word:?}"),
            ScriptFlaw::WrongCount(count) => write!(f, "the instruction takes {count} arguments"),
            ScriptFlaw::UnknownKey(word) => write!(f, "there is no key {word:?}"),
            ScriptFlaw::UnknownButton(word) => write!(f, "there is no button {word:?}"),
            ScriptFlaw::NotANumber(word) => write!(f, "{word:?} is not a number or out of range"),
        }
    }
}

impl std::error::Error for ScriptError {}

fn instruction(line: &str, steps: &mut Vec<Step>) -> Result<(), ScriptFlaw> {
    let (word, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
    let rest = rest.trim();
    match word {
        "press" => steps.push(Step::Event(Event::Pressed(key(one(rest)?)?))),
        "release" => steps.push(Step::Event(Event::Released(key(one(rest)?)?))),
        "key" => {
            let key = key(one(rest)?)?;
            steps.extend([Event::Pressed(key), Event::Released(key)].map(Step::Event));
        }
        "move" => steps.push(Step::Event(Event::Moved(point(rest)?))),
        "down" => steps.push(Step::Event(Event::Down(button(one(rest)?)?))),
        "up" => steps.push(Step::Event(Event::Up(button(one(rest)?)?))),
        "click" => {
            let click = [Event::Moved(point(rest)?), Event::Down(Button::Left), Event::Up(Button::Left)];
            steps.extend(click.map(Step::Event));
        }
        "wheel" => steps.push(Step::Event(Event::Wheel(coordinate(one(rest)?)?))),
        "drop" => steps.push(Step::Drop(path(rest)?)),
        "frames" => steps.push(Step::Frames(frames(one(rest)?)?)),
        "screenshot" => steps.push(Step::Screenshot(path(rest)?)),
        "report" => steps.push(none(rest, Step::Report)?),
        "quit" => steps.push(none(rest, Step::Quit)?),
        _ => return Err(ScriptFlaw::UnknownInstruction(word.to_owned())),
    }
    Ok(())
}

fn none(rest: &str, step: Step) -> Result<Step, ScriptFlaw> {
    if rest.is_empty() { Ok(step) } else { Err(ScriptFlaw::WrongCount(0)) }
}

fn one(rest: &str) -> Result<&str, ScriptFlaw> {
    let is_one = !rest.is_empty() && !rest.contains(char::is_whitespace);
    if is_one { Ok(rest) } else { Err(ScriptFlaw::WrongCount(1)) }
}

/// Path, which may contain spaces.
fn path(rest: &str) -> Result<String, ScriptFlaw> {
    if rest.is_empty() { Err(ScriptFlaw::WrongCount(1)) } else { Ok(rest.to_owned()) }
}

fn point(rest: &str) -> Result<[f32; 2], ScriptFlaw> {
    let mut words = rest.split_whitespace();
    let (Some(x), Some(y), None) = (words.next(), words.next(), words.next()) else {
        return Err(ScriptFlaw::WrongCount(2));
    };
    Ok([coordinate(x)?, coordinate(y)?])
}

fn coordinate(word: &str) -> Result<f32, ScriptFlaw> {
    let number = word.parse().ok().filter(|number: &f32| number.abs() <= 1e6);
    number.ok_or_else(|| ScriptFlaw::NotANumber(word.to_owned()))
}

fn frames(word: &str) -> Result<u32, ScriptFlaw> {
    let number = word.parse().ok().filter(|&number| number <= FRAMES_MAX);
    number.ok_or_else(|| ScriptFlaw::NotANumber(word.to_owned()))
}

fn button(word: &str) -> Result<Button, ScriptFlaw> {
    match word {
        "left" => Ok(Button::Left),
        "middle" => Ok(Button::Middle),
        "right" => Ok(Button::Right),
        _ => Err(ScriptFlaw::UnknownButton(word.to_owned())),
    }
}

fn key(word: &str) -> Result<Key, ScriptFlaw> {
    let mut characters = word.chars();
    if let (Some(character), None) = (characters.next(), characters.next()) {
        return Ok(Key::Character(character.to_ascii_lowercase()));
    }
    match word {
        "space" => Ok(Key::Space),
        "left" => Ok(Key::Left),
        "right" => Ok(Key::Right),
        "up" => Ok(Key::Up),
        "down" => Ok(Key::Down),
        "home" => Ok(Key::Home),
        "end" => Ok(Key::End),
        "pageup" => Ok(Key::PageUp),
        "pagedown" => Ok(Key::PageDown),
        "enter" => Ok(Key::Enter),
        "escape" => Ok(Key::Escape),
        "delete" => Ok(Key::Delete),
        "tab" => Ok(Key::Tab),
        "shift" => Ok(Key::Shift),
        "control" => Ok(Key::Control),
        _ => Err(ScriptFlaw::UnknownKey(word.to_owned())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_instruction() {
        let text = "# a comment\n\n  key space\npress A\nrelease pageup\nmove 10.5 -3\ndown right\nup middle\n\
                    click 1 2\nwheel -2\ndrop a file.replay\nframes 10\nscreenshot out/a b.png\nreport\nquit\n";
        let event = |event| Step::Event(event);
        let expected = vec![
            event(Event::Pressed(Key::Space)),
            event(Event::Released(Key::Space)),
            event(Event::Pressed(Key::Character('a'))),
            event(Event::Released(Key::PageUp)),
            event(Event::Moved([10.5, -3.0])),
            event(Event::Down(Button::Right)),
            event(Event::Up(Button::Middle)),
            event(Event::Moved([1.0, 2.0])),
            event(Event::Down(Button::Left)),
            event(Event::Up(Button::Left)),
            event(Event::Wheel(-2.0)),
            Step::Drop("a file.replay".to_owned()),
            Step::Frames(10),
            Step::Screenshot("out/a b.png".to_owned()),
            Step::Report,
            Step::Quit,
        ];
        assert_eq!(Script::parse(text), Ok(Script { steps: expected }));
        assert_eq!(Script::parse(""), Ok(Script::default()));
    }

    #[test]
    fn every_flaw_and_its_line() {
        let word = str::to_owned;
        let flaws = [
            ("jump 3", ScriptFlaw::UnknownInstruction(word("jump"))),
            ("key", ScriptFlaw::WrongCount(1)),
            ("key a b", ScriptFlaw::WrongCount(1)),
            ("move 1", ScriptFlaw::WrongCount(2)),
            ("click 1 2 3", ScriptFlaw::WrongCount(2)),
            ("report now", ScriptFlaw::WrongCount(0)),
            ("drop", ScriptFlaw::WrongCount(1)),
            ("press any", ScriptFlaw::UnknownKey(word("any"))),
            ("down under", ScriptFlaw::UnknownButton(word("under"))),
            ("move 1 NaN", ScriptFlaw::NotANumber(word("NaN"))),
            ("wheel 1e9", ScriptFlaw::NotANumber(word("1e9"))),
            ("frames -1", ScriptFlaw::NotANumber(word("-1"))),
            ("frames 1000000", ScriptFlaw::NotANumber(word("1000000"))),
        ];
        for (line, flaw) in flaws {
            let text = format!("report\n\n{line}\nquit");
            assert_eq!(Script::parse(&text), Err(ScriptError { line: 3, flaw }), "{line}");
        }
    }

    #[test]
    fn every_key_has_a_name() {
        let names =
            "space left right up down home end pageup pagedown enter escape delete tab shift control a 7 [";
        let keys: Vec<_> = names.split(' ').map(key).collect();
        assert!(keys.iter().all(Result::is_ok));
        for (at, key) in keys.iter().enumerate() {
            assert!(!keys[..at].contains(key), "{key:?}");
        }
    }
}
