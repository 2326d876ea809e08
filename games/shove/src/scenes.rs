//! Matches of bots, for recording.

use lockstep2d_cli::{Catalogue, Scene, SceneInfo};
use lockstep2d_shove::{Bot, Pad, Setup, Shove};

/// Matches for the command `record`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Matches;

const TICKS: u64 = 3000;

impl Catalogue<Shove> for Matches {
    fn scenes(&self) -> Vec<SceneInfo> {
        let info = |name, about| SceneInfo { name, about, ticks: TICKS };
        vec![
            info("duel", "two bots"),
            info("match", "four bots"),
            info("guests", "four bots that join and leave"),
        ]
    }

    fn open(&self, name: &str, seed: u64) -> Option<Scene<Shove>> {
        let (seats, is_there): (u8, fn(u64, u64) -> bool) = match name {
            "duel" => (2, |_, _| true),
            "match" => (4, |_, _| true),
            "guests" => (4, guest_is_there),
            _ => return None,
        };
        let setup = Setup { seats, seed, ..Setup::default() };
        let mut bots = Bot::each(&setup);
        let script = move |tick, game: &Shove| {
            let pads = (0..).zip(&mut bots).map(|(seat, bot)| match is_there(seat, tick) {
                true => bot.pad(game),
                false => Pad::ABSENT,
            });
            pads.collect()
        };
        Some(Scene { setup, ticks: TICKS, script: Box::new(script) })
    }
}

/// Whether a bot is present. Each bot joins 200 ticks after the previous one. From then on it is present for 1200 ticks
/// and absent for 300, in turn.
fn guest_is_there(seat: u64, tick: u64) -> bool {
    let arrival = 200 * seat;
    tick >= arrival && (tick - arrival) % 1500 < 1200
}
