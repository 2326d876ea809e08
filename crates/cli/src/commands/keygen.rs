//! `keygen`: makes a key to sign replays with.

use std::path::PathBuf;

use clap::Args;
use lockstep2d::lockstep::Game;
use serde::Serialize;

use crate::context::{CommandResult, Context};
use crate::error::CommandError;
use crate::exit::Exit;
use crate::output_file::{OutputFile, Overwrite};
use crate::signature::{SecretKey, is_name};

/// Make a key to sign replays with
#[derive(Args, Debug)]
#[command(
    after_help = "The file is the secret key: only its owner may read it. The line that is printed is the public \
                        key, for the file of verify --keys.\n\nExit code: 0 when it was written, 2 for wrong usage, or \
                        a file that cannot be written."
)]
pub(crate) struct Arguments {
    /// The name of the key's owner
    #[arg(long)]
    name: String,
    /// The file to write: the secret key
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    /// Replace the output file if it exists; the key in it is lost
    #[arg(long)]
    force: bool,
    /// Print one JSON document
    #[arg(long)]
    json: bool,
}

pub(crate) fn run<G: Game>(arguments: &Arguments, context: &mut Context<'_, G>) -> CommandResult {
    let name = &arguments.name;
    if !is_name(name) {
        return Err(CommandError::KeyName { name: name.clone() });
    }
    let overwrite = Overwrite { force: arguments.force };
    let mut output = OutputFile::create_private(&arguments.output, overwrite)?;
    let secret = SecretKey::generate().map_err(CommandError::Random)?;
    output.append(secret.text().as_bytes())?;
    output.publish(&mut context.console)?;
    let key = secret.public_key();
    if arguments.json {
        let file = arguments.output.display().to_string();
        context.console.json(&Line { file, key: key.to_string(), name })?;
    } else {
        context.console.line(format_args!("{key} {name}"))?;
    }
    Ok(Exit::Success)
}

#[derive(Serialize)]
struct Line<'a> {
    file: String,
    key: String,
    name: &'a str,
}
