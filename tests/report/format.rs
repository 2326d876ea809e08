//! Valid reports survive a round trip, and anything else is refused.

use std::sync::atomic::{AtomicU32, Ordering};

use lockstep2d::codec;
use lockstep2d::hash::StateHash;
use lockstep2d::math::Rng;
use lockstep2d::replay::Limits;
use lockstep2d::report::{
    Desync, DesyncReport, Evidence, ReportError, ReportFlaw, Trace, TraceError, bisect, compare,
};

use crate::sweep;
use crate::yard::{PLAYERS, Peer, Yard};

fn peer() -> Peer {
    let mut peer = Peer::new(1, None);
    (0..130).for_each(|_| peer.advance());
    peer
}

fn read(bytes: &[u8]) -> Result<DesyncReport, ReportError> {
    DesyncReport::from_bytes(bytes, &Limits::default())
}

fn repaired(mut bytes: Vec<u8>) -> Vec<u8> {
    let end = bytes.len() - 16;
    let hash = StateHash::of_bytes(&bytes[..end]);
    bytes[end..].copy_from_slice(&hash.0.to_le_bytes());
    bytes
}

#[test]
fn a_report_comes_back() {
    let peer = peer();
    let report = peer.report(1, 120, vec![Some(StateHash(1)), None, None]);
    assert_eq!(read(&report.to_bytes()), Ok(report.clone()));
    assert_eq!((report.rules(), report.players(), report.tick()), (("yard", 1), PLAYERS, 120));
    let own = peer.history.get(120).unwrap().hash;
    assert_eq!(
        report.hashes(),
        [Some(StateHash(1)), Some(own), None],
        "expected the reporting peer's own hash"
    );
    assert!(report.history().len() >= 120, "expected a history of at least two seconds");
    assert_eq!(report.saves_left_out(), 0);
}

/// A reader accepts a trace that was made with the reader's limits.
#[test]
fn a_trace_that_would_be_large_leaves_saves_and_starts_out() {
    let replay = peer().replay();
    let trace = |file_bytes: u64| {
        let limits = Limits { file_bytes, ..Limits::default() };
        Trace::<Yard>::of_replay(&replay, &limits, u64::MAX, 60).map(|report| (report, limits))
    };
    let whole = trace(u64::MAX).unwrap().0.to_bytes().len() as u64;
    let mut kept = Vec::new();
    for percent in [100, 60, 30, 10, 5] {
        let (report, limits) = trace(whole * percent / 100).unwrap();
        let evidence = Evidence::read(report.to_bytes(), &limits).unwrap();
        assert!(bisect::<Yard>(&evidence, None, &limits).unwrap().is_equal());
        assert_eq!((report.history().len(), report.phases().len()), (61, 60));
        kept.push(report.saves().len());
    }
    assert!(kept.is_sorted_by(|more, fewer| more > fewer) && kept[0] > 50 && kept[4] < 5, "{kept:?}");
    let max = replay.len() as u64 + 100;
    let error = trace(max).map(|_| ()).unwrap_err();
    assert!(matches!(error, TraceError::TooLong { bytes, max: is } if bytes > is && is == max), "{error}");
}

/// Saves near the differing checkpoint are kept. Distant saves are left out first.
#[test]
fn a_report_that_would_be_large_leaves_saves_out() {
    let peer = peer();
    let found = Desync { players: PLAYERS, tick: 100, known: u64::MAX, seats: vec![0], hashes: Vec::new() };
    let length = codec::encode(&peer.history.get(100).unwrap().save).len();
    let report = DesyncReport::within(length * 5 + length / 2, &found, &peer.history, Vec::new());
    let ticks: Vec<u64> = report.saves().iter().map(|(tick, _)| *tick).collect();
    assert_eq!(ticks, [96, 97, 98, 99, 100]);
    assert_eq!(report.saves_left_out(), report.history().len() - 5);
    let none = DesyncReport::within(0, &found, &peer.history, Vec::new());
    assert!(none.saves().is_empty() && none.history().len() >= 120);
}

#[test]
fn what_no_peer_writes_is_refused() {
    let peer = peer();
    let bytes = peer.report(0, 120, Vec::new()).to_bytes();
    let with = |at: usize, byte: u8| {
        let mut bytes = bytes.clone();
        bytes[at] = byte;
        read(&repaired(bytes))
    };
    assert_eq!(with(0, 0), Err(ReportError::NotAReport));
    assert_eq!(with(8, 1), Err(ReportError::Format { found: 1 }));
    assert!(matches!(with(16, 0), Err(ReportError::Length { .. })));
    let name = 24 + 8;
    let players = name + "yard".len() + 4;
    assert_eq!(with(players, 65), Err(ReportError::Invalid(ReportFlaw::Players)));
    assert_eq!(with(players, 2), Err(ReportError::Invalid(ReportFlaw::Hashes)));
    let seat = players + 4 + 8;
    assert_eq!(with(seat, 3), Err(ReportError::Invalid(ReportFlaw::Seats)));
    assert!(
        matches!(with(24 + 7, 1), Err(ReportError::Decode(_))),
        "the length of the name exceeds the file"
    );
    let mut damaged = bytes.clone();
    damaged[100] ^= 1;
    assert_eq!(read(&damaged), Err(ReportError::Hash));
    let small = Limits { file_bytes: 99, ..Limits::default() };
    let (length, max) = (bytes.len() as u64, 99);
    assert_eq!(DesyncReport::from_bytes(&bytes, &small), Err(ReportError::TooLong { bytes: length, max }));
    for length in (0..bytes.len()).step_by(997) {
        assert!(read(&bytes[..length]).is_err());
    }
}

/// The report is damaged and its hash is repaired. A comparison with it ends with a result or an error.
#[test]
fn hostile_reports_are_no_danger() {
    let mut peer = Peer::new(1, None);
    (0..12).for_each(|_| peer.advance());
    let good = peer.report(0, 10, Vec::new());
    let bytes = good.to_bytes();
    let limits = Limits::default();
    let compared = AtomicU32::new(0);
    let cases = sweep::sample(0..300, 5);
    let count = u32::try_from(cases.len()).unwrap();
    sweep::for_each(cases, |case| {
        let mut rng = Rng::new(700 + case);
        let mut bytes = bytes.clone();
        for _ in 0..1 + rng.next_u32() % 3 {
            // Two thirds of the changes hit the structure in front of the saves.
            let reach = if rng.next_u32().is_multiple_of(3) { bytes.len() - 40 } else { 700 };
            let at = 24 + rng.next_u32() as usize % (reach - 24);
            bytes[at] ^= 1 << (rng.next_u32() % 8);
        }
        if let Ok(evidence) = Evidence::read(repaired(bytes), &limits) {
            let other = Evidence::Report(Box::new(good.clone()));
            let is_ok = compare::<Yard>(&evidence, &other, &limits).is_ok();
            compared.fetch_add(u32::from(is_ok), Ordering::Relaxed);
        }
    });
    let compared = compared.into_inner();
    assert!(compared * 15 > count, "only {compared} of {count} were readable");
}
