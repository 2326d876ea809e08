//! Characters that are pushed or carried slide along the other surfaces that they touch.

use lockstep2d::body::{BodyDef, BodyId, BodyKind, Filter, Geometry, Polygon, ShapeDef};
use lockstep2d::fx;
use lockstep2d::math::{Angle, Fx, Rot, Unit, fx_mul};
use lockstep2d::world::{Moved, Mover, MoverState, QueryFilter, World};

use super::{RATES, at, fall, shapes, world};

fn rectangle(x: Fx, y: Fx) -> ShapeDef {
    ShapeDef::new(Polygon::rectangle(x, y).expect("valid"))
}

fn floor(world: &mut World) {
    world.spawn(&BodyDef::fixed().position((fx!(0), fx!(-1))), &[rectangle(fx!(50), fx!(1))]).expect("valid");
}

/// Steps the world, and moves a character that stands still.
fn wait(world: &mut World, mover: &Mover, state: &MoverState) -> MoverState {
    world.step();
    let velocity = at(fx!(0), state.velocity.y - fall(world.config().tick_rate));
    world.move_character(mover, &MoverState { velocity, ..*state }, QueryFilter::default()).state
}

fn distance(world: &World, mover: &Mover, state: &MoverState, body: BodyId) -> Fx {
    let shape = world.body(body).expect("there").shapes()[0];
    world.probe_distance(&mover.probe(state.position), shape).expect("there").distance
}

/// The largest overlap of the character with the body, and the last state, while the character stands still.
fn overlap(world: &mut World, mover: &Mover, start: MoverState, body: BodyId) -> (Fx, MoverState) {
    let (mut state, mut deepest) = (start, fx!(0));
    for _ in 0..world.config().tick_rate * 2 {
        state = wait(world, mover, &state);
        deepest = deepest.min(distance(world, mover, &state, body));
    }
    (deepest, state)
}

#[test]
fn a_box_pushes_a_standing_character_up_a_ramp() {
    for (rate, (name, shape)) in RATES.into_iter().flat_map(|rate| shapes().map(|shape| (rate, shape))) {
        for degrees in [0, 10, 30] {
            let mut world = world(rate);
            let angle = Angle::from_degrees(Fx::from_num(degrees));
            let below = Rot::from_angle(angle).apply_wide(at(fx!(0), fx!(-1)));
            world
                .spawn(&BodyDef::fixed().position(below).angle(angle), &[rectangle(fx!(50), fx!(1))])
                .expect("valid");
            let pusher = BodyDef::kinematic().position((fx!(-3), fx!(0))).velocity((fx!(3), fx!(0)));
            let pusher = world.spawn(&pusher, &[rectangle(fx!(0.5), fx!(9))]).expect("valid");
            let mover = Mover::new(shape).expect("valid").snap_distance(fx!(0.2));
            let start = MoverState::at(at(fx!(0), fx!(1.3)));
            let (deepest, state) = overlap(&mut world, &mover, start, pusher);
            let case = format!("{name}, {rate} Hz, {degrees} degrees: {deepest} m, {state:?}");
            assert!(deepest >= 0, "{case}");
            assert!(state.is_on_ground() && state.position.x > fx!(3.7), "{case}");
        }
    }
}

#[test]
fn a_boulder_pushes_a_standing_character_along_the_floor() {
    for (rate, (name, shape)) in RATES.into_iter().flat_map(|rate| shapes().map(|shape| (rate, shape))) {
        let mut world = world(rate);
        floor(&mut world);
        let boulder = BodyDef::kinematic().position((fx!(-4), fx!(2))).velocity((fx!(3), fx!(0)));
        let circle = ShapeDef::new(Geometry::circle(fx!(2)).expect("valid"));
        let boulder = world.spawn(&boulder, &[circle]).expect("valid");
        let mover = Mover::new(shape).expect("valid");
        let start = MoverState::at(at(fx!(0), fx!(0.7001)));
        let (deepest, state) = overlap(&mut world, &mover, start, boulder);
        let case = format!("{name}, {rate} Hz: {deepest} m, {state:?}");
        assert!(deepest >= 0, "{case}");
        assert!(state.is_on_ground() && state.position.x > fx!(3.5), "{case}");
        assert!((state.position.y - fx!(0.7001)).abs() < fx!(0.00001), "{case}");
    }
}

