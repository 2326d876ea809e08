//! Casts that start in contact meet real obstacles, and only those.

use crate::sweep;
use lockstep2d::body::{BodyDef, Geometry, Polygon, ShapeDef, ShapeId};
use lockstep2d::fx;
use lockstep2d::math::{Angle, Fx, Rng, Rot, Unit, Vec2, fx_mul, ratio};
use lockstep2d::world::{CastHit, InitialOverlap, Probe, QueryFilter, World};

fn at(x: Fx, y: Fx) -> Vec2<Fx> {
    Vec2::new(x, y)
}

fn disc(radius: Fx) -> Geometry {
    Geometry::circle(radius).expect("valid")
}

fn rectangle(half_width: Fx, half_height: Fx) -> Geometry {
    Polygon::rectangle(half_width, half_height).expect("valid").into()
}

fn add(world: &mut World, geometry: Geometry, place: Vec2<Fx>) -> ShapeId {
    let body = world.spawn(&BodyDef::fixed().position(place), &[ShapeDef::new(geometry)]).expect("valid");
    world.shapes_of(body)[0]
}

fn probe(geometry: Geometry, place: Vec2<Fx>) -> Probe {
    Probe::new(geometry, place).expect("valid")
}

fn ignoring() -> QueryFilter {
    QueryFilter::default().initial_overlap(InitialOverlap::Ignore)
}

/// A ball on a floor overlaps a disc behind it by 20 mm. The disc would lift the ball off the floor.
#[test]
fn a_disc_behind_a_ball_does_not_hide_the_floor() {
    for gap in [fx!(0), fx!(0.00005), fx!(0.0002), fx!(0.003)] {
        for filter in [QueryFilter::default(), ignoring()] {
            let mut world = World::default();
            let floor = add(&mut world, rectangle(fx!(50), fx!(1)), at(fx!(0), fx!(-1) - gap));
            let ball = probe(disc(fx!(0.5)), at(fx!(0), fx!(0.5)));
            let way = at(fx!(1), fx!(-0.01));
            let alone = world.cast_shape(&ball, way, filter).expect("the floor");
            let turning_alone = world.cast_turning(&ball, way, fx!(0), filter).expect("the floor");
            add(&mut world, disc(fx!(0.5)), at(fx!(-0.693), fx!(-0.193)));
            let hit = world.cast_shape(&ball, way, filter).expect("the floor");
            assert!(hit.shape == floor && hit.fraction == alone.fraction, "{gap} {hit:?}");
            let hit = world.cast_turning(&ball, way, fx!(0), filter).expect("the floor");
            assert_eq!(hit, turning_alone, "{gap}");
        }
    }
}

/// A surface that the shape has left does not change what the cast meets afterwards.
#[test]
fn a_surface_left_behind_hides_no_obstacle() {
    let mut rng = Rng::new(3);
    let mut hits = 0;
    for case in 0..sweep::size(20_000, 2_000) {
        let moving = probe([disc(fx!(0.5)), rectangle(fx!(0.4), fx!(0.4))][case % 2], Vec2::ZERO);
        let mut world = World::default();
        let target = at(rng.range(fx!(2), fx!(9)), rng.range(fx!(-1.1), fx!(1.1)));
        add(&mut world, [disc(fx!(0.5)), rectangle(fx!(0.3), fx!(0.5))][case / 2 % 2], target);
        let cast = |world: &World| {
            let (way, filter) = (at(fx!(10), fx!(0)), QueryFilter::default());
            [world.cast_shape(&moving, way, filter), world.cast_turning(&moving, way, fx!(0), filter)]
        };
        let alone = cast(&world);
        // A disc on the left, into which the shape has sunk by up to 20 mm.
        let direction = Rot::from_angle(Angle::from_degrees(rng.range(fx!(90), fx!(270)))).apply(Vec2::X);
        let behind = |away: Fx| probe(disc(fx!(0.5)), direction.widen().scale(away));
        let gap = moving.distance(&behind(fx!(1.5))).distance + rng.range(fx!(0), fx!(0.0199));
        let behind = behind(fx!(1.5) - gap);
        let start = moving.distance(&behind);
        if start.normal.x > Unit::lit("-0.03") || start.distance < fx!(-0.0199) {
            continue;
        }
        add(&mut world, disc(fx!(0.5)), behind.position());
        assert_eq!(cast(&world), alone, "{case}: {target} {behind:?}");
        hits += alone.iter().flatten().count();
    }
    assert!(hits > 300, "{hits}");
}

/// A plank lies on a floor and has sunk into a pebble at its other end. Its tip turns into the floor.
#[test]
fn a_pebble_under_a_plank_does_not_hide_the_floor() {
    for gap in [fx!(0), fx!(0.0001), fx!(0.0002), fx!(0.001)] {
        let mut world = World::default();
        let floor = add(&mut world, rectangle(fx!(1.5), fx!(1)), at(fx!(0.8), fx!(-1) - gap));
        let plank = probe(rectangle(fx!(1), fx!(0.1)), at(fx!(0), fx!(0.1)));
        let cast = |world: &World| {
            world.cast_turning(&plank, Vec2::ZERO, fx!(-0.0016), QueryFilter::default()).expect("the floor")
        };
        let alone = cast(&world);
        add(&mut world, rectangle(fx!(0.1), fx!(0.1)), at(fx!(-0.9), fx!(-0.081)));
        let hit = cast(&world);
        assert!(hit == alone && hit.shape == floor, "{gap}: {hit:?} {alone:?}");
    }
}

