//! A range of ticks as an animation.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use lockstep2d::draw::{Frame, View, fit};
use lockstep2d::lockstep::Game;
use lockstep2d::math::Aabb;
use lockstep2d_render::{Animation, DrawList, Image, Pace};

use super::format::Format;
use super::still::image;
use super::{Arguments, Output, Replay};
use crate::context::{CommandResult, Context};
use crate::error::CommandError;

/// Largest default frame rate in frames per second.
const FRAME_RATE_MAX: u32 = 30;
/// Default width in pixels, smaller than for pictures to keep files small.
const WIDTH: u32 = 640;
/// Highest frame rate at which most programs show a GIF, in frames per second: they slow down frames shorter than 2/100
/// s.
const GIF_RATE_MAX: u32 = 50;
/// Maximum number of ticks before the last one that are sampled to find a window. The last tick is always sampled.
const SAMPLES: u64 = 100;
/// One in this many sampled ticks is drawn as a sample picture, from which the palette is made.
const SAMPLES_OF_A_PICTURE: usize = 10;

/// Plays the replay twice. The first pass finds the window and the colours, and fails before anything is written.
pub(super) fn write<G: Game>(
    bytes: &[u8],
    mut replay: Replay<'_, G>,
    format: Format,
    arguments: &Arguments,
    context: &mut Context<'_, G>,
) -> CommandResult {
    let frames = Frames::of(&replay, arguments)?;
    if format == Format::Gif && frames.pace.ticks.saturating_mul(GIF_RATE_MAX) < frames.pace.tick_rate {
        context.console.warning("more than 50 frames a second: most programs show such a GIF too slowly");
    }
    let progress = Progress::new(context.console.is_terminal, frames.count);
    let mut camera = Camera::new(&mut replay, context.tool.view, arguments)?;
    let samples = camera.look_at(&mut replay, &frames)?;
    let mut replay = Replay::<G>::open(bytes, arguments, context.limits())?;
    Output::write(arguments, &mut context.console, |output| {
        let (to, failed) = output.parts();
        let mut animation = match format {
            Format::Apng => Animation::apng(to, frames.pace, frames.count),
            _ => Animation::gif(to, frames.pace),
        };
        samples.iter().for_each(|sample| animation.expect(sample));
        let mut list = DrawList::default();
        for tick in frames.ticks() {
            replay.play_to(tick)?;
            animation.add(&camera.picture(&mut replay, &mut list)?).map_err(&failed)?;
            progress.advance();
        }
        animation.finish().map_err(failed)
    })
}

struct Frames {
    first: u64,
    last: u64,
    pace: Pace,
    count: u32,
}

impl Frames {
    fn of<G: Game>(replay: &Replay<'_, G>, arguments: &Arguments) -> Result<Self, CommandError> {
        let (first, last) = replay.range(arguments)?;
        let tick_rate = replay.verified.game().tick_rate();
        let ticks = arguments.every.unwrap_or_else(|| tick_rate.div_ceil(FRAME_RATE_MAX).max(1));
        let count = u32::try_from((last - first) / u64::from(ticks) + 1).unwrap_or(u32::MAX);
        Ok(Frames { first, last, pace: Pace { ticks, tick_rate }, count })
    }

    fn ticks(&self) -> impl Iterator<Item = u64> {
        (0..u64::from(self.count)).map(|frame| self.first + frame * u64::from(self.pace.ticks))
    }

    /// The ticks to sample: at most `SAMPLES` + 1, including the first and the last.
    fn samples(&self) -> impl Iterator<Item = u64> {
        let step = (self.last - self.first).div_ceil(SAMPLES).max(1);
        (0..SAMPLES)
            .map(move |sample| self.first + sample * step)
            .take_while(|&tick| tick < self.last)
            .chain([self.last])
    }
}

struct Camera<'a, G: Game> {
    view: Option<fn(&G) -> View>,
    arguments: &'a Arguments,
    size: (u32, u32),
    /// Window of all frames. Not used if the game or the arguments set a window.
    window: Option<Aabb>,
}

impl<'a, G: Game> Camera<'a, G> {
    /// Determines the size of all frames. Their aspect ratio is that of the game's view, unless the arguments set both
    /// width and height, or a side would have fewer than 64 or more than 16384 pixels.
    fn new(
        replay: &mut Replay<'_, G>,
        view: Option<fn(&G) -> View>,
        arguments: &'a Arguments,
    ) -> Result<Self, CommandError> {
        replay.world()?;
        let View { width, height, .. } = replay.view(view);
        let scaled = |side: u32, from: u32, to: u32| {
            let side = u64::from(side) * u64::from(to) / u64::from(from.max(1));
            u32::try_from(side).unwrap_or(u32::MAX).clamp(64, 16384)
        };
        let size = match (arguments.width, arguments.height) {
            (None, None) => (WIDTH, scaled(height, width, WIDTH)),
            (Some(to), None) => (to, scaled(height, width, to)),
            (None, Some(to)) => (scaled(width, height, to), to),
            (Some(width), Some(height)) => (width, height),
        };
        Ok(Camera { view, arguments, size, window: None })
    }

    /// Finds a window that fits the world at all sampled ticks. Returns sample pictures for the palette.
    fn look_at(&mut self, replay: &mut Replay<'_, G>, frames: &Frames) -> Result<Vec<Image>, CommandError> {
        let mut window: Option<Aabb> = None;
        let mut pictures = Vec::new();
        for (at, tick) in frames.samples().enumerate() {
            replay.play_to(tick)?;
            let fitting = fit(replay.world()?);
            window = Some(window.map_or(fitting, |window| window.union(fitting)));
            if at % SAMPLES_OF_A_PICTURE == SAMPLES_OF_A_PICTURE / 2 {
                pictures.push(self.picture(replay, &mut DrawList::default())?);
            }
        }
        self.window = window;
        Ok(pictures)
    }

    fn picture(&self, replay: &mut Replay<'_, G>, list: &mut DrawList) -> Result<Image, CommandError> {
        let (width, height) = self.size;
        let mut view = View { width, height, ..self.arguments.view(replay.view(self.view)) };
        if let (Frame::Fit, Some(window)) = (view.frame, self.window) {
            view.frame = Frame::Window(window);
        }
        Ok(image(list, replay.world()?, &view))
    }
}

struct Progress(Option<ProgressBar>);

impl Progress {
    fn new(is_shown: bool, frames: u32) -> Self {
        Progress(is_shown.then(|| {
            let bar =
                ProgressBar::with_draw_target(Some(frames.into()), ProgressDrawTarget::stderr_with_hz(10));
            let style = ProgressStyle::with_template("{bar:40} {pos} of {len} frames, {eta} left");
            bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
            bar
        }))
    }

    fn advance(&self) {
        if let Some(bar) = &self.0 {
            bar.inc(1);
        }
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        if let Some(bar) = &self.0 {
            bar.finish_and_clear();
        }
    }
}
