use alloc::vec::Vec;
use core::fmt;

use super::candidate;
use super::comparison::{Comparison, InputDifference, Side, Trajectory};
use super::evidence::{Evidence, SideEvidence};
use super::replayed::{self, Effort};
use crate::codec;
use crate::inspect::{Difference, InspectError, differences, fields};
use crate::lockstep::{Game, decode_inputs};
use crate::replay::{Limits, Mismatch, ReadError, Reader, TickInputs, Verdict};
use crate::world::World;

/// Reason why two files cannot be compared.
///
/// ```
/// # use lockstep2d::{lockstep::{Sandbox, SandboxSetup}, replay::{Limits, Recording}, world::World};
/// use lockstep2d::report::{CompareError, Evidence, compare};
/// # let recording = Recording::<Sandbox>::start(&SandboxSetup::default(), 60)?;
/// let replay = Evidence::Replay(recording.finish()?);
/// let world = Evidence::World(Box::new(World::default()));
/// assert_eq!(compare::<Sandbox>(&replay, &world, &Limits::default()), Err(CompareError::Kinds));
/// # Ok::<(), lockstep2d::replay::RecordError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum CompareError {
    /// A snapshot of a world can only be compared with another snapshot.
    Kinds,
    /// A report comes from other engine semantics, another game, or another version of its rules.
    Unverifiable {
        /// The file.
        side: Side,
        /// The difference to this program.
        why: Mismatch,
    },
    /// A replay, or the replay in a report, cannot be read or played.
    Replay {
        /// The file.
        side: Side,
        /// The verdict.
        verdict: Verdict,
    },
    /// A save, setup or input cannot be inspected.
    Inspect(InspectError),
}

impl fmt::Display for CompareError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            CompareError::Kinds => write!(f, "a snapshot can only be compared with another snapshot"),
            CompareError::Unverifiable { side, why } => write!(f, "{side}: {why}"),
            CompareError::Replay { side, verdict } => write!(f, "the replay of {side}: {verdict}"),
            CompareError::Inspect(error) => error.fmt(f),
        }
    }
}

impl core::error::Error for CompareError {}

impl From<InspectError> for CompareError {
    fn from(error: InspectError) -> Self {
        CompareError::Inspect(error)
    }
}

/// Finds the first difference between two reports, replays or snapshots, and the side that diverged.
///
/// The running engine simulates the inputs of the longer replay again. Two snapshots are compared without a simulation;
/// then `G` may be any game.
///
/// # Errors
/// [`CompareError`] if the files cannot be compared. If a part of the result cannot be determined,
/// [`Comparison::notes`] gives the reason.
pub fn compare<G: Game>(a: &Evidence, b: &Evidence, limits: &Limits) -> Result<Comparison, CompareError> {
    if let (Evidence::World(a), Evidence::World(b)) = (a, b) {
        return compare_worlds(a, b);
    }
    let (known, mut found) = survey::<G>(a, Some(b), limits)?;
    if !found.setup.is_empty() {
        found.first_different = Some(0);
        return Ok(found);
    }
    replayed::run::<G>(&known, limits, Effort::Thorough, &mut found)?;
    Ok(found)
}

pub(super) fn compare_worlds(a: &World, b: &World) -> Result<Comparison, CompareError> {
    let found = differences(&fields(&a.save())?, &fields(&b.save())?);
    Ok(Comparison { subjects: candidate::subjects(found), ..Comparison::new() })
}

/// Collects the data of both sides, and the differences that can be found without a simulation. If there is no `b`, the
/// running engine is the second side.
pub(super) fn survey<'a, G: Game>(
    a: &'a Evidence,
    b: Option<&'a Evidence>,
    limits: &Limits,
) -> Result<([SideEvidence<'a>; 2], Comparison), CompareError> {
    let known_a = known::<G>(a, Side::A, limits)?;
    let known_b = b.map_or_else(|| Ok(known_a.of_rerun()), |b| known::<G>(b, Side::B, limits))?;
    let known = [known_a, known_b];
    let mut found = Comparison::new();
    found.trajectories =
        [0, 1].map(|side: usize| Trajectory { seats: known[side].seats.to_vec(), ..Trajectory::default() });
    let report = [Some(a), b].into_iter().flatten().find_map(|evidence| match evidence {
        Evidence::Report(report) if !report.hashes().iter().all(Option::is_none) => Some(report),
        _ => None,
    });
    if let Some(report) = report {
        (found.checkpoint, found.groups) = (Some(report.tick()), report.groups());
    }
    if known.iter().all(|known| !known.replay.is_empty()) && b.is_some() {
        found.setup = setup_differences::<G>(&known, limits)?;
        if found.setup.is_empty() {
            found.input = input_difference::<G>(&known, limits)?;
        }
    }
    if let [SideEvidence { claims: Some(a), ticks, .. }, SideEvidence { claims: Some(b), ticks: other, .. }] =
        &known
    {
        if ticks == other {
            found.claims = differences(&fields(a)?, &fields(b)?);
        } else if found.setup.is_empty() {
            found.lengths = Some([*ticks, *other]);
        }
    }
    Ok((known, found))
}

fn known<'a, G: Game>(
    evidence: &'a Evidence,
    side: Side,
    limits: &Limits,
) -> Result<SideEvidence<'a>, CompareError> {
    let known = match evidence {
        Evidence::World(_) => return Err(CompareError::Kinds),
        Evidence::Report(report) => {
            let (name, version) = report.rules();
            check_rules::<G>(report.semantics, name, version)
                .map_err(|why| CompareError::Unverifiable { side, why })?;
            SideEvidence::of_report(report, limits)
        }
        Evidence::Replay(bytes) => SideEvidence::of_replay(bytes, limits),
    };
    known.map_err(|error| unreadable(side, error))
}

