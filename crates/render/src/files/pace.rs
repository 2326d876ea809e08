//! [`Pace`]: duration of the frames of an animation.

/// Duration of each frame, in ticks of a game.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pace {
    /// Ticks per frame. 0 counts as 1.
    pub ticks: u32,
    /// Ticks per second. 0 counts as 1.
    pub tick_rate: u32,
}

impl Pace {
    /// Duration of a frame in hundredths of a second. `frame` is the number of the frame, from 0. The time at which a
    /// frame ends is rounded, so rounding errors do not accumulate.
    pub(super) fn hundredths(self, frame: u64) -> u16 {
        let end = |frames: u64| {
            let (ticks, rate) = (u128::from(self.ticks.max(1)), u128::from(self.tick_rate.max(1)));
            (u128::from(frames) * ticks * 200 + rate) / (2 * rate)
        };
        u16::try_from(end(frame + 1) - end(frame)).unwrap_or(u16::MAX)
    }

    /// Duration of a frame in seconds, as a numerator and a denominator of at most 16 bits each.
    pub(super) fn fraction(self) -> (u16, u16) {
        let (mut above, mut below) = (self.ticks.max(1), self.tick_rate.max(1));
        let common = gcd(above, below);
        (above, below) = (above / common, below / common);
        while above.max(below) > u32::from(u16::MAX) {
            (above, below) = (above / 2, (below / 2).max(1));
        }
        (above as u16, below as u16)
    }
}

fn gcd(a: u32, b: u32) -> u32 {
    if b == 0 { a } else { gcd(b, a % b) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hundredths_add_up_to_the_time() {
        for (ticks, tick_rate) in [(1, 60), (2, 60), (3, 60), (1, 50), (7, 144), (1, 240), (600, 60), (0, 0)]
        {
            let pace = Pace { ticks, tick_rate };
            let mut sum = 0u64;
            for frame in 0..1000u64 {
                sum += u64::from(pace.hundredths(frame));
                let exact =
                    (frame + 1) as f64 * 100.0 * f64::from(ticks.max(1)) / f64::from(tick_rate.max(1));
                assert!((sum as f64 - exact).abs() <= 0.5, "{pace:?}, {frame}: {sum}, not {exact}");
            }
        }
        let thirty: Vec<u16> =
            (0..3).map(|frame| Pace { ticks: 2, tick_rate: 60 }.hundredths(frame)).collect();
        assert_eq!(thirty, [3, 4, 3]);
    }

    #[test]
    fn fractions_are_reduced() {
        let fraction = |ticks, tick_rate| Pace { ticks, tick_rate }.fraction();
        assert_eq!([fraction(2, 60), fraction(1, 60), fraction(7, 0)], [(1, 30), (1, 60), (7, 1)]);
        let (above, below) = fraction(100_003, 200_003);
        assert!((f64::from(above) / f64::from(below) - 0.5).abs() < 1e-3);
    }
}
