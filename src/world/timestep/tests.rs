use super::*;

#[test]
fn no_time_is_lost_between_calls() {
    let mut timestep = FixedTimestep::new(60);
    let ticks: u32 = (0..1000).map(|_| timestep.advance(7_000_000)).sum();
    assert_eq!(ticks, 420);
    assert_eq!(timestep.interpolation_billionths(), 0);
    assert_eq!(timestep.advance(8_333_333), 0);
    assert!(timestep.interpolation_billionths().abs_diff(500_000_000) < 100);
}

#[test]
fn a_long_pause_asks_for_a_bounded_number_of_ticks() {
    let mut timestep = FixedTimestep::new(60).ticks_max(5);
    assert_eq!(timestep.advance(u64::MAX), 5);
    assert!(timestep.advance(0) == 0);
}
