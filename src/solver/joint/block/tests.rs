use std::vec;
use std::vec::Vec;

use super::choice::{Candidate, Choice, ROWS_MAX};
use super::matrix::{Factor, Matrix, ONE};
use super::mobility::Mobility;
use super::scaling::{Scaling, root_and_inverse};
use crate::fx;
use crate::math::{Ratio, Rng, Unit, Vec2};
use crate::solver::row::MassFractions;

/// A random positive definite matrix: the diagonal is 1, and the other entries of each row have a sum below 1.
fn random_matrix(rng: &mut Rng, size: usize) -> Matrix {
    let first_columns: Vec<usize> = (1..).take(size).map(|count| rng.below(count) as usize).collect();
    let mut matrix = Matrix::new(first_columns.clone());
    for (row, first) in first_columns.into_iter().enumerate() {
        for column in first..row {
            let most = ONE / i64::try_from(2 * size).expect("small");
            let entry = i64::from(rng.below(u32::try_from(2 * most).expect("small"))) - most;
            matrix.set(row, column, entry);
        }
    }
    matrix
}

/// The solution `x` satisfies the equations: `S A S x + (1 - S^2) x` differs from the right-hand side by less than
/// 2^-20 of the largest number.
#[test]
fn a_factor_solves_its_equations() {
    let mut rng = Rng::new(21);
    for size in [1usize, 2, 3, 12, 40] {
        let matrix = random_matrix(&mut rng, size);
        let scales: Vec<i64> = (0..size).map(|_| ONE / 2 + i64::from(rng.below(1 << 29))).collect();
        let right: Vec<i64> = (0..size).map(|_| i64::from(rng.below(1 << 31)) << 4).collect();
        let (mut factor, mut x) = (Factor::default(), right.clone());
        factor.compute(&matrix, &scales, 0);
        factor.solve(&matrix, &mut x);
        for row in 0..size {
            let entry = |column: usize| {
                let (high, low) = (row.max(column), row.min(column));
                i128::from(matrix.get(high, low)) * i128::from(scales[row]) * i128::from(scales[column])
            };
            let others = (0..size).filter(|&column| column != row);
            let sum: i128 = others.map(|column| (entry(column) >> 60) * i128::from(x[column])).sum();
            let found = i128::from(x[row]) + (sum >> 30);
            let off = (found - i128::from(right[row])).unsigned_abs();
            assert!(off < 1 << 15, "size {size}, row {row}: {off} off");
        }
    }
}

#[test]
fn roots_and_inverses_are_those_of_theory() {
    let mut rng = Rng::new(22);
    for _ in 0..10_000 {
        let x = i64::try_from(rng.next_u64() >> (20 + rng.below(36))).expect("44 bits").max(1 << 6);
        let (root, inverse) = root_and_inverse(x);
        let one = (i128::from(root) * i128::from(inverse)) >> 30;
        assert!((one - i128::from(ONE)).abs() < 1 << 16, "{x}: {one}");
        let square = (i128::from(root) * i128::from(root)) >> 30;
        assert!((square - i128::from(x)).abs() <= 2 + (i128::from(x) >> 14), "{x}: {square}");
    }
}

/// Multiplying by `K` and dividing again is exact to 2^-18: the 30 fraction bits of a root, times the largest condition
/// number, 2^9, and a few roundings. With geometric stiffness, a body yields less to an impulse across its arm.
#[test]
fn impulses_are_the_same_whatever_the_denominator() {
    let mut rng = Rng::new(23);
    let number = |rng: &mut Rng, most: i32| rng.below(2 * most.unsigned_abs() + 1).cast_signed() - most;
    for _ in 0..10_000 {
        let ratio = |rng: &mut Rng| Ratio::from_bits(number(rng, 16 << 24));
        let e = [0, 1].map(|_| Vec2::new(ratio(&mut rng), ratio(&mut rng)));
        let a = Unit::from_bits(number(&mut rng, (1 << 29) - 1) + (1 << 29));
        let mut mobility = Mobility::new(MassFractions { a, b: Unit::ONE - a });
        let (whole, _) = Scaling::of_point(e, &mobility);
        let impulse = [0, 1].map(|_| i64::from(number(&mut rng, 1 << 30)) << 8);
        let near = |found: [i64; 2]| {
            let off = found.into_iter().zip(impulse).map(|(x, y)| (x - y).unsigned_abs()).max();
            off.is_some_and(|off| off <= 1 << 20)
        };
        assert!(near(whole.divide(whole.multiply(impulse))), "{e:?}, {a}: {impulse:?}");
        assert!(mobility.set_spins([ONE / 3, ONE / 11]) && mobility.is_stiffened());
        let (stiff, _) = Scaling::of_point(e, &mobility);
        assert!(near(stiff.divide(stiff.multiply(impulse))), "{e:?}, {a}: {impulse:?}");
        // The energy that an impulse gives is `p K p / 2`.
        let energy = |scaling: &Scaling| {
            let [x, y] = scaling.multiply(impulse).map(i128::from);
            x * i128::from(impulse[0]) + y * i128::from(impulse[1])
        };
        assert!(energy(&stiff) <= energy(&whole), "{e:?}, {a}: {impulse:?}");
    }
}

fn hinge(bodies: [u32; 2], share: Unit) -> Candidate {
    Candidate { bodies, rows: 2, holds: true, is_hinge: true, reduced_mass: fx!(1), shares: [share; 2] }
}

