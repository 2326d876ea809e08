//! A comparison as readable text.

use std::fmt;
use std::path::Path;

use lockstep2d::inspect::Difference;
use lockstep2d::report::{Blame, Comparison, Group, Side, Subject, Trajectory};

use crate::console::{BAD, DOUBTFUL, GOOD};
use crate::files::{OneLine, Shown};

/// A comparison, printed with the differing fields of at most `subjects` parts of the state.
pub(super) struct Text<'a> {
    pub(super) found: &'a Comparison,
    pub(super) sides: [&'a Path; 2],
    pub(super) subjects: usize,
}

impl fmt::Display for Text<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.heads(f)?;
        self.verdict(f)?;
        if let Some(stage) = self.found.stage {
            write!(f, ", {stage}")?;
        }
        self.who(f)?;
        self.inputs(f)?;
        self.began(f)?;
        self.what(f)?;
        self.found
            .notes
            .iter()
            .try_for_each(|note| write!(f, "\n{DOUBTFUL}note:{DOUBTFUL:#} {}", OneLine(note)))
    }
}

impl Text<'_> {
    fn heads(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (side, trajectory) in Side::BOTH.into_iter().zip(&self.found.trajectories) {
            writeln!(f, "{side}: {}{}", Shown(self.sides[side.index()]), Seats(trajectory))?;
        }
        Ok(())
    }

    fn verdict(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let found = self.found;
        match (found.last_equal, found.first_different) {
            _ if found.is_equal() => {
                write!(f, "{GOOD}equal{GOOD:#}")?;
                found.last_equal.map_or(Ok(()), |tick| write!(f, " up to tick {tick}"))
            }
            _ if !found.setup.is_empty() => write!(f, "{BAD}different{BAD:#} from the setup on"),
            (Some(last), Some(first)) => {
                write!(f, "{BAD}different{BAD:#} at tick {first}, equal at tick {last}")
            }
            (None, Some(first)) => write!(f, "{BAD}different{BAD:#} at tick {first}"),
            (Some(last), None) => write!(f, "{BAD}different{BAD:#}, equal states up to tick {last}"),
            (None, None) => write!(f, "{BAD}different{BAD:#}"),
        }
    }

    fn who(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let found = self.found;
        if let Some(tick) = found.checkpoint.filter(|_| found.groups.len() > 1) {
            for Group { hash, seats } in &found.groups {
                write!(f, "\nat tick {tick} {} {} {hash}", SeatList(seats), has(seats))?;
            }
        }
        match (found.simulated, found.blame) {
            (None, _) | (_, Blame::Unknown) => {}
            (Some(until), Blame::Nobody) => {
                write!(f, "\nplayed again up to tick {until}: both kept to the rules")?;
                if !found.claims.is_empty() {
                    write!(f, ", so `verify` tells which claims are true")?;
                }
            }
            (Some(until), Blame::Side(side)) => {
                let trajectory = &found.trajectories[side.index()];
                write!(
                    f,
                    "\nplayed again up to tick {until}: {BAD}{side} diverged{BAD:#}{}",
                    Seats(trajectory)
                )?;
                trajectory.diverges.map_or(Ok(()), |tick| write!(f, " at tick {tick}"))?;
            }
            (Some(until), Blame::Both) => {
                let [a, b] = [0, 1].map(|side: usize| found.trajectories[side].diverges.unwrap_or_default());
                write!(
                    f,
                    "\nplayed again up to tick {until}: {BAD}both diverged{BAD:#}, A at tick {a}, B at tick {b}; check \
                     that both were made with these rules and this engine, and that the rules use no floats and no random \
                     order, such as that of a HashMap"
                )?;
            }
        }
        let Some(explanation) = &found.explanation else {
            return Ok(());
        };
        let (tick, bit, path) = (explanation.tick, explanation.bit, OneLine(&explanation.path));
        write!(f, "\nexplained by bit {bit} of a number of {path}, flipped after tick {tick}:")?;
        explanation
            .differences
            .iter()
            .try_for_each(|difference| write!(f, "\n    {}", Line(difference.field().name(), difference)))
    }

    fn inputs(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if !self.found.setup.is_empty() {
            write!(f, "\nsetup")?;
            self.lines(&self.found.setup, f)?;
        }
        if !self.found.claims.is_empty() {
            write!(f, "\n{BAD}other claims{BAD:#}")?;
            self.lines(&self.found.claims, f)?;
        }
        if let Some([a, b]) = self.found.lengths {
            write!(f, "\n{BAD}other lengths{BAD:#}: A ends after tick {a}, B after tick {b}")?;
        }
        let Some(input) = &self.found.input else {
            return Ok(());
        };
        write!(f, "\n{BAD}other inputs{BAD:#}: after tick {}, of seat {}", input.tick, input.seat)?;
        self.lines(&input.differences, f)
    }

    /// Prints at most `subjects` fields, and the number of the fields that are left out.
    fn lines(&self, differences: &[Difference], f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut shown = differences.iter().take(self.subjects);
        shown
            .try_for_each(|difference| write!(f, "\n    {}", Line(difference.field().path(), difference)))?;
        let count = differences.len();
        match count.saturating_sub(self.subjects) {
            0 => Ok(()),
            more => write!(f, "\n    and {more} more (--subjects {count})"),
        }
    }

    fn what(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let found = self.found;
        if found.subjects.is_empty() {
            return Ok(());
        }
        match found.tick {
            Some(tick) => write!(f, "\nstates after tick {tick}: ")?,
            None => writeln!(f)?,
        }
        self.subjects(&found.subjects, f)
    }

    fn began(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let found = self.found;
        if found.began.is_empty() || found.explanation.is_some() {
            return Ok(());
        }
        write!(f, "\nwhen the step of the world began: ")?;
        self.subjects(&found.began, f)
    }

    fn subjects(&self, subjects: &[Subject], f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut sections: Vec<&str> = subjects.iter().map(|subject| subject.section.as_str()).collect();
        sections.sort_unstable();
        sections.dedup();
        let count = subjects.len();
        let differ = if count == 1 { "subject differs" } else { "subjects differ" };
        write!(f, "{count} {differ} in {}", OneLine(&sections.join(", ")))?;
        for Subject { path, differences, .. } in subjects.iter().take(self.subjects) {
            write!(f, "\n  {}", OneLine(path))?;
            differences.iter().try_for_each(|difference| {
                write!(f, "\n    {}", Line(difference.field().name(), difference))
            })?;
        }
        match count.saturating_sub(self.subjects) {
            0 => Ok(()),
            more => write!(f, "\n  and {more} more (--subjects {count})"),
        }
    }
}

/// Name and values of a field.
struct Line<'a>(&'a str, &'a Difference);

impl fmt::Display for Line<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Line(name, difference) = self;
        let value = |value: &Option<_>| match value {
            Some(value) => format!("{value}"),
            None => "nothing".into(),
        };
        let name = if name.is_empty() { "value" } else { name };
        // The texts may come from an untrusted file, so they are escaped.
        let text = format!("{name}: {} | {}", value(&difference.a), value(&difference.b));
        write!(f, "{}", OneLine(&text))
    }
}

struct Seats<'a>(&'a Trajectory);

impl fmt::Display for Seats<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.0.seats.is_empty() { Ok(()) } else { write!(f, " ({})", SeatList(&self.0.seats)) }
    }
}

struct SeatList<'a>(&'a [u32]);

impl fmt::Display for SeatList<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let numbers: Vec<String> = self.0.iter().map(u32::to_string).collect();
        write!(f, "{} {}", if numbers.len() == 1 { "seat" } else { "seats" }, numbers.join(", "))
    }
}

fn has(seats: &[u32]) -> &'static str {
    if seats.len() == 1 { "has" } else { "have" }
}
