use super::*;
use crate::body::{Body, BodyDef, MassProperties, Polygon, ShapeDef};
use crate::collision::{CachedAxis, PosedShape, SatCounters, collide_near};
use crate::fx;
use crate::math::{Rng, narrow};

struct Boxes {
    bodies: [Body; 2],
    shapes: [ShapeDef; 2],
}

impl Boxes {
    /// Two boxes, one on top of the other, that overlap by up to 5 mm. Each box is up to 3 m from its body's centre
    /// of mass on each axis.
    fn random(rng: &mut Rng) -> Self {
        let square = ShapeDef::new(Polygon::square(fx!(0.5)).expect("valid"));
        let mut offset = || Vec2::new(rng.range(fx!(-3), fx!(3)), rng.range(fx!(-3), fx!(3)));
        let offsets = [offset(), offset()];
        let top = Vec2::new(rng.range(fx!(-0.9), fx!(0.9)), rng.range(fx!(0.995), fx!(1)));
        let body = |position: Vec2<Fx>| {
            Body::new(&BodyDef::dynamic().position(position), MassProperties::immovable())
        };
        Boxes {
            bodies: [body(-offsets[0]), body(top - offsets[1])],
            shapes: offsets.map(|offset| square.offset(offset)),
        }
    }

    fn manifold(&self) -> Manifold {
        let [a, b] = [0, 1].map(|i| {
            let body = &self.bodies[i];
            PosedShape::new(&self.shapes[i], body, body.rotation())
        });
        collide_near(&a, &b, Length::lit("0.02"), &mut CachedAxis::default(), &mut SatCounters::default())
    }

    fn poses(&self) -> [Pose; 2] {
        self.bodies.each_ref().map(Body::pose)
    }

    fn sides(&self, reach: Length) -> [KeptSide; 2] {
        self.poses().map(|pose| KeptSide { pose, reach })
    }
}

#[test]
fn separations_follow_the_bodies() {
    let mut rng = Rng::new(3);
    let mut kept_points = 0;
    for _ in 0..5000 {
        let mut boxes = Boxes::random(&mut rng);
        let first = boxes.manifold();
        let kept = KeptManifold::new(&first, boxes.poses());
        for body in &mut boxes.bodies {
            let moved = Vec2::new(rng.range(fx!(-0.001), fx!(0.001)), rng.range(fx!(-0.001), fx!(0.001)));
            let turned = Angle::from_radians(rng.range(fx!(-0.0003), fx!(0.0003)));
            body.set_transform(body.position() + moved, body.angle() + turned);
        }
        let manifold = boxes.manifold();
        let sides = boxes.sides(Length::lit("1"));
        let Some(separations) = kept.separations_at(sides, manifold.count(), Length::lit("0.005")) else {
            continue;
        };
        for (separation, old) in separations.iter().zip(first.points()) {
            // The order of the points depends on which box has the reference edge.
            let Some(point) = manifold.points().iter().find(|point| point.feature == old.feature) else {
                continue;
            };
            let error = separation.dist(point.separation);
            // `separations_at` is exact to first order only. The normal rotates by up to 0.0006 rad, and so does the
            // edge along which a clipped point moves.
            assert!(error < Step::lit("0.000007"), "{separation} instead of {}", point.separation);
            kept_points += 1;
        }
    }
    assert!(kept_points > 4000, "{kept_points}");
}

#[test]
fn a_manifold_is_kept_up_to_the_limit() {
    let mut rng = Rng::new(5);
    let boxes = Boxes::random(&mut rng);
    let kept = KeptManifold::new(&boxes.manifold(), boxes.poses());
    let limit = Length::lit("0.005");
    let at = |side: usize, moved: Vec2<Fx>, turned: Fx, reach: Length| {
        let mut sides = boxes.sides(reach);
        sides[side].pose.centre += moved;
        sides[side].pose.angle += Angle::from_radians(turned);
        kept.separations_at(sides, 2, limit)
    };
    for side in [0, 1] {
        assert!(at(side, Vec2::new(fx!(0.0049), fx!(0)), fx!(0), Length::ONE).is_some());
        assert!(at(side, Vec2::new(fx!(0.0026), fx!(-0.0026)), fx!(0), Length::ONE).is_none());
        assert!(at(side, Vec2::new(fx!(0), fx!(-0.0051)), fx!(0), Length::ONE).is_none());
        for turned in [fx!(0.006), fx!(-0.006), fx!(0.2), fx!(3.1)] {
            assert!(at(side, Vec2::ZERO, turned, Length::ONE).is_none(), "{turned}");
            assert_eq!(
                at(side, Vec2::ZERO, turned, Length::ZERO),
                Some(kept.separations),
                "rotation should not change a circle"
            );
        }
        let mut sides = boxes.sides(Length::ONE);
        sides.iter_mut().for_each(|side| side.pose.centre += Vec2::new(fx!(500), fx!(-700)));
        assert_eq!(kept.separations_at(sides, 2, limit), Some(kept.separations));
    }
}

/// The centre of mass of a fixed body may be so far away that the lever arm exceeds the range of `Length` and wraps.
#[test]
fn a_level_may_be_far_from_its_origin() {
    for far in [fx!(0), fx!(511.9), fx!(700), fx!(123456.789)] {
        let mut manifold = Manifold::new(Vec2::Y);
        let point = |x| crate::collision::ManifoldPoint {
            anchor: Vec2::new(x, Length::ZERO),
            separation: Step::ZERO,
            feature: crate::collision::Feature::SINGLE,
        };
        manifold.push(point(Length::ZERO));
        manifold.push(point(Length::ONE));
        let poses = [-far, fx!(0.25)].map(|x| Pose { centre: Vec2::new(x, fx!(0)), angle: Angle::ZERO });
        let kept = KeptManifold::new(&manifold, poses);
        assert_eq!(kept.arm_b, Vec2::new(Length::lit("-0.25"), Length::ZERO));
        let mut sides = poses.map(|pose| KeptSide { pose, reach: Length::ONE });
        sides[1].pose.centre.y = fx!(-0.001);
        let moved = kept.separations_at(sides, 2, Length::lit("0.005")).expect("within the limit");
        for separation in moved {
            let expected: Step = narrow(fx!(-0.001));
            assert!(separation.dist(expected) < Step::lit("0.0000005"), "{separation} at {far} m");
        }
    }
}

#[test]
fn stored_words_come_back_and_nonsense_is_invalid() {
    let mut rng = Rng::new(9);
    for _ in 0..100 {
        let words = core::array::from_fn(|_| rng.next_u32().cast_signed());
        let kept = KeptManifold::from_words(words);
        assert_eq!(kept.to_words(), words);
        assert!(!kept.is_valid(2), "a normal whose length is not 1 should be invalid: {kept:?}");
        let kept = KeptManifold { normal: Vec2::X, ..kept };
        assert!(kept.is_valid(2) && !kept.is_valid(1) && !kept.is_valid(0));
    }
    assert!(KeptManifold::NONE.is_valid(0));
}