/// A wall that leans over the lift pushes the rider aside.
#[test]
fn a_lift_carries_its_rider_along_a_leaning_wall() {
    for (rate, (name, shape)) in RATES.into_iter().flat_map(|rate| shapes().map(|shape| (rate, shape))) {
        let mut world = world(rate);
        let lift = BodyDef::kinematic().position((fx!(0), fx!(-0.5))).velocity((fx!(0), fx!(2)));
        let lift = world.spawn(&lift, &[rectangle(fx!(3), fx!(0.5))]).expect("valid");
        let lean = Angle::from_degrees(fx!(5));
        // At first, the wall is a few centimetres away.
        let width = if name == "ball" { fx!(0.7) } else { fx!(0.3) };
        let centre = at(width + fx!(0.1), fx!(0.7)) + Rot::from_angle(lean).apply_wide(at(fx!(0.5), fx!(0)));
        let wall = BodyDef::fixed().position(centre).angle(lean);
        let wall = world.spawn(&wall, &[rectangle(fx!(0.5), fx!(9))]).expect("valid");
        let mover = Mover::new(shape).expect("valid");
        let mut state = MoverState::at(at(fx!(0), fx!(0.7001)));
        for number in 0..rate * 3 / 2 {
            state = wait(&mut world, &mover, &state);
            let case = format!("{name}, {rate} Hz, tick {number}: {state:?}");
            let above = state.position.y - fx!(1.2) - world.body(lift).expect("there").position().y;
            assert!(
                (fx!(0)..fx!(0.0002)).contains(&above) && state.is_on_ground(),
                "{case}: {above} m above"
            );
            assert!(distance(&world, &mover, &state, wall) > 0, "{case}");
        }
    }
}

/// Between nearly parallel surfaces a character is crushed, and not shot out to the side.
#[test]
fn a_press_does_not_shoot_characters_out() {
    for ((name, shape), degrees) in
        shapes().into_iter().flat_map(|shape| [0, 1, 5].map(|angle| (shape, angle)))
    {
        let mut world = world(60);
        floor(&mut world);
        let angle = Angle::from_degrees(Fx::from_num(degrees));
        let press = BodyDef::kinematic().position((fx!(0), fx!(4))).angle(angle).velocity((fx!(0), fx!(-3)));
        world.spawn(&press, &[rectangle(fx!(9), fx!(0.5))]).expect("valid");
        let mover = Mover::new(shape).expect("valid");
        let mut state = MoverState::at(at(fx!(0), fx!(0.7001)));
        for number in 0..60 {
            let next = wait(&mut world, &mover, &state);
            let moved = next.position.distance(state.position);
            assert!(moved < fx!(0.25), "{name}, {degrees} degrees, tick {number}: moved by {moved} m");
            state = next;
        }
    }
}

/// Walks to the right at 3 m/s for two seconds against a crate. `push` is called after each move. Returns the distances
/// that the character and the crate have moved.
fn walk_against_crate(
    filter: impl Fn(BodyId) -> QueryFilter,
    push: impl Fn(&mut World, BodyId, &Moved),
) -> (Fx, Fx) {
    let mut world = world(60);
    floor(&mut world);
    let pill = shapes()[0].1;
    let own = world.spawn(&BodyDef::kinematic().position((fx!(0), fx!(0.7001))), &[ShapeDef::new(pill)]);
    let own = own.expect("valid");
    let of_crates = Filter { category: CRATE, ..Filter::default() };
    let square = ShapeDef::new(Polygon::square(fx!(0.5)).expect("valid")).filter(of_crates);
    let pushed = world.spawn(&BodyDef::dynamic().position((fx!(2), fx!(0.5))), &[square]).expect("valid");
    let mover = Mover::new(pill).expect("valid");
    let mut state = MoverState::at(at(fx!(0), fx!(0.7001)));
    for _ in 0..120 {
        world.step();
        state.velocity = at(SPEED, state.velocity.y - fall(60));
        let moved = world.move_character(&mover, &state, filter(own));
        push(&mut world, own, &moved);
        state = moved.state;
        assert!(state.is_on_ground(), "{state:?}");
    }
    (state.position.x, world.body(pushed).expect("there").position().x - fx!(2))
}

const CRATE: u64 = 2;

const SPEED: Fx = fx!(3);

/// Bodies that the filter sees stop a character, even if the character's kinematic body follows it.
#[test]
fn a_character_pushes_crates_by_impulses_or_by_its_kinematic_body() {
    let follow = |world: &mut World, own: BodyId, moved: &Moved| {
        world.move_to(own, moved.state.position, Angle::ZERO).expect("near");
    };
    let (walked, pushed) = walk_against_crate(|own| QueryFilter::default().except(own), follow);
    assert!(walked < fx!(1.3) && pushed.abs() < fx!(0.01), "a crate that is seen: {walked} m, {pushed} m");

    let unseen = |own| QueryFilter { mask: !CRATE, ..QueryFilter::default().except(own) };
    let (walked, pushed) = walk_against_crate(unseen, follow);
    assert!(walked > fx!(5.9) && pushed > fx!(4.6), "a crate that is not seen: {walked} m, {pushed} m");

    let impulses = |world: &mut World, _: BodyId, moved: &Moved| {
        for plane in &moved.met {
            let Some(body) = world.body(plane.body).filter(|body| body.kind() == BodyKind::Dynamic) else {
                continue;
            };
            let missing = SPEED - body.velocity().x;
            if plane.normal.x < Unit::lit("-0.5") && missing > 0 {
                let impulse = fx_mul(missing, body.mass()).min(fx!(2));
                world.apply_impulse_to_centre(plane.body, at(impulse, fx!(0))).expect("dynamic");
            }
        }
    };
    let (walked, pushed) = walk_against_crate(|own| QueryFilter::default().except(own), impulses);
    assert!(walked > fx!(5) && pushed > fx!(3.8), "by impulses: {walked} m, {pushed} m");
}
