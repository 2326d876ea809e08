//! The `lockstep2d` command.

fn main() {}
