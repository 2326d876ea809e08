use super::*;
use crate::solver::limits::{Faults, STEP_MAX};

impl Softness {
    /// [`Self::wanted`], clamped to [`STEP_MAX`].
    pub(crate) fn impulse(&self, v: Speed, bias: Speed, lambda: Speed, faults: &mut Faults) -> Speed {
        let wanted = self.wanted(v, bias, lambda);
        let limit = i64::from(STEP_MAX.to_bits());
        let within = wanted.clamp(-limit, limit);
        *faults += u64::from(within != wanted);
        Speed::from_bits(saturate(within))
    }
}

#[test]
fn coefficients_match_the_formula() {
    // omega = 188.4956, h omega = 0.785398.
    let soft = Softness::spring(fx!(30), fx!(10), 240);
    let close = |a: Fx, b: Fx| assert!((a - b).abs() < fx!(0.0001), "{a} is not {b}");
    close(soft.bias_rate.into(), fx!(9.06873));
    close(soft.mass_scale.into(), fx!(0.942276));
    close(soft.impulse_scale.into(), fx!(0.057724));
}
