//! Measures the time of a step in worlds with different numbers of bodies `n`, and fits a power law `n^p` to the times.
//! The number of contacts per body is similar at each size.

use anyhow::{Result, anyhow};
use indicatif::ProgressBar;
use lockstep2d::body::{BodyDef, Geometry, Polygon, ShapeDef, WorldError};
use lockstep2d::fx;
use lockstep2d::lockstep::SandboxSetup;
use lockstep2d::math::{Angle, Fx, Vec2};
use lockstep2d::world::Config;
use lockstep2d_scenes::Builder;
use serde::Serialize;

use crate::engine::Kind;
use crate::measure::run;
use crate::script::Script;
use crate::stats::{median, power};

/// A world that can be built in any size.
#[derive(Clone, Copy)]
pub struct World {
    pub name: &'static str,
    /// Setup for about this number of bodies.
    pub setup: fn(bodies: u32) -> Result<SandboxSetup, WorldError>,
}

pub const WORLDS: [World; 3] = [
    World { name: "pyramids", setup: pyramids },
    World { name: "drums", setup: drums },
    World { name: "churn", setup: churn },
];

#[derive(Clone, Debug)]
pub struct Plan {
    /// Approximate numbers of bodies.
    pub sizes: Vec<u32>,
    pub steps: u64,
    /// Number of steps before the timed ones.
    pub untimed: u64,
    /// Number of runs of each engine at each size.
    pub rounds: usize,
}

/// A world in one engine, at every size.
#[derive(Clone, Debug, Serialize)]
pub struct Growth {
    pub world: &'static str,
    pub engine: &'static str,
    /// Points in the order of the sizes.
    pub points: Vec<Point>,
    /// Exponent `p` of the fit `n^p`.
    pub p: f64,
}

#[derive(Clone, Copy, Debug, Serialize)]
pub struct Point {
    /// Number of dynamic bodies.
    pub bodies: usize,
    /// Number of pairs with contact points at the end.
    pub contacts: usize,
    /// CPU time of a step, in ms.
    pub ms: f64,
}

/// Measures every engine, in interleaved rounds.
pub fn measure(world: World, plan: &Plan, progress: &ProgressBar) -> Result<Vec<Growth>> {
    let World { name, setup } = world;
    let mut growths =
        Kind::ALL.map(|kind| Growth { world: name, engine: kind.name(), points: Vec::new(), p: 0.0 });
    for &size in &plan.sizes {
        let setup = setup(size).map_err(|error| anyhow!("{name} of {size}: {error}"))?;
        let script = Script::of_setup(setup, plan.untimed + plan.steps)?.untimed(plan.untimed as usize);
        let mut times: [Vec<f64>; 3] = Default::default();
        let mut counted = [(0, 0); 3];
        for round in 1..=plan.rounds {
            for kind in Kind::ALL {
                progress.set_message(format!("{name} of {size}: {}, round {round}", kind.name()));
                let (time, engine) = run(kind, &script, 1)?;
                times[kind as usize].push(time.cpu);
                let bodies = engine.bodies().iter().filter(|body| body.dynamic).count();
                counted[kind as usize] = (bodies, engine.contacts().pairs);
                progress.inc(1);
            }
        }
        for ((growth, times), (bodies, contacts)) in growths.iter_mut().zip(&times).zip(counted) {
            growth.points.push(Point { bodies, contacts, ms: median(times) });
        }
    }
    for growth in &mut growths {
        let points: Vec<_> = growth.points.iter().map(|point| (point.bodies as f64, point.ms)).collect();
        growth.p = power(&points);
    }
    Ok(growths.into())
}

fn config() -> Config {
    Config { sleeping: false, pair_limit: 1 << 20, ..Config::default() }
}

/// Pyramids of 55 boxes. Each shelf has 20 pyramids side by side, as in `many_pyramids`.
fn pyramids(bodies: u32) -> Result<SandboxSetup, WorldError> {
    let pyramids = (bodies / 55).max(1);
    let mut scene = Builder::new(config());
    let shelf = |row: u32| {
        let y = Fx::from_num(11 * row);
        Geometry::segment(Vec2::new(fx!(-110), y), Vec2::new(fx!(110), y)).map(ShapeDef::new)
    };
    let shelves = (0..pyramids.div_ceil(20)).map(shelf).collect::<Result<Vec<_>, _>>()?;
    scene.spawn(BodyDef::fixed(), &shelves)?;
    let place = |pyramid: u32, i: i32, j: i32| {
        let (column, row) = (pyramid % 20, pyramid / 20);
        let x = Fx::from_num(i + 1) / 2 + Fx::from_num(j - i) + Fx::from_num(11 * column) - fx!(109.5);
        Vec2::new(x, Fx::from_num(i) + fx!(0.5) + Fx::from_num(11 * row))
    };
    let tile = |pyramid| (0..10).flat_map(move |i| (i..10).map(move |j| place(pyramid, i, j)));
    let square = ShapeDef::new(Polygon::square(fx!(0.5))?);
    scene.spawn_each(BodyDef::dynamic(), &[square], (0..pyramids).flat_map(tile))?;
    Ok(scene.finish())
}

