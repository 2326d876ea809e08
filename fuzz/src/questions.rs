//! Checks queries. Results must not depend on the broad phase or its history. In ordinary scenes they must agree with
//! the distances of all shapes.

use lockstep2d::body::{Geometry, Polygon, ShapeId};
use lockstep2d::collision::BroadPhaseKind;
use lockstep2d::fx;
use lockstep2d::math::{Aabb, Fx, Vec2};
use lockstep2d::world::{
    CastHit, InitialOverlap, Mover, MoverState, Probe, QueryFilter, World, clip_velocity, solve_planes,
};

use crate::generator::{self, Generator};
use crate::shapes;
use crate::source::Source;

mod singles;

/// A run ends early when the sum of [`generator::cost`] over its ticks exceeds this number.
const COST_MAX: u64 = 60_000;
/// Maximum difference, in metres, between a distance that follows from the result of a query and the same distance
/// computed directly.
const TOLERANCE: Fx = fx!(0.005);
/// Maximum penetration depth, in metres, of a probe into a shape that it rests on, or into the next shape when it
/// passes a seam.
const DEPTH_OF_REST: Fx = fx!(0.021);

/// Runs queries in the scene that the bytes describe. Returns the number of results that were not empty.
///
/// # Panics
/// When a result is wrong.
pub fn run(bytes: &[u8]) -> u64 {
    let mut source = Source::new(bytes);
    let config = generator::config(&mut source);
    let mut world = World::new(config).unwrap_or_default();
    let mut sweep = world.clone();
    sweep.set_broad_phase(BroadPhaseKind::SweepAndPrune);
    let mut generator = Generator::new(&mut source);
    let (mut answers, mut cost) = (0, 0);
    let mut commands = generator.setup(&mut source);
    for _ in 0..4 + source.below(28) {
        for command in &commands {
            assert_eq!(world.execute(command), sweep.execute(command), "{command:?}");
        }
        // Queries must also work between the commands and the tick.
        if source.one_in(3) {
            answers += ask(&mut source, &world, &sweep);
        }
        world.step();
        sweep.step();
        answers += ask(&mut source, &world, &sweep);
        cost += generator::cost(&world);
        if cost > COST_MAX {
            break;
        }
        commands = generator.tick(&mut source, &world);
    }
    answers
}

/// One world with three broad phases. `brute_force` is a new copy, and the other two have the history of the scene.
struct Questions<'a> {
    world: &'a World,
    sweep: &'a World,
    brute_force: World,
    filter: QueryFilter,
    /// Whether the scene is ordinary. Only then are rounding errors small enough to compare results with distances.
    ordinary: bool,
}

fn ask(source: &mut Source<'_>, world: &World, sweep: &World) -> u64 {
    let mut brute_force = world.clone();
    brute_force.set_broad_phase(BroadPhaseKind::BruteForce);
    let mut asked = Questions {
        world,
        sweep,
        brute_force,
        filter: QueryFilter::default(),
        ordinary: source.is_ordinary(),
    };
    let mut answers = 0;
    for _ in 0..1 + source.below(4) {
        asked.filter = filter(source, world);
        answers += u64::from(match source.below(12) {
            0 | 1 => asked.rays(source),
            2 | 3 => asked.casts(source),
            4 => asked.points(source),
            5 => asked.boxes(source),
            6 => asked.probes(source),
            7 => asked.planes(source),
            8 => asked.walks(source),
            9 => asked.turning_casts(source),
            10 => asked.singles(source),
            _ => asked.closest(source),
        });
    }
    answers
}

fn filter(source: &mut Source<'_>, world: &World) -> QueryFilter {
    let mut filter = QueryFilter::default();
    if source.one_in(4) {
        filter.category = source.pick(&[u64::MAX, 1, 2, 0]);
        filter.mask = source.pick(&[u64::MAX, 1, 2, 0]);
        filter.except = world.bodies().nth(source.below(world.body_count())).map(|(id, _)| id);
    }
    if source.one_in(4) {
        let bodies = 1 + source.below(QueryFilter::EXCEPT_ALSO_MAX);
        let bodies: Vec<_> = world.bodies().map(|(id, _)| id).take(bodies).collect();
        filter = filter.except_all(&bodies).expect("few bodies");
    }
    filter.initial_overlap =
        source.pick(&[InitialOverlap::Resist, InitialOverlap::Report, InitialOverlap::Ignore]);
    filter.sensors = source.one_in(2);
    filter
}

