//! Takes the screenshots of `crates/bevy/test window`, and checks them.

use std::path::PathBuf;
use std::time::Duration;

use bevy::prelude::*;
use bevy::render::view::screenshot::{Screenshot, ScreenshotCaptured, save_to_disk};
use bevy::time::TimeUpdateStrategy;
use bevy_lockstep2d::prelude::LockstepStatus;
use lockstep2d::draw::{PAPER, Style};

/// Environment variable with the file for the picture.
const FILE: &str = "LOCKSTEP2D_SCREENSHOT";
/// Environment variable with the number of frames before the picture.
const FRAMES: &str = "LOCKSTEP2D_FRAMES";
/// Environment variable with the least number of pixels of each style, such as `fixed=1400 dynamic=400`.
const SHOWS: &str = "LOCKSTEP2D_SHOWS";

/// Largest accepted difference of a colour channel. Rendering converts a channel to a linear float and back, and rounds
/// it.
const TOLERANCE: u8 = 2;

#[derive(Resource)]
struct Plan {
    file: PathBuf,
    frames: u32,
    shows: Vec<Expected>,
}

#[derive(Clone, Copy, Debug)]
struct Expected {
    style: Style,
    pixels: usize,
}

/// Takes a picture if `LOCKSTEP2D_SCREENSHOT=FILE.png` is set: the app plays 240 frames (or `LOCKSTEP2D_FRAMES`), saves
/// a picture of its window, and ends. It panics if a style in `LOCKSTEP2D_SHOWS` has too few pixels.
pub(crate) fn take_when_asked(app: &mut App) {
    let Some(file) = std::env::var_os(FILE) else { return };
    let frames = std::env::var(FRAMES).ok().and_then(|frames| frames.parse().ok()).unwrap_or(240);
    let shows = std::env::var(SHOWS).unwrap_or_default();
    let shows =
        parse(&shows).unwrap_or_else(|| panic!("{SHOWS} has styles and numbers of pixels, not {shows}"));
    app.insert_resource(Plan { file: file.into(), frames, shows })
        .insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_nanos(16_666_667)))
        .add_systems(Update, take);
}

fn parse(shows: &str) -> Option<Vec<Expected>> {
    let expected = |word: &str| {
        let (name, pixels) = word.split_once('=')?;
        let style = match name {
            "fixed" => Style::Fixed,
            "kinematic" => Style::Kinematic,
            "dynamic" => Style::Dynamic,
            "sensor" => Style::Sensor,
            "anchor" => Style::JointAnchor,
            _ => return None,
        };
        Some(Expected { style, pixels: pixels.parse().ok()? })
    };
    shows.split_whitespace().map(expected).collect()
}

fn take(plan: Res<Plan>, mut frame: Local<u32>, mut commands: Commands) {
    *frame += 1;
    if *frame == plan.frames {
        commands.spawn(Screenshot::primary_window()).observe(save_to_disk(plan.file.clone())).observe(check);
    }
}

fn check(
    captured: On<ScreenshotCaptured>,
    plan: Res<Plan>,
    status: Res<LockstepStatus>,
    mut exit: MessageWriter<AppExit>,
) -> Result {
    let picture = captured.image.clone().try_into_dynamic()?.into_rgb8();
    let (pixels, _) = picture.as_raw().as_chunks::<3>();
    compare(pixels, &plan.shows)?;
    // A match plays its first tick only after some frames.
    if status.tick < u64::from(plan.frames) / 2 {
        return Err(format!("only {} ticks in {} frames", status.tick, plan.frames).into());
    }
    exit.write(AppExit::Success);
    Ok(())
}

/// Checks the number of pixels of each style. At least half of a picture, but not all of it, must be background.
fn compare(pixels: &[[u8; 3]], shows: &[Expected]) -> Result<(), String> {
    let of_colour = |colour: u32| pixels.iter().filter(|pixel| is_near(**pixel, colour)).count();
    let (background, total) = (of_colour(PAPER), pixels.len());
    if background < total / 2 || background == total {
        return Err(format!("{background} of {total} pixels are background"));
    }
    for Expected { style, pixels } in shows {
        let colour = style.paint().stroke;
        let drawn = of_colour(colour);
        if drawn < *pixels {
            return Err(format!("{drawn} instead of {pixels} pixels of {style:?} (#{colour:06x})"));
        }
    }
    Ok(())
}

fn is_near(pixel: [u8; 3], colour: u32) -> bool {
    let [_, colour @ ..] = colour.to_be_bytes();
    pixel.into_iter().zip(colour).all(|(pixel, colour)| pixel.abs_diff(colour) <= TOLERANCE)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pixels(parts: &[(u32, usize)]) -> Vec<[u8; 3]> {
        let part = |(colour, count): &(u32, usize)| {
            let [_, red, green, blue] = colour.to_be_bytes();
            vec![[red, green, blue]; *count]
        };
        parts.iter().flat_map(part).collect()
    }

    #[test]
    fn a_picture_without_what_it_has_to_show_is_refused() {
        let shows = parse("fixed=20 dynamic=10").expect("two styles");
        let [fixed, dynamic] = [Style::Fixed, Style::Dynamic].map(|style| style.paint().stroke);
        let compare = |parts: &[(u32, usize)]| compare(&pixels(parts), &shows);
        assert_eq!(compare(&[(PAPER, 100), (fixed, 20), (dynamic, 10)]), Ok(()));
        // A value that is off by one counts as the same colour.
        assert_eq!(compare(&[(PAPER - 0x01_0101, 100), (fixed + 1, 20), (dynamic, 10)]), Ok(()));
        let refused: [&[(u32, usize)]; 7] = [
            &[],
            &[(PAPER, 130)],
            &[(0, 130)],
            &[(PAPER, 100), (fixed, 20)],
            &[(PAPER, 100), (fixed, 19), (dynamic, 10)],
            &[(0xff_ffff, 100), (fixed, 20), (dynamic, 10)],
            &[(PAPER, 20), (fixed, 20), (dynamic, 10)],
        ];
        for parts in refused {
            assert!(compare(parts).is_err(), "{parts:x?}");
        }
    }

    #[test]
    fn only_known_styles_and_numbers_are_read() {
        assert!(parse("").is_some_and(|shows| shows.is_empty()));
        assert!(parse("fixed").is_none());
        assert!(parse("fixed=many").is_none());
        assert!(parse("blue=10").is_none());
    }
}
