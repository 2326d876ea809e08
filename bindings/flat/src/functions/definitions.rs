//! Definitions of bodies, shapes and joints.

use lockstep2d::body::{BodyDef, Chain, Geometry, MassProperties, ShapeDef};
use lockstep2d::math::{Fx, Vec2};

use crate::border::{In, Out};
use crate::describe::api;
use crate::numbers::{RawFx, RawVec2};
use crate::records::{CIRCLE, LINK_FLAGS, RawBodyDef, RawJointDef, RawShapeDef, body_kind};
use crate::status::Outcome;

/// Largest number of shapes in one call.
const SHAPES_MAX: usize = 4096;

pub(super) fn shapes_of(shapes: &In<'_, RawShapeDef>, count: usize) -> Outcome<Vec<ShapeDef>> {
    if count > SHAPES_MAX {
        return Err(super::library::copied("a body has at most 4096 shapes", count));
    }
    shapes.slice(count)?.iter().map(RawShapeDef::def).collect()
}

api! {
    /// Sets the defaults of a body of the given kind, at rest at the origin.
    fn ls2d_body_def_init(kind: u32, def: Out<'_, RawBodyDef>) {
        let mut def = def;
        def.set(RawBodyDef::of(&BodyDef::new(body_kind(kind)?)))
    }

    /// Sets the defaults of a shape of the given kind. The caller sets the geometry.
    fn ls2d_shape_def_init(kind: u32, def: Out<'_, RawShapeDef>) {
        let mut def = def;
        let mut raw = RawShapeDef::of(&ShapeDef::new(Geometry::Circle { radius: Fx::ZERO }));
        raw.kind = kind;
        def.set(raw)
    }

    /// Sets the defaults of a joint of the given kind. The caller sets its bodies, which are `LS2D_NO_ID` at first.
    fn ls2d_joint_def_init(kind: u32, def: Out<'_, RawJointDef>) {
        let mut def = def;
        def.set(RawJointDef::of_kind(kind)?)
    }

    /// Makes the links of a chain through some points. If `closed` is not 0, the last point is connected with the
    /// first. If `one_sided` is not 0, the chain is solid only from the right, looking along the points. The links take
    /// all other properties from `base`, whose geometry is ignored.
    fn ls2d_chain_links(
        base: In<'_, RawShapeDef>,
        points: In<'_, RawVec2>,
        point_count: usize,
        closed: u32,
        one_sided: u32,
        links: Out<'_, RawShapeDef>,
        capacity: usize,
        count: Out<'_, usize>,
    ) {
        let (mut links, mut count) = (links, count);
        let mut base = base.get()?;
        if point_count > SHAPES_MAX + 1 {
            return Err(super::library::copied("a chain has at most 4097 points", point_count));
        }
        let points: Vec<Vec2<Fx>> = points.slice(point_count)?.iter().map(|point| point.vec()).collect();
        let mut chain = Chain::new(&points);
        if closed != 0 {
            chain = chain.closed();
        }
        if one_sided != 0 {
            chain = chain.one_sided();
        }
        let made = chain.links()?;
        let flags = base.flags & !LINK_FLAGS;
        base = RawShapeDef { kind: CIRCLE, radius: RawFx::of(Fx::ONE), flags, ..base };
        let base = base.def()?;
        let with_base = |link: &ShapeDef| RawShapeDef::of(&ShapeDef { geometry: link.geometry, ..base });
        let made: Vec<RawShapeDef> = made.iter().map(with_base).collect();
        links.set_all(capacity, &mut count, &made)
    }

    /// Mass, centre of mass and radius of gyration of a dynamic body with some shapes, for an `ls2d_body_def`. Each
    /// pointer to a result may be null. At least one shape must have both an area and a density.
    fn ls2d_shapes_mass(
        shapes: In<'_, RawShapeDef>,
        shape_count: usize,
        mass: Out<'_, RawFx>,
        centre: Out<'_, RawVec2>,
        gyration: Out<'_, RawFx>,
    ) {
        let (mut mass, mut centre, mut gyration) = (mass, centre, gyration);
        let properties = MassProperties::of_shapes(&shapes_of(&shapes, shape_count)?)?;
        mass.set_if_wanted(RawFx::of(properties.mass()))?;
        centre.set_if_wanted(RawVec2::of(properties.centre_of_mass()))?;
        gyration.set_if_wanted(RawFx::of(properties.radius_of_gyration()))
    }
}
