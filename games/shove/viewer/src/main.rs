//! Shove in a window or on a web page.

fn main() -> std::process::ExitCode {
    lockstep2d_shove_viewer::viewer().run()
}
