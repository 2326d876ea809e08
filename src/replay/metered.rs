use super::limits::{LimitKind, Limits};
use super::verdict::Verdict;
use crate::lockstep::Game;

/// Plays a tick with `step`, within the limits of a tick and of the replay. `spent` is the work so far.
pub(crate) fn play_within<G: Game, T>(
    game: &mut G,
    inputs: &[G::Input],
    limits: &Limits,
    spent: &mut u64,
    step: impl FnOnce(&mut G, &[G::Input]) -> T,
) -> Result<T, Verdict> {
    let work = game.work(inputs);
    LimitKind::TickWork.check(work, limits.tick_work)?;
    let before = *spent;
    LimitKind::TotalWork.check(before.saturating_add(work), limits.total_work)?;
    let room = (limits.tick_work - work).min(limits.total_work - before - work);
    if let Some(world) = game.world_mut() {
        world.start_work_meter(room);
    }
    let done = step(game, inputs);
    // A world with an exhausted work budget has a wrong state: check before any use of it.
    let metered = game.world_mut().map_or(0, |world| world.stop_work_meter());
    let work = work.saturating_add(metered);
    *spent = before.saturating_add(work);
    LimitKind::TickWork.check(work, limits.tick_work)?;
    LimitKind::TotalWork.check(*spent, limits.total_work)?;
    Ok(done)
}
