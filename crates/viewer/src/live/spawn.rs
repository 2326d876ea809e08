//! Builds the spawn command of a body that the user draws.

use lockstep2d::body::{BodyDef, Geometry, GeometryError, Polygon, ShapeDef};
use lockstep2d::fx;
use lockstep2d::math::{Angle, Fx, Rng, Rot, Vec2, fx_mul};
use lockstep2d::world::Command;

use super::act::Form;

/// Size in metres of a body that is placed by a click: the radius, the half side of a box, or the length of a capsule's
/// segment.
const SIZE: Fx = fx!(0.5);
/// Drags shorter than this, in metres, count as clicks.
const CLICK: Fx = fx!(0.05);
/// Smallest half side of a box, in metres. Also the smallest radius and half length of a capsule.
const HALF_MIN: Fx = fx!(0.02);
/// Largest size, in metres.
const SIZE_MAX: Fx = fx!(50);

/// Returns the spawn command of a body drawn from `at` to `to`, if it has a valid shape.
pub(super) fn spawn(form: Form, at: Vec2<Fx>, to: Vec2<Fx>, rng: &mut Rng) -> Option<Command> {
    let way = to - at;
    let size = way.length();
    let way = if size < CLICK { None } else { Some(way) };
    let size = way.map_or(SIZE, |_| size.min(SIZE_MAX));
    let (body, geometry) = match form {
        Form::Circle => (upright(at), Geometry::circle(size)),
        Form::Box => (upright(at), rectangle(way)),
        Form::Polygon => (upright(at), polygon(size, rng).map(Geometry::from)),
        Form::Capsule => capsule(at, way, size),
    };
    Some(Command::Spawn { body, shapes: vec![ShapeDef::new(geometry.ok()?)] })
}

fn upright(at: Vec2<Fx>) -> BodyDef {
    BodyDef::dynamic().position(at)
}

fn rectangle(corner: Option<Vec2<Fx>>) -> Result<Geometry, GeometryError> {
    let half = |side: Fx| side.saturating_abs().clamp(HALF_MIN, SIZE_MAX);
    let (width, height) = corner.map_or((SIZE, SIZE), |corner| (half(corner.x), half(corner.y)));
    Polygon::rectangle(width, height).map(Geometry::from)
}

/// Convex hull of three to eight random points. Their distances from the centre are 0.6 to 1 times the radius.
fn polygon(radius: Fx, rng: &mut Rng) -> Result<Polygon, GeometryError> {
    let corners = 3 + rng.below(6);
    let points: Vec<_> = (0..corners)
        .map(|corner| {
            let part =
                fx_mul(Fx::from_num(corner) + rng.range(fx!(0), fx!(0.6)), Fx::ONE) / i64::from(corners);
            let distance = fx_mul(radius, rng.range(fx!(0.6), fx!(1)));
            Rot::from_angle(Angle::from_turns(part)).apply_wide(Vec2::new(distance, Fx::ZERO))
        })
        .collect();
    // If the points have no valid hull, a regular polygon replaces it.
    Polygon::hull(&points).or_else(|_| Polygon::regular(corners, radius))
}

/// Capsule along the drag. Its radius is a fifth of the length of the drag, and at least [`HALF_MIN`].
fn capsule(at: Vec2<Fx>, way: Option<Vec2<Fx>>, length: Fx) -> (BodyDef, Result<Geometry, GeometryError>) {
    let half = (length / 2).max(HALF_MIN);
    let radius = (length / 5).max(HALF_MIN);
    let shape = Geometry::capsule(Vec2::new(-half, Fx::ZERO), Vec2::new(half, Fx::ZERO), radius);
    let Some(way) = way else { return (upright(at), shape) };
    let angle = Angle::of(way);
    let middle = at + Rot::from_angle(angle).apply_wide(Vec2::new(half, Fx::ZERO));
    (upright(middle).angle(angle), shape)
}

#[cfg(test)]
mod tests {
    use lockstep2d::world::World;

    use super::*;

    #[test]
    fn every_form_of_every_size_is_a_body_where_it_was_drawn() {
        let mut rng = Rng::new(1);
        for form in Form::ALL {
            for length in [fx!(0), fx!(0.06), fx!(0.3), fx!(2), fx!(1000)] {
                for direction in [(1, 0), (-1, 0), (3, 4), (0, -1)] {
                    let way = Vec2::new(length * direction.0, length * direction.1);
                    let at = Vec2::new(fx!(7), fx!(-3));
                    let command = spawn(form, at, at + way, &mut rng);
                    let mut world = World::default();
                    let made = command.map(|command| world.execute(&command));
                    assert!(matches!(made, Some(Ok(_))), "{form:?} {length} {direction:?}");
                    assert_eq!(world.overlap_point(at, Default::default()).len(), 1, "{form:?} {length}");
                }
            }
        }
    }

    #[test]
    fn a_box_is_drawn_from_its_middle_to_a_corner() {
        let Some(Command::Spawn { shapes, .. }) =
            spawn(Form::Box, Vec2::ZERO, Vec2::new(fx!(-2), fx!(1)), &mut Rng::new(1))
        else {
            panic!("expected a box");
        };
        assert_eq!(shapes[0], ShapeDef::new(Polygon::rectangle(fx!(2), fx!(1)).expect("a rectangle")));
    }
}
