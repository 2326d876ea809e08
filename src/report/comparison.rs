//! [`Comparison`]: what two files tell together.

use alloc::string::String;
use alloc::vec::Vec;
use core::fmt;

use super::desync::Group;
use super::stage::Stage;
use crate::inspect::Difference;

/// One of two files.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Side {
    /// The first.
    A,
    /// The second.
    B,
}

impl Side {
    /// Both, in order.
    pub const BOTH: [Side; 2] = [Side::A, Side::B];

    /// 0 or 1.
    #[must_use]
    pub const fn index(self) -> usize {
        match self {
            Side::A => 0,
            Side::B => 1,
        }
    }
}

impl fmt::Display for Side {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Side::A => "A",
            Side::B => "B",
        })
    }
}

/// Who left the course that the setup and the inputs lead to on the running engine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Blame {
    /// Nobody has.
    Nobody,
    /// One side has, the other has not.
    Side(Side),
    /// Both have: if they agree with each other, this engine or these rules are not theirs.
    Both,
    /// It cannot be known: there are no inputs to play again, or they are not the same.
    Unknown,
}

/// How one side compares with the rerun of the inputs.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Course {
    /// The seats that this side plays, as its report says.
    pub seats: Vec<u32>,
    /// The last tick before it departs, or of all, at which its state is known to be that of the rerun.
    pub equal_until: Option<u64>,
    /// The first tick at which its state is known not to be that of the rerun.
    pub departs: Option<u64>,
}

/// The first input in which two replays differ.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct InputDifference {
    /// After how many ticks: the input is that of the next one.
    pub tick: u64,
    /// Whose.
    pub seat: u32,
    /// How it differs.
    pub differences: Vec<Difference>,
}

/// Something that two states do not have in common or that differs in them: a body, a contact, an entry of any map, or a
/// section that has none.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Thing {
    /// Where it is, such as `world.bodies.body 12v1`.
    pub path: String,
    /// The section that it is in, such as `world.bodies`.
    pub section: String,
    /// How it differs.
    pub differences: Vec<Difference>,
}

/// One flipped bit between two ticks, with which the rules lead exactly to what the side to blame has.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Explanation {
    /// After how many ticks it flipped.
    pub tick: u64,
    /// The path of the body.
    pub path: String,
    /// The number of the bit, from the lowest.
    pub bit: u32,
    /// What that changed then: first the number that the bit is in. A is what it was and B what it became.
    pub differences: Vec<Difference>,
}

/// What two reports, replays or snapshots tell together.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Comparison {
    /// The last tick before the first difference, or of all, at which both states are known to be the same.
    pub last_equal: Option<u64>,
    /// The first tick at which the states are known to differ.
    pub first_different: Option<u64>,
    /// How the setups differ; if they do, [`compare`](super::compare) compares nothing else.
    pub setup: Vec<Difference>,
    /// The first input that differs. [`compare`](super::compare) compares states up to there.
    pub input: Option<InputDifference>,
    /// How A and B compare with the rerun.
    pub courses: [Course; 2],
    /// How many ticks of the inputs were played again.
    pub rerun: Option<u64>,
    /// Who departed.
    pub blame: Blame,
    /// At which tick `things` were compared: the first at which both states can be had.
    pub tick: Option<u64>,
    /// What differs in the states: what is to blame for it first, if that is known, then the bodies whose motion differs
    /// most.
    pub things: Vec<Thing>,
    /// In which part of the tick that led to `first_different` the states parted.
    pub stage: Option<Stage>,
    /// If they parted before the step of the world: what differed when it began. B is the side to blame, A the rerun.
    pub began: Vec<Thing>,
    /// What explains all of it.
    pub explanation: Option<Explanation>,
    /// The checkpoint that a report was written for.
    pub checkpoint: Option<u64>,
    /// Which seats agree there, the largest group first.
    pub groups: Vec<Group>,
    /// What could not be found out, and why.
    pub notes: Vec<String>,
}

impl Comparison {
    pub(super) fn new() -> Self {
        Comparison {
            last_equal: None,
            first_different: None,
            setup: Vec::new(),
            input: None,
            courses: Default::default(),
            rerun: None,
            blame: Blame::Unknown,
            tick: None,
            things: Vec::new(),
            stage: None,
            began: Vec::new(),
            explanation: None,
            checkpoint: None,
            groups: Vec::new(),
            notes: Vec::new(),
        }
    }

    /// Whether nothing differs, as far as both go.
    #[must_use]
    pub fn is_equal(&self) -> bool {
        self.setup.is_empty()
            && self.input.is_none()
            && self.first_different.is_none()
            && self.things.is_empty()
            && self.courses.iter().all(|course| course.departs.is_none())
    }

    /// The sections in which the states differ, in order.
    #[must_use]
    pub fn sections(&self) -> Vec<&str> {
        let mut sections: Vec<&str> = Vec::new();
        for thing in &self.things {
            if !sections.contains(&thing.section.as_str()) {
                sections.push(&thing.section);
            }
        }
        sections
    }
}
