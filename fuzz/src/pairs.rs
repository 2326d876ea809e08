//! Two shapes that jump about each other: what their contact is does not depend on what was found before, nor on vectors,
//! nor, but for a tie, on which of them comes first.

use lockstep2d::body::{BodyDef, BodyId, Geometry, ShapeDef, ShapeId};
use lockstep2d::collision::BroadPhaseKind;
use lockstep2d::collision::Manifold;
use lockstep2d::fx;
use lockstep2d::math::{Angle, Fx, Unit, Vec2};
use lockstep2d::world::{Backend, Config, World};

use crate::source::Source;
use crate::{generator, shapes};

/// How far separations may differ from each other and from distances: half a millimetre by which a face has to be better
/// than that of the other shape, and as much within which outlines count as touching.
const ERROR: Fx = fx!(0.001001);
/// How far the distance may be another one with the shapes exchanged, twice 20 nm, and a part of their size.
const DISTANCE_ERROR: Fx = fx!(0.00000005);
const PARTS: i64 = 1_000_000_000;

/// A world with two bodies.
#[derive(Clone)]
struct Pair {
    world: World,
    /// The one that is fixed, the one that moves.
    bodies: [BodyId; 2],
    shapes: [ShapeId; 2],
}

/// Lets one shape jump about another. Returns how many contacts there were; `None` if the shapes are refused.
///
/// # Panics
/// When caches, vectors or the order matter, or a contact is not one.
pub fn run(bytes: &[u8]) -> Option<u64> {
    let mut source = Source::new(bytes);
    let wild = generator::config(&mut source);
    let config = Config { gravity: Vec2::ZERO, sleeping: false, ..wild };
    let (still, moving) = (shapes::shape(&mut source), shapes::shape(&mut source));
    let mut first = Pair::new(config, still, moving, false)?;
    let mut second = Pair::new(config, still, moving, true)?;
    let mut bare = first.clone();
    bare.world.set_broad_phase(BroadPhaseKind::BruteForce);
    // Boxes one pair after the other: the others may have them in lanes.
    let scalar = bare.world.set_backend(Backend::Scalar);
    assert!(scalar, "every machine has it");
    let mut contacts = 0;
    for _ in 0..1 + source.below(8) {
        let reach = source.pick(&[500, 1500, 500, 5000, 0, 120_000]);
        let position = source.mostly_vec(-reach, reach);
        let angle = source.angle();
        for pair in [&mut first, &mut second, &mut bare] {
            pair.place(position, angle);
        }
        bare.world.clear_scratch();
        distances(&first);
        let before = first.world.distance(first.shapes[0], first.shapes[1]).map(|it| it.distance);
        for pair in [&mut first, &mut second, &mut bare] {
            pair.world.step();
        }
        let (found, again) = (first.contact(), bare.contact());
        assert_eq!(found, again, "caches or vectors decide");
        assert_eq!(first.world.state_hash(), bare.world.state_hash(), "caches or vectors decide");
        let Some((manifold, _)) = found else { continue };
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
                "{least} m in contact, {before} m apart at {position:?} {angle:?}: {still:?} {moving:?}"
            );
        }
        if let Some((swapped, _)) = second.contact() {
            let other = separation(&swapped);
            assert!(
                (least - other).abs() <= ERROR,
                "{least} m and, exchanged, {other} m at {position:?} {angle:?}: {still:?} {moving:?}"
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
        // Beyond the end of the world it stays where it is.
        let _ = self.world.set_transform(moving, position, angle);
        self.world.set_velocity(moving, Vec2::ZERO, Fx::ZERO).expect("no velocity is valid");
    }

    /// The contact, from the fixed shape to the other one.
    fn contact(&self) -> Option<(Manifold, bool)> {
        let contact = self.world.contacts().next()?;
        Some((*contact.manifold, contact.touching))
    }
}

/// Exchanged, the distance is the same and the normal the opposite, where there is no tie.
fn distances(pair: &Pair) {
    let [a, b] = pair.shapes;
    let (Some(there), Some(back)) = (pair.world.distance(a, b), pair.world.distance(b, a)) else { return };
    let size = (there.point_a - there.point_b).length();
    let error = DISTANCE_ERROR + (size + fx!(250)) / PARTS;
    let difference = (there.distance - back.distance).abs();
    assert!(difference <= error, "{} m, and {} m back", there.distance, back.distance);
    let length = there.normal.widen().length();
    assert!((length - Fx::ONE).abs() < Fx::from_bits(16), "a normal of length {length}");
    if there.distance > fx!(0.001) {
        let between = there.point_a.distance(there.point_b);
        assert!(
            (between - there.distance).abs() <= fx!(0.000001),
            "{between} m between, {} m apart",
            there.distance
        );
        let same: Unit = there.normal.dot(back.normal);
        assert!(same < Unit::ZERO, "{:?} there, {:?} back", there.normal, back.normal);
    }
}

/// Whether a polygon has a corner at which its outline goes on, or comes back, almost in the same direction: normals are
/// not exact enough to tell beside which of the two edges something is.
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
