//! [`Format`]: the output formats of `export`.

use std::path::Path;

use clap::Args;

use crate::error::CommandError;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Format {
    Svg,
    Png,
    Gif,
    Apng,
    Json,
    Plot,
}

/// The options that select a format.
#[derive(Args, Debug)]
#[group(multiple = false)]
pub(super) struct Formats {
    /// A picture of one tick as an SVG document
    #[arg(long)]
    svg: bool,
    /// A picture of one tick as a PNG file
    #[arg(long)]
    png: bool,
    /// An animation as a GIF file
    #[arg(long)]
    gif: bool,
    /// An animation as an animated PNG file
    #[arg(long)]
    apng: bool,
    /// The states of one or more ticks as JSON, one line for each tick
    #[arg(long)]
    json: bool,
    /// Energy, overlaps, contacts, awake bodies and joint gaps over time, as an SVG document
    #[arg(long)]
    plot: bool,
}

impl Formats {
    /// The format that an option selects. Without such an option, the extension of the output file determines the
    /// format.
    pub(super) fn chosen(&self, output: Option<&Path>) -> Result<Format, CommandError> {
        let Formats { svg, png, gif, apng, json, plot } = *self;
        let asked = [
            (svg, Format::Svg),
            (png, Format::Png),
            (gif, Format::Gif),
            (apng, Format::Apng),
            (json, Format::Json),
            (plot, Format::Plot),
        ];
        let format = match asked.into_iter().find(|(asked, _)| *asked) {
            Some((_, format)) => format.checked(output)?,
            None => by_extension(output).ok_or(CommandError::NoFormat)?,
        };
        let is_text = matches!(format, Format::Svg | Format::Json | Format::Plot);
        if output.is_none() && !is_text {
            return Err(CommandError::NoOutput { format: format.option() });
        }
        Ok(format)
    }
}

fn by_extension(output: Option<&Path>) -> Option<Format> {
    match output?.extension()?.to_str()?.to_ascii_lowercase().as_str() {
        "svg" => Some(Format::Svg),
        "png" => Some(Format::Png),
        "gif" => Some(Format::Gif),
        "apng" => Some(Format::Apng),
        "json" | "jsonl" => Some(Format::Json),
        _ => None,
    }
}

impl Format {
    /// Refuses an output file with the extension of another format. A plot may end in .svg, and an animated PNG in
    /// .png.
    fn checked(self, output: Option<&Path>) -> Result<Self, CommandError> {
        let (Some(other), Some(path)) = (by_extension(output), output) else { return Ok(self) };
        let fits = match self {
            Format::Plot => other == Format::Svg,
            Format::Apng => matches!(other, Format::Apng | Format::Png),
            _ => other == self,
        };
        let (option, other) = (self.option(), other.option());
        let error = || CommandError::Extension { path: path.to_path_buf(), option, other };
        if fits { Ok(self) } else { Err(error()) }
    }

    pub(super) fn option(self) -> &'static str {
        match self {
            Format::Svg => "--svg",
            Format::Png => "--png",
            Format::Gif => "--gif",
            Format::Apng => "--apng",
            Format::Json => "--json",
            Format::Plot => "--plot",
        }
    }
}
