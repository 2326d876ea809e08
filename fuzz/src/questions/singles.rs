//! Casts that turn, and queries of single shapes.

use lockstep2d::math::{Angle, Fx, fx_mul};
use lockstep2d::world::{Displacement, QueryFilter, TimeOfImpact};

use super::{Questions, TOLERANCE};
use crate::source::Source;

impl Questions<'_> {
    pub(super) fn turning_casts(&self, source: &mut Source<'_>) -> bool {
        let Some(probe) = self.probe(source) else { return false };
        let angle = source.angle();
        let probe = probe.turned(angle);
        let (way, turns) = (self.way(source), source.mostly(-2000, 2000));
        let hit = self.same(|world| world.cast_turning(&probe, way, turns, self.filter));
        if let Some(hit) = hit {
            assert!(self.seen().any(|shape| shape == hit.shape), "excluded by the filter: {hit:?}");
            assert!((Fx::ZERO..=Fx::ONE).contains(&hit.fraction), "{hit:?}");
        }
        if self.ordinary {
            let distance = |fraction, shape| {
                let place = probe.position() + way.scale(fraction);
                let turned = probe.at(place).turned(angle + Angle::from_turns(fx_mul(turns, fraction)));
                self.world.probe_distance(&turned, shape).expect("the shape exists").distance
            };
            self.check_cast(hit, distance);
        }
        hit.is_some()
    }

    /// Compares queries of a single shape with queries of the world.
    pub(super) fn singles(&self, source: &mut Source<'_>) -> bool {
        let Some(loose) = self.probe(source) else { return false };
        let nth = source.below(self.world.shape_count());
        let Some((id, _)) = self.world.shapes().nth(nth) else { return false };
        let Some(shape) = self.world.probe_of(id) else {
            assert!(!self.is_enabled(id), "an enabled shape must have a probe");
            return false;
        };
        let (point, way) = (self.place(source), self.way(source));
        let all = QueryFilter { sensors: true, ..QueryFilter::default() };
        let is_seen = self.world.overlap_shape(&shape, all).contains(&id);
        let inside = self.world.overlap_point(point, all).contains(&id);
        assert_eq!(shape.contains_point(point) && is_seen, inside && is_seen);
        let hits = self.world.cast_ray_all(point, way, all);
        let hit = hits.iter().find(|hit| hit.shape == id).map(|hit| (hit.fraction, hit.point, hit.normal));
        let single = shape.cast_ray(point, way).map(|hit| (hit.fraction, hit.point, hit.normal));
        assert!(!is_seen || hit == single, "{hit:?}, but {single:?} alone");
        let found = loose.distance(&shape);
        assert_eq!(Some(found), self.world.probe_distance(&loose, id));
        assert!(!self.ordinary || loose.overlaps(&shape) == (found.distance <= 0), "{found:?}");
        let manifold = loose.manifold(&shape, source.mostly(0, 100));
        let turns = [source.mostly(-2000, 2000), source.mostly(-2000, 2000)];
        let own = Displacement { translation: way, turns: turns[0] };
        let theirs = Displacement { translation: self.way(source), turns: turns[1] };
        match loose.time_of_impact(own, &shape, theirs) {
            TimeOfImpact::Hit { fraction } | TimeOfImpact::Failed { fraction } => {
                assert!((Fx::ZERO..=Fx::ONE).contains(&fraction), "{fraction}");
            }
            TimeOfImpact::Overlapped => assert!(found.distance <= TOLERANCE, "{found:?}"),
            TimeOfImpact::Separated => assert!(!self.ordinary || found.distance > 0, "{found:?}"),
        }
        single.is_some() || !manifold.points().is_empty()
    }
}
