//! A screenshot equals the picture on the screen.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use super::picture::{Picture, distance};
use super::run::{SIZE, command, directory, golden};

/// File in which Xvfb keeps its screen.
const SCREEN: &str = "LOCKSTEP2D_SCREEN";

#[test]
#[ignore = "needs Xvfb: crates/viewer/test-window"]
fn a_screenshot_is_what_is_on_the_screen() {
    let screen = PathBuf::from(
        std::env::var_os(SCREEN).expect("LOCKSTEP2D_SCREEN should be set by crates/viewer/test-window"),
    );
    // All edges in this scene are parallel to the axes. The blending of slanted edges may be rounded differently on the
    // screen.
    let (directory, replay) = (directory("screen"), golden("box_stack.replay"));
    let shot = directory.join("shot.png");
    let _none = std::fs::remove_file(&shot);
    // After 300 frames, the verification is complete. Its progress would change the picture.
    let script = "key space\nkey home\nkey pagedown\nframes 300\nscreenshot shot.png\nframes 100000\n";
    let mut window = command(&directory, script, &[replay.to_str().unwrap()]).spawn().unwrap();
    let alike = wait_for(Duration::from_secs(60), || shot.exists() && is_on(&screen, &shot));
    window.kill().unwrap();
    window.wait().unwrap();
    assert!(alike, "the screen should show the screenshot within 60 s");
}

fn wait_for(time: Duration, mut holds: impl FnMut() -> bool) -> bool {
    let start = Instant::now();
    while start.elapsed() < time {
        std::thread::sleep(Duration::from_millis(200));
        if holds() {
            return true;
        }
    }
    false
}

/// Whether a picture is on the screen, up to a difference of 1 per channel.
fn is_on(screen: &Path, shot: &Path) -> bool {
    // The file may be incomplete while it is being written.
    let Ok(file) = std::fs::File::open(shot) else { return false };
    let whole = png::Decoder::new(std::io::BufReader::new(file)).read_info();
    if !whole.is_ok_and(|mut reader| reader.next_frame(&mut vec![0; SIZE[0] * SIZE[1] * 4]).is_ok()) {
        return false;
    }
    let shot = Picture::read(shot);
    let screen = read_xwd(&std::fs::read(screen).unwrap());
    let height = screen.pixels.len() / screen.width;
    let places =
        (0..=height - SIZE[1]).flat_map(|top| (0..=screen.width - SIZE[0]).map(move |left| [left, top]));
    let starts = places.filter(|&[left, top]| distance(screen.at(left, top), shot.at(0, 0)) <= 1);
    starts.take(10).any(|[left, top]| {
        let same = |at: usize| {
            let [x, y] = [at % SIZE[0], at / SIZE[0]];
            distance(screen.at(left + x, top + y), shot.at(x, y)) <= 1
        };
        (0..shot.pixels.len()).all(same)
    })
}

/// Reads an XWD screen dump with 32 bits per pixel.
fn read_xwd(bytes: &[u8]) -> Picture {
    let word = |at: usize| u32::from_be_bytes(bytes[at * 4..at * 4 + 4].try_into().unwrap()) as usize;
    let [header, width, height, bits, line, colours] = [0, 4, 5, 11, 12, 19].map(word);
    assert_eq!((bits, word(7)), (32, 0), "expected little-endian pixels of 32 bits");
    let start = header + colours * 12;
    let row = |y: usize| bytes[start + y * line..].chunks_exact(4).take(width);
    let pixels = (0..height).flat_map(row).map(|pixel| [pixel[2], pixel[1], pixel[0]]).collect();
    Picture { width, pixels }
}