/// Square drums with 484 boxes and balls each, side by side.
fn drums(bodies: u32) -> Result<SandboxSetup, WorldError> {
    let mut scene = Builder::new(config());
    for drum in 0..(bodies / DRUM).max(1) {
        let centre = Vec2::new(Fx::from_num(16 * (drum % 16)), Fx::from_num(16 * (drum / 16)));
        add_drum(&mut scene, centre, DRUM)?;
    }
    Ok(scene.finish())
}

const DRUM: u32 = 484;

/// A single drum. More bodies make its pile deeper, so the shares of the parts of a step change with the size, unlike
/// in `drums`.
fn churn(bodies: u32) -> Result<SandboxSetup, WorldError> {
    let mut scene = Builder::new(config());
    add_drum(&mut scene, Vec2::ZERO, bodies)?;
    Ok(scene.finish())
}

/// Adds a square drum full of boxes and balls, turned by 30 degrees. Its angular velocity is chosen so that drums of
/// all sizes have the same Froude number.
pub fn add_drum(scene: &mut Builder, centre: Vec2<Fx>, bodies: u32) -> Result<(), WorldError> {
    let side = bodies.isqrt().max(2);
    // The walls leave room for the upright grid of bodies in the turned drum.
    let apart = fx!(0.255);
    let half_grid = apart * i64::from(side) / 2;
    let half = half_grid * fx!(1.45) + fx!(0.5);
    let wall = |hx: Fx, hy: Fx, x: Fx, y: Fx| {
        Polygon::rectangle(hx, hy).map(|wall| ShapeDef::new(wall).offset((x, y)))
    };
    let walls = [
        wall(fx!(0.5), half, half, fx!(0))?,
        wall(fx!(0.5), half, -half, fx!(0))?,
        wall(half, fx!(0.5), fx!(0), half)?,
        wall(half, fx!(0.5), fx!(0), -half)?,
    ];
    let turning = lockstep2d::math::sqrt(fx!(2) / half).unwrap_or(fx!(0.4));
    let drum = BodyDef::kinematic().position(centre).angle(Angle::from_degrees(fx!(30)));
    scene.spawn(drum.angular_velocity(turning), &walls)?;
    let at = |index: u32| Fx::from_num(index) * apart + apart / 2 - half_grid;
    let place = |i: u32| centre + Vec2::new(at(i % side), at(i / side));
    let shapes: [Geometry; 2] = [Polygon::square(fx!(0.125))?.into(), Geometry::circle(fx!(0.125))?];
    for (geometry, first) in shapes.into_iter().zip(0..) {
        let places = (first..side * side).step_by(2).map(place);
        scene.spawn_each(BodyDef::dynamic(), &[ShapeDef::new(geometry)], places)?;
    }
    Ok(())
}

pub fn table(growths: &[Growth]) -> String {
    let mut text = format!("{:9} {:10} {:>6}  ms per step (bodies, contacts)\n", "world", "engine", "p");
    for Growth { world, engine, points, p } in growths {
        let point = |point: &Point| format!("{:.2} ({}, {})", point.ms, point.bodies, point.contacts);
        let points: Vec<_> = points.iter().map(point).collect();
        text += &format!("{world:9} {engine:10} {p:6.3}  {}\n", points.join("  "));
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn worlds_of_two_sizes_give_an_exponent() {
        let plan = Plan { sizes: vec![500, 2000], steps: 10, untimed: 20, rounds: 1 };
        for world in WORLDS {
            for growth in measure(world, &plan, &ProgressBar::hidden()).unwrap() {
                let bodies: Vec<_> = growth.points.iter().map(|point| point.bodies).collect();
                let expected = if world.name == "pyramids" { [495, 1980] } else { [484, 1936] };
                assert_eq!(bodies, expected, "{growth:?}");
                assert!((0.3..2.5).contains(&growth.p), "{growth:?}");
                let density = |point: &Point| point.contacts as f64 / point.bodies as f64;
                assert!(
                    (density(&growth.points[0]) / density(&growth.points[1]) - 1.0).abs() < 0.5,
                    "{growth:?}"
                );
            }
        }
    }
}