/// A turn stops 0.1 mm deeper than at the start, however deep the start is.
#[test]
fn a_turn_does_not_sink_deeper_into_a_touched_floor() {
    for depth in [fx!(0), fx!(0.001), fx!(0.005), fx!(0.019)] {
        let mut world = World::default();
        let floor = add(&mut world, rectangle(fx!(9), fx!(1)), at(fx!(0), fx!(-1)));
        let plank = probe(rectangle(fx!(1), fx!(0.1)), at(fx!(0), fx!(0.1) - depth));
        for turns in [fx!(-0.0006), fx!(-0.0001), fx!(0.0006)] {
            let hit = world.cast_turning(&plank, Vec2::ZERO, turns, QueryFilter::default());
            let hit = hit.unwrap_or_else(|| panic!("{depth} {turns}: the floor"));
            let there = plank.turned(Angle::from_turns(fx_mul(turns, hit.fraction)));
            let deepest = world.probe_distance(&there, floor).expect("there").distance;
            assert!(deepest > -depth - fx!(0.00011), "{depth} {turns}: {deepest}");
        }
    }
}

/// A floor of tiles with a seam at x = 0.5001, just in front of the shape, and at each metre from there.
fn tiles() -> World {
    let mut world = World::default();
    for i in -3..4 {
        add(&mut world, rectangle(fx!(0.5), fx!(0.5)), at(Fx::from_num(i) + fx!(0.0001), fx!(-0.5)));
    }
    world
}

/// The shape has sunk into a tile and touches the side or corner of the next tile at the start.
#[test]
fn casts_pass_a_seam_that_they_touch_at_the_start() {
    let world = tiles();
    let round = Polygon::square(fx!(0.4)).and_then(|square| square.rounded(fx!(0.1))).expect("valid");
    for shape in [rectangle(fx!(0.5), fx!(0.5)), disc(fx!(0.5)), round.into()] {
        for depth in [fx!(0.0005), fx!(0.005), fx!(0.015)] {
            for ahead in (-30..=30).map(|i| ratio(i, 200)) {
                let moving = probe(shape, at(ahead, fx!(0.5) - depth));
                for rise in [fx!(0), fx!(0.001), fx!(0.01), fx!(0.2), fx!(1), fx!(4)] {
                    for filter in [QueryFilter::default(), ignoring()] {
                        let way = at(fx!(1.5), fx_mul(rise, fx!(1.5)));
                        let hit = world.cast_shape(&moving, way, filter);
                        assert_eq!(hit, None, "{depth} {ahead} {rise} {shape:?}");
                        let hit = world.cast_turning(&moving, way, fx!(0), filter);
                        assert_eq!(hit, None, "{depth} {ahead} {rise} {shape:?}");
                    }
                }
            }
        }
    }
}

/// A box in a floor of tiles rises while it turns, and its lower corner sweeps over the next tile.
#[test]
fn a_turn_passes_a_seam_that_it_touches_at_the_start() {
    let world = tiles();
    for depth in [fx!(0.001), fx!(0.005), fx!(0.01)] {
        for ahead in [fx!(0), fx!(0.00005), fx!(-0.0002), fx!(-0.001)] {
            let moving = probe(rectangle(fx!(0.5), fx!(0.5)), at(ahead, fx!(0.5) - depth));
            let hit =
                world.cast_turning(&moving, at(fx!(0), fx!(0.0035)), fx!(0.001), QueryFilter::default());
            assert_eq!(hit, None, "{depth} {ahead}");
        }
    }
}

/// A shape that slides out of a floor, into which it has sunk, stops at a wall.
#[test]
fn casts_that_leave_a_floor_stop_at_a_wall() {
    for depth in [fx!(0), fx!(0.005), fx!(0.015)] {
        for rise in [fx!(0), fx!(0.01), fx!(0.2), fx!(1)] {
            for shape in [rectangle(fx!(0.5), fx!(0.5)), disc(fx!(0.5))] {
                let mut world = tiles();
                let wall = add(&mut world, rectangle(fx!(0.5), fx!(9)), at(fx!(1.2), fx!(0)));
                let moving = probe(shape, at(fx!(0), fx!(0.5) - depth));
                let way = at(fx!(0.5), fx_mul(rise, fx!(0.5)));
                let straight = world.cast_shape(&moving, way, QueryFilter::default());
                let turning = world.cast_turning(&moving, way, fx!(0), QueryFilter::default());
                for hit in [straight, turning] {
                    let hit = hit.unwrap_or_else(|| panic!("{depth} {rise} {shape:?}: the wall"));
                    let CastHit { shape, travelled, normal, .. } = hit;
                    let away = (travelled.x - fx!(0.2)).abs();
                    assert!(shape == wall && away < fx!(0.0002) && normal.x == -1, "{depth} {rise} {hit:?}");
                }
            }
        }
    }
}
