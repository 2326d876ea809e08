//! Characters, which a game moves by its own rules.

use lockstep2d::world::World;

use crate::border::{In, Out};
use crate::describe::api;
use crate::numbers::{RawFx, RawVec2};
use crate::records::{RawMover, RawMoverPlane, RawMoverState, RawQueryFilter};
use crate::table::with;

api! {
    /// Sets the defaults of a character with a shape of the given kind: it stands on slopes up to 45 degrees, climbs no
    /// steps, and follows ground that descends by up to 0.1 m in a tick. The caller sets the geometry.
    fn ls2d_mover_init(kind: u32, mover: Out<'_, RawMover>) {
        let mut mover = mover;
        mover.set(RawMover::of_kind(kind))
    }

    /// Sets the state of a character at rest in the air, at a position in metres.
    fn ls2d_mover_state_init(x: RawFx, y: RawFx, state: Out<'_, RawMoverState>) {
        let mut state = state;
        state.set(RawMoverState::at(RawVec2 { x, y }.vec()))
    }

    /// Moves a character for one tick at its velocity among the shapes that a filter accepts. The game adds gravity to
    /// the velocity. `from` and `state` may point to the same struct. Writes the new state to `state`, and the surfaces
    /// to `met`, in the order in which the character meets them. If `met` is too short, the state is written
    /// nevertheless.
    fn ls2d_move_character(
        world: u32,
        mover: In<'_, RawMover>,
        from: In<'_, RawMoverState>,
        filter: In<'_, RawQueryFilter>,
        state: Out<'_, RawMoverState>,
        met: Out<'_, RawMoverPlane>,
        capacity: usize,
        count: Out<'_, usize>,
    ) {
        let (mut state, mut met, mut count) = (state, met, count);
        let (mover, from) = (mover.get()?.mover()?, from.get()?.state()?);
        let filter = RawQueryFilter::of(&filter)?;
        with(world, |world: &mut World| {
            let moved = world.move_character(&mover, &from, filter);
            state.set(RawMoverState::of(&moved.state, moved.is_wedged()))?;
            let planes: Vec<_> = moved.met.iter().map(RawMoverPlane::of).collect();
            met.set_all(capacity, &mut count, &planes)
        })
    }
}
