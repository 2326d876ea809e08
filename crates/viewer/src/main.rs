//! The viewer program, in a window or on a web page.
#![expect(clippy::disallowed_types, reason = "drawing uses floats")]

#[cfg(not(target_arch = "wasm32"))]
mod desktop;
mod window;

#[cfg(not(target_arch = "wasm32"))]
fn main() -> std::process::ExitCode {
    desktop::main()
}

#[cfg(target_arch = "wasm32")]
fn main() {
    let mut app = lockstep2d_viewer::App::default();
    app.show_scene(window::FIRST_SCENE, 0);
    let options = window::Options { size: [0; 2], script: None, output: None };
    if let Err(error) = window::show(app, options) {
        miniquad::error!("{}", error);
    }
}
