//! `export` to PNG, GIF and APNG: the decoded frames are the pictures of the ticks, at the pace of the game.

use std::fs;
use std::io::Cursor;
use std::ops::RangeInclusive;

use lockstep2d::draw::{Frame, Layers, View, fit};
use lockstep2d::lockstep::Sandbox;
use lockstep2d::math::Aabb;
use lockstep2d::replay::{Limits, Recording, Step, VerifiedReplay};
use lockstep2d_cli::Exit;
use lockstep2d_render::{Colour, DrawList, Image, page, raster};
use lockstep2d_scenes::Scene;

use crate::{Folder, golden, run_sandbox};

/// The pictures of a replay after each of `ticks`.
fn pictures(file: &[u8], ticks: &[u64], view: &View) -> Vec<Image> {
    let mut replay = VerifiedReplay::<Sandbox>::open(file, &Limits::default()).unwrap();
    let mut pictures = Vec::new();
    for &tick in ticks {
        while replay.tick() < tick {
            assert_eq!(replay.step(), Ok(Step::Ticked));
        }
        let mut list = DrawList::default();
        page(&mut list, replay.game().world(), view);
        pictures.push(raster(&list, (view.width, view.height), Colour::hex(0xffffff)));
    }
    pictures
}

/// The smallest window that contains the world at some ticks of a range: at most 101 ticks in equal steps from the
/// first one, and the last tick.
fn window(file: &[u8], mut ticks: RangeInclusive<u64>) -> Aabb {
    let step = usize::try_from((ticks.end() - ticks.start()).div_ceil(100).max(1)).unwrap();
    let last = *ticks.end();
    let mut replay = VerifiedReplay::<Sandbox>::open(file, &Limits::default()).unwrap();
    let mut window: Option<Aabb> = None;
    for tick in ticks.by_ref().step_by(step).chain([last]) {
        while replay.tick() < tick {
            assert_eq!(replay.step(), Ok(Step::Ticked));
        }
        let fitting = fit(replay.game().world());
        window = Some(window.map_or(fitting, |window| window.union(fitting)));
    }
    window.unwrap()
}

fn decoded(png: &[u8]) -> (u32, u32, Vec<u8>) {
    let mut reader = png::Decoder::new(Cursor::new(png)).read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut pixels).unwrap();
    (info.width, info.height, pixels)
}

#[test]
fn a_png_is_the_picture_of_its_tick() {
    let folder = Folder::new("export-png");
    let picture = folder.path("a.png");
    let outcome = run_sandbox(&["export", &golden("ragdoll"), "--tick", "80", "-o", &picture]);
    assert_eq!((outcome.exit, outcome.out.as_str()), (Exit::Success, ""), "{}", outcome.err);
    let (width, height, pixels) = decoded(&fs::read(&picture).unwrap());
    assert_eq!((width, height), (960, 720));
    let expected = &pictures(&fs::read(golden("ragdoll")).unwrap(), &[80], &View::default())[0];
    assert!(expected.rgba().chunks(4).flat_map(|pixel| &pixel[..3]).eq(&pixels));
}

#[test]
fn a_gif_shows_the_ticks_at_the_pace_of_the_game() {
    let folder = Folder::new("export-gif");
    let animation = folder.path("a.gif");
    let file = golden("free_fall");
    let arguments = ["--from", "5", "--to", "35", "--every", "3", "--width", "320", "--layers", "outlines"];
    let command = ["export", &file, "-o", &animation];
    let outcome = run_sandbox(&command.into_iter().chain(arguments).collect::<Vec<_>>());
    assert_eq!((outcome.exit, outcome.err.as_str()), (Exit::Success, ""));
    let ticks: Vec<u64> = (5..=35).step_by(3).collect();
    let bytes = fs::read(&file).unwrap();
    let mut options = gif::DecodeOptions::new();
    options.set_color_output(gif::ColorOutput::RGBA);
    let gif = fs::read(&animation).unwrap();
    let mut decoder = options.read_info(&gif[..]).unwrap();
    assert_eq!((decoder.width(), decoder.height()), (320, 240));
    let layers = Layers { outlines: true, ..Layers::NONE };
    let view = View {
        width: 320,
        height: 240,
        frame: Frame::Window(window(&bytes, 5..=35)),
        layers,
        ..View::default()
    };
    let expected = pictures(&bytes, &ticks, &view);
    let (mut delays, mut shown) = (Vec::new(), vec![0u8; 320 * 240 * 3]);
    while let Some(frame) = decoder.read_next_frame().unwrap() {
        for (i, pixel) in frame.buffer.chunks(4).enumerate().filter(|(_, pixel)| pixel[3] == 255) {
            let (x, y) = (i % usize::from(frame.width), i / usize::from(frame.width));
            let at = ((y + usize::from(frame.top)) * 320 + x + usize::from(frame.left)) * 3;
            shown[at..at + 3].copy_from_slice(&pixel[..3]);
        }
        let expected = expected[delays.len()].rgba().chunks(4).flat_map(|pixel| &pixel[..3]);
        let error = shown.iter().zip(expected).map(|(a, b)| a.abs_diff(*b)).max();
        assert!(error <= Some(24), "frame {}: a shade is off by {error:?}", delays.len());
        delays.push(frame.delay);
    }
    assert_eq!(delays.len(), ticks.len());
    assert!(delays.iter().all(|&delay| delay == 5), "20 frames a second: {delays:?}");
}

