//! The command-line tools for replays of the game: `cargo run --bin tool -- --help`.

fn main() -> std::process::ExitCode {
    lockstep2d_cli::Tool::<my_game::MyGame>::new().run()
}
