use alloc::format;
use alloc::string::String;
use alloc::vec::Vec;

use super::primitive::Style;
use crate::hash::StateHash;
use crate::math::Fx;
use crate::world::World;

/// The text beside a picture of a world: figures, state hash and names of the colours. The title is not included.
///
/// ```
/// use lockstep2d::{draw::{Layers, Legend, primitives}, world::World};
/// # use lockstep2d::{body::{BodyDef, Geometry, ShapeDef}, fx};
/// # let mut world = World::default();
/// world.spawn(&BodyDef::fixed(), &[ShapeDef::new(Geometry::circle(fx!(1))?)])?;
/// let styles = primitives(&world, Layers::default()).into_iter().map(|primitive| primitive.style);
/// let legend = Legend::of(&world, styles);
/// assert_eq!(legend.hash, world.state_hash());
/// assert!(legend.names.iter().any(|(name, _)| *name == "fixed"), "{:?}", legend.names);
/// # Ok::<(), lockstep2d::body::WorldError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Legend {
    /// A line with the tick, the numbers of bodies and contacts, [`World::deepest_overlap`],
    /// [`World::widest_joint_gap`], and the number of faults.
    pub figures: String,
    /// State hash of the world.
    pub hash: StateHash,
    /// Names of the styles in the picture, each once, with the colour as `0xRRGGBB`. Styles with many hues are listed
    /// in the colour of the legend's text.
    pub names: Vec<(&'static str, u32)>,
}

impl Legend {
    /// Creates the legend of a picture with these styles, in painting order.
    #[must_use]
    pub fn of(world: &World, styles: impl IntoIterator<Item = Style>) -> Self {
        let overlap = millimetres(world.deepest_overlap());
        let gap = millimetres(world.widest_joint_gap());
        let (tick, bodies, contacts) = (world.tick(), world.body_count(), world.contacts().count());
        let faults = world.faults();
        let figures = format!(
            "tick {tick} · {bodies} bodies · {contacts} contacts · deepest overlap {overlap:.1} mm · \
             widest joint gap {gap:.1} mm · {faults} faults"
        );
        let mut names = Vec::<(&str, u32)>::new();
        for style in styles {
            let name = style.paint().name;
            if names.iter().all(|(other, _)| *other != name) {
                names.push((name, style.legend_colour()));
            }
        }
        Legend { figures, hash: world.state_hash(), names }
    }
}

fn millimetres(length: Fx) -> Fx {
    length.saturating_mul_int(1000)
}
