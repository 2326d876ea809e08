//! A world with random changes.

use lockstep2d::body::{
    BodyDef, BodyId, BodyKind, Chain, Filter, Geometry, Polygon, ShapeDef, ShapeId, WorldError,
};
use lockstep2d::fx;
use lockstep2d::math::{Fx, Rng, Vec2};
use lockstep2d::world::World;

pub(crate) struct Churn {
    pub(crate) world: World,
    pub(crate) rng: Rng,
    pub(crate) centre: Vec2<Fx>,
    bodies: Vec<BodyId>,
}

impl Churn {
    pub(crate) fn new(seed: u64, centre: Vec2<Fx>) -> Self {
        let mut churn = Churn { world: World::default(), rng: Rng::new(seed), centre, bodies: vec![] };
        let (x, y) = (centre.x, centre.y);
        let hills: Vec<_> =
            (0..12).map(|_| churn.vector(fx!(10))).enumerate().map(|(i, p)| across(i, p.y / 8)).collect();
        let ground = Chain::new(&hills).links().expect("valid");
        churn.world.spawn(&BodyDef::fixed().position((x, y - fx!(8))), &ground).expect("valid");
        let ledge = Chain::new(&hills[3..6]).one_sided().links().expect("valid");
        churn.world.spawn(&BodyDef::fixed().position((x, y + fx!(2))), &ledge).expect("valid");
        let far = Vec2::new(fx!(500000000), fx!(1000000));
        let long = ShapeDef::new(Geometry::segment(-far, far).expect("valid"));
        churn.world.spawn(&BodyDef::fixed().position((x, y - fx!(12))), &[long]).expect("valid");
        (0..30).for_each(|_| churn.change());
        churn
    }

    pub(crate) fn vector(&mut self, size: Fx) -> Vec2<Fx> {
        Vec2::new(self.rng.range(-size, size), self.rng.range(-size, size))
    }

    pub(crate) fn place(&mut self, size: Fx) -> Vec2<Fx> {
        let offset = self.vector(size);
        self.centre + offset
    }

    pub(crate) fn geometry(&mut self) -> Geometry {
        loop {
            let size = self.rng.range(fx!(0.1), fx!(1));
            let (a, b) = (self.vector(fx!(1.5)), self.vector(fx!(1.5)));
            let points = [(); 6].map(|()| self.vector(fx!(1)));
            let made = match self.rng.below(6) {
                0 => Geometry::circle(size),
                1 => Geometry::capsule(a, b, size / 2),
                2 => Geometry::segment(a, b),
                3 => Polygon::hull(&points).map(Geometry::from),
                4 => Polygon::hull(&points).and_then(|hull| hull.rounded(size / 3)).map(Geometry::from),
                _ => Polygon::rectangle(size, fx!(0.2)).map(Geometry::from),
            };
            if let Ok(geometry) = made {
                return geometry;
            }
        }
    }

    fn shape(&mut self) -> ShapeDef {
        let filter = Filter { category: 1 << self.rng.below(3), mask: u64::MAX, group: 0 };
        let offset = self.vector(fx!(0.5));
        let shape = ShapeDef::new(self.geometry()).offset(offset).filter(filter);
        if self.rng.chance(1, 6) { shape.sensor() } else { shape }
    }

    pub(crate) fn change(&mut self) {
        let outcome = self.try_change();
        let allowed = |error: &WorldError| {
            matches!(
                error,
                WorldError::MassOutOfRange { .. }
                    | WorldError::GyrationOutOfRange { .. }
                    | WorldError::WrongKind(_)
                    | WorldError::OffsetOutOfRange { .. }
                    | WorldError::SpeedOutOfRange { .. }
            )
        };
        assert!(outcome.as_ref().err().is_none_or(allowed), "{outcome:?}");
    }

    fn try_change(&mut self) -> Result<(), WorldError> {
        let room = self.bodies.len() < 32;
        let Some(id) = self.any_body().filter(|_| !(room && self.rng.chance(1, 3))) else {
            return self.spawn();
        };
        let (place, velocity, angle) = (self.place(fx!(10)), self.vector(fx!(20)), self.rng.angle());
        let shape = self.any_shape(id);
        match self.rng.below(13) {
            0 => {
                self.bodies.retain(|other| *other != id);
                self.world.despawn(id)
            }
            1 => self.world.disable(id),
            2 | 3 => self.world.enable(id),
            4 => self.world.set_transform(id, place, angle),
            5 => self.world.set_velocity(id, velocity, fx!(3)),
            6 => {
                let shape = self.shape();
                self.world.add_shape(id, &shape).map(|_| ())
            }
            // The last shape of a body is not removed, so that queries find the body.
            7 if self.world.body(id).expect("alive").shapes().len() < 2 => Ok(()),
            7 => shape.map_or(Ok(()), |shape| self.world.remove_shape(shape)),
            8 => {
                let def = self.shape();
                shape.map_or(Ok(()), |shape| self.world.set_shape(shape, &def))
            }
            9 => {
                let kind =
                    [BodyKind::Fixed, BodyKind::Kinematic, BodyKind::Dynamic][self.rng.below(3) as usize];
                self.world.set_kind(id, kind)
            }
            10 => self.world.sleep(id),
            11 => self.world.wake(id),
            _ => self.world.move_to(id, place, angle),
        }
    }

    fn spawn(&mut self) -> Result<(), WorldError> {
        let place = self.place(fx!(10));
        let kind = self.rng.below(4);
        let def = match kind {
            0 => BodyDef::fixed(),
            1 => BodyDef::kinematic(),
            _ => BodyDef::dynamic(),
        };
        let def = def.position(place).angle(self.rng.angle());
        let shapes: Vec<_> = (0..1 + self.rng.below(3)).map(|_| self.shape()).collect();
        let id = self.world.spawn(&def, &shapes)?;
        self.bodies.push(id);
        Ok(())
    }

    pub(crate) fn any_body(&mut self) -> Option<BodyId> {
        let count = u32::try_from(self.bodies.len()).expect("few");
        (count > 0).then(|| self.bodies[self.rng.below(count) as usize])
    }

    fn any_shape(&mut self, id: BodyId) -> Option<ShapeId> {
        let shapes = self.world.body(id).expect("alive").shapes();
        let count = u32::try_from(shapes.len()).expect("few");
        (count > 0).then(|| shapes[self.rng.below(count) as usize])
    }
}

/// Point `i` of a hilly line that runs from right to left. The points are 2 m apart along x.
fn across(i: usize, height: Fx) -> Vec2<Fx> {
    Vec2::new(fx!(11) - Fx::from_num(i) * 2, height)
}
