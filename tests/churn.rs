//! Ten thousand bodies come and go in random order: stale handles do not resolve, and a restored world continues
//! identically.

use lockstep2d::body::{BodyDef, BodyId, Geometry, JointId, Polygon, ShapeDef, ShapeId, WorldError};
use lockstep2d::fx;
use lockstep2d::math::Rng;
use lockstep2d::solver::{JointDef, Revolute};
use lockstep2d::world::World;

/// A world, and lists of its bodies, of all destroyed bodies and shapes, and of all joints ever added.
struct Churn {
    world: World,
    rng: Rng,
    alive: Vec<BodyId>,
    gone: Vec<BodyId>,
    gone_shapes: Vec<ShapeId>,
    joints: Vec<JointId>,
    spawned: u32,
}

impl Churn {
    fn new() -> Self {
        let mut world = World::default();
        let floor = ShapeDef::new(Polygon::rectangle(fx!(30), fx!(1)).expect("valid"));
        world.spawn(&BodyDef::fixed().position((fx!(0), fx!(-1))), &[floor]).expect("valid");
        let (alive, gone, gone_shapes, joints) = Default::default();
        Churn { world, rng: Rng::new(9), alive, gone, gone_shapes, joints, spawned: 0 }
    }

    fn change(&mut self) {
        match self.rng.below(9) {
            0..=4 => self.spawn(),
            5 if self.alive.len() > 2 => self.join(),
            _ if !self.alive.is_empty() => self.despawn(),
            _ => {}
        }
    }

    fn spawn(&mut self) {
        let rng = &mut self.rng;
        let def = BodyDef::dynamic().position((rng.range(fx!(-25), fx!(25)), rng.range(fx!(0), fx!(30))));
        let ball = ShapeDef::new(Geometry::circle(rng.range(fx!(0.1), fx!(0.4))).expect("valid"));
        let square = ShapeDef::new(Polygon::square(fx!(0.3)).expect("valid")).offset((fx!(0.3), fx!(0)));
        let id = self.world.spawn(&def.angle(rng.angle()), &[ball, square][..rng.below(2) as usize + 1]);
        self.alive.push(id.expect("valid"));
        self.spawned += 1;
    }

    fn join(&mut self) {
        let pick = |rng: &mut Rng, alive: &[BodyId]| {
            alive[rng.below(u32::try_from(alive.len()).expect("few")) as usize]
        };
        let (a, b) = (pick(&mut self.rng, &self.alive), pick(&mut self.rng, &self.alive));
        match self.world.add_joint(&JointDef::new(a, b, Revolute::new())) {
            Ok(id) => self.joints.push(id),
            Err(error) => assert_eq!(error, WorldError::JointToItself(a)),
        }
    }

    fn despawn(&mut self) {
        let count = u32::try_from(self.alive.len()).expect("few");
        let id = self.alive.swap_remove(self.rng.below(count) as usize);
        self.gone_shapes.extend_from_slice(self.world.body(id).expect("alive").shapes());
        self.world.despawn(id).expect("alive");
        self.gone.push(id);
    }

    fn check(&mut self) {
        assert_eq!(self.world.validate(), Ok(()));
        assert!(self.alive.iter().all(|&id| self.world.body(id).is_some()));
        assert!(self.gone.iter().all(|&id| self.world.body(id).is_none()), "a stale body resolves");
        assert!(self.gone_shapes.iter().all(|&id| self.world.shape(id).is_none()), "a stale shape resolves");
        for id in self.gone.iter().rev().take(3) {
            assert_eq!(self.world.despawn(*id), Err(WorldError::StaleBody(*id)));
        }
        let (world, joints) = (&self.world, &self.joints);
        let held = |id: &JointId| {
            world.joint(*id).is_none_or(|joint| {
                let (a, b) = joint.def().bodies();
                world.body(a).is_some() && world.body(b).is_some()
            })
        };
        assert!(joints.iter().all(held), "a joint has outlived a body");
    }
}

#[test]
fn ten_thousand_bodies_come_and_go() {
    let mut churn = Churn::new();
    let mut twin: Option<World> = None;
    while churn.spawned < 10_000 {
        // Keeps the world small: the test is about handles, not about large piles.
        while churn.alive.len() > 150 {
            churn.despawn();
        }
        churn.change();
        if churn.rng.below(16) == 0 {
            churn.world.step();
        }
        if churn.spawned.is_multiple_of(1000) {
            churn.check();
        }
        if churn.spawned == 5000 && twin.is_none() {
            twin = Some(World::from_bytes(&churn.world.to_bytes()).expect("its own bytes"));
            replay_on_twin(&mut churn, twin.as_mut().expect("just made"));
        }
    }
    churn.check();
    assert!(churn.gone.len() > 9000 && churn.joints.len() > 500, "{} joints", churn.joints.len());
}

/// Makes 500 equal changes and steps in both worlds, and expects that handles and hashes stay equal.
fn replay_on_twin(churn: &mut Churn, twin: &mut World) {
    for _ in 0..500 {
        let mut other = Churn {
            world: twin.clone(),
            rng: churn.rng.clone(),
            alive: churn.alive.clone(),
            gone: vec![],
            gone_shapes: vec![],
            joints: vec![],
            spawned: 0,
        };
        churn.change();
        other.change();
        churn.world.step();
        other.world.step();
        *twin = other.world;
        assert_eq!(churn.alive, other.alive, "expected the same handles");
        assert_eq!(churn.world.state_hash(), twin.state_hash());
    }
}
