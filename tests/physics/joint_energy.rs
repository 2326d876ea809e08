//! Joints without motors feed no energy into an assembly: kinetic, potential and spring energy together stay within a
//! hundredth of the start. Stars, trees, chains, loops and grids of 3 to 12 bodies with mass ratios up to 100 and arms
//! up to 16 radii of gyration, of which one body is hit.

use crate::assembly::{Case, Mix, SHAPES, Start};
use crate::sweep;

/// 20 s.
const TICKS: u32 = 1200;

fn never_gain(mix: Mix) {
    let seeds = sweep::size(60, 3);
    let cases = SHAPES
        .into_iter()
        .flat_map(|shape| (0..seeds).map(move |seed| Case { shape, mix, start: Start::Hit, seed }))
        .collect();
    sweep::for_each(cases, |case| {
        let outcome = case.run(TICKS);
        assert!(outcome.gain <= 0.01, "{case:?}: {outcome:?}");
        assert_eq!(outcome.faults, 0, "{case:?}: expected no clamped value");
    });
}

#[test]
fn assemblies_of_welds_gain_no_energy() {
    never_gain(Mix::Weld);
}

#[test]
fn assemblies_of_hinges_gain_no_energy() {
    never_gain(Mix::Hinge);
}

#[test]
fn assemblies_of_sliders_gain_no_energy() {
    never_gain(Mix::Prismatic);
}

#[test]
fn friction_gains_no_energy() {
    never_gain(Mix::Friction);
}
