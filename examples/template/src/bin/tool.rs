//! Command-line tools for replays: `cargo run --bin tool -- --help`.

fn main() -> std::process::ExitCode {
    lockstep2d_cli::Tool::<my_game::MyGame>::new().run()
}
