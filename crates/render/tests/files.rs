//! Written pictures and animations decode to the same pixels and durations, and errors are reported.
#![expect(clippy::unwrap_used, reason = "a failed unwrap in a helper fails the test")]
#![expect(clippy::disallowed_types, reason = "drawing uses floats")]

mod common;

use std::io::Cursor;

use common::colourful;
use gif::{ColorOutput, DecodeOptions, DisposalMethod};
use lockstep2d_render::{Animation, Colour, DrawList, Image, Pace, raster};

const SIZE: (u32, u32) = (120, 80);
const WHITE: Colour = Colour::hex(0xffffff);
const THIRTY: Pace = Pace { ticks: 2, tick_rate: 60 };

/// A picture with few colours: a moving square, and text.
fn flat(frame: u32) -> Image {
    let mut list = DrawList::default();
    list.rectangle([0.0, 60.0], [120.0, 20.0], Colour::hex(0xdddcd6));
    list.rectangle([frame as f32 * 2.0, 30.0], [30.0, 30.0], Colour::hex(0x1f5f9e).with_opacity(80));
    list.text([2.0, 2.0], 1.0, Colour::hex(0x222222), format!("tick {frame}"));
    raster(&list, SIZE, WHITE)
}

#[test]
fn a_png_is_the_image() {
    let clear = raster(&DrawList::default(), (3, 2), Colour::hex(0x204060).with_opacity(128));
    for image in [flat(3), colourful(1, SIZE), clear] {
        let mut reader = png::Decoder::new(Cursor::new(image.to_png())).read_info().unwrap();
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut pixels).unwrap();
        assert_eq!((info.width, info.height), (image.width(), image.height()));
        let parts = info.color_type.samples();
        assert_eq!(parts, if image.is_opaque() { 3 } else { 4 });
        let expected = image.rgba().chunks(4).flat_map(|pixel| &pixel[..parts]);
        assert!(pixels.iter().eq(expected), "the decoded pixels should equal the image");
    }
}

/// The pictures that a decoder shows, with their durations in hundredths of a second.
fn decoded_gif(bytes: &[u8]) -> Vec<(Vec<[u8; 3]>, u16)> {
    let mut options = DecodeOptions::new();
    options.set_color_output(ColorOutput::RGBA);
    let mut decoder = options.read_info(bytes).unwrap();
    assert_eq!((decoder.width(), decoder.height()), (120, 80));
    assert_eq!(decoder.repeat(), gif::Repeat::Infinite);
    let mut shown = vec![[1, 2, 3]; 120 * 80];
    let mut frames = Vec::new();
    while let Some(frame) = decoder.read_next_frame().unwrap() {
        assert_eq!(frame.dispose, DisposalMethod::Keep);
        for (i, pixel) in frame.buffer.chunks(4).enumerate() {
            let (x, y) = (i % usize::from(frame.width), i / usize::from(frame.width));
            if pixel[3] == 255 {
                let at = (y + usize::from(frame.top)) * 120 + x + usize::from(frame.left);
                shown[at] = [pixel[0], pixel[1], pixel[2]];
            }
        }
        frames.push((shown.clone(), frame.delay));
    }
    frames
}

fn gif_of(frames: &[Image], pace: Pace) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut animation = Animation::gif(&mut bytes, pace);
    frames.iter().for_each(|frame| animation.add(frame).unwrap());
    animation.finish().unwrap();
    bytes
}

fn rgb(image: &Image) -> Vec<[u8; 3]> {
    image.rgba().chunks(4).map(|pixel| [pixel[0], pixel[1], pixel[2]]).collect()
}

#[test]
fn a_gif_of_few_colours_is_exact() {
    // The last frame is equal to the one before.
    let images: Vec<Image> = (0..30).map(|frame| flat(frame.min(28))).collect();
    let bytes = gif_of(&images, THIRTY);
    let frames = decoded_gif(&bytes);
    assert_eq!(frames.len(), 30);
    for (at, ((pixels, _), image)) in frames.iter().zip(&images).enumerate() {
        assert!(*pixels == rgb(image), "frame {at}");
    }
    let delays: Vec<u16> = frames.iter().map(|(_, delay)| *delay).collect();
    assert_eq!(
        delays.iter().map(|&delay| u32::from(delay)).sum::<u32>(),
        100,
        "30 frames should last one second"
    );
    assert_eq!(delays[..6], [3, 4, 3, 3, 4, 3]);
    let whole: usize = images.iter().map(|image| gif_of(std::slice::from_ref(image), THIRTY).len()).sum();
    assert!(bytes.len() * 4 < whole * 3, "{} bytes, but {whole} bytes for 30 single pictures", bytes.len());
}

#[test]
fn new_colours_come_with_a_palette_of_their_own() {
    let frame = |colour: u32| {
        let mut list = DrawList::default();
        list.rectangle([0.0; 2], [50.0, 50.0], Colour::hex(colour));
        raster(&list, SIZE, WHITE)
    };
    let images = [0x000000, 0x000001, 0x123456, 0x000000, 0xfe0000].map(frame);
    for ((pixels, _), image) in decoded_gif(&gif_of(&images, THIRTY)).iter().zip(&images) {
        assert!(*pixels == rgb(image));
    }
}

