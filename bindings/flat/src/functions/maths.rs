//! Mathematics on fixed-point numbers, for the rules of games, which cannot use floats.

use lockstep2d::codec;
use lockstep2d::hash::StateHash;
use lockstep2d::math::{Angle, Fx, Rng, Rot, Vec2, fx_div, fx_mul, hypot, ratio, sqrt, widen};

use crate::border::{In, Out};
use crate::describe::api;
use crate::numbers::{RawAngle, RawFx, RawHash, RawRng, RawVec2};
use crate::status::{Failure, Outcome, Status};

fn undefined(what: &str) -> Failure {
    Failure::new(Status::Number, what)
}

fn generator(raw: RawRng) -> Outcome<Rng> {
    Ok(codec::decode(&codec::encode(&(raw.state, raw.increment)))?)
}

fn described(rng: &Rng) -> Outcome<RawRng> {
    let (state, increment) = codec::decode(&codec::encode(rng))?;
    Ok(RawRng { state, increment })
}

api! {
    /// Reads a decimal number such as `-1.25`, rounded to nearest.
    fn ls2d_fx_parse(text: In<'_, u8>, length: usize, number: Out<'_, RawFx>) {
        let mut number = number;
        let text = text.text(length)?;
        let plain = text.bytes().all(|byte| matches!(byte, b'0'..=b'9' | b'+' | b'-' | b'.'));
        let parsed = plain.then(|| Fx::from_str(text).ok()).flatten();
        let parsed = parsed.ok_or_else(|| Failure::new(Status::Text, format!("{text:?} is not a number in range")))?;
        number.set(RawFx::of(parsed))
    }

    /// Writes a number as exact decimal text, and the length of the text in bytes.
    fn ls2d_fx_format(number: RawFx, text: Out<'_, u8>, capacity: usize, length: Out<'_, usize>) {
        let (mut text, mut length) = (text, length);
        text.set_all(capacity, &mut length, number.fx().to_string().as_bytes())
    }

    /// `numerator / denominator`, rounded to nearest, saturating. `LS2D_NUMBER` if `denominator` is 0.
    fn ls2d_fx_ratio(numerator: i64, denominator: i64, number: Out<'_, RawFx>) {
        let mut number = number;
        if denominator == 0 {
            return Err(undefined("division by zero"));
        }
        number.set(RawFx::of(ratio(numerator, denominator)))
    }

    /// `a + b`, saturating.
    fn ls2d_fx_add(a: RawFx, b: RawFx) -> RawFx { RawFx(a.0.saturating_add(b.0)) }

    /// `a - b`, saturating.
    fn ls2d_fx_sub(a: RawFx, b: RawFx) -> RawFx { RawFx(a.0.saturating_sub(b.0)) }

    /// `a b`, rounded to nearest, saturating.
    fn ls2d_fx_mul(a: RawFx, b: RawFx) -> RawFx { RawFx::of(fx_mul(a.fx(), b.fx())) }

    /// `a / b`, rounded to nearest, saturating. `LS2D_NUMBER` if `b` is 0.
    fn ls2d_fx_div(a: RawFx, b: RawFx, number: Out<'_, RawFx>) {
        let mut number = number;
        number.set(RawFx::of(fx_div(a.fx(), b.fx()).ok_or_else(|| undefined("division by zero"))?))
    }

    /// Square root, rounded to nearest. `LS2D_NUMBER` for a negative number.
    fn ls2d_fx_sqrt(a: RawFx, number: Out<'_, RawFx>) {
        let mut number = number;
        number.set(RawFx::of(sqrt(a.fx()).ok_or_else(|| undefined("root of a negative number"))?))
    }

    /// Length of a vector, rounded to nearest, saturating.
    fn ls2d_fx_hypot(x: RawFx, y: RawFx) -> RawFx { RawFx::of(hypot(x.fx(), y.fx())) }

    /// `a.x b.x + a.y b.y`, rounded once, saturating.
    fn ls2d_vec2_dot(ax: RawFx, ay: RawFx, bx: RawFx, by: RawFx) -> RawFx {
        RawFx::of(Vec2::new(ax.fx(), ay.fx()).dot(Vec2::new(bx.fx(), by.fx())))
    }

    /// `a.x b.y - a.y b.x`, rounded once, saturating.
    fn ls2d_vec2_cross(ax: RawFx, ay: RawFx, bx: RawFx, by: RawFx) -> RawFx {
        RawFx::of(Vec2::new(ax.fx(), ay.fx()).cross(Vec2::new(bx.fx(), by.fx())))
    }

    /// The direction of a vector as a unit vector. `LS2D_NUMBER` for the zero vector.
    fn ls2d_vec2_normalize(x: RawFx, y: RawFx, unit: Out<'_, RawVec2>) {
        let mut unit = unit;
        let found = Vec2::new(x.fx(), y.fx()).normalized().ok_or_else(|| undefined("direction of zero"))?;
        unit.set(RawVec2::of_units(found))
    }

    /// A vector turned by an angle.
    fn ls2d_vec2_rotate(x: RawFx, y: RawFx, angle: RawAngle, turned: Out<'_, RawVec2>) {
        let mut turned = turned;
        let rotation = Rot::from_angle(angle.angle());
        turned.set(RawVec2::of(rotation.apply_wide(Vec2::new(x.fx(), y.fx()))))
    }

    /// Sine of an angle.
    fn ls2d_angle_sin(angle: RawAngle) -> RawFx { RawFx::of(widen(angle.angle().sin())) }

    /// Cosine of an angle.
    fn ls2d_angle_cos(angle: RawAngle) -> RawFx { RawFx::of(widen(angle.angle().cos())) }

    /// Angle of a vector from the x axis; 0 for the zero vector.
    fn ls2d_angle_of(x: RawFx, y: RawFx) -> RawAngle { RawAngle::of(Angle::of(Vec2::new(x.fx(), y.fx()))) }

    /// Converts a number of degrees to an angle.
    fn ls2d_angle_from_degrees(degrees: RawFx) -> RawAngle { RawAngle::of(Angle::from_degrees(degrees.fx())) }

    /// Converts a number of radians to an angle.
    fn ls2d_angle_from_radians(radians: RawFx) -> RawAngle { RawAngle::of(Angle::from_radians(radians.fx())) }

    /// Converts an angle to degrees, above -180 and up to 180.
    fn ls2d_angle_to_degrees(angle: RawAngle) -> RawFx { RawFx::of(angle.angle().to_degrees()) }

    /// Converts an angle to radians, above -pi and up to pi.
    fn ls2d_angle_to_radians(angle: RawAngle) -> RawFx { RawFx::of(angle.angle().to_radians()) }

    /// Makes a random number generator, which the game keeps as part of its state.
    fn ls2d_rng_init(seed: u64, rng: Out<'_, RawRng>) {
        let mut rng = rng;
        rng.set(described(&Rng::new(seed))?)
    }

    /// Draws a uniform number below `bound`; 0 if `bound` is 0. `from` is the generator before the draw, `rng` the
    /// generator after it. Both may be the same struct.
    fn ls2d_rng_below(from: In<'_, RawRng>, rng: Out<'_, RawRng>, bound: u32, number: Out<'_, u32>) {
        let (mut rng, mut number) = (rng, number);
        let mut drawn = generator(from.get()?)?;
        number.set(drawn.below(bound))?;
        rng.set(described(&drawn)?)
    }

    /// Draws a uniform number from `low` to below `high`; `low` if the range is empty. `from` is the generator before
    /// the draw, `rng` the generator after it. Both may be the same struct.
    fn ls2d_rng_range(
        from: In<'_, RawRng>,
        rng: Out<'_, RawRng>,
        low: RawFx,
        high: RawFx,
        number: Out<'_, RawFx>,
    ) {
        let (mut rng, mut number) = (rng, number);
        let mut drawn = generator(from.get()?)?;
        number.set(RawFx::of(drawn.range(low.fx(), high.fx())))?;
        rng.set(described(&drawn)?)
    }

    /// Hash of bytes, for the state hash of a game.
    fn ls2d_hash_bytes(data: In<'_, u8>, size: usize, hash: Out<'_, RawHash>) {
        let mut hash = hash;
        hash.set(RawHash::of(StateHash::of_bytes(data.slice(size)?)))
    }
}
