//! [`LockstepGame`]: the games that can be a resource.

use lockstep2d::lockstep::Game;

/// A [`Game`] that can be part of a Bevy resource, because threads can share it, its inputs and its saves.
pub trait LockstepGame:
    Game<Setup: Send + Sync, Input: Send + Sync + 'static, Save: Send + Sync + 'static> + Send + Sync + 'static
{
}

impl<G> LockstepGame for G where
    G: Game<Setup: Send + Sync, Input: Send + Sync + 'static, Save: Send + Sync + 'static>
        + Send
        + Sync
        + 'static
{
}
