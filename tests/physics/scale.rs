//! With `Config::for_smallest`, stacks of boxes of any size are as firm as stacks of boxes of 1 m.
//!
//! A contact yields by about `g / omega^2` for each body that it carries, whatever the size of the bodies, so smaller
//! bodies need stiffer contacts. The documentation of `Config` has a table of the settings for each size.

use lockstep2d::body::{BodyDef, BodyId, Polygon, ShapeDef};
use lockstep2d::fx;
use lockstep2d::math::{Fx, Rng, Vec2, fx_div, fx_mul};
use lockstep2d::solver::ContactTuning;
use lockstep2d::world::{Config, World};

/// A floor with its top at height 0, and boxes of one size.
struct Floor {
    world: World,
    size: Fx,
}

impl Floor {
    fn new(config: Config, size: Fx) -> Self {
        let mut world = World::new(config).expect("valid settings");
        let floor = ShapeDef::new(Polygon::rectangle(size * 10, size).expect("valid"));
        world.spawn(&BodyDef::fixed().position((fx!(0), -size)), &[floor]).expect("valid");
        Floor { world, size }
    }

    /// Adds a box at a position in units of the size.
    fn add(&mut self, x: Fx, y: Fx) -> BodyId {
        let shape = ShapeDef::new(Polygon::square(self.size / 2).expect("valid"));
        let position = Vec2::new(fx_mul(x, self.size), fx_mul(y, self.size));
        self.world.spawn(&BodyDef::dynamic().position(position), &[shape]).expect("valid")
    }

    /// Position of a body in units of the size.
    fn place(&self, id: BodyId) -> Vec2<Fx> {
        let at = self.world.body(id).expect("there").position();
        let units = |x: Fx| fx_div(x, self.size).expect("positive");
        Vec2::new(units(at.x), units(at.y))
    }

    fn run(&mut self, seconds: u32) {
        for _ in 0..seconds * self.world.config().tick_rate {
            self.world.step();
        }
        assert_eq!(self.world.faults(), 0);
    }

    fn is_asleep(&self) -> bool {
        self.world.bodies().all(|(_, body)| !body.is_dynamic() || body.is_asleep())
    }
}

/// Overlap in a column of 8 boxes after 10 s: distance of the topmost box below its place in a column without overlaps,
/// in units of the size of a box. At the start, the gaps between the boxes are 1 % of this size.
fn sink(config: Config, size: Fx) -> Fx {
    let mut floor = Floor::new(config, size);
    let boxes: Vec<BodyId> = (0..8).map(|i| floor.add(fx!(0), fx!(0.5) + fx!(1.01) * i)).collect();
    floor.run(10);
    assert!(floor.is_asleep(), "{size} m: expected rest");
    fx!(7.5) - floor.place(boxes[7]).y
}

/// Checks a column of 20 boxes, each moved sideways by up to 1 % of its size, and a pyramid of 10 rows. Small boxes
/// sway faster, so they sway more often in the half second until they sleep. At the end, a column of boxes of 1 cm
/// leans by 0.11 of the size of a box, and a column of boxes of 1 m by 0.002 of it.
fn check_piles(config: Config, size: Fx) {
    let mut floor = Floor::new(config, size);
    let mut rng = Rng::new(5);
    let last =
        (0..20).map(|i| floor.add(rng.range(fx!(-0.01), fx!(0.01)), fx!(0.5) + Fx::from_num(i))).last();
    floor.run(10);
    let top = floor.place(last.expect("twenty"));
    assert!(floor.is_asleep() && top.x.abs() < fx!(0.125), "{size} m: the top of a column is at {top:?}");

    let mut floor = Floor::new(config, size);
    let mut top = None;
    for row in 0..10 {
        for i in 0..10 - row {
            top = Some(floor.add(fx!(1.1) * i + fx!(0.55) * row - fx!(5), fx!(0.5) + fx!(1.02) * row));
        }
    }
    floor.run(10);
    let top = floor.place(top.expect("a box")).y;
    assert!(floor.is_asleep() && top > fx!(9.4), "{size} m: the top of a pyramid is at {top}");
}

/// The settings are those of the table in the documentation of `Config`.
#[test]
fn the_settings_of_each_size_are_those_of_the_table() {
    for (size, sub_steps, stiffness, distance) in [
        (fx!(10), 4, fx!(30), fx!(0.02)),
        (fx!(0.9), 4, fx!(30), fx!(0.018)),
        (fx!(0.3), 7, fx!(52.5), fx!(0.006)),
        (fx!(0.1), 12, fx!(90), fx!(0.002)),
        (fx!(0.03), 22, fx!(165), fx!(0.001)),
        (fx!(0.01), 37, fx!(277.5), fx!(0.001)),
        (fx!(0.005), 52, fx!(390), fx!(0.001)),
    ] {
        let config = Config::default().for_smallest(size);
        let ContactTuning::Soft { hertz, .. } = config.solver.contact else { panic!("soft by default") };
        assert_eq!((config.solver.sub_steps, hertz), (sub_steps, stiffness), "{size} m");
        assert!((config.speculative_distance - distance).abs() < fx!(0.000001), "{size} m");
    }
}

#[test]
fn stacks_of_any_size_sink_by_at_most_a_fortieth_of_a_box() {
    for size in [fx!(10), fx!(1), fx!(0.9), fx!(0.3), fx!(0.1), fx!(0.03), fx!(0.01), fx!(0.005)] {
        let sunk = sink(Config::default().for_smallest(size), size);
        assert!(sunk < fx!(0.025), "{size} m: sinks by {sunk} of a box");
    }
    // Boxes of 0.9 m and more need no other settings than the defaults.
    for size in [fx!(10), fx!(1), fx!(0.9)] {
        let sunk = sink(Config::default(), size);
        assert!(sunk < fx!(0.025), "{size} m: sinks by {sunk} of a box at defaults");
    }
}

/// The settings depend on the ratio of gravity to size, and on the sub-steps per second.
#[test]
fn settings_for_small_bodies_follow_gravity_and_tick_rate() {
    let moon = Config { gravity: Vec2::new(fx!(0), fx!(-1.62)), ..Config::default() };
    assert_eq!(moon.for_smallest(fx!(0.162)), Config { speculative_distance: fx!(0.162) / 50, ..moon });
    for (config, size) in [
        (moon, fx!(0.02)),
        (Config { tick_rate: 120, ..Config::default() }, fx!(0.05)),
        (Config { tick_rate: 240, ..Config::default() }, fx!(0.02)),
    ] {
        let sunk = sink(config.for_smallest(size), size);
        assert!(sunk < fx!(0.025), "{size} m: sinks by {sunk} of a box");
    }
    let above = Config { gravity: Vec2::ZERO, ..Config::default() };
    assert_eq!(above.for_smallest(fx!(0.01)).solver, above.solver);
}

#[test]
fn piles_of_any_size_come_to_rest() {
    for size in [fx!(10), fx!(1), fx!(0.3), fx!(0.1), fx!(0.03), fx!(0.01)] {
        check_piles(Config::default().for_smallest(size), size);
    }
}