#[test]
fn an_apng_is_the_pictures_of_its_ticks_and_the_camera_stands_still() {
    let folder = Folder::new("export-apng");
    let animation = folder.path("a.apng");
    let file = golden("bouncing_ball");
    let outcome = run_sandbox(&["export", &file, "-o", &animation, "--width", "300", "--height", "200"]);
    assert_eq!((outcome.exit, outcome.err.as_str()), (Exit::Success, ""));
    let bytes = fs::read(&file).unwrap();
    let last = VerifiedReplay::<Sandbox>::open(&bytes, &Limits::default()).unwrap().ticks();
    let ticks: Vec<u64> = (0..=last).step_by(2).collect();
    let frame = Frame::Window(window(&bytes, 0..=last));
    let view = View { width: 300, height: 200, frame, ..View::default() };
    let expected = pictures(&bytes, &ticks, &view);
    let apng = fs::read(&animation).unwrap();
    let mut reader = png::Decoder::new(Cursor::new(&apng)).read_info().unwrap();
    assert_eq!(reader.info().animation_control().unwrap().num_frames as usize, ticks.len());
    let mut shown = vec![0; 300 * 200 * 4];
    for (tick, image) in ticks.iter().zip(&expected) {
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut pixels).unwrap();
        let control = *reader.info().frame_control().unwrap();
        assert_eq!((control.delay_num, control.delay_den), (1, 30));
        for (i, pixel) in (0..control.width * control.height).zip(pixels.chunks(4)) {
            let (x, y) = (i % control.width, i / control.width);
            let at = ((y + control.y_offset) * 300 + x + control.x_offset) as usize * 4;
            if pixel[3] == 255 {
                shown[at..at + 4].copy_from_slice(pixel);
            }
        }
        assert!(shown == image.rgba(), "tick {tick}");
    }
}

#[test]
fn more_frames_than_a_gif_can_show_are_pointed_out() {
    let folder = Folder::new("export-fast");
    let file = golden("free_fall");
    let fast = ["export", &file, "-o", &folder.path("a.gif"), "--every", "1", "--to", "3", "--width", "64"]
        .map(str::to_string);
    let outcome = run_sandbox(&fast.iter().map(String::as_str).collect::<Vec<_>>());
    assert_eq!(outcome.exit, Exit::Success);
    assert!(outcome.err.contains("more than 50 frames a second"), "{}", outcome.err);
}

/// A replay that is damaged in the middle.
fn wrong() -> Vec<u8> {
    let scene = Scene::find("box_stack").unwrap();
    let mut recording = Recording::<Sandbox>::start(&scene.setup(1), 10).unwrap();
    for tick in 0..100 {
        let commands = scene.commands(tick, recording.game());
        recording.step(&[commands]).unwrap();
    }
    let mut bytes = recording.finish().unwrap();
    let middle = bytes.len() / 2;
    // The damage is found by a checksum or by a checkpoint.
    (middle..middle + 40).for_each(|at| bytes[at] ^= 0x55);
    bytes
}

#[test]
fn a_damaged_replay_leaves_no_file() {
    let folder = Folder::new("export-damaged");
    let bad = folder.write("bad.replay", &wrong());
    for format in ["a.gif", "a.apng", "a.png", "a.svg", "a.jsonl"] {
        let to = folder.path(format);
        let outcome = run_sandbox(&["export", &bad, "-o", &to]);
        assert_eq!(outcome.exit, Exit::NoMatch, "{format}: {}", outcome.err);
        assert!(outcome.err.contains("malformed") || outcome.err.contains("differ"), "{}", outcome.err);
        assert!(!fs::exists(&to).unwrap(), "{format}");
        fs::write(&to, "what was there before").unwrap();
        assert_eq!(run_sandbox(&["export", &bad, "-o", &to, "--force"]).exit, Exit::NoMatch);
        assert_eq!(fs::read_to_string(&to).unwrap(), "what was there before", "{format}");
        fs::remove_file(&to).unwrap();
    }
    assert_eq!(fs::read_dir(folder.path("")).unwrap().count(), 1, "no unfinished file is left");
}

/// Each measurement is a process of its own, so that memory of other tests does not count.
#[cfg(target_os = "linux")]
#[test]
fn memory_does_not_grow_with_the_frames() {
    let folder = Folder::new("export-memory");
    let peak_of = |frames: u32| {
        let to = folder.path(&format!("{frames}.gif"));
        let frames = frames.to_string();
        let arguments = ["export", &golden("box_stack"), "-o", &to, "--every", "1", "--to", &frames];
        let peak = crate::memory::peak(&arguments);
        assert!(fs::exists(&to).unwrap());
        peak
    };
    let frames = crate::sweep::size(500, 150);
    let (few, many) = (peak_of(50), peak_of(frames));
    // The limit of 10 MB is far below the size of the pixels of the additional frames: 120 MB for 100 frames.
    assert!(many < few + 10_000, "{few} KiB for 50 frames, {many} KiB for {frames}");
}

#[test]
fn layers_choose_what_is_drawn() {
    let folder = Folder::new("export-layers");
    let bytes = fs::read(golden("ragdoll")).unwrap();
    let mut seen = Vec::new();
    for (names, layers) in [
        ("none", Layers::NONE),
        ("all", Layers::ALL),
        ("contact_points,velocities", Layers { contact_points: true, velocities: true, ..Layers::NONE }),
    ] {
        let to = folder.path("a.png");
        let outcome = run_sandbox(&[
            "export",
            &golden("ragdoll"),
            "--tick",
            "40",
            "--layers",
            names,
            "-o",
            &to,
            "--force",
        ]);
        assert_eq!(outcome.exit, Exit::Success, "{}", outcome.err);
        let expected = &pictures(&bytes, &[40], &View { layers, ..View::default() })[0];
        let (_, _, pixels) = decoded(&fs::read(&to).unwrap());
        assert!(expected.rgba().chunks(4).flat_map(|pixel| &pixel[..3]).eq(&pixels), "{names}");
        assert!(!seen.contains(&pixels), "{names} gives the same pixels as other layers");
        seen.push(pixels);
    }
}
