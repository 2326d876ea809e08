//! Comparing reports finds the diverged peer, the tick, the body and the field after a bit flip.

use lockstep2d::hash::StateHash;
use lockstep2d::inspect::{Difference, Value};
use lockstep2d::lockstep::Game;
use lockstep2d::math::Rng;
use lockstep2d::replay::{Limits, Recording};
use lockstep2d::report::{Blame, Comparison, DesyncReport, Evidence, Side, bisect, compare};
use lockstep2d::world::BodyField;

use crate::sweep;
use crate::yard::{BODIES, Flip, Peer, When, Yard, inputs_at};

const CHECKPOINT: u64 = 10;

fn evidence(report: &DesyncReport) -> Evidence {
    Evidence::read(report.to_bytes(), &Limits::default()).unwrap()
}

pub(crate) fn compared(a: &Evidence, b: &Evidence) -> Comparison {
    compare::<Yard>(a, b, &Limits::default()).unwrap()
}

/// Simulates until a checkpoint differs, and seven ticks more. Returns the reports, or `None` if no checkpoint up to
/// `until` differs.
fn reports(peers: &mut [Peer; 3], until: u64) -> Option<[DesyncReport; 3]> {
    let mut found = None;
    while peers[0].tick < until {
        peers.iter_mut().for_each(Peer::advance);
        let tick = peers[0].tick;
        let hashes: Vec<StateHash> = peers.iter().map(|peer| peer.game.state_hash()).collect();
        if tick.is_multiple_of(CHECKPOINT) && found.is_none() && hashes.iter().any(|hash| *hash != hashes[0])
        {
            found = Some((tick, hashes));
        }
        if let Some((at, hashes)) = &found
            && tick >= at + 7
        {
            let hashes: Vec<_> = hashes.iter().copied().map(Some).collect();
            return Some([0, 1, 2].map(|seat: u32| peers[seat as usize].report(seat, *at, hashes.clone())));
        }
    }
    None
}

fn random_flip(rng: &mut Rng, when: When) -> Flip {
    Flip {
        tick: 30 + u64::from(rng.next_u32() % 60),
        when,
        body: rng.next_u32() as usize % BODIES,
        field: BodyField::ALL[rng.next_u32() as usize % 2],
        bit: rng.next_u32() % 30,
    }
}

fn flipped_bits(difference: &Difference) -> u32 {
    let bits = |value: &Option<Value>| value.as_ref().and_then(Value::bits).unwrap();
    (bits(&difference.a) ^ bits(&difference.b)).count_ones()
}

fn explained(found: &Comparison) -> Option<(BodyField, u32)> {
    let explanation = found.explanation.as_ref()?;
    let name = explanation.differences.first()?.field().name();
    let field = BodyField::ALL.into_iter().find(|field| field.name() == name)?;
    Some((field, explanation.bit))
}

/// Hash of the state after the tick of a flip. Two flips with the same hash have the same effect: a changed velocity of
/// a rolling ball may lead to the same state as a changed spin. No comparison can tell these two flips apart.
fn state_after(seed: u64, flip: Flip) -> StateHash {
    let mut peer = Peer::new(seed, Some(flip));
    while peer.tick < flip.tick {
        peer.advance();
    }
    peer.game.state_hash()
}

