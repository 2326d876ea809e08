//! Timeline bar, which is clicked or dragged to seek.

use lockstep2d_render::DrawList;

use super::theme;
use crate::source::Source;

/// Distance of the bar from the borders of the window, in pixels.
const MARGIN: f32 = 12.0;
/// Height of the bar, in pixels.
const HEIGHT: f32 = 14.0;

#[derive(Clone, Copy, Debug)]
pub(super) struct Bar {
    left: f32,
    top: f32,
    width: f32,
    first: u64,
    last: u64,
}

impl Bar {
    pub(super) fn new([width, height]: [f32; 2], source: &dyn Source) -> Self {
        let (first, last) = (source.first(), source.ticks().unwrap_or_else(|| source.recorded()));
        let width = (width - 2.0 * MARGIN).max(1.0);
        Bar { left: MARGIN, top: height - MARGIN - HEIGHT, width, first, last }
    }

    pub(super) fn holds(self, [x, y]: [f32; 2]) -> bool {
        // The bar is thin, so clicks slightly beside it count, too.
        (self.left - 4.0..=self.left + self.width + 4.0).contains(&x)
            && (self.top - 6.0..=self.top + HEIGHT + MARGIN).contains(&y)
    }

    /// Tick at an x coordinate, clamped to the range of the bar.
    pub(super) fn tick_at(self, x: f32) -> u64 {
        let part = (f64::from((x - self.left) / self.width)).clamp(0.0, 1.0);
        self.first + (part * self.ticks() + 0.5) as u64
    }

    fn place_of(self, tick: u64) -> f32 {
        let part = tick.saturating_sub(self.first) as f64 / self.ticks().max(1.0);
        self.left + self.width * part.min(1.0) as f32
    }

    fn ticks(self) -> f64 {
        self.last.saturating_sub(self.first) as f64
    }

    pub(super) fn draw(
        self,
        list: &mut DrawList,
        source: &dyn Source,
        goal: Option<u64>,
        marked: Option<u64>,
    ) {
        let Bar { left, top, width, .. } = self;
        list.rectangle([left, top], [width, HEIGHT], theme::FAINT.with_opacity(90));
        let now = self.place_of(source.tick());
        list.rectangle([left, top], [now - left, HEIGHT], theme::ACCENT.with_opacity(160));
        for (tick, colour) in [(goal, theme::FAINT), (marked, theme::BAD)] {
            if let Some(tick) = tick {
                list.rectangle([self.place_of(tick) - 1.0, top - 4.0], [2.0, HEIGHT + 8.0], colour);
            }
        }
        list.rectangle([now - 2.0, top - 4.0], [4.0, HEIGHT + 8.0], theme::ACCENT);
    }
}
