//! The `lockstep2d` command: the tools of the sandbox game.

use std::process::ExitCode;

use lockstep2d::lockstep::Sandbox;
use lockstep2d_cli::{SandboxScenes, Tool};

fn main() -> ExitCode {
    let tool = Tool::<Sandbox>::new().with_scenes(SandboxScenes);
    #[cfg(feature = "view")]
    let tool = tool.with_viewer(lockstep2d_viewer::sandbox);
    tool.run()
}
