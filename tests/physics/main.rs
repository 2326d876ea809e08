//! Physics against theory, or against bounds where there is no theory.

mod areas;
mod assembly;
mod assembly_energy;
mod belts;
mod capsule;
mod chain;
mod collisions;
mod columns;
mod continuous;
mod corners;
mod couplings;
mod driven_blocks;
mod free_fall;
mod gears;
mod heaps;
mod impacts;
mod joint_bench;
mod joint_energy;
mod joint_holds;
mod joint_limits;
mod joint_motors;
mod joint_springs;
mod joints;
mod machines;
mod manifolds;
mod momentum;
mod one_way;
mod piles;
mod rebound;
mod rolling;
mod scale;
mod seams;
mod slope;
mod spring_pairs;
mod squeezed;
mod surface;
mod turning;

use lockstep2d::lockstep::{Game, Sandbox};
use lockstep2d::math::{Fx, fx_mul};
use lockstep2d::world::World;
use lockstep2d_scenes::Scene;
use lockstep2d_tests::sweep;

fn open(name: &str) -> Sandbox {
    let scene = Scene::find(name).unwrap_or_else(|| panic!("no scene {name}"));
    Sandbox::new(&scene.setup(1)).expect("the scenes of this crate are valid")
}

/// Runs a scene without commands.
fn run(game: &mut Sandbox, ticks: u64, mut look: impl FnMut(u64, &World)) {
    for tick in 0..ticks {
        game.step(&[vec![]]);
        look(tick, game.world());
    }
    assert_eq!(game.world().validate(), Ok(()));
    assert_eq!(game.world().faults(), 0, "expected no clamped or saturated value in the solver");
}

/// Kinetic and potential energy of the dynamic bodies in J.
fn energy(world: &World) -> Fx {
    let gravity = world.config().gravity;
    let of = |body: &lockstep2d::body::Body| {
        body.kinetic_energy() - fx_mul(body.mass(), gravity.dot(body.centre_of_mass()))
    };
    world
        .bodies()
        .filter(|(_, body)| body.is_dynamic())
        .map(|(_, body)| of(body))
        .fold(Fx::ZERO, |a, b| a + b)
}

/// Largest distance in metres between the anchors of a joint.
fn joint_gap(world: &World) -> Fx {
    let gap = |id| world.joint_anchors(id).map_or(Fx::ZERO, |(a, b)| a.distance(b));
    world.joints().map(|(id, _)| gap(id)).max().unwrap_or(Fx::ZERO)
}

/// Largest speed in m/s.
fn speed_max(world: &World) -> Fx {
    speeds(world).max().unwrap_or(Fx::ZERO)
}

/// Mean speed in m/s.
fn speed_mean(world: &World) -> Fx {
    let sum = speeds(world).fold(Fx::ZERO, |a, b| a + b);
    sum / i64::try_from(speeds(world).count().max(1)).expect("a small number")
}

fn speeds(world: &World) -> impl Iterator<Item = Fx> {
    world.bodies().filter(|(_, body)| body.is_dynamic()).map(|(_, body)| body.velocity().length())
}

/// Depth of the deepest contact point in metres.
fn deepest(world: &World) -> Fx {
    let depth = |point: &lockstep2d::collision::ManifoldPoint| -Fx::from(point.separation);
    world.contacts().flat_map(|contact| contact.manifold.points()).map(depth).max().unwrap_or(Fx::ZERO)
}
