//! [`Legend`]: what a picture of a world says in words.

use alloc::format;
use alloc::string::String;
use alloc::vec::Vec;

use super::primitive::Style;
use crate::hash::StateHash;
use crate::math::{Fx, widen};
use crate::world::World;

/// What a picture of a world says in words, below its title.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Legend {
    /// Tick, how much there is, and how well contacts and joints hold it.
    pub figures: String,
    /// Of the state.
    pub hash: StateHash,
    /// What can be seen, each with its colour as `0xRRGGBB`.
    pub names: Vec<(&'static str, u32)>,
}

impl Legend {
    /// Of a picture in which these styles can be seen, in the order in which they are painted.
    #[must_use]
    pub fn of(world: &World, styles: impl IntoIterator<Item = Style>) -> Self {
        let overlaps =
            world.contacts().flat_map(|contact| contact.manifold.points()).map(|point| -point.separation);
        let overlap = millimetres(overlaps.max().map_or(Fx::ZERO, widen));
        let gaps = world.joints().filter_map(|(id, _)| world.joint_anchors(id)).map(|(a, b)| a.distance(b));
        let gap = millimetres(gaps.max().unwrap_or_default());
        let (tick, bodies, contacts) = (world.tick(), world.body_count(), world.contacts().count());
        let faults = world.faults();
        let figures = format!(
            "tick {tick} · {bodies} bodies · {contacts} contacts · deepest overlap {overlap:.1} mm · \
             widest joint gap {gap:.1} mm · {faults} faults"
        );
        let paints = styles.into_iter().map(|style| style.paint());
        let mut names: Vec<_> = paints.map(|paint| (paint.name, paint.stroke)).collect();
        names.retain(|(name, _)| !name.is_empty());
        // Styles of many hues have one name.
        names.dedup_by_key(|(name, _)| *name);
        Legend { figures, hash: world.state_hash(), names }
    }
}

/// Of a length in metres; what does not reach anything is 0.
fn millimetres(length: Fx) -> Fx {
    length.max(Fx::ZERO).saturating_mul_int(1000)
}