#[test]
fn colours_that_were_expected_are_written_once() {
    let empty = || raster(&DrawList::default(), SIZE, WHITE);
    let frames: Vec<Image> =
        (0..60).map(|frame| if frame < 3 { empty() } else { colourful(frame, SIZE) }).collect();
    let plain = gif_of(&frames, THIRTY);
    let mut bytes = Vec::new();
    let mut animation = Animation::gif(&mut bytes, THIRTY);
    frames.iter().step_by(10).for_each(|frame| animation.expect(frame));
    frames.iter().for_each(|frame| animation.add(frame).unwrap());
    animation.finish().unwrap();
    assert!(
        bytes.len() + 40 * 3 * 256 < plain.len(),
        "{} bytes with announced colours, {} without",
        bytes.len(),
        plain.len()
    );
    let shown = decoded_gif(&bytes);
    assert_eq!(shown.len(), 60);
    for ((pixels, _), image) in shown.iter().zip(&frames) {
        let expected = rgb(image);
        let channels = pixels.iter().flatten().zip(expected.iter().flatten());
        let error = channels.map(|(a, b)| u64::from(a.abs_diff(*b)));
        assert!(error.sum::<u64>() < 3 * 2 * 120 * 80, "the mean error should be below 2");
    }
}

#[test]
fn a_gif_of_many_colours_is_close() {
    let images: Vec<Image> = (0..40).map(|frame| colourful(frame, SIZE)).collect();
    for ((pixels, _), image) in decoded_gif(&gif_of(&images, THIRTY)).iter().zip(&images) {
        let expected = rgb(image);
        let errors = pixels.iter().flatten().zip(expected.iter().flatten());
        let errors: Vec<u32> = errors.map(|(a, b)| u32::from(a.abs_diff(*b))).collect();
        let mean = f64::from(errors.iter().sum::<u32>()) / errors.len() as f64;
        assert!(mean < 2.0, "the mean error should be below 2: {mean}");
        assert!(*errors.iter().max().unwrap() <= 60, "no error should exceed 60: {:?}", errors.iter().max());
    }
}

/// The pictures that a decoder shows, with their durations in seconds as fractions.
fn decoded_apng(bytes: &[u8]) -> Vec<(Vec<u8>, (u16, u16))> {
    let mut reader = png::Decoder::new(Cursor::new(bytes)).read_info().unwrap();
    let count = reader.info().animation_control().unwrap().num_frames;
    let mut shown = vec![0; 120 * 80 * 4];
    let mut frames = Vec::new();
    for _ in 0..count {
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut pixels).unwrap();
        let control = *reader.info().frame_control().unwrap();
        for (i, pixel) in pixels.chunks(4).take((control.width * control.height) as usize).enumerate() {
            let (x, y) = (i as u32 % control.width, i as u32 / control.width);
            let at = ((y + control.y_offset) * 120 + x + control.x_offset) as usize * 4;
            if control.blend_op == png::BlendOp::Source || pixel[3] == 255 {
                shown[at..at + 4].copy_from_slice(pixel);
            } else {
                assert_eq!(pixel, [0; 4], "blended pixels should be opaque or fully transparent");
            }
        }
        frames.push((shown.clone(), (control.delay_num, control.delay_den)));
    }
    frames
}

#[test]
fn an_apng_is_exact_also_where_something_shines_through() {
    let clear = |frame: u32| {
        let mut list = DrawList::default();
        list.rectangle([frame as f32, 10.0], [20.0, 20.0], Colour::hex(0xff0000).with_opacity(100));
        raster(&list, SIZE, Colour::NONE)
    };
    for draw in [&flat as &dyn Fn(u32) -> Image, &|frame| colourful(frame, SIZE), &clear] {
        let images: Vec<Image> = (0..20).map(|frame| draw(frame.min(18))).collect();
        let mut bytes = Vec::new();
        let mut animation = Animation::apng(&mut bytes, THIRTY, 20);
        images.iter().for_each(|frame| animation.add(frame).unwrap());
        animation.finish().unwrap();
        let frames = decoded_apng(&bytes);
        assert_eq!(frames.len(), 20);
        for (at, ((pixels, delay), image)) in frames.iter().zip(&images).enumerate() {
            assert!(pixels == image.rgba(), "frame {at}");
            assert_eq!(*delay, (1, 30));
        }
    }
}

#[test]
fn what_is_no_animation_is_refused() {
    let other = raster(&DrawList::default(), (10, 10), WHITE);
    let mut gif = Animation::gif(Vec::new(), THIRTY);
    gif.add(&flat(0)).unwrap();
    assert!(gif.add(&other).is_err());
    let mut apng = Animation::apng(Vec::new(), THIRTY, 2);
    apng.add(&flat(0)).unwrap();
    assert!(apng.add(&other).is_err());
    assert!(apng.finish().is_err(), "finishing with a missing frame should fail");
    let mut apng = Animation::apng(Vec::new(), THIRTY, 1);
    apng.add(&flat(0)).unwrap();
    assert!(apng.add(&flat(0)).is_err(), "adding more frames than announced should fail");
    assert!(Animation::gif(Vec::new(), THIRTY).finish().is_err());
    assert!(Animation::apng(Vec::new(), THIRTY, 0).finish().is_err());
}

/// A writer that fails, as on a full disk, when more than this number of bytes would be written.
struct Full(usize);

impl std::io::Write for Full {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        if bytes.len() > self.0 {
            return Err(std::io::ErrorKind::StorageFull.into());
        }
        self.0 -= bytes.len();
        Ok(bytes.len())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

#[test]
fn a_full_disk_is_an_error_wherever_it_is_full() {
    let play = |mut animation: Animation<Full>| {
        (0..3).try_for_each(|frame| animation.add(&flat(frame))).and_then(|()| animation.finish())
    };
    for room in (0..600).step_by(7) {
        let error = play(Animation::gif(Full(room), THIRTY)).unwrap_err();
        assert_eq!(error.kind(), std::io::ErrorKind::StorageFull, "{room}");
        let error = play(Animation::apng(Full(room), THIRTY, 3)).unwrap_err();
        assert_eq!(error.kind(), std::io::ErrorKind::StorageFull, "{room}");
    }
    assert!(play(Animation::gif(Full(1 << 20), THIRTY)).is_ok());
}
