//! Soft constraints: springs and dampers that stay stable at any stiffness, given by three coefficients (E. Catto,
//! "Soft Constraints", GDC 2011, and Solver2D). With the damping ratio `zeta` and the time step `h` of a sub-step:
//!
//! ```text
//! omega = 2 pi hertz,  a1 = 2 zeta + h omega,  a2 = h omega a1,  a3 = 1 / (1 + a2)
//! biasRate = omega / a1,  massScale = a2 a3,  impulseScale = a3
//! ```

#[cfg(test)]
mod tests;

use super::limits::units;
use crate::fx;
use crate::math::{
    Fx, Rate, Speed, TAU, Unit, Vec2, div_round, fx_div, fx_mul, narrow, round_shift, saturate, saturate_wide,
};

/// The coefficients of a soft constraint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Softness {
    pub(crate) bias_rate: Rate,
    pub(super) mass_scale: Unit,
    pub(super) impulse_scale: Unit,
}

impl Softness {
    /// Rigid: solves the velocity exactly and does not correct the position error.
    pub(crate) const RIGID: Self =
        Softness { bias_rate: Rate::ZERO, mass_scale: Unit::ONE, impulse_scale: Unit::ZERO };

    /// Solves the velocity exactly, and removes a position error `x` at the speed `bias_rate x`.
    pub(crate) const fn rigid_with_rate(bias_rate: Rate) -> Self {
        Softness { bias_rate, ..Self::RIGID }
    }

    /// A spring with a frequency in Hz, solved `rate` times per second.
    pub(crate) fn spring(hertz: Fx, damping_ratio: Fx, rate: u32) -> Self {
        let omega = fx_mul(TAU, hertz);
        let h_omega = omega / i64::from(rate);
        let a1 = (damping_ratio * 2).saturating_add(h_omega);
        let a2 = fx_mul(h_omega, a1);
        let a3 = fx_div(Fx::ONE, Fx::ONE.saturating_add(a2)).unwrap_or(Fx::ONE);
        let bias_rate = fx_div(omega, a1).unwrap_or(Fx::ZERO);
        // The scales add up to exactly 1, so that a mean with these weights is at most the larger value.
        let impulse_scale = narrow(a3);
        Softness { bias_rate: narrow(bias_rate), mass_scale: Unit::ONE - impulse_scale, impulse_scale }
    }

    /// The softness of a spring with this stiffness and damping in a row that also turns bodies and has the denominator
    /// `D` (30 fraction bits). `a2` becomes `a2 D`, and `massScale' = massScale D / (impulseScale + massScale D)`.
    pub(crate) fn at_mobility(&self, denominator: i64) -> Self {
        let [mass, impulse] = [self.mass_scale, self.impulse_scale].map(|scale| i128::from(scale.to_bits()));
        let mass = mass * i128::from(denominator);
        let whole = (impulse << 30) + mass;
        let mass_scale = if whole > 0 { div_round(mass << 30, whole) } else { 0 };
        let mass_scale = Unit::from_bits(saturate(saturate_wide(mass_scale)));
        Softness { mass_scale, impulse_scale: Unit::ONE - mass_scale, ..*self }
    }

    /// The factor by which a joint overestimates the predicted rotation, so that its softness yields to only 0.4 of the
    /// centrifugal force: `1 + 0.6 impulseScale / massScale`, at most 1.9. On a rod that turns at 20 rad/s about an
    /// anchor 40 radii of gyration away, 0.5 instead of 0.6 leaves a gap of 8.4 mm instead of 6.9 mm. With 1 instead of
    /// 0.6, chains of free bodies gain energy.
    pub(crate) fn stretch(&self) -> Unit {
        let (impulse, mass) = (Fx::from(self.impulse_scale), Fx::from(self.mass_scale));
        let give = fx_mul(fx!(0.6), fx_div(impulse, mass).unwrap_or(Fx::ZERO));
        narrow(Fx::ONE.saturating_add(give.min(fx!(0.9))))
    }

    pub(crate) fn to_bits(self) -> [i32; 3] {
        [self.bias_rate.to_bits(), self.mass_scale.to_bits(), self.impulse_scale.to_bits()]
    }

    /// The negated part of a spring's impulse that comes from a stretch of `x` metres: `massScale biasRate x`, about
    /// `h omega^2 x`. Only the whole product is rounded to a [`Speed`], because the bias rate times a long stretch does
    /// not fit a [`Speed`].
    pub(crate) fn push(&self, stretch: Fx) -> Speed {
        narrow(self.push_wide(stretch))
    }

    fn push_wide(&self, stretch: Fx) -> Fx {
        fx_mul(fx_mul(stretch, self.bias_rate.into()), self.mass_scale.into())
    }

    /// Like [`Self::push`], but for a stretch with a direction. Components are at most `most` m/s, in units of
    /// [`Speed`].
    pub(crate) fn push_along(&self, stretch: Vec2<Fx>, most: Fx) -> [i64; 2] {
        // The product of the bias rate and a longer stretch would overflow.
        let longest = Fx::MAX / (i64::from(self.bias_rate.to_num::<i32>()) + 1);
        let Vec2 { x, y } = stretch.shortened(longest);
        let Vec2 { x, y } = Vec2::new(self.push_wide(x), self.push_wide(y)).shortened(most);
        [units(x), units(y)]
    }

    /// `-massScale (v + bias) - impulseScale L` in units of [`Speed`], up to twice the range of a [`Speed`].
    #[inline]
    pub(crate) fn wanted(&self, v: Speed, bias: Speed, lambda: Speed) -> i64 {
        let error = i64::from(v.to_bits()) + i64::from(bias.to_bits());
        let wide = i64::from(self.mass_scale.to_bits()) * error
            + i64::from(self.impulse_scale.to_bits()) * i64::from(lambda.to_bits());
        round_shift(-wide, 30)
    }
}
