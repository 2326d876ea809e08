//! Measures the mean CPU time of a frame of the scene `large_pyramid` (5051 bodies), for several sets of layers. The
//! time to fill the draw list and the time to build its triangles are measured separately.
//!
//! ```text
//! cargo run --release -p lockstep2d-viewer --example frame_cost
//! ```
#![expect(clippy::disallowed_types, reason = "measures time")]

use std::error::Error;
use std::time::{Duration, Instant};

use lockstep2d::draw::Layers;
use lockstep2d_viewer::mesh::{Mesh, Screen};
use lockstep2d_viewer::{App, Event, Key, LAYER_KEYS};

const FRAMES: u32 = 200;
const SIZE: [f32; 2] = [1280.0, 960.0];
/// Keys of the layers that are on at the start.
const AT_FIRST: [char; 2] = ['1', '5'];

fn main() -> Result<(), Box<dyn Error>> {
    let mut app = App::default();
    if !app.show_scene("large_pyramid", 0) {
        return Err("no such scene".into());
    }
    app.handle(Event::Resized(SIZE));
    for _ in 0..60 {
        app.advance(Duration::from_secs(1) / 60);
    }
    app.handle(Event::Pressed(Key::Space));
    measure(&mut app, "initial layers");
    let mut layers = Layers::NONE;
    let names = layers.named().map(|(name, _)| name);
    // Turns the initial layers off.
    press(&mut app, &AT_FIRST);
    for (name, key) in names.into_iter().zip(LAYER_KEYS) {
        press(&mut app, &[key]);
        measure(&mut app, name);
        press(&mut app, &[key]);
    }
    press(&mut app, &LAYER_KEYS);
    measure(&mut app, "all layers");
    Ok(())
}

fn press(app: &mut App, keys: &[char]) {
    keys.iter().for_each(|&key| app.handle(Event::Pressed(Key::Character(key))));
}

fn measure(app: &mut App, what: &str) {
    let list = mean_of(|| {
        app.draw();
    });
    let screen = Screen { size: SIZE, pixel: 1.0 };
    let (items, mut mesh) = (app.draw(), Mesh::default());
    let triangles = mean_of(|| mesh.build(items, &screen));
    println!("{what:32} {:6} items  list {list:5.2} ms  triangles {triangles:5.2} ms", items.items().len());
}

/// Mean time of a call, in milliseconds.
fn mean_of(mut make: impl FnMut()) -> f64 {
    let (start, wall) = (cpu_time(), Instant::now());
    (0..FRAMES).for_each(|_| make());
    let time = cpu_time().zip(start).map_or_else(|| wall.elapsed(), |(end, start)| end.saturating_sub(start));
    time.as_secs_f64() * 1e3 / f64::from(FRAMES)
}

/// CPU time of this thread, with a resolution of a few milliseconds. `None` on systems other than Linux.
fn cpu_time() -> Option<Duration> {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    text.split(' ').next()?.parse().ok().map(Duration::from_nanos)
}
