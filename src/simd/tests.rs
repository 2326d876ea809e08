//! Every backend gives the same results as the scalar backend, for numbers of all sizes.

use super::*;
use crate::math::Rng;

impl Machine {
    /// Runs a kernel of [`WIDTH`] lanes: with vectors, or on arrays of plain integers if the backend has no vectors.
    pub(crate) fn run_wide(self, kernel: impl Kernel<WIDTH>) {
        match self.vectors() {
            Some(vectors) => vectors.run(kernel),
            None => kernel.run::<Scalar<WIDTH>>(),
        }
    }
}

fn random(rng: &mut Rng) -> i32 {
    match rng.below(8) {
        0 => i32::MIN,
        1 => i32::MAX,
        2 => 0,
        _ => i32::from_le_bytes(rng.next_u32().to_le_bytes()) >> rng.below(31),
    }
}

fn randoms(rng: &mut Rng) -> Ints<WIDTH> {
    Ints(core::array::from_fn(|_| random(rng)))
}

fn only_first([first, ..]: [i32; WIDTH]) -> [i32; WIDTH] {
    core::array::from_fn(|i| if i == 0 { first } else { 0 })
}

/// The first [`WIDTH`] of eight numbers.
fn first(numbers: [u32; 8]) -> [u32; WIDTH] {
    core::array::from_fn(|i| numbers[i])
}

struct Operations<'a> {
    a: Ints<WIDTH>,
    b: Ints<WIDTH>,
    results: &'a mut std::vec::Vec<[i32; WIDTH]>,
}

impl Kernel<WIDTH> for Operations<'_> {
    #[inline(always)]
    fn run<L: Lanes<WIDTH>>(self) {
        let (a, b) = (L::load(&self.a), L::load(&self.b));
        let mut keep = |value: L::Int| {
            let mut ints = Ints::ZERO;
            L::store(value, &mut ints);
            self.results.push(ints.0);
        };
        for value in [L::add(a, b), L::sub(a, b), L::add_saturating(a, b), L::sub_saturating(a, b)] {
            keep(value);
        }
        for value in [L::min(a, b), L::max(a, b), L::or(a, b), L::splat(7)] {
            keep(value);
        }
        for mask in masks::<L>(a, b) {
            keep(L::select(mask, a, b));
            keep(L::to_int(mask));
        }
        // Sums of products stay below 2^62, as in the kernels.
        let quarter = L::narrow::<2>(L::mul(L::splat(1), b));
        let products = [L::mul(a, quarter), L::add_wide(L::mul(a, quarter), L::mul(quarter, quarter))];
        for wide in products.into_iter().chain([L::sub_wide(L::mul(quarter, quarter), L::mul(a, quarter))]) {
            let (rounded, out) = L::narrow_saturating::<24>(wide);
            keep(rounded);
            keep(L::to_int(out));
            let (rounded, out) = L::narrow_saturating::<31>(wide);
            keep(rounded);
            keep(L::to_int(out));
            keep(L::narrow::<32>(wide));
            keep(L::low(wide));
        }
        let (wide, other) = (L::mul(a, quarter), L::mul(quarter, b));
        keep(L::to_int(L::greater_wide(wide, other)));
        keep(L::to_int(L::greater_wide(wide, wide)));
        for wide in [L::max_wide(wide, other), L::abs_wide(wide)] {
            keep(L::narrow_saturating::<31>(wide).0);
            keep(L::low(wide));
        }
        // Numbers of all sizes to which the rounding constant can be added without overflow.
        let wide = L::load_wide(&core::array::from_fn(|i| {
            (i64::from(self.a.0[i]) << 31).saturating_add(i64::from(self.b.0[i])).saturating_mul(2) / 2
        }));
        keep(L::low(wide));
        keep(L::narrow_saturating::<25>(wide).0);
        keep(L::to_int(L::narrow_saturating::<25>(wide).1));
        let positive = L::abs_wide(L::mul(a, quarter));
        keep(L::low(L::shift_down::<18>(positive)));
        keep(L::low(L::shift_down::<40>(positive)));
        let shifts = Ints(self.b.0.map(|b| (b & 63).clamp(1, 61)));
        keep(L::narrow_by(L::mul(a, b), L::load(&shifts)));
        let quads: std::vec::Vec<_> = (0..WIDTH).map(|i| Quad([self.a.0[i], self.b.0[i], 3, -4])).collect();
        L::quads(&quads, &first([3, 0, 2, 2, 1, 7, 6, 5])).into_iter().for_each(&mut keep);
        // `narrow` requires a result that fits 32 bits.
        keep(L::narrow::<30>(L::mul(quarter, L::splat(1 << 30))));
    }
}

