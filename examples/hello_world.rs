//! A box falls onto the floor: `cargo run --example hello_world`.

use lockstep2d::body::{BodyDef, Polygon, ShapeDef, WorldError};
use lockstep2d::fx;
use lockstep2d::world::{Config, World};

fn main() -> Result<(), WorldError> {
    let mut world = World::new(Config::default())?;
    let floor = ShapeDef::new(Polygon::rectangle(fx!(20), fx!(1))?);
    world.spawn(&BodyDef::fixed().position((fx!(0), fx!(-1))), &[floor])?;
    let square = ShapeDef::new(Polygon::square(fx!(0.5))?);
    let square = world.spawn(&BodyDef::dynamic().position((fx!(0), fx!(4))), &[square])?;

    for _ in 0..=6 {
        let height = world.body(square).map_or(fx!(0), |body| body.position().y);
        println!("tick {:3}: height {height:.4} m, hash {}", world.tick(), world.state_hash());
        for _ in 0..10 {
            world.step();
        }
    }
    Ok(())
}
