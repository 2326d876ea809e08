//! Lines and distances as long as the world.

use lockstep2d::body::{BodyDef, BodyId, Chain, Geometry, ShapeDef};
use lockstep2d::fx;
use lockstep2d::math::{Angle, Fx, Vec2};
use lockstep2d::world::{QueryFilter, World};

use super::{ball, rectangle, run, spawn, square, weightless};

/// The largest coordinate of a position, 2^30 m.
const EDGE: Fx = fx!(1073741824);

fn line(a: (Fx, Fx), b: (Fx, Fx)) -> ShapeDef {
    ShapeDef::new(Geometry::segment(a, b).expect("valid"))
}

fn pose(world: &World, id: BodyId) -> (Vec2<Fx>, Angle) {
    let body = world.body(id).expect("there");
    (body.position(), body.angle())
}

/// If lever arms were constant, the boxes would stay on their corners.
#[test]
fn a_box_tips_over_on_ground_of_any_length() {
    for degrees in [fx!(20), fx!(44), fx!(50), fx!(80)] {
        let [mut short, mut long] = [fx!(50), EDGE].map(|half| {
            let mut world = World::default();
            spawn(&mut world, BodyDef::fixed(), line((-half, fx!(0)), (half, fx!(0))));
            let def = BodyDef::dynamic().position((fx!(0), fx!(1))).angle(Angle::from_degrees(degrees));
            let id = spawn(&mut world, def, rectangle(fx!(0.6), fx!(0.5)));
            (world, id)
        });
        for tick in 0..180 {
            short.0.step();
            long.0.step();
            assert_eq!(pose(&long.0, long.1), pose(&short.0, short.1), "{degrees} degrees, tick {tick}");
        }
    }
}

/// The line is 3e9 m long. Its ends are further from some balls than coordinates reach.
#[test]
fn a_line_across_the_world_has_one_normal() {
    let link =
        Chain::new(&[(-EDGE, -EDGE), (EDGE, EDGE)].map(|(x, y)| Vec2::new(x, y))).links().expect("valid");
    let lines = [line((-EDGE, -EDGE), (EDGE, EDGE)), link[0]];
    let cases = lines.iter().flat_map(|line| [0, 30, 45, 80, 135, 250].map(|degrees| (line, degrees)));
    for (line, degrees) in cases {
        let mut world = weightless();
        let wall = BodyDef::fixed().angle(Angle::from_degrees(Fx::from_num(degrees)));
        spawn(&mut world, wall, *line);
        let direction = Angle::from_degrees(Fx::from_num(degrees + 45)).direction().widen();
        let normal = direction.perp();
        for along in [fx!(0), fx!(-1000), fx!(7000000), fx!(1070000000), fx!(-1070000000)] {
            // Near its ends the line is off by the rounding of the rotation.
            let start = direction.scale(along) + normal.scale(fx!(50));
            let filter = QueryFilter::default();
            let hit = world.cast_ray(start, normal.scale(fx!(-100)), filter).expect("the line is there");
            let place = hit.point + normal.scale(fx!(0.499));
            let probe = spawn(&mut world, BodyDef::dynamic().position(place), ball(fx!(0.5)));
            world.step();
            let contact = world.contacts().next().expect("the ball touches the line");
            let off = contact.manifold.normal.widen() - normal;
            let found = contact.manifold.points()[0].separation;
            assert!(off.length() < fx!(0.000001), "{degrees} degrees, {along} m: {off:?}");
            assert!((Fx::from(found) + fx!(0.001)).abs() < fx!(0.0001), "{degrees}, {along} m: {found}");
            world.despawn(probe).expect("there");
        }
    }
}

#[test]
fn a_line_beyond_the_range_of_coordinates_holds_a_ball() {
    for sign in [1, -1] {
        let mut world = World::default();
        let ground = BodyDef::fixed().position((EDGE * sign, fx!(0)));
        spawn(&mut world, ground, line((fx!(-100) * sign, fx!(0)), (EDGE * sign, fx!(0))));
        let place = Vec2::new((EDGE - fx!(50)) * sign, fx!(0.6));
        let ball = spawn(&mut world, BodyDef::dynamic().position(place), ball(fx!(0.5)));
        run(&mut world, 120);
        assert!((pose(&world, ball).0.y - fx!(0.5)).abs() < fx!(0.01), "{:?}", pose(&world, ball));
    }
}

#[test]
fn a_body_may_be_moved_from_one_end_of_the_world_to_the_other() {
    let mut world = weightless();
    let [a, b] = [Vec2::new(EDGE, -EDGE), Vec2::new(-EDGE, EDGE)];
    let id = spawn(&mut world, BodyDef::dynamic().position(a), square(fx!(0.5)));
    for place in [b, a, Vec2::ZERO] {
        world.set_transform(id, place, Angle::ZERO).expect("within the world");
        assert_eq!(pose(&world, id).0, place);
        run(&mut world, 2);
    }
}