#[inline(always)]
fn masks<L: Lanes<WIDTH>>(a: L::Int, b: L::Int) -> [L::Mask; 4] {
    let (greater, negative) = (L::greater(a, b), L::negative(a));
    [greater, negative, L::both(greater, negative), L::either(greater, negative)]
}

struct Masks<'a> {
    a: Ints<WIDTH>,
    b: Ints<WIDTH>,
    results: &'a mut std::vec::Vec<(u32, u32, bool)>,
}

impl Kernel<WIDTH> for Masks<'_> {
    #[inline(always)]
    fn run<L: Lanes<WIDTH>>(self) {
        for mask in masks::<L>(L::load(&self.a), L::load(&self.b)) {
            self.results.push((L::count(mask), L::bits(mask), L::any(mask)));
        }
    }
}

struct Divisions<'a> {
    divisors: [i64; WIDTH],
    entries: [[i64; WIDTH]; 3],
    results: &'a mut [Ints<WIDTH>; 4],
}

impl Kernel<WIDTH> for Divisions<'_> {
    #[inline(always)]
    fn run<L: Lanes<WIDTH>>(self) {
        let [xx, xy, yy] = &self.entries;
        let [g11, g12, g22] = L::inverse([L::load_wide(xx), L::load_wide(xy), L::load_wide(yy)]);
        let values = [L::reciprocal(L::load_wide(&self.divisors)), g11, g12, g22];
        self.results.iter_mut().zip(values).for_each(|(to, value)| L::store(value, to));
    }
}

/// Entries of `K - I` with 46 fraction bits, for mass fractions and lever ratios of all sizes.
fn entries(rng: &mut Rng) -> [i64; 3] {
    let a = i64::from(rng.below(1 << 30) + 1) >> rng.below(31);
    let mut sum = [0; 3];
    for fraction in [a, (1 << 30) - a] {
        let mut ratio = || i64::from(random(rng)) >> 1 >> 7;
        let [x, y] = [ratio(), ratio()];
        let term = |a: i64, b: i64| i64::try_from((i128::from(fraction) * i128::from(a * b)) >> 16).unwrap();
        sum = [sum[0] + term(x, x), sum[1] + term(x, y), sum[2] + term(y, y)];
    }
    sum
}

#[test]
fn every_backend_divides_as_plain_integers_do() {
    let mut rng = Rng::new(2);
    for round in 0..200_000u32 {
        let divisors = core::array::from_fn(|lane| match lane {
            // Lanes 0 and 1: powers of two. Lanes 2 and 3: the largest `d` for which `2^60 / d` is at least `n`, for a
            // random `n`. To each of them, -1, 0 or 1 is added.
            0 | 1 => (1i64 << (round % 47).max(1)) + i64::from(rng.below(3)) - 1,
            2 | 3 => (1i64 << 60) / (i64::from(rng.below(1 << 30)) + 1) + i64::from(rng.below(3)) - 1,
            _ => i64::from(rng.next_u32()) << 14 >> rng.below(46),
        });
        let divisors = divisors.map(|d| d.min((1 << 46) - 1));
        let entries: [[i64; 3]; WIDTH] = core::array::from_fn(|_| entries(&mut rng));
        let entries = core::array::from_fn(|i| entries.map(|entries| entries[i]));
        let results = Backend::available().map(|backend| {
            let mut results = [Ints::ZERO; 4];
            let machine = Machine::new(backend).expect("available");
            machine.run_wide(Divisions { divisors, entries, results: &mut results });
            results.map(|ints| ints.0)
        });
        let results: std::vec::Vec<_> = results.collect();
        assert!(results.iter().all(|result| *result == results[0]), "{divisors:?} {entries:?}: {results:?}");
        let mut one = [Ints::ZERO; 4];
        Divisions { divisors, entries, results: &mut one }.run::<Scalar<1>>();
        let first = results[0].map(only_first);
        assert_eq!(one.map(|ints| ints.0), first, "one lane: {divisors:?} {entries:?}");
        for (quotient, d) in results[0][0].into_iter().zip(divisors) {
            let (quotient, d) = (i128::from(quotient), i128::from(d.max(1 << 30)));
            assert!(
                quotient * d <= 1 << 60 && (quotient + 1) * d > 1 << 60,
                "1 / {d} should be rounded down"
            );
        }
    }
}

