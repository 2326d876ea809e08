//! Rollback: a tick is simulated with a predicted input, and again when the input arrives. `cargo run --example
//! rollback`.

use lockstep2d::fx;
use lockstep2d::lockstep::{Game, Sandbox, SetupError};
use lockstep2d::math::Vec2;
use lockstep2d::world::Command;
use lockstep2d_scenes::Scene;

/// The true input of the player for a tick: a push of one body in tick 55, and nothing in other ticks.
fn true_input(game: &Sandbox, tick: u64) -> Vec<Command> {
    let pushed = game.world().bodies().filter(|(_, body)| body.is_dynamic()).take(usize::from(tick == 55));
    pushed
        .map(|(body, _)| Command::SetVelocity {
            body,
            velocity: Vec2::new(fx!(5), fx!(0)),
            angular_velocity: fx!(0),
        })
        .collect()
}

fn main() -> Result<(), SetupError> {
    let scene = Scene::find("box_stack").expect("a scene of the engine");
    let setup = scene.setup(0);

    // A peer that gets every input in time.
    let mut peer = Sandbox::new(&setup)?;
    for tick in 0..60 {
        let input = true_input(&peer, tick);
        peer.step(&[input]);
    }

    // This peer gets the inputs of the last ten ticks late. It first predicts that the player does nothing.
    let mut here = Sandbox::new(&setup)?;
    for _ in 0..50 {
        here.step(&[vec![]]);
    }
    let confirmed = here.save();
    for _ in 50..60 {
        here.step(&[vec![]]);
    }
    println!("peer        {}", peer.state_hash());
    println!("predicted   {}", here.state_hash());

    here.load(&confirmed);
    for tick in 50..60 {
        let input = true_input(&here, tick);
        here.step(&[input]);
    }
    println!("resimulated {}", here.state_hash());
    println!("equal: {}", here.state_hash() == peer.state_hash());
    Ok(())
}
