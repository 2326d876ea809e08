//! `sign`: signs a replay, in a file beside it.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use clap::Args;
use lockstep2d::lockstep::Game;
use serde::Serialize;

use crate::context::{CommandResult, Context};
use crate::error::CommandError;
use crate::exit::Exit;
use crate::files::{self, Shown};
use crate::output_file::{OutputFile, Overwrite};
use crate::signature::{FILE_BYTES_MAX, GameDigest, SecretKey, Signatures, path_beside};

/// Maximum size of a secret key file in bytes.
const KEY_BYTES_MAX: u64 = 4096;

/// Sign a replay, in a file beside it
#[derive(Args, Debug)]
#[command(
    after_help = "The signature is added to REPLAY.sig; an earlier one of the same key is replaced. It is made \
                        over the rules, setup and inputs, and holds for every file of the same game. The replay is not \
                        simulated: verify it first.\n\nExit code: 0 when it was signed, 1 for a replay that is damaged \
                        or of another game, 2 for wrong usage, or files that cannot be read or written."
)]
pub(crate) struct Arguments {
    /// The replay
    #[arg(value_name = "REPLAY")]
    file: PathBuf,
    /// The secret key, as `keygen` writes it
    #[arg(long, value_name = "FILE")]
    key: PathBuf,
    /// Print one JSON document
    #[arg(long)]
    json: bool,
}

pub(crate) fn run<G: Game>(arguments: &Arguments, context: &mut Context<'_, G>) -> CommandResult {
    let replay = context.load(&arguments.file)?;
    let path = &arguments.key;
    let secret: SecretKey = read_text(path, KEY_BYTES_MAX)?.parse().map_err(CommandError::line(path))?;
    let game = GameDigest::of_replay::<G>(&replay, context.limits())
        .map_err(CommandError::replay(&arguments.file))?;

    let beside = path_beside(&arguments.file);
    // The file is locked before the signatures are read, so that simultaneous processes lose no signature.
    let mut output = OutputFile::create(&beside, Overwrite::ALWAYS, &[])?;
    let mut signatures = match read_signatures(&beside) {
        Err(CommandError::Read { error, .. }) if error.kind() == io::ErrorKind::NotFound => {
            Signatures::default()
        }
        signatures => signatures?,
    };
    signatures.add(secret.sign(&game)).map_err(CommandError::line(&beside))?;
    output.append(signatures.to_string().as_bytes())?;
    output.publish(&mut context.console)?;

    let key = secret.public_key();
    if arguments.json {
        let [file, signatures] = [&arguments.file, &beside].map(|path| path.display().to_string());
        let line = Line { file, signatures, key: key.to_string(), game: game.to_string() };
        context.console.json(&line)?;
    } else {
        let line = format_args!("{}: game {game} signed by {key}", Shown(&beside));
        context.console.line(line)?;
    }
    Ok(Exit::Success)
}

#[derive(Serialize)]
struct Line {
    file: String,
    signatures: String,
    key: String,
    game: String,
}

pub(crate) fn read_signatures(path: &Path) -> Result<Signatures, CommandError> {
    // Only regular files are read: reading a pipe would block.
    if !fs::metadata(path).map_err(CommandError::read(path))?.is_file() {
        return Err(CommandError::NoText { path: path.to_path_buf() });
    }
    read_text(path, FILE_BYTES_MAX)?.parse().map_err(CommandError::line(path))
}

/// Reads a text file of at most `bytes_max` bytes.
pub(crate) fn read_text(path: &Path, bytes_max: u64) -> Result<String, CommandError> {
    let no_text = || CommandError::NoText { path: path.to_path_buf() };
    let bytes = files::read(path, bytes_max).map_err(CommandError::read(path))?;
    if u64::try_from(bytes.len()).unwrap_or(u64::MAX) > bytes_max {
        return Err(no_text());
    }
    String::from_utf8(bytes).map_err(|_| no_text())
}