fn unreadable(side: Side, error: ReadError) -> CompareError {
    CompareError::Replay { side, verdict: error.into() }
}

fn check_rules<G: Game>(semantics: u32, name: &str, version: u32) -> Result<(), Mismatch> {
    if semantics != crate::SEMANTICS {
        return Err(Mismatch::Semantics { file: semantics, here: crate::SEMANTICS });
    }
    if (name, version) != (G::RULES.name, G::RULES.version) {
        let here = (G::RULES.name.into(), G::RULES.version);
        return Err(Mismatch::Rules { file: (name.into(), version), here });
    }
    Ok(())
}

/// The differences between the setups of two replays. Returns an error if one of the replays is of another game.
fn setup_differences<G: Game>(
    known: &[SideEvidence<'_>; 2],
    limits: &Limits,
) -> Result<Vec<Difference>, CompareError> {
    let mut setups = Vec::new();
    for (side, known) in Side::BOTH.into_iter().zip(known) {
        let reader = Reader::open(known.replay, limits).map_err(|error| unreadable(side, error))?;
        let header = reader.header();
        check_rules::<G>(header.semantics, header.rules_name, header.rules_version)
            .map_err(|why| CompareError::Replay { side, verdict: Verdict::Unverifiable { why } })?;
        setups.push(header.setup);
    }
    if setups[0] == setups[1] {
        return Ok(Vec::new());
    }
    let mut listed = Vec::new();
    for setup in setups {
        // A setup that does not decode is compared as bytes.
        listed.push(match codec::decode::<G::Setup>(setup) {
            Ok(setup) => fields(&setup)?,
            Err(_) => fields(setup)?,
        });
    }
    let found = differences(&listed[0], &listed[1]);
    Ok(found)
}

/// The first tick and seat whose inputs differ between two replays.
fn input_difference<G: Game>(
    known: &[SideEvidence<'_>; 2],
    limits: &Limits,
) -> Result<Option<InputDifference>, CompareError> {
    let open = |side: Side| {
        TickInputs::open(known[side.index()].replay, limits).map_err(|error| unreadable(side, error))
    };
    let (mut a, mut b) = (open(Side::A)?, open(Side::B)?);
    let players = Reader::open(known[0].replay, limits).map_err(|error| unreadable(Side::A, error))?;
    let players = players.header().players;
    for tick in 0.. {
        let run_a = a.next_tick().map_err(|error| unreadable(Side::A, error))?;
        let run_b = b.next_tick().map_err(|error| unreadable(Side::B, error))?;
        let (Some(run_a), Some(run_b)) = (run_a, run_b) else {
            break;
        };
        if run_a.encoded == run_b.encoded {
            continue;
        }
        let decode = |side: Side, run: &crate::replay::Run<'_>| {
            let flaw = crate::replay::Flaw::Inputs;
            let verdict = Verdict::Malformed { offset: run.offset, flaw };
            decode_inputs::<G::Input>(run.encoded, players)
                .map_err(|_| CompareError::Replay { side, verdict })
        };
        let (inputs_a, inputs_b) = (decode(Side::A, &run_a)?, decode(Side::B, &run_b)?);
        for (seat, (a, b)) in (0..).zip(inputs_a.iter().zip(&inputs_b)) {
            if codec::encode(a) != codec::encode(b) {
                let differences = differences(&fields(a)?, &fields(b)?);
                return Ok(Some(InputDifference { tick, seat, differences }));
            }
        }
    }
    Ok(None)
}
