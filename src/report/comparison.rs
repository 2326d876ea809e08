use alloc::string::String;
use alloc::vec::Vec;
use core::fmt;

use super::desync::Group;
use super::stage::Stage;
use crate::inspect::Difference;

/// One of the two files of a comparison.
///
/// ```
/// # use lockstep2d::{lockstep::{Sandbox, SandboxSetup}, replay::{Limits, Recording}};
/// use lockstep2d::report::{Evidence, Side, Trajectory, bisect};
/// # let mut recording = Recording::<Sandbox>::start(&SandboxSetup::default(), 60)?;
/// # (0..120).try_for_each(|_| recording.step(&[vec![]]))?;
/// // Checks whether this machine computes the same states as the machine of the recording.
/// let replay = Evidence::Replay(recording.finish()?);
/// let found = bisect::<Sandbox>(&replay, None, &Limits::default()).expect("it can be played");
/// let Trajectory { equal_until, diverges, .. } = &found.trajectories[Side::A.index()];
/// assert_eq!((*equal_until, *diverges), (Some(120), None));
/// # Ok::<(), lockstep2d::replay::RecordError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Side {
    /// The first file.
    A,
    /// The second file.
    B,
}

impl Side {
    /// Both sides, in order.
    pub const BOTH: [Side; 2] = [Side::A, Side::B];

    /// Index of the side, 0 or 1.
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

/// The side that diverged from the trajectory of the running engine.
///
/// ```
/// use lockstep2d::report::{Blame, Side};
/// /// The next step of a support team.
/// fn next_step(blame: Blame) -> String {
///     match blame {
///         Blame::Nobody => "the files agree".into(),
///         Blame::Side(side) => format!("ask for the machine of file {}", if side == Side::A { 1 } else { 2 }),
///         Blame::Both => "look for another version of the game".into(),
///         Blame::Unknown => "ask for the reports instead of snapshots".into(),
///     }
/// }
/// assert_eq!(next_step(Blame::Side(Side::B)), "ask for the machine of file 2");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Blame {
    /// Neither side diverged.
    Nobody,
    /// One side diverged, the other did not.
    Side(Side),
    /// Both sides diverged. If they agree with each other, they probably used another engine or other rules.
    Both,
    /// There are no inputs to simulate, the setups differ, or [`bisect`](super::bisect) found different inputs.
    Unknown,
}

/// Comparison of one side with the rerun, which is the simulation of the inputs by the running engine.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Trajectory {
    /// The seats that this side plays, according to its report.
    pub seats: Vec<u32>,
    /// The last tick at which this side is known to equal the rerun, before it diverges.
    pub equal_until: Option<u64>,
    /// The first tick at which this side is known to differ from the rerun.
    pub diverges: Option<u64>,
}

/// The first different input of two replays.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct InputDifference {
    /// Tick of the input, counted from 0.
    pub tick: u64,
    /// Seat of the input.
    pub seat: u32,
    /// The fields that differ.
    pub differences: Vec<Difference>,
}

/// A part of the state that differs: a body, a contact, an entry of any map, or a section without entries.
///
/// ```
/// # use lockstep2d::body::{BodyDef, Geometry, ShapeDef};
/// # use lockstep2d::{fx, lockstep::Sandbox, replay::Limits, world::{BodyField, World}};
/// use lockstep2d::report::{Evidence, Subject, compare};
/// # let mut ours = World::default();
/// # let ball = ours.spawn(&BodyDef::dynamic(), &[ShapeDef::new(Geometry::circle(fx!(0.5))?)])?;
/// let mut theirs = ours.clone();
/// theirs.flip_bit(ball, BodyField::VelocityX, 3)?;
/// let [a, b] = [ours, theirs].map(|world| Evidence::World(Box::new(world)));
/// let found = compare::<Sandbox>(&a, &b, &Limits::default()).expect("two worlds");
/// // The subject that differs, and its fields.
/// let Subject { path, differences, .. } = &found.subjects[0];
/// assert!(path.ends_with("body 0v0"), "{path}");
/// assert_eq!(differences[0].field().name(), "velocity.x");
/// # Ok::<(), lockstep2d::body::WorldError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Subject {
    /// Path of the subject, such as `world.bodies.body 12v1`.
    pub path: String,
    /// Section with the subject, such as `world.bodies`.
    pub section: String,
    /// The fields that differ.
    pub differences: Vec<Difference>,
}

