//! 2D vectors whose components are SIMD lanes.

use crate::simd::{Lanes, WIDTH};

pub(super) type Vector<T> = [T; 2];

#[inline(always)]
pub(super) fn dot<L: Lanes<WIDTH>>(a: Vector<L::Int>, b: Vector<L::Int>) -> L::Wide {
    L::add_wide(L::mul(a[0], b[0]), L::mul(a[1], b[1]))
}

#[inline(always)]
pub(super) fn plus<L: Lanes<WIDTH>>(a: Vector<L::Int>, b: Vector<L::Int>) -> Vector<L::Int> {
    [L::add(a[0], b[0]), L::add(a[1], b[1])]
}

#[inline(always)]
pub(super) fn minus<L: Lanes<WIDTH>>(a: Vector<L::Int>, b: Vector<L::Int>) -> Vector<L::Int> {
    [L::sub(a[0], b[0]), L::sub(a[1], b[1])]
}

#[inline(always)]
pub(super) fn negated<L: Lanes<WIDTH>>(v: Vector<L::Int>) -> Vector<L::Int> {
    minus::<L>([L::splat(0); 2], v)
}

#[inline(always)]
pub(super) fn select_vector<L: Lanes<WIDTH>>(
    mask: L::Mask,
    yes: Vector<L::Int>,
    no: Vector<L::Int>,
) -> Vector<L::Int> {
    [L::select(mask, yes[0], no[0]), L::select(mask, yes[1], no[1])]
}