fn weld(bodies: [u32; 2]) -> Candidate {
    Candidate { rows: 3, is_hinge: false, ..hinge(bodies, Unit::ZERO) }
}

fn chosen(candidates: &[Candidate]) -> Vec<u32> {
    let mut choice = Choice::default();
    choice.choose(candidates, 300);
    choice.order.sort_unstable();
    choice.order
}

#[test]
fn joints_of_crowded_bodies_are_chosen_and_others_are_not() {
    let half = Unit::lit("0.5");
    // Not chosen: a single weld, a chain of equal hinges, and a body in cloth.
    assert_eq!(chosen(&[weld([1, 2])]), Vec::<u32>::new());
    assert_eq!(chosen(&[hinge([1, 2], half), hinge([2, 3], half), hinge([3, 4], half)]), Vec::<u32>::new());
    assert_eq!(chosen(&[2, 3, 4, 5].map(|limb| hinge([1, limb], half))), Vec::<u32>::new());
    // Two welds at a body, and a chain that is not chosen.
    let mixed = [hinge([7, 8], half), weld([1, 2]), hinge([8, 9], half), weld([2, 3])];
    assert_eq!(chosen(&mixed), vec![1, 3]);
    // The ground connects no joints and is never crowded.
    assert_eq!(chosen(&[weld([0, 1]), weld([0, 2]), weld([0, 3])]), Vec::<u32>::new());
}

#[test]
fn no_block_grows_beyond_its_limit_and_no_joint_is_lost() {
    for count in 2..200 {
        let candidates: Vec<Candidate> = (1..=count).map(|body| weld([body, body + 1])).collect();
        let mut choice = Choice::default();
        choice.choose(&candidates, 300);
        let mut start = 0;
        for &end in &choice.block_ends {
            assert!(3 * (end - start) <= ROWS_MAX as usize, "{} joints in a block", end - start);
            start = end;
        }
        choice.order.sort_unstable();
        assert!(choice.order.iter().copied().eq(0..count), "{count} welds: {:?}", choice.order);
    }
}

/// Blocks by their definition: breadth first, with a scan over all joints for each body.
fn blocks_by_definition(candidates: &[Candidate], crowded: impl Fn(u32) -> bool) -> Vec<Vec<u32>> {
    let mut taken = vec![false; candidates.len()];
    let walk = |start: u32, taken: &mut Vec<bool>| {
        let (mut queue, mut at) = (vec![start], 0);
        taken[start as usize] = true;
        let mut rows = candidates[start as usize].rows;
        while at < queue.len() {
            for body in candidates[queue[at] as usize].bodies.into_iter().filter(|&body| crowded(body)) {
                for (joint, candidate) in (0..).zip(candidates) {
                    let is_there = candidate.rows > 0 && candidate.bodies.contains(&body);
                    if is_there && !taken[joint as usize] && rows + candidate.rows <= ROWS_MAX {
                        taken[joint as usize] = true;
                        rows += candidate.rows;
                        queue.push(joint);
                    }
                }
            }
            at += 1;
        }
        queue
    };
    let mut blocks = Vec::new();
    for (first, candidate) in (0..).zip(candidates) {
        let is_chosen = candidate.rows > 0 && candidate.bodies.iter().any(|&body| crowded(body));
        while is_chosen && !taken[first as usize] {
            let trial = walk(first, &mut taken);
            trial.iter().for_each(|&joint| taken[joint as usize] = false);
            let mut block = walk(*trial.last().expect("the first"), &mut taken);
            block.reverse();
            blocks.push(block);
        }
    }
    blocks
}

#[test]
fn blocks_are_those_of_their_definition() {
    let mut rng = Rng::new(24);
    for round in 0..300 {
        let bodies = 2 + rng.below(40);
        let candidates: Vec<Candidate> = (0..1 + rng.below(300))
            .map(|_| {
                let a = rng.below(bodies);
                let b = (a + 1 + rng.below(bodies - 1)) % bodies;
                // Bodies 1 to 3 have many joints.
                let ends = if rng.chance(1, 3) { [1, 1 + b % 3] } else { [a, b] };
                let ends = if ends[0] == ends[1] { [a, b] } else { ends };
                Candidate { rows: rng.below(7), holds: true, ..weld(ends) }
            })
            .collect();
        let mut choice = Choice::default();
        choice.choose(&candidates, 300);
        // Two welds make a body crowded, but not the ground.
        let crowded = |body: u32| {
            let held = candidates.iter().filter(|joint| joint.rows > 0 && joint.bodies.contains(&body));
            body != 0 && held.count() >= 2
        };
        let mut start = 0;
        let mut blocks = Vec::new();
        for &end in &choice.block_ends {
            blocks.push(choice.order[start..end].to_vec());
            start = end;
        }
        assert_eq!(blocks, blocks_by_definition(&candidates, crowded), "round {round}");
    }
}

/// The choice takes time in proportion to the number of joints, whatever numbers of rows they have.
#[test]
fn a_hundred_thousand_joints_at_one_body_are_chosen_at_once() {
    for sizes in [&[3][..], &[5], &[5, 1], &[6, 4, 1, 2]] {
        let rows = sizes.iter().copied().cycle();
        let candidates: Vec<_> = rows.take(100_000).map(|rows| Candidate { rows, ..weld([1, 2]) }).collect();
        let mut choice = Choice::default();
        choice.choose(&candidates, 3);
        assert_eq!(choice.order.len(), candidates.len());
    }
}
