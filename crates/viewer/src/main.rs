//! The viewer of the sandbox: scenes, replays, reports and snapshots.

fn main() -> std::process::ExitCode {
    lockstep2d_viewer::sandbox().run()
}
