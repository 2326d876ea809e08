//! Two shapes at changing relative positions. Their contact must not depend on caches or on SIMD. If the shapes are
//! exchanged, its separation may change by at most `ERROR`.

use lockstep2d::body::{BodyDef, BodyId, Geometry, ShapeDef, ShapeId};
use lockstep2d::collision::BroadPhaseKind;
use lockstep2d::collision::Manifold;
use lockstep2d::fx;
use lockstep2d::math::{Angle, Fx, Unit, Vec2};
use lockstep2d::world::{Backend, Config, World};

use crate::source::Source;
use crate::{generator, shapes};

/// Maximum difference between two separations, or between a separation and a distance, in metres: 0.5 mm because a face
/// of the second shape is chosen only if its separation exceeds that of the best face of the first by more than 0.5 mm,
/// 0.5 mm because outlines up to 0.5 mm apart count as touching, and 1 µm for rounding.
const ERROR: Fx = fx!(0.001001);
/// Maximum difference, in metres, between the distance from A to B and the one from B to A: twice the error of a
/// distance (20 nm), rounded up.
const DISTANCE_ERROR: Fx = fx!(0.00000005);
/// Divisor for the part of the error that grows with the distance: the distance between the nearest points plus 250 m,
/// divided by this number, is added to [`DISTANCE_ERROR`].
const PARTS: i64 = 1_000_000_000;

#[derive(Clone)]
struct Pair {
    world: World,
    /// The fixed body and the moving body.
    bodies: [BodyId; 2],
    shapes: [ShapeId; 2],
}

/// Moves one shape around another. Returns the number of contacts, or `None` if a shape is refused.
///
/// # Panics
/// When a contact is invalid, or depends on caches, SIMD or the order of the shapes.
pub fn run(bytes: &[u8]) -> Option<u64> {
    let mut source = Source::new(bytes);
    let wild = generator::config(&mut source);
    let config = Config { gravity: Vec2::ZERO, sleeping: false, ..wild };
    let (still, moving) = (shapes::shape(&mut source), shapes::shape(&mut source));
    let new = Pair::new(config, still, moving, false)?;
    let new_swapped = Pair::new(config, still, moving, true)?;
    let (mut first, mut bare) = (new.clone(), new.clone());
    bare.world.set_broad_phase(BroadPhaseKind::BruteForce);
    // This world tests AABBs one pair at a time. The other worlds may use SIMD lanes.
    let scalar = bare.world.set_backend(Backend::Scalar);
    assert!(scalar, "every machine has the scalar backend");
    let mut contacts = 0;
    for _ in 0..1 + source.below(8) {
        let reach = source.pick(&[500, 1500, 500, 5000, 0, 120_000]);
        let position = source.mostly_vec(-reach, reach);
        let angle = source.angle();
        // A pair that has hardly moved keeps its manifold, even if a new search would choose another face. Therefore
        // only contacts of new worlds are compared with the distance, and with the contact of the exchanged shapes.
        let (mut fresh, mut swapped) = (new.clone(), new_swapped.clone());
        for pair in [&mut first, &mut bare, &mut fresh, &mut swapped] {
            pair.place(position, angle);
        }
        bare.world.clear_scratch();
        distances(&first);
        let before = fresh.world.distance(fresh.shapes[0], fresh.shapes[1]).map(|it| it.distance);
        for pair in [&mut first, &mut bare, &mut fresh, &mut swapped] {
            pair.world.step();
        }
        let (found, again) = (first.contact(), bare.contact());
        assert_eq!(found, again, "the contact must not depend on caches or SIMD");
        assert_eq!(
            first.world.state_hash(),
            bare.world.state_hash(),
            "the state must not depend on caches or SIMD"
        );
        found.iter().for_each(|(manifold, _)| check(manifold));
        let Some((manifold, _)) = fresh.contact() else { continue };
        contacts += 1;
        check(&manifold);
        let links = [still, moving].iter().any(|def| matches!(def.geometry, Geometry::Link { .. }));
        if links || still.one_way.is_some() || moving.one_way.is_some() {
            continue;
        }
        if is_thin(&still) || is_thin(&moving) {
            continue;
        }
        let least = separation(&manifold);
        if let Some(before) = before.filter(|before| *before > fx!(-15)) {
            assert!(
                (least - before).abs() <= ERROR,
                "separation {least} m, but distance {before} m, at {position:?} {angle:?}: {still:?} {moving:?}"
            );
        }
        if let Some((swapped, _)) = swapped.contact() {
            let other = separation(&swapped);
            assert!(
                (least - other).abs() <= ERROR,
                "separation {least} m, but {other} m if swapped, at {position:?} {angle:?}: {still:?} {moving:?}"
            );
        } else {
            assert!(least > config.touching_distance() - ERROR, "no contact with the shapes exchanged");
        }
    }
    Some(contacts)
}

