//! Keeps the lever arms of contacts as they were in the last tick while the shapes hardly move against each other: see
//! [`KeptArms`](crate::collision::KeptArms).

use super::input::{Input, columns};
use crate::collision::{Contact, Manifold};
use crate::math::Length;
use crate::simd::{Ints, Lanes, Quad, shift};

/// Shift from the format of a length to that in which arms are compared: the 16 bits of a kept arm are the high ones,
/// so that sums and differences wrap as kept arms do.
const LENGTH_TO_ARM: i32 = shift(17 + 16 - Length::FRAC_NBITS);

/// Returns the words of [`KeptArms`](crate::collision::KeptArms), and the bound on the change of an arm that is kept: 0
/// if the points are not those of the last tick.
#[inline(always)]
pub(super) fn last_arms(memory: &Contact, manifold: &Manifold, tolerance: u16) -> Quad {
    let [a, b] = manifold.both_points();
    let [old_a, old_b] = &memory.points;
    let count = manifold.count();
    let has_same_points =
        count == memory.count && a.feature.0 == old_a.feature && (count < 2 || b.feature.0 == old_b.feature);
    let bound = if has_same_points { (i32::from(tolerance) << 16) + 1 } else { 0 };
    let [a, b, between] = memory.arms.0;
    Quad([a, b, between, bound])
}

/// The arms of a batch's contacts that have changed.
#[derive(Clone, Debug)]
pub(super) struct RenewedArms<const N: usize> {
    /// Bit mask of the lanes in which an arm has changed.
    pub(super) lanes: u32,
    pub(super) words: [Ints<N>; 3],
}

impl<const N: usize> RenewedArms<N> {
    pub(super) const NONE: Self = RenewedArms { lanes: 0, words: [Ints::ZERO; 3] };
}

/// Where the points of a batch's contacts are.
pub(super) struct Places<L: Lanes<N>, const N: usize> {
    /// Vectors from the centres of mass of A and B to the origin of the manifold.
    pub(super) to_origin: [[L::Int; 2]; 2],
    /// Vectors from the origin of the manifold to the points.
    pub(super) anchors: [[L::Int; 2]; 2],
}

impl<L: Lanes<N>, const N: usize> Places<L, N> {
    /// Moves the points, and B's centre of mass, so that the arms are those of the last tick. A coordinate of an arm
    /// that has changed too much keeps its current value.
    #[inline(always)]
    pub(super) fn keep_arms(&mut self, inputs: &[Input; N], count: usize, renewed: &mut RenewedArms<N>) {
        let [first, second, between, bound] = columns::<L, N>(inputs, |input| &input.last_arms);
        let [to_a, to_b] = &mut self.to_origin;
        let arm = [L::sub(to_b[0], to_a[0]), L::sub(to_b[1], to_a[1])];
        let mut all_kept = keep::<L, N>(between, arm, bound, to_b, &mut renewed.words[2]);
        for (i, anchor) in self.anchors.iter_mut().enumerate().take(count) {
            let arm = [L::add(to_a[0], anchor[0]), L::add(to_a[1], anchor[1])];
            let kept = keep::<L, N>([first, second][i], arm, bound, anchor, &mut renewed.words[i]);
            all_kept = L::both(all_kept, kept);
        }
        renewed.lanes = !L::bits(all_kept);
    }
}

/// Moves a place so that its arm equals that of the last tick, in each coordinate whose difference is below the bound.
/// Stores the arm to be kept. Returns whether both coordinates are those of the last tick.
#[inline(always)]
fn keep<L: Lanes<N>, const N: usize>(
    last: L::Int,
    arm: [L::Int; 2],
    bound: L::Int,
    place: &mut [L::Int; 2],
    word: &mut Ints<N>,
) -> L::Mask {
    let last_x = L::shift_left::<16>(last);
    let last_y = L::sub(last, L::shift_right::<16>(last_x));
    let (x, x_kept) = keep_axis::<L, N>(last_x, arm[0], bound, &mut place[0]);
    let (y, y_kept) = keep_axis::<L, N>(last_y, arm[1], bound, &mut place[1]);
    L::store(L::add(x, L::shift_left::<16>(y)), word);
    L::both(x_kept, y_kept)
}

/// [`keep`] along one axis. Returns the coordinate to be kept, and whether it is `last`, which is in the high bits.
#[inline(always)]
fn keep_axis<L: Lanes<N>, const N: usize>(
    last: L::Int,
    arm: L::Int,
    bound: L::Int,
    place: &mut L::Int,
) -> (L::Int, L::Mask) {
    let arm = L::shift_left::<LENGTH_TO_ARM>(arm);
    let difference = L::sub(last, arm);
    let is_kept = L::both(L::greater(bound, difference), L::greater(difference, L::sub(L::splat(0), bound)));
    let change = L::select(is_kept, difference, L::splat(0));
    *place = L::add_saturating(*place, L::shift_right::<LENGTH_TO_ARM>(change));
    (L::shift_right::<16>(L::add(arm, change)), is_kept)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simd::Scalar;

    /// Keeps an arm that was `last` and now is `arm`. Returns the change of the place, the word, and whether both
    /// coordinates are kept.
    fn kept(last: i32, arm: [i32; 2], tolerance: i32) -> ([i32; 2], i32, bool) {
        let (mut place, mut word) = ([[0], [0]], Ints([0]));
        let bound = if tolerance < 0 { 0 } else { (tolerance << 16) + 1 };
        let [all] = keep::<Scalar<1>, 1>([last], arm.map(|arm| [arm]), [bound], &mut place, &mut word);
        (place.map(|[change]| change), word.0[0], all)
    }

    #[test]
    fn an_arm_is_kept_up_to_the_tolerance() {
        let tolerance = 100;
        let most = tolerance << 5;
        for x in [0, 32, -32, 1 << 20, -(1 << 20), 123_456_768, i32::MAX - 31, i32::MIN] {
            for y in [0, 32, -32, (1 << 20) - 32, 1 << 20, -77_777_760] {
                let (_, last, all) = kept(0, [x, y], -1);
                assert!(!all, "nothing is kept of a contact with other points");
                for moved in [0, 1, -1, 31, 32, most, -most] {
                    let arm = [x.wrapping_add(moved), y.wrapping_sub(moved)];
                    assert_eq!(kept(last, arm, tolerance), ([-moved, moved], last, true), "{x} {y} {moved}");
                }
                for moved in [most + 1, -most - 1, 1 << 19] {
                    let (change, word, all) = kept(last, [x, y.wrapping_add(moved)], tolerance);
                    assert_eq!((change, all), ([0, 0], false), "{x} {y} {moved}");
                    assert_eq!((word << 16, word == last), (last << 16, false), "x keeps its bits");
                }
            }
        }
    }
}