#[test]
fn every_backend_computes_what_plain_integers_do() {
    let mut rng = Rng::new(1);
    for _ in 0..20_000 {
        let (a, b) = (randoms(&mut rng), randoms(&mut rng));
        let results = Backend::available().map(|backend| {
            let (mut results, mut masks) = (std::vec::Vec::new(), std::vec::Vec::new());
            let machine = Machine::new(backend).expect("available");
            assert_eq!(machine.backend(), backend);
            machine.run_wide(Operations { a, b, results: &mut results });
            machine.run_wide(Masks { a, b, results: &mut masks });
            (results, masks)
        });
        let results: std::vec::Vec<_> = results.collect();
        assert!(results.iter().all(|result| *result == results[0]), "{a:?} {b:?}: {results:?}");
    }
}

/// `Scalar<1>` computes the first lane, and stores no other lane.
#[test]
fn one_lane_computes_what_the_first_of_all_does() {
    let mut rng = Rng::new(3);
    for _ in 0..20_000 {
        let (a, b) = (randoms(&mut rng), randoms(&mut rng));
        let (mut one, mut all) = (std::vec::Vec::new(), std::vec::Vec::new());
        Operations { a, b, results: &mut one }.run::<Scalar<1>>();
        Operations { a, b, results: &mut all }.run::<Scalar<WIDTH>>();
        let first = all.iter().copied().map(only_first);
        assert!(one.iter().copied().eq(first), "{a:?} {b:?}: {one:?} and {all:?}");
        let (mut one, mut all) = (std::vec::Vec::new(), std::vec::Vec::new());
        Masks { a, b, results: &mut one }.run::<Scalar<1>>();
        Masks { a, b, results: &mut all }.run::<Scalar<WIDTH>>();
        let first = all.iter().map(|&(_, bits, _)| (bits & 1, bits & 1, bits & 1 == 1));
        assert!(one.iter().copied().eq(first), "{a:?} {b:?}: {one:?} and {all:?}");
    }
}

struct Places<'a> {
    quads: &'a [Quad],
    bodies: &'a [Cell<SolverBody>],
    at: [u32; WIDTH],
}

impl Kernel<WIDTH> for Places<'_> {
    #[inline(always)]
    fn run<L: Lanes<WIDTH>>(self) {
        let Places { quads, bodies, at } = self;
        if quads.len() < bodies.len() {
            L::set_velocities(bodies, &at, L::shifts(bodies, &at));
            return;
        }
        let [x, y, turn, _] = L::quads(quads, &at);
        L::set_shifts(bodies, &at, VelocityW { x, y, turn });
    }
}

#[test]
fn places_that_are_not_there_are_refused() {
    for backend in Backend::available() {
        let machine = Machine::new(backend).expect("available");
        let is_refused = |quads: u32, bodies: u32, at: [u32; WIDTH]| {
            let quads: std::vec::Vec<_> = (0..quads).map(|_| Quad::default()).collect();
            let bodies: std::vec::Vec<_> = (0..bodies).map(|_| Cell::new(SolverBody::default())).collect();
            let run = || machine.run_wide(Places { quads: &quads, bodies: &bodies, at });
            std::panic::catch_unwind(std::panic::AssertUnwindSafe(run)).is_err()
        };
        for (quads, bodies) in [(10, 10), (0, 10)] {
            assert!(
                !is_refused(quads, bodies, first([0, 9, 1, 2, 0, 3, 4, 5])),
                "{backend:?} should accept valid indices"
            );
            for lane in 0..WIDTH {
                for outside in [10, 1 << 31, u32::MAX] {
                    let mut at = [1; WIDTH];
                    at[lane] = outside;
                    assert!(
                        is_refused(quads, bodies, at),
                        "{backend:?} should reject index {outside} in lane {lane}"
                    );
                }
            }
        }
        assert!(is_refused(0, 0, [0; WIDTH]), "{backend:?} should reject empty slices");
    }
}
