//! Conversions of the parameters of a match.

use lockstep2d::session::{Config, Timing};

use super::{RawMatchConfig, check_size, size};
use crate::status::{Outcome, value};

fn narrow<T: TryFrom<u32>>(name: &str, given: u32) -> Outcome<T> {
    T::try_from(given).map_err(|_| value(&format!("`{name}`"), given))
}

impl RawMatchConfig {
    pub(crate) fn of(config: &Config) -> Self {
        RawMatchConfig {
            size: size::<Self>(),
            seats: config.seats.into(),
            own_seats: 1,
            start_with: config.start_with.into(),
            input_bytes: config.input_bytes.into(),
            tick_micros: config.tick_micros,
            guess: config.guess.into(),
            delay_min: config.delay_min.into(),
            delay_max: config.delay_max.into(),
            save_interval: 0,
            check_interval: 0,
            history: config.history.into(),
            log_ticks: config.log_ticks,
            seat_lead: config.seat_lead.into(),
            seat_within: config.seat_within.into(),
            peer: 0,
            match_tag: config.match_tag,
            patience: config.timing.patience,
            key: 0,
            secret: [0; 2],
        }
    }

    /// The intervals in ticks at which states are saved and compared. The defaults equal those of `lockstep2d::peer`,
    /// because two peers compare their states only in ticks at which both of them check.
    fn intervals(&self) -> Outcome<(u16, u16)> {
        let check: u16 = narrow("check_interval", self.check_interval)?;
        let divides = |save: &u16| if check == 0 { 60_u16 } else { check }.is_multiple_of(*save);
        let save = match narrow("save_interval", self.save_interval)? {
            0 if self.guess > 0 => 1,
            0 => (1..=8).rev().find(divides).unwrap_or(1),
            given => given,
        };
        Ok((save, if check == 0 { (10 / save).max(1).saturating_mul(save) } else { check }))
    }

    pub(crate) fn config(&self) -> Outcome<Config> {
        check_size::<Self>(self.size)?;
        let mut config = Config::new(self.match_tag, narrow("seats", self.seats)?);
        config.start_with = narrow("start_with", self.start_with)?;
        config.input_bytes = narrow("input_bytes", self.input_bytes)?;
        config.tick_micros = self.tick_micros;
        config.guess = narrow("guess", self.guess)?;
        config.delay_min = narrow("delay_min", self.delay_min)?;
        config.delay_max = narrow("delay_max", self.delay_max)?;
        (config.save_interval, config.check_interval) = self.intervals()?;
        config.history = narrow("history", self.history)?;
        config.log_ticks = self.log_ticks;
        config.seat_lead = narrow("seat_lead", self.seat_lead)?;
        config.seat_within = narrow("seat_within", self.seat_within)?;
        config.timing = Timing { patience: self.patience, ..config.timing };
        config.validate()?;
        if self.own_seats > self.seats {
            return Err(value("`own_seats`", self.own_seats));
        }
        Ok(config)
    }
}

#[cfg(all(test, feature = "lockstep"))]
mod tests {
    use super::*;

    #[test]
    fn default_intervals_are_those_of_native_peers() {
        // With a checkpoint interval of 60 ticks, `lockstep2d::peer` saves every 6 ticks in lockstep, and every tick
        // with guessed inputs.
        for (guess, save_interval, check_interval, expected) in [
            (0, 0, 0, (6, 6)),
            (8, 0, 0, (1, 10)),
            (0, 8, 0, (8, 8)),
            (0, 3, 0, (3, 9)),
            (0, 12, 0, (12, 12)),
            (0, 0, 64, (8, 64)),
            (0, 0, 7, (7, 7)),
            (8, 0, 7, (1, 7)),
            (8, 4, 16, (4, 16)),
        ] {
            let raw = RawMatchConfig {
                guess,
                save_interval,
                check_interval,
                ..RawMatchConfig::of(&Config::new(0, 2))
            };
            let config = raw.config().unwrap_or_else(|failure| panic!("{failure:?}"));
            assert_eq!((config.save_interval, config.check_interval), expected, "{raw:?}");
        }
    }
}
