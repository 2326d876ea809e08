//! [`page`]: a picture of a world with a legend and a scale bar, like `lockstep2d::draw::svg`.

use lockstep2d::draw::{Bar, Frame, Legend, PAPER, Style, View, fit, primitives};
use lockstep2d::world::World;

use crate::camera::Camera;
use crate::colour::Colour;
use crate::list::DrawList;
use crate::paint::{Brush, paint};
use crate::text::{CELL_WIDTH, width_of};

/// Colour of the scale bar and of the legend, except for the names of styles.
const INK: Colour = Colour::hex(0x222222);
/// Background colour of the legend.
const WHITE: Colour = Colour::hex(0xffffff);
/// Line height of the legend, in pixels.
const LINE: f32 = 17.0;
/// Margin around the legend, in pixels.
const MARGIN: f32 = 8.0;
/// Typical number of characters of the figures in the legend.
const FIGURES: usize = 100;
/// Number of characters of the hash.
const HASH: usize = 34;
/// Typical number of characters of a style's name.
const NAME: usize = 12;

/// Draws a world like `lockstep2d::draw::svg`: its visible part, and a scale bar. The legend is above them; its lines
/// are wrapped to the width of the picture.
pub fn page(list: &mut DrawList, world: &World, view: &View) {
    let size = [view.width.clamp(64, 16384) as f32, view.height.clamp(64, 16384) as f32];
    let window = match view.frame {
        Frame::Fit => fit(world),
        Frame::Window(window) => window,
    };
    let mut found = primitives(world, view.layers);
    // The sort is stable, so the primitives of a style stay in slot order.
    found.sort_by_key(|primitive| primitive.style);
    let top = height_of_legend(view, size[0]).min(size[1] / 2.0);
    let camera = Camera::new(window, [0.0, top], [size[0], size[1] - top]);
    let brush = Brush::suiting(world, &camera);
    list.rectangle([0.0, top], [size[0], size[1] - top], Colour::hex(PAPER));
    let mut styles: Vec<Style> = Vec::new();
    for primitive in &found {
        let count = (list.items().len(), list.texts().len());
        paint(list, primitive, &camera, &brush);
        if (list.items().len(), list.texts().len()) != count && styles.last() != Some(&primitive.style) {
            styles.push(primitive.style);
        }
    }
    add_bar(list, &camera, size);
    // Covers the parts of primitives above the picture area.
    list.rectangle([0.0, 0.0], [size[0], top], WHITE);
    add_legend(list, &Legend::of(world, styles), &view.title, size[0]);
}

/// Height of the legend, in pixels. It is computed from typical lengths of the texts, so that it is equal in all frames
/// of an animation.
fn height_of_legend(view: &View, width: f32) -> f32 {
    let columns = ((width - 2.0 * MARGIN) / CELL_WIDTH).max(1.0) as usize;
    let title = view.title.chars().count().next_multiple_of(8);
    let layers = { view.layers }.named().into_iter().filter(|(_, shown)| **shown).count();
    let lines = (FIGURES + title).div_ceil(columns) + (HASH + layers * NAME).div_ceil(columns);
    lines as f32 * LINE + MARGIN
}

/// Adds the title and figures, and below them the hash with the names of the visible styles.
fn add_legend(list: &mut DrawList, legend: &Legend, title: &str, width: f32) {
    let mut pen = Pen { at: [MARGIN, 2.0], width };
    if !title.is_empty() {
        // The font has one weight, so bold text is drawn as two offset copies.
        let title = format!("{title} · ");
        list.text([pen.at[0] + 0.6, pen.at[1]], 1.0, INK, title.clone());
        pen.write(list, &title, INK);
    }
    for figure in legend.figures.split_inclusive(" · ") {
        pen.write(list, figure, INK);
    }
    pen.new_line();
    pen.write(list, &format!("{} ", legend.hash), INK);
    for &(name, colour) in &legend.names {
        pen.write(list, &format!("{name} "), Colour::hex(colour));
    }
}

/// Writes text from left to right, wrapped at the width.
struct Pen {
    at: [f32; 2],
    width: f32,
}

impl Pen {
    fn write(&mut self, list: &mut DrawList, text: &str, colour: Colour) {
        let length = width_of(text, 1.0);
        if self.at[0] > MARGIN && self.at[0] + width_of(text.trim_end(), 1.0) > self.width - MARGIN {
            self.new_line();
        }
        list.text(self.at, 1.0, colour, text);
        self.at[0] += length;
    }

    fn new_line(&mut self) {
        self.at = [MARGIN, self.at[1] + LINE];
    }
}

/// Adds a scale bar of up to a quarter of the picture's width, in the lower left corner.
fn add_bar(list: &mut DrawList, camera: &Camera, [width, height]: [f32; 2]) {
    let Some(Bar { length, label }) = Bar::up_to(|length| camera.length(length) <= width / 4.0) else {
        return;
    };
    let (left, right, y) = (10.0, 10.0 + camera.length(length), height - 10.0);
    list.line([[left, y], [right, y]], INK, 1.0);
    for end in [left, right] {
        list.line([[end, y - 3.0], [end, y + 3.0]], INK, 1.0);
    }
    list.text([14.0, y - 18.0], 1.0, INK, label);
}
