//! Screenshots for `crates/bevy/test window`.

use std::path::PathBuf;
use std::time::Duration;

use bevy::prelude::*;
use bevy::render::view::screenshot::{Screenshot, ScreenshotCaptured, save_to_disk};
use bevy::time::TimeUpdateStrategy;

/// File for the picture.
const FILE: &str = "LOCKSTEP2D_SCREENSHOT";
/// Number of frames before it is taken.
const FRAMES: &str = "LOCKSTEP2D_FRAMES";

/// Pixels that are not background, at least: a ball has as many.
const DRAWN_MIN: usize = 300;

#[derive(Resource)]
struct Plan {
    file: PathBuf,
    frames: u32,
}

/// With the environment variable `LOCKSTEP2D_SCREENSHOT=FILE.png` the app plays 240 frames of a sixtieth of a second,
/// or `LOCKSTEP2D_FRAMES`, saves a picture of its window, and ends. It panics if the picture is empty.
pub(crate) fn take_when_asked(app: &mut App) {
    let Some(file) = std::env::var_os(FILE) else { return };
    let frames = std::env::var(FRAMES).ok().and_then(|frames| frames.parse().ok()).unwrap_or(240);
    app.insert_resource(Plan { file: file.into(), frames })
        .insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_nanos(16_666_667)))
        .add_systems(Update, take);
}

fn take(plan: Res<Plan>, mut frame: Local<u32>, mut commands: Commands) {
    *frame += 1;
    if *frame == plan.frames {
        commands.spawn(Screenshot::primary_window()).observe(save_to_disk(plan.file.clone())).observe(check);
    }
}

fn check(captured: On<ScreenshotCaptured>, mut exit: MessageWriter<AppExit>) -> Result {
    let pixels = captured.image.data.as_deref().ok_or("a picture without pixels")?;
    let (pixels, _) = pixels.as_chunks::<4>();
    let background = pixels.first().ok_or("a picture without pixels")?;
    let drawn = pixels.iter().filter(|pixel| *pixel != background).count();
    if drawn < DRAWN_MIN {
        return Err(format!("the picture is empty: {drawn} of {} pixels are drawn", pixels.len()).into());
    }
    exit.write(AppExit::Success);
    Ok(())
}
