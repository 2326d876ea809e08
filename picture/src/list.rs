//! [`DrawList`]: what to draw, in the order in which to draw it.

use crate::colour::Colour;

/// Where the points of an [`Item`] are in [`DrawList::points`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Points {
    /// The first.
    pub first: u32,
    /// How many.
    pub count: u32,
}

/// A convex polygon or a line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Item {
    /// Its corners.
    pub points: Points,
    /// Of its inside; [`Colour::NONE`] for lines.
    pub fill: Colour,
    /// Of its border.
    pub stroke: Colour,
    /// Of the border, in pixels.
    pub width: f32,
    /// Whether the border goes on from the last point to the first.
    pub closed: bool,
}

/// A line of text, in the cells of a monospaced font (see [`CELL_WIDTH`](crate::CELL_WIDTH)).
#[derive(Clone, Debug, PartialEq)]
pub struct Text {
    /// After how many items it is drawn.
    pub after: u32,
    /// Its upper left corner, in pixels.
    pub at: [f32; 2],
    /// Height of a line in pixels, as a factor of [`CELL_HEIGHT`](crate::CELL_HEIGHT).
    pub scale: f32,
    /// Its colour.
    pub colour: Colour,
    /// What it says.
    pub text: String,
}

/// What to draw, in pixels from the upper left corner, y downwards; what is last lies on top.
///
/// It keeps its memory from frame to frame: [`DrawList::clear`] it and fill it again.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DrawList {
    points: Vec<[f32; 2]>,
    items: Vec<Item>,
    texts: Vec<Text>,
}

impl DrawList {
    /// Takes everything out.
    pub fn clear(&mut self) {
        self.points.clear();
        self.items.clear();
        self.texts.clear();
    }

    /// All polygons and lines.
    #[must_use]
    pub fn items(&self) -> &[Item] {
        &self.items
    }

    /// All lines of text, in the order of [`Text::after`].
    #[must_use]
    pub fn texts(&self) -> &[Text] {
        &self.texts
    }

    /// The corners of an item.
    #[must_use]
    pub fn points(&self, item: &Item) -> &[[f32; 2]] {
        let first = item.points.first as usize;
        &self.points[first..first + item.points.count as usize]
    }

    /// Adds a convex polygon with a border of `width` pixels.
    pub fn polygon(
        &mut self,
        points: impl IntoIterator<Item = [f32; 2]>,
        fill: Colour,
        stroke: Colour,
        width: f32,
    ) {
        let points = self.add_points(points);
        self.items.push(Item { points, fill, stroke, width, closed: true });
    }

    /// Adds a line through points.
    pub fn line(&mut self, points: impl IntoIterator<Item = [f32; 2]>, stroke: Colour, width: f32) {
        let points = self.add_points(points);
        self.items.push(Item { points, fill: Colour::NONE, stroke, width, closed: false });
    }

    /// Adds a rectangle without a border.
    pub fn rectangle(&mut self, [x, y]: [f32; 2], [width, height]: [f32; 2], fill: Colour) {
        let corners = [[x, y], [x, y + height], [x + width, y + height], [x + width, y]];
        self.polygon(corners, fill, Colour::NONE, 0.0);
    }

    /// Adds a line of text.
    pub fn text(&mut self, at: [f32; 2], scale: f32, colour: Colour, text: impl Into<String>) {
        let after = u32::try_from(self.items.len()).unwrap_or(u32::MAX);
        self.texts.push(Text { after, at, scale, colour, text: text.into() });
    }

    /// Takes the last polygon or line out again.
    pub(crate) fn undo(&mut self) {
        if let Some(item) = self.items.pop() {
            self.points.truncate(item.points.first as usize);
        }
    }

    fn add_points(&mut self, points: impl IntoIterator<Item = [f32; 2]>) -> Points {
        let first = self.points.len();
        self.points.extend(points);
        let index = |index: usize| u32::try_from(index).unwrap_or(u32::MAX);
        Points { first: index(first), count: index(self.points.len() - first) }
    }
}