/// Draws random flips, and tries every `stride`th of them until `count` flips have made a difference. At most one in
/// twenty may be explained by another flip with the same effect. Returns the number of flips without a difference.
fn cases(seed: u64, count: u32, when: When, stride: u32) -> u32 {
    let mut rng = Rng::new(seed);
    let mut drawn = 0_u32;
    let (mut told, mut swallowed, mut ambiguous, mut largest) = (0, 0, 0, 0);
    while told < count {
        let flip = random_flip(&mut rng, when);
        let faulty = rng.next_u32() as usize % 3;
        drawn += 1;
        if !drawn.is_multiple_of(stride) {
            continue;
        }
        let mut peers = [0, 1, 2].map(|seat: usize| Peer::new(seed, (seat == faulty).then_some(flip)));
        let reports = reports(&mut peers, flip.tick + 25);
        let (Some(body), Some(reports)) = (peers[faulty].flipped.clone(), reports) else {
            swallowed += 1;
            continue;
        };
        told += 1;
        let other = (faulty + 1) % 3;
        let sides = if told % 2 == 0 { [faulty, other] } else { [other, faulty] };
        let found = compared(&evidence(&reports[sides[0]]), &evidence(&reports[sides[1]]));
        let what = format!("{flip:?} of {body} on peer {faulty}: {found:?}");
        assert_eq!(found.first_different, Some(flip.tick), "{what}");
        assert_eq!(found.last_equal, Some(flip.tick - 1), "{what}");
        let blamed = Side::BOTH[usize::from(told % 2 == 1)];
        assert_eq!(found.blame, Blame::Side(blamed), "{what}");
        assert_eq!(found.trajectories[blamed.index()].seats, [u32::try_from(faulty).unwrap()], "{what}");
        assert_eq!(found.tick, Some(flip.tick), "{what}");
        let first = &found.subjects[0];
        // The step may have restored the body after other bodies or contacts were affected.
        let is_restored = found.subjects.iter().all(|subject| subject.path != body);
        assert!(!is_restored || when == When::Before, "{what}");
        if !is_restored {
            let place = (first.path.as_str(), first.section.as_str());
            assert_eq!(place, (body.as_str(), "world.bodies"), "{what}");
        }
        let difference = match when {
            When::After => {
                assert_eq!((found.subjects.len(), first.differences.len()), (1, 1), "{what}");
                assert_eq!(found.explanation, None, "{what}");
                assert_eq!(flipped_bits(&first.differences[0]), 1, "{what}");
                &first.differences[0]
            }
            // Without an explanation, no other body is affected.
            When::Before if found.explanation.is_none() => {
                assert_eq!((found.subjects.len(), first.differences.len()), (1, 1), "{what}");
                &first.differences[0]
            }
            // The step may have restored the flipped field and changed other fields.
            When::Before => {
                let explanation = found.explanation.as_ref().expect(&what);
                assert_eq!((explanation.tick, &explanation.path), (flip.tick - 1, &body), "{what}");
                assert_eq!(flipped_bits(&explanation.differences[0]), 1, "{what}");
                &explanation.differences[0]
            }
        };
        assert_eq!(difference.field().subject(), Some(body.as_str()), "{what}");
        if difference.field().name() != flip.field.name() {
            let explained = explained(&found).expect(&what);
            let found = Flip { field: explained.0, bit: explained.1, ..flip };
            assert_eq!(state_after(seed, found), state_after(seed, flip), "{what}");
            ambiguous += 1;
        }
        largest = largest.max(found.subjects.len());
        let seats: Vec<&[u32]> = found.groups.iter().map(|group| group.seats.as_slice()).collect();
        let faulty = u32::try_from(faulty).unwrap();
        let others: Vec<u32> = (0..3).filter(|seat| *seat != faulty).collect();
        assert_eq!(seats, [others.as_slice(), &[faulty]], "{what}");
    }
    assert!(ambiguous * 20 <= count, "{ambiguous} of {count} flips were explained by another one");
    if when == When::Before {
        assert!(largest > 20, "expected a flip to spread to more than 20 objects, found {largest}");
    }
    swallowed
}

#[test]
fn a_bit_that_flips_after_a_step_is_found() {
    let (count, stride) = sweep::size((100, 1), (20, 5));
    cases(1, count, When::After, stride);
}

/// The comparison has to try all bits, because one tick later everything that touches the body differs. Fewer than half
/// of the flips leave no difference.
fn check_flips_before_a_step(seed: u64) {
    let (count, stride) = sweep::size((50, 1), (10, 5));
    let swallowed = cases(seed, count, When::Before, stride);
    assert!(swallowed < count, "{swallowed} flips made no difference, and only {count} made one");
}

#[test]
fn a_bit_that_flips_before_a_step_is_found() {
    check_flips_before_a_step(2);
}

#[test]
fn a_bit_that_flips_before_another_step_is_found() {
    check_flips_before_a_step(3);
}

#[test]
fn peers_that_agree_are_equal() {
    let mut peers = [0, 1, 2].map(|_| Peer::new(5, None));
    assert_eq!(reports(&mut peers, 60), None);
    let [a, b, _] = peers.map(|peer| peer.report(0, 50, Vec::new()));
    let found = compared(&evidence(&a), &evidence(&b));
    assert!(found.is_equal(), "{found:?}");
    assert_eq!((found.blame, found.last_equal, found.simulated), (Blame::Nobody, Some(60), Some(60)));
    let replays = [a, b].map(|report| Evidence::Replay(report.replay().to_vec()));
    assert!(compared(&replays[0], &replays[1]).is_equal());
}

#[test]
fn complete_replays_of_different_lengths_are_not_equal() {
    let complete = |ticks| {
        let mut recording = Recording::<Yard>::start(&5, 25).unwrap();
        (0..ticks).for_each(|tick| recording.step(&[0, 1, 2].map(|player| inputs_at(tick, player))).unwrap());
        Evidence::Replay(recording.finish().unwrap())
    };
    let (short, long) = (complete(40), complete(60));
    let mut peer = Peer::new(5, None);
    (0..40).for_each(|_| peer.advance());
    let so_far = evidence(&peer.report(0, 25, Vec::new()));
    let limits = Limits::default();
    for found in [compared(&long, &short), bisect::<Yard>(&long, Some(&short), &limits).unwrap()] {
        assert_eq!((found.lengths, found.is_equal()), (Some([60, 40]), false), "{found:?}");
        assert_eq!((found.first_different, found.blame), (None, Blame::Nobody), "{found:?}");
    }
    assert_eq!(compared(&short, &long).lengths, Some([40, 60]));
    // The replay in a report has no trailer, so it may be the beginning of a longer match.
    for found in [compared(&long, &so_far), compared(&short, &so_far), compared(&short, &short)] {
        assert_eq!((found.lengths, found.is_equal()), (None, true), "{found:?}");
    }
}

