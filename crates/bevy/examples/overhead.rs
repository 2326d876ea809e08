//! Measures the time that the plugin adds to a step of a pyramid of about 1000 boxes that stay awake. The step is timed
//! without Bevy, and in an app with views. Run it with `--release`.

use std::time::{Duration, Instant};

use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_lockstep2d::prelude::*;
use lockstep2d::body::{BodyDef, Polygon, ShapeDef, WorldError};
use lockstep2d::fx;
use lockstep2d::lockstep::{Game, Sandbox, SandboxSetup};
use lockstep2d::math::{Angle, Fx, Vec2, fx_mul};
use lockstep2d::world::{BodyPose, Command};

const ROWS: i32 = 45;

fn pyramid() -> Result<SandboxSetup, WorldError> {
    let ground = ShapeDef::new(Polygon::rectangle(fx!(60), fx!(1))?);
    let square = ShapeDef::new(Polygon::square(fx!(0.5))?);
    let pose = |row: i32, column: i32| {
        let x = fx_mul(Fx::from_num(2 * column + row - ROWS), fx!(0.525));
        BodyPose { position: Vec2::new(x, fx!(0.5) + Fx::from_num(row)), angle: Angle::ZERO }
    };
    let poses = (0..ROWS).flat_map(|row| (0..ROWS - row).map(move |column| pose(row, column)));
    let fixed = BodyDef::fixed().position((fx!(0), fx!(-1)));
    let commands = vec![
        Command::Spawn { body: fixed, shapes: vec![ground] },
        Command::SpawnEach {
            body: BodyDef::dynamic().never_sleeps(),
            shapes: vec![square],
            poses: poses.collect(),
        },
    ];
    Ok(SandboxSetup { commands, ..SandboxSetup::default() })
}

fn timed(mut call: impl FnMut()) -> Duration {
    let start = Instant::now();
    call();
    start.elapsed()
}

fn median(mut times: Vec<Duration>) -> f64 {
    times.sort();
    times[times.len() / 2].as_secs_f64() * 1e6
}

/// App whose frames are a tick apart.
fn app() -> App {
    let mut app = App::new();
    app.add_plugins(MinimalPlugins)
        .insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_nanos(16_666_667)));
    app
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let setup = pyramid()?;
    let (mut alone, mut empty, mut app) = (Sandbox::new(&setup)?, app(), app());
    app.add_plugins(LockstepPlugin::<Sandbox>::default())
        .insert_resource(Lockstep::<Sandbox>::local(&setup)?);
    app.update();
    let (mut steps, mut empty_frames, mut frames, mut in_frames) = (vec![], vec![], vec![], vec![]);
    for _ in 0..600 {
        steps.push(timed(|| alone.step(&[vec![]])));
        empty_frames.push(timed(|| empty.update()));
        frames.push(timed(|| app.update()));
        in_frames.push(app.world().resource::<LockstepStatus>().step_time);
    }
    let lockstep = app.world().resource::<Lockstep<Sandbox>>();
    let difference = lockstep.tick().abs_diff(alone.world().tick());
    let [step, empty, frame, in_frame] = [steps, empty_frames, frames, in_frames].map(median);
    println!("{} bodies, {difference} ticks apart", alone.world().body_count());
    println!("a step alone {step:.0} us, a frame without the plugin {empty:.0} us");
    println!("the driver's step in an app {in_frame:.0} us, the whole frame {frame:.0} us");
    println!(
        "added by the driver {:.1} %, by the driver and the views {:.1} %",
        (in_frame / step - 1.0) * 100.0,
        ((frame - empty) / step - 1.0) * 100.0
    );
    Ok(())
}
