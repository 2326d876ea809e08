//! [`Legend`]: the text of a picture of a world.

use alloc::format;
use alloc::string::String;
use alloc::vec::Vec;

use super::primitive::Style;
use crate::hash::StateHash;
use crate::math::{Fx, widen};
use crate::world::World;

/// The text of a picture of a world, below its title.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Legend {
    /// Tick, numbers of bodies and contacts, and the largest errors of contacts and joints.
    pub figures: String,
    /// State hash of the world.
    pub hash: StateHash,
    /// Names of the styles in the picture, each with its colour as `0xRRGGBB`.
    pub names: Vec<(&'static str, u32)>,
}

impl Legend {
    /// Creates the legend of a picture with these styles, given in the order in which they are painted.
    #[must_use]
    pub fn of(world: &World, styles: impl IntoIterator<Item = Style>) -> Self {
        let overlaps =
            world.contacts().flat_map(|contact| contact.manifold.points()).map(|point| -point.separation);
        let overlap = millimetres(overlaps.max().map_or(Fx::ZERO, widen));
        let enabled = world.joints().filter(|(_, joint)| joint.def().enabled);
        let gaps = enabled.filter_map(|(id, _)| world.joint_anchors(id)).map(|(a, b)| a.distance(b));
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
        // The styles of different hues share one name.
        names.dedup_by_key(|(name, _)| *name);
        Legend { figures, hash: world.state_hash(), names }
    }
}

/// A length in metres, converted to millimetres; negative lengths become 0.
fn millimetres(length: Fx) -> Fx {
    length.max(Fx::ZERO).saturating_mul_int(1000)
}
