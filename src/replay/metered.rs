use super::limits::{LimitKind, Limits};
use super::verdict::Verdict;
use crate::lockstep::Game;

/// Plays a tick by calling `step`, within [`Limits::tick_work`] and [`Limits::total_work`]. `spent` is the work of the
/// setup and of the earlier ticks (see [`RawReplay::work`](super::RawReplay::work)), to which this call adds the work
/// of the tick.
///
/// ```
/// use lockstep2d::lockstep::{Game, Sandbox, SandboxSetup};
/// use lockstep2d::replay::{Limits, play_within};
/// // A server refuses inputs that would take too long.
/// let (mut game, mut spent) = (Sandbox::new(&SandboxSetup::default())?, 0);
/// let limits = Limits { total_work: 100, ..Limits::default() };
/// let ticks = (0..).take_while(|_| play_within(&mut game, &[vec![]], &limits, &mut spent, Sandbox::step).is_ok());
/// assert_eq!(ticks.count(), 12);
/// # Ok::<(), lockstep2d::lockstep::SetupError>(())
/// ```
///
/// # Errors
/// [`Verdict::LimitExceeded`]. If the inputs alone exceed a limit, the tick is not played. If the world exceeds a limit
/// during the tick, the state of the game is wrong afterwards.
pub fn play_within<G: Game, T>(
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
    // The state of a world that has exhausted its work budget is wrong. Therefore the limits are checked again, before
    // the caller uses the game.
    let metered = game.world_mut().map_or(0, |world| world.stop_work_meter());
    let work = work.saturating_add(metered);
    *spent = before.saturating_add(work);
    LimitKind::TickWork.check(work, limits.tick_work)?;
    LimitKind::TotalWork.check(*spent, limits.total_work)?;
    Ok(done)
}