impl Pair {
    fn new(config: Config, still: ShapeDef, moving: ShapeDef, moving_first: bool) -> Option<Self> {
        let mut world = World::new(config).ok()?;
        let mut spawn = |body: &BodyDef, shape| {
            let body = world.spawn(body, &[shape]).ok()?;
            Some((body, world.body(body)?.shapes()[0]))
        };
        let (fixed, free) = (BodyDef::fixed(), BodyDef::dynamic());
        let ((a, shape_a), (b, shape_b)) = if moving_first {
            let b = spawn(&free, moving)?;
            (spawn(&fixed, still)?, b)
        } else {
            (spawn(&fixed, still)?, spawn(&free, moving)?)
        };
        Some(Pair { world, bodies: [a, b], shapes: [shape_a, shape_b] })
    }

    fn place(&mut self, position: Vec2<Fx>, angle: Angle) {
        let [_, moving] = self.bodies;
        // If the position is beyond the end of the world, the world refuses it and the body stays.
        let _ = self.world.set_transform(moving, position, angle);
        self.world.set_velocity(moving, Vec2::ZERO, Fx::ZERO).expect("a velocity of zero is valid");
    }

    /// The contact, and whether it is touching.
    fn contact(&self) -> Option<(Manifold, bool)> {
        let contact = self.world.contacts().next()?;
        Some((*contact.manifold, contact.touching))
    }
}

/// Checks that the distance stays the same when the shapes are exchanged. If they are more than 1 mm apart, also checks
/// that the normal then points the opposite way, and that the nearest points are at this distance from each other.
fn distances(pair: &Pair) {
    let [a, b] = pair.shapes;
    let (Some(there), Some(back)) = (pair.world.distance(a, b), pair.world.distance(b, a)) else { return };
    let size = (there.point_a - there.point_b).length();
    let error = DISTANCE_ERROR + (size + fx!(250)) / PARTS;
    let difference = (there.distance - back.distance).abs();
    assert!(
        difference <= error,
        "the distance is {} m, and {} m with the shapes exchanged",
        there.distance,
        back.distance
    );
    let length = there.normal.widen().length();
    assert!((length - Fx::ONE).abs() < Fx::from_bits(16), "a normal of length {length}");
    if there.distance > fx!(0.001) {
        let between = there.point_a.distance(there.point_b);
        assert!(
            (between - there.distance).abs() <= fx!(0.000001),
            "the nearest points are {between} m apart, but the distance is {} m",
            there.distance
        );
        let same: Unit = there.normal.dot(back.normal);
        assert!(
            same < Unit::ZERO,
            "the normal is {:?}, and {:?} with the shapes exchanged",
            there.normal,
            back.normal
        );
    }
}

/// Whether two consecutive edges of a polygon are almost parallel. Their normals are then not precise enough to decide
/// which of the edges is nearer to the other shape.
fn is_thin(def: &ShapeDef) -> bool {
    let Geometry::Polygon(polygon) = &def.geometry else { return false };
    let normals = polygon.normals();
    let turn = |(n, next): (&Vec2<Unit>, &Vec2<Unit>)| n.widen().cross(next.widen()).abs();
    normals.iter().zip(normals.iter().cycle().skip(1)).map(turn).any(|turn| turn < fx!(0.0001))
}

fn separation(manifold: &Manifold) -> Fx {
    let least = manifold.points().iter().map(|point| point.separation).min();
    least.expect("a contact has points").into()
}

fn check(manifold: &Manifold) {
    let length = manifold.normal.widen().length();
    assert!((length - Fx::ONE).abs() < Fx::from_bits(16), "a normal of length {length}");
    let [first, rest @ ..] = manifold.points() else { panic!("a contact without points") };
    assert!(rest.iter().all(|point| point.feature != first.feature), "points with one feature: {manifold:?}");
}
