use super::*;
use crate::body::{Arena, Body, BodyDef, BodyId, MassProperties, MassSource};
use crate::fx;
use crate::math::{Fx, Speed, Unit, Vec2};

/// The share of a very heavy body rounds to 0, but its contacts must still have different colours.
#[test]
fn a_body_that_is_too_heavy_to_be_moved_is_still_one_that_changes() {
    let mut bodies: Arena<Body, BodyId> = Arena::default();
    for mass in [fx!(1073741824), fx!(0.00001)] {
        let source = MassSource::Given { mass, centre: Vec2::ZERO, gyration: fx!(1) };
        let mass = MassProperties::dynamic(source, core::iter::empty()).expect("valid");
        bodies.insert(Body::new(&BodyDef::dynamic(), mass));
    }
    let mut list = BodyList::default();
    list.fill(&bodies, &[0, 1]);
    let surface = Surface {
        friction: crate::math::FrictionRatio::ZERO,
        restitution: Unit::ZERO,
        restitution_threshold: Speed::ZERO,
        surface_speed: Speed::ZERO,
        rolling_resistance: Fx::ZERO,
    };
    let pair = ActiveContact {
        contact: 0,
        manifold: 0,
        shapes: (0, 1),
        bodies: (0, 1),
        surface,
        is_impact: false,
        is_hit: false,
        extras: false,
        keeps_rows: false,
    };
    let source = ContactSource {
        pairs: &[pair],
        manifolds: &[Manifold::new(Vec2::Y)],
        contacts: &[Contact::new((0, 1))],
        list: &list,
        mean_time: Fx::ZERO,
    };
    let mut input = Input::NONE;
    source.gather(&pair, &[Prospect::default(); 3], &mut WarmStarts::default(), &mut input);
    assert_eq!(input.shares.0[2], 0);
    let changed: Vec<_> = input.changed.into_iter().filter(|&index| index != GROUND).collect();
    assert_eq!(changed, input.bodies);
}