/// A replay has checkpoints, but no states: the comparison finds neither the tick nor the fields.
#[test]
fn replays_tell_who_diverged_between_which_checkpoints() {
    let flip = Flip { tick: 60, when: When::After, body: 9, field: BodyField::VelocityY, bit: 12 };
    let mut peers = [None, Some(flip)].map(|flip| Peer::new(3, flip));
    (0..110).for_each(|_| peers.iter_mut().for_each(Peer::advance));
    let replays = [0, 1].map(|peer: usize| Evidence::Replay(peers[peer].replay()));
    let found = compared(&replays[0], &replays[1]);
    assert_eq!((found.last_equal, found.first_different), (Some(50), Some(75)));
    assert_eq!(found.blame, Blame::Side(Side::B));
    assert!(found.subjects.is_empty() && !found.notes.is_empty());

    // The report of the diverged peer gives tick and field.
    let report = peers[1].report(1, 75, Vec::new());
    let found = compared(&replays[0], &evidence(&report));
    assert_eq!((found.first_different, found.blame), (Some(60), Blame::Side(Side::B)));
    assert_eq!(found.subjects.len(), 1, "{:?}", found.subjects);

    // The correct peer's report has no state of the diverged peer.
    let report = peers[0].report(0, 75, Vec::new());
    let found = compared(&evidence(&report), &replays[1]);
    assert_eq!((found.first_different, found.blame), (Some(75), Blame::Side(Side::B)));
}

/// Both sides diverge from the rerun, in the same way at first. This happens if the game uses floats or a random order,
/// or with the wrong build of the tool.
#[test]
fn reports_of_rules_that_this_program_cannot_reproduce_give_the_tick_and_the_field() {
    let flip = |tick, body| Flip { tick, when: When::After, body, field: BodyField::VelocityY, bit: 12 };
    let (other_rules, fault) = (flip(20, 5), flip(150, 9));
    // With checkpoints every 100 ticks, A has no hash for most ticks before its report begins.
    for (interval, until) in [(25, 160), (100, 160), (100, 164)] {
        let mut a = Peer::with_checkpoints(interval, 3, [other_rules]);
        let mut b = Peer::new(3, [other_rules, fault]);
        (0..until).for_each(|_| a.advance());
        (0..162).for_each(|_| b.advance());
        let flipped = b.flipped.clone().unwrap();
        let (a, b) = (evidence(&a.report(0, 150, Vec::new())), evidence(&b.report(1, 150, Vec::new())));
        for found in [compared(&a, &b), bisect::<Yard>(&a, Some(&b), &Limits::default()).unwrap()] {
            let ticks = (found.last_equal, found.first_different, found.tick);
            assert_eq!(ticks, (Some(149), Some(150), Some(150)), "{found:?}");
            assert_eq!((found.blame, found.subjects.len()), (Blame::Both, 1), "{found:?}");
            assert_eq!(found.subjects[0].path, flipped, "{found:?}");
        }
    }
}

#[test]
fn other_inputs_and_other_setups_are_named() {
    let mut peers = [0, 1].map(|_| Peer::new(3, None));
    (0..40).for_each(|_| peers.iter_mut().for_each(Peer::advance));
    let replay = peers[0].replay();
    let mut other = Recording::<Yard>::start(&3, 25).unwrap();
    for tick in 0..40 {
        let mut inputs = [0, 1, 2].map(|player| inputs_at(tick, player));
        inputs[2] ^= u8::from(tick >= 33);
        other.step(&inputs).unwrap();
    }
    let (a, b) = (Evidence::Replay(replay), Evidence::Replay(other.finish().unwrap()));
    let found = compared(&a, &b);
    let input = found.input.clone().unwrap();
    assert_eq!((input.tick, input.seat, input.differences.len()), (33, 2, 1));
    assert_eq!(
        (found.first_different, found.blame),
        (None, Blame::Nobody),
        "expected no difference before the different input"
    );
    assert!(!found.is_equal());

    let c = Evidence::Replay(Peer::new(4, None).replay());
    let found = compared(&a, &c);
    assert_eq!(found.setup.len(), 1);
    assert_eq!(found.setup[0].to_string(), ": 3 | 4");
}

#[test]
fn worlds_are_compared_field_by_field() {
    let mut peer = Peer::new(6, None);
    (0..30).for_each(|_| peer.advance());
    let a = Evidence::World(Box::new(peer.game.world.clone()));
    let bytes = peer.game.world.to_bytes();
    let same = Evidence::read(bytes, &Limits::default()).unwrap();
    assert!(compared(&a, &same).is_equal());
    let flip = Flip { tick: 0, when: When::After, body: 20, field: BodyField::Spin, bit: 3 };
    let body = flip.apply(&mut peer.game).unwrap();
    let b = Evidence::World(Box::new(peer.game.world));
    let found = compared(&a, &b);
    assert_eq!(format!("world.{}", found.subjects[0].path), body);
    let names: Vec<&str> =
        found.subjects[0].differences.iter().map(|difference| difference.field().name()).collect();
    assert_eq!(names, ["spin", "angular_velocity"]);
    assert!(compare::<Yard>(&a, &Evidence::Replay(Vec::new()), &Limits::default()).is_err());
}
