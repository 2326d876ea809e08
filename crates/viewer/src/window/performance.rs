//! [`Performance`]: runs a script in the window.

use std::io;
use std::path::Path;

use crate::Event;
use crate::script::{FRAME, Script, Step};
use miniquad::window;

use super::WindowError;
use super::renderer::Picture;
use super::stage::Stage;

pub(super) struct Performance {
    steps: std::vec::IntoIter<Step>,
    /// Remaining frames of the current `frames` instruction.
    frames: u32,
}

impl Performance {
    pub(super) fn new(script: Script) -> Self {
        Performance { steps: script.steps().to_vec().into_iter(), frames: 0 }
    }

    /// Runs the instructions before the next frame. Returns `false` at the end of the script.
    pub(super) fn frame(&mut self, stage: &mut Stage) -> Result<bool, WindowError> {
        loop {
            if self.frames > 0 {
                self.frames -= 1;
                stage.app.advance(FRAME);
                return Ok(true);
            }
            match self.steps.next() {
                None | Some(Step::Quit) => return Ok(false),
                Some(Step::Frames(count)) => self.frames = count,
                Some(Step::Event(event)) => stage.app.handle(event),
                Some(Step::Drop(path)) => {
                    let bytes = std::fs::read(&path).map_err(|error| file(&path, error))?;
                    let name =
                        Path::new(&path).file_name().unwrap_or_default().to_string_lossy().into_owned();
                    stage.app.handle(Event::Dropped { name, bytes });
                }
                Some(Step::Screenshot(path)) => {
                    let picture = picture(stage);
                    write_png(&path, &picture).map_err(|error| file(&path, error))?;
                }
                Some(Step::Report) => println!("{}", stage.app.report()),
            }
        }
    }
}

fn picture(stage: &mut Stage) -> Picture {
    stage.mesh.build(stage.app.draw(), &stage.screen);
    let (width, height) = window::screen_size();
    stage.renderer.picture(&stage.mesh, &stage.screen, [width as u32, height as u32])
}

fn write_png(path: &str, picture: &Picture) -> io::Result<()> {
    let file = io::BufWriter::new(std::fs::File::create(path)?);
    let mut encoder = png::Encoder::new(file, picture.width, picture.height);
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_depth(png::BitDepth::Eight);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&picture.pixels)?;
    writer.finish()?;
    Ok(())
}

fn file(path: &str, error: io::Error) -> WindowError {
    WindowError::File { path: path.to_owned(), error }
}
