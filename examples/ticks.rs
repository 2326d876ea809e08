//! Steps a scene, for `.ci/instructions`: `ticks SCENE COUNT [scalar|avx2|avx512|neon|simd128]`.

use std::process::ExitCode;

use lockstep2d::lockstep::{Game, Sandbox};
use lockstep2d::world::Backend;
use lockstep2d_scenes::Scene;

fn main() -> ExitCode {
    let words: Vec<String> = std::env::args().skip(1).collect();
    match run(&words) {
        Ok(summary) => {
            println!("{summary}");
            ExitCode::SUCCESS
        }
        Err(message) => {
            eprintln!("{message}");
            ExitCode::FAILURE
        }
    }
}

fn run(words: &[String]) -> Result<String, String> {
    let (name, count, backend) = match words {
        [name, count] => (name, count, Backend::best()),
        [name, count, backend] => (name, count, backend_named(backend)?),
        _ => return Err("ticks SCENE COUNT [scalar|avx2|avx512|neon|simd128]".into()),
    };
    let scene = Scene::find(name).ok_or(format!("there is no scene {name}"))?;
    let count: u64 = count.parse().map_err(|error| format!("{count}: {error}"))?;
    let mut game = Sandbox::new(&scene.setup(1)).map_err(|error| error.to_string())?;
    if !game.world_mut().set_backend(backend) {
        return Err(format!("this machine has no {backend:?}"));
    }
    for tick in 0..count {
        let commands = scene.commands(tick, &game);
        game.step(&[commands]);
    }
    Ok(format!("{name}: {} after {count} ticks, {backend:?}", game.state_hash()))
}

fn backend_named(name: &str) -> Result<Backend, String> {
    let found = Backend::available().find(|backend| format!("{backend:?}").eq_ignore_ascii_case(name));
    found.ok_or(format!("this machine has no {name}"))
}