/// A single bit flip between two ticks that explains the divergence. In rare cases another flip leads to the same
/// state, such as a flip in the velocity of a rolling ball instead of its spin.
///
/// ```
/// use lockstep2d::report::{Comparison, Explanation, Stage};
/// /// Where to search for the cause.
/// fn place(found: &Comparison) -> String {
///     match (&found.explanation, found.stage) {
///         (Some(Explanation { path, bit, .. }), _) => format!("memory: bit {bit} of {path}"),
///         (None, Some(Stage::BeforeStep | Stage::AfterStep)) => "the rules of the game".into(),
///         (None, Some(Stage::Phase(phase))) => format!("the compiler or the processor, in {phase:?}"),
///         (None, _) => "unknown".into(),
///     }
/// }
/// # use lockstep2d::{lockstep::{Sandbox, SandboxSetup}, replay::{Limits, Recording}};
/// # use lockstep2d::report::{Evidence, bisect};
/// # let file = Recording::<Sandbox>::start(&SandboxSetup::default(), 60)?.finish()?;
/// # let found = bisect::<Sandbox>(&Evidence::Replay(file), None, &Limits::default()).expect("it can be played");
/// assert_eq!(place(&found), "unknown", "nothing differs");
/// # Ok::<(), lockstep2d::replay::RecordError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Explanation {
    /// Number of ticks after which the bit flipped.
    pub tick: u64,
    /// Path of the body or other subject with the bit.
    pub path: String,
    /// Index of the bit, counted from the lowest.
    pub bit: u32,
    /// The changes that the flip causes, starting with the number that has the bit. A is the state before the flip, B
    /// the state after it.
    pub differences: Vec<Difference>,
}

/// Result of comparing two reports, replays or snapshots.
///
/// ```
/// # use lockstep2d::{body::BodyDef, lockstep::{Sandbox, SandboxSetup}, replay::{Limits, Recording}, world::Command};
/// use lockstep2d::report::{Comparison, Evidence, InputDifference, compare};
/// let spawn = Command::Spawn { body: BodyDef::dynamic(), shapes: vec![] };
/// // Two runs of a level, one of them with an additional body.
/// let [a, b] = [vec![], vec![spawn]].map(|commands| {
///     let mut recording = Recording::<Sandbox>::start(&SandboxSetup::default(), 60).expect("a setup");
///     (0..30).for_each(|_| recording.step(&[vec![]]).expect("one input"));
///     recording.step(&[commands]).expect("one input");
///     Evidence::Replay(recording.finish().expect("few claims"))
/// });
/// let found: Comparison = compare::<Sandbox>(&a, &b, &Limits::default()).expect("two replays");
/// let Some(InputDifference { tick, seat, .. }) = found.input else { panic!("{found:?}") };
/// assert_eq!((tick, seat, found.is_equal()), (30, 0, false));
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Comparison {
    /// The last tick at which the states are known to be equal, before the first difference if there is one.
    pub last_equal: Option<u64>,
    /// The first tick at which the states are known to differ.
    pub first_different: Option<u64>,
    /// Differences between the setups. If there are any, [`compare`](super::compare) compares nothing else.
    pub setup: Vec<Difference>,
    /// The first input that differs. [`compare`](super::compare) compares states up to the tick of this input.
    pub input: Option<InputDifference>,
    /// Differences between the claims of two complete replays of the same length. The states may be equal.
    pub claims: Vec<Difference>,
    /// Numbers of ticks of A and B, if both are complete replays with the same setup and their lengths differ.
    pub lengths: Option<[u64; 2]>,
    /// A and B compared with the rerun.
    pub trajectories: [Trajectory; 2],
    /// Number of ticks simulated in the rerun.
    pub simulated: Option<u64>,
    /// The side that diverged.
    pub blame: Blame,
    /// The tick of `subjects`: the first different tick for which both states are available.
    pub tick: Option<u64>,
    /// The subjects that differ: the origin first, if known, then by the difference in motion, largest first.
    pub subjects: Vec<Subject>,
    /// The stage in which the states diverged, in the tick that led to `first_different`.
    pub stage: Option<Stage>,
    /// The differences at the start of the world's step, if the states diverged before the step. B is the diverged
    /// side.
    pub began: Vec<Subject>,
    /// A single bit flip that explains the differences.
    pub explanation: Option<Explanation>,
    /// The tick of the checkpoint for which the reports were written.
    pub checkpoint: Option<u64>,
    /// The seats that agree at the checkpoint, largest group first.
    pub groups: Vec<Group>,
    /// Parts of the result that could not be determined, with reasons.
    pub notes: Vec<String>,
}

impl Comparison {
    pub(super) fn new() -> Self {
        Comparison {
            last_equal: None,
            first_different: None,
            setup: Vec::new(),
            input: None,
            claims: Vec::new(),
            lengths: None,
            trajectories: Default::default(),
            simulated: None,
            blame: Blame::Unknown,
            tick: None,
            subjects: Vec::new(),
            stage: None,
            began: Vec::new(),
            explanation: None,
            checkpoint: None,
            groups: Vec::new(),
            notes: Vec::new(),
        }
    }

    /// Whether no difference was found. Two files may then still differ in length: a report, or a replay without a
    /// trailer, may be the beginning of the other file.
    #[must_use]
    pub fn is_equal(&self) -> bool {
        self.setup.is_empty()
            && self.input.is_none()
            && self.claims.is_empty()
            && self.lengths.is_none()
            && self.first_different.is_none()
            && self.subjects.is_empty()
            && self.trajectories.iter().all(|trajectory| trajectory.diverges.is_none())
    }

    /// The sections with differences, in the order of `subjects`.
    #[must_use]
    pub fn sections(&self) -> Vec<&str> {
        let mut sections: Vec<&str> = Vec::new();
        for subject in &self.subjects {
            if !sections.contains(&subject.section.as_str()) {
                sections.push(&subject.section);
            }
        }
        sections
    }
}