impl Questions<'_> {
    fn same<A: PartialEq + std::fmt::Debug>(&self, ask: impl Fn(&World) -> A) -> A {
        let answer = ask(self.world);
        assert_eq!(answer, ask(&self.brute_force), "the tree and brute force differ");
        assert_eq!(answer, ask(self.sweep), "the tree and sweep and prune differ");
        answer
    }

    /// The shapes that a query with `self.filter` can find.
    fn seen(&self) -> impl Iterator<Item = ShapeId> {
        self.world.shapes().filter_map(|(id, shape)| {
            let (filter, own) = (self.filter, shape.filter());
            let accepted = own.mask & filter.category != 0 && own.category & filter.mask != 0;
            let body = Some(shape.body());
            let excepted = filter.except == body || filter.except_also.contains(&body);
            let wanted = (filter.sensors || !shape.is_sensor()) && !excepted;
            (accepted && wanted && self.is_enabled(id)).then_some(id)
        })
    }

    fn is_enabled(&self, shape: ShapeId) -> bool {
        let body = self.world.shape(shape).and_then(|shape| self.world.body(shape.body()));
        body.is_some_and(|body| body.is_enabled())
    }

    /// A position, mostly near a shape.
    fn place(&self, source: &mut Source<'_>) -> Vec2<Fx> {
        if !self.ordinary && source.one_in(6) {
            return Vec2::new(source.edge(), source.edge());
        }
        let some = self.world.shapes().nth(source.below(self.world.shape_count()));
        let body = some.and_then(|(_, shape)| self.world.body(shape.body()));
        let offset = Vec2::new(source.mostly(-2000, 2000), source.mostly(-2000, 2000));
        body.map_or(Vec2::ZERO, |body| body.position()) + offset
    }

    fn way(&self, source: &mut Source<'_>) -> Vec2<Fx> {
        let reach = source.pick(&[5000, 1000, 20_000, 0]);
        if self.ordinary {
            Vec2::new(source.thousandths(-reach, reach), source.thousandths(-reach, reach))
        } else {
            source.mostly_vec(-reach, reach)
        }
    }

    fn probe(&self, source: &mut Source<'_>) -> Option<Probe> {
        let shape = if self.ordinary { shapes::ordinary_shape(source) } else { shapes::shape(source) };
        Some(Probe::new(shape.geometry, self.place(source)).ok()?.turned(source.angle()))
    }

    fn distance(&self, point: Vec2<Fx>, shape: ShapeId) -> Fx {
        let radius = fx!(0.002);
        let probe = Probe::new(Geometry::Circle { radius }, point).expect("a valid size");
        self.world.probe_distance(&probe, shape).expect("the shape exists").distance.saturating_add(radius)
    }

    /// Checks that `found` has the shapes that overlap the shape of a query, and no others. `distance` gives the
    /// distance of a shape from the shape of the query.
    fn check_found(&self, found: &[ShapeId], distance: impl Fn(ShapeId) -> Fx) {
        assert!(found.is_sorted_by(|a, b| a < b), "the shapes must be in slot order");
        if self.ordinary {
            for shape in self.seen() {
                let (away, is_found) = (distance(shape), found.contains(&shape));
                assert!(away <= TOLERANCE || !is_found, "{shape} is found at a distance of {away} m");
                assert!(away >= -TOLERANCE || is_found, "{shape} is not found at a distance of {away} m");
            }
        }
        let seen: Vec<_> = self.seen().collect();
        assert!(
            found.iter().all(|shape| seen.contains(shape)),
            "shapes excluded by the filter must not be found"
        );
    }

    fn points(&self, source: &mut Source<'_>) -> bool {
        let point = self.place(source);
        let found = self.same(|world| world.overlap_point(point, self.filter));
        self.check_found(&found, |shape| self.distance(point, shape));
        !found.is_empty()
    }

    fn probes(&self, source: &mut Source<'_>) -> bool {
        let Some(probe) = self.probe(source) else { return false };
        let found = self.same(|world| world.overlap_shape(&probe, self.filter));
        let distance = |shape| self.world.probe_distance(&probe, shape).expect("the shape exists").distance;
        self.check_found(&found, distance);
        let (a, b) = (source.below(self.world.shape_count()), source.below(self.world.shape_count()));
        let shape = |nth| self.world.shapes().nth(nth).map(|(id, _)| id);
        if let (Some(a), Some(b)) = (shape(a), shape(b)) {
            let there = self.same(|world| world.distance(a, b));
            let back = self.same(|world| world.distance(b, a));
            let difference = match (there, back) {
                (Some(there), Some(back)) => there.distance.saturating_sub(back.distance).saturating_abs(),
                (there, back) => {
                    assert!((there, back) == (None, None) && !(self.is_enabled(a) && self.is_enabled(b)));
                    Fx::ZERO
                }
            };
            assert!(!self.ordinary || difference <= TOLERANCE, "distance {there:?}, but {back:?} exchanged");
        }
        !found.is_empty()
    }

    fn boxes(&self, source: &mut Source<'_>) -> bool {
        let (a, b) = (self.place(source), self.place(source));
        let area = if source.one_in(16) { Aabb::new(a, b) } else { Aabb::new(a.min(b), a.max(b)) };
        let found = self.same(|world| world.overlap_box(area, self.filter));
        let half = (area.upper - area.lower).scale(fx!(0.5));
        let probe = Polygon::rectangle(half.x, half.y).ok();
        if let Some(probe) = probe.and_then(|probe| Probe::new(probe, area.centre()).ok()) {
            let distance =
                |shape| self.world.probe_distance(&probe, shape).expect("the shape exists").distance;
            self.check_found(&found, distance);
        }
        !found.is_empty()
    }

    fn closest(&self, source: &mut Source<'_>) -> bool {
        let (point, within) = (self.place(source), source.mostly(0, 5000));
        let found = self.same(|world| world.closest(point, within, self.filter));
        if self.ordinary {
            let least = self.seen().map(|shape| self.distance(point, shape)).min();
            match (&found, least) {
                (Some((_, found)), Some(least)) => {
                    let error = (found.distance - least).abs();
                    assert!(
                        error <= TOLERANCE,
                        "the closest shape is {} m away, expected {least} m",
                        found.distance
                    );
                }
                (Some(found), None) => panic!("there is no shape, but the query found {found:?}"),
                (None, least) => {
                    let far = least.is_none_or(|least| least >= within - TOLERANCE);
                    assert!(far, "nothing is found within {within} m, but the least distance is {least:?}");
                }
            }
        }
        found.is_some()
    }

    fn rays(&self, source: &mut Source<'_>) -> bool {
        let (origin, way) = (self.place(source), self.way(source));
        let hits = self.same(|world| world.cast_ray_all(origin, way, self.filter));
        let first = self.same(|world| world.cast_ray(origin, way, self.filter));
        assert_eq!(first, hits.first().copied(), "the single hit must be the first of all hits");
        assert_eq!(self.same(|world| world.cast_ray_any(origin, way, self.filter)), first.is_some());
        // Hits are ordered by their exact fractions, so hits with equal rounded fractions need not be in slot order.
        assert!(hits.is_sorted_by_key(|hit| hit.fraction), "hits must be in ascending order of the fraction");
        let seen: Vec<_> = self.seen().collect();
        for hit in &hits {
            assert!(seen.contains(&hit.shape) && (Fx::ZERO..=Fx::ONE).contains(&hit.fraction), "{hit:?}");
            let away = self.distance(hit.point, hit.shape);
            let good = away.abs() <= TOLERANCE || hit.fraction == 0 && away <= TOLERANCE;
            assert!(!self.ordinary || good, "{hit:?} is {away} m away from the shape");
        }
        if self.ordinary {
            let away = |fraction, shape| self.distance(origin + way.scale(fraction), shape);
            let ignored = |shape| {
                self.filter.initial_overlap == InitialOverlap::Ignore && away(Fx::ZERO, shape) <= TOLERANCE
            };
            for (fraction, shape) in self.samples(away).filter(|(_, shape)| !ignored(*shape)) {
                let hit = hits.iter().find(|hit| hit.shape == shape);
                assert!(
                    hit.is_some_and(|hit| hit.fraction <= fraction),
                    "{shape} is reached at {fraction}, but the hit is {hit:?}"
                );
            }
        }
        first.is_some()
    }

    fn casts(&self, source: &mut Source<'_>) -> bool {
        let Some(probe) = self.probe(source) else { return false };
        let way = self.way(source);
        let hit = self.same(|world| world.cast_shape(&probe, way, self.filter));
        if let Some(hit) = hit {
            assert!(
                self.seen().any(|shape| shape == hit.shape),
                "shapes excluded by the filter must not be hit"
            );
            assert!((Fx::ZERO..=Fx::ONE).contains(&hit.fraction), "{hit:?}");
        }
        if !self.ordinary {
            return hit.is_some();
        }
        let distance = |fraction, shape| {
            let there = self.world.probe_distance(&probe.at(probe.position() + way.scale(fraction)), shape);
            there.expect("the shape exists").distance
        };
        self.check_cast(hit, distance);
        hit.is_some()
    }

    /// Checks that a cast ends where the probe touches the hit shape, and that it passes through no shape before.
    /// `distance` gives the distance of a shape from the probe at a fraction of the cast.
    fn check_cast(&self, hit: Option<CastHit>, distance: impl Fn(Fx, ShapeId) -> Fx) {
        let touched_before = |shape| distance(Fx::ZERO, shape) <= TOLERANCE;
        if let Some(hit) = hit {
            let away = distance(hit.fraction, hit.shape);
            let good = away.abs() <= TOLERANCE || touched_before(hit.shape);
            assert!(good, "{hit:?} stops {away} m before the shape");
        }
        // A cast slides over seams between shapes. There, the probe may be as deep in the next shape as in the shape
        // that it rests on.
        let rests = self.seen().any(|shape| touched_before(shape));
        let deeper = if rests { DEPTH_OF_REST } else { Fx::ZERO };
        let inside = |fraction, shape| distance(fraction, shape).saturating_add(deeper);
        for (fraction, shape) in self.samples(inside).filter(|(_, shape)| !touched_before(*shape)) {
            assert!(
                hit.is_some_and(|hit| hit.fraction <= fraction),
                "{shape} is reached at {fraction}, but the hit is {hit:?}"
            );
        }
    }

    /// Compares the planes of a mover between the broad phases. Also runs the plane solver with arbitrary limits and
    /// separations, only to see that it does not panic.
    fn planes(&self, source: &mut Source<'_>) -> bool {
        let Some(probe) = self.probe(source) else { return false };
        let within = source.mostly(0, 2000);
        let mut planes = self.same(|world| world.collide_mover(&probe, within, self.filter));
        assert!(planes.is_sorted_by_key(|plane| plane.shape), "the planes must be in slot order");
        for plane in &mut planes {
            if source.one_in(4) {
                plane.push_limit = source.mostly(0, 1000);
            }
            if !self.ordinary && source.one_in(6) {
                plane.separation = source.edge();
            }
        }
        let (wanted, velocity) = (self.way(source), self.way(source));
        let _moved = solve_planes(wanted, &mut planes);
        let _left = clip_velocity(velocity, &planes);
        !planes.is_empty()
    }

    /// Moves a character without stepping the world.
    fn walks(&self, source: &mut Source<'_>) -> bool {
        let shape = if self.ordinary { shapes::ordinary_shape(source) } else { shapes::shape(source) };
        let Ok(mover) = Mover::new(shape.geometry) else { return false };
        let mover = mover.slope_max(source.angle()).step_height(source.mostly(0, 500));
        let mover = mover.snap_distance(source.mostly(0, 500));
        let mut state = MoverState::at(self.place(source));
        let mut met = false;
        for _ in 0..1 + source.below(4) {
            state.velocity = self.way(source);
            let moved = self.same(|world| world.move_character(&mover, &state, self.filter));
            met |= !moved.met.is_empty();
            state = moved.state;
        }
        met
    }

    /// Samples a path at 17 fractions from 0 to 1. Returns each fraction with each shape whose `distance` there is
    /// below -[`TOLERANCE`]. Links are left out, because they may be one-sided.
    fn samples<'a>(
        &'a self,
        distance: impl Fn(Fx, ShapeId) -> Fx + 'a,
    ) -> impl Iterator<Item = (Fx, ShapeId)> + 'a {
        let link = |id: ShapeId| {
            self.world.shape(id).is_some_and(|shape| matches!(shape.geometry(), Geometry::Link { .. }))
        };
        self.seen().filter(move |&shape| !link(shape)).flat_map(move |shape| {
            let inside = |fraction: &Fx| distance(*fraction, shape) < -TOLERANCE;
            let steps = (0..=16).map(|step| lockstep2d::math::ratio(step, 16));
            steps.filter(inside).map(|fraction| (fraction, shape)).collect::<Vec<_>>()
        })
    }
}
