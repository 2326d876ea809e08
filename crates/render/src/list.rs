//! [`DrawList`]: polygons, lines and text in drawing order.

use crate::colour::Colour;

/// Range of the points of an [`Item`]. [`DrawList::points`] returns the points.
///
/// ```
/// use lockstep2d_render::{Colour, DrawList, Points};
/// let mut list = DrawList::default();
/// list.line([[0.0, 0.0], [5.0, 5.0]], Colour::hex(0), 1.0);
/// list.polygon([[0.0, 0.0], [9.0, 0.0], [0.0, 9.0]], Colour::hex(0), Colour::NONE, 0.0);
/// // The corners of all items are stored in one array, like a vertex buffer.
/// assert_eq!(list.items()[1].points, Points { first: 2, count: 3 });
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Points {
    /// Index of the first point.
    pub first: u32,
    /// Number of points.
    pub count: u32,
}

/// Convex polygon or line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Item {
    /// Range of the corners.
    pub points: Points,
    /// Colour of the inside.
    pub fill: Colour,
    /// Colour of the border or line.
    pub stroke: Colour,
    /// Width of the border or line, in pixels.
    pub width: f32,
    /// Whether an edge leads from the last point to the first.
    pub closed: bool,
}

/// Line of text. At scale 1, each character takes [`CELL_WIDTH`](crate::CELL_WIDTH) pixels.
#[derive(Clone, Debug, PartialEq)]
pub struct Text {
    /// Number of items drawn before the text.
    pub after: u32,
    /// Upper left corner, in pixels.
    pub at: [f32; 2],
    /// Size, as a factor of [`CELL_HEIGHT`](crate::CELL_HEIGHT).
    pub scale: f32,
    /// Colour.
    pub colour: Colour,
    /// The text.
    pub text: String,
}

/// Items and texts to draw, in pixels from the upper left corner with y pointing down. Later entries lie on top.
///
/// ```
/// use lockstep2d_render::{Colour, DrawList, Item, Text};
/// // A health bar with a number, drawn on top of all earlier entries.
/// let mut list = DrawList::default();
/// list.rectangle([10.0, 10.0], [80.0, 8.0], Colour::hex(0x2ca02c));
/// list.text([10.0, 20.0], 1.0, Colour::hex(0x222222), "80");
/// // A custom renderer reads the list.
/// let [bar]: &[Item] = list.items() else { panic!("one rectangle") };
/// assert_eq!(list.points(bar)[2], [90.0, 18.0]);
/// let [Text { after, text, .. }] = list.texts() else { panic!("one text") };
/// assert_eq!((*after, text.as_str()), (1, "80"));
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DrawList {
    points: Vec<[f32; 2]>,
    items: Vec<Item>,
    texts: Vec<Text>,
}

impl DrawList {
    /// Removes all entries, and keeps the memory.
    pub fn clear(&mut self) {
        self.points.clear();
        self.items.clear();
        self.texts.clear();
    }

    /// Polygons and lines.
    #[must_use]
    pub fn items(&self) -> &[Item] {
        &self.items
    }

    /// Lines of text, in the order of [`Text::after`].
    #[must_use]
    pub fn texts(&self) -> &[Text] {
        &self.texts
    }

    /// Corners of an item.
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
