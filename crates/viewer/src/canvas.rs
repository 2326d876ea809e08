//! [`Canvas`]: draws over the world of a game.

use std::f32::consts::TAU;

use lockstep2d::body::BodyId;
use lockstep2d::draw::{Layers, Primitive, Subject, primitives};
use lockstep2d::math::{Fx, Vec2};
use lockstep2d::world::World;
use lockstep2d_render::{Brush, CELL_HEIGHT, Camera, Colour, DrawList, filled, paint, width_of};

/// Number of corners of a circle.
const CORNERS: u16 = 48;
/// Background of a headline.
const PLATE: Colour = Colour::hex(0x14_181d);
/// Opacity of the inside of a coloured body.
const INSIDE: u8 = 150;

/// Draws over the world, in metres with y upwards. Later shapes lie on top.
///
/// [`Viewer::draw`](crate::Viewer::draw) passes the game a canvas that draws into the list of the viewer.
/// [`Canvas::new`] makes one that draws into another [`DrawList`]:
///
/// ```
/// use lockstep2d::{fx, math::{Aabb, Vec2}};
/// use lockstep2d_viewer::{Camera, Canvas, Colour, DrawList};
///
/// let window = Aabb::new(Vec2::new(fx!(-10), fx!(-5)), Vec2::new(fx!(10), fx!(5)));
/// let camera = Camera::new(window, [0.0, 0.0], [800.0, 400.0]);
/// let mut list = DrawList::default();
/// let mut canvas = Canvas::new(&mut list, &camera);
/// canvas.circle(Vec2::ZERO, fx!(0.5), Colour::hex(0x009e73));
/// canvas.text(Vec2::new(fx!(0), fx!(1)), Colour::hex(0xffffff), "goal");
/// assert_eq!((list.items().len(), list.texts().len()), (1, 1));
/// ```
pub struct Canvas<'a> {
    list: &'a mut DrawList,
    camera: &'a Camera,
}

impl<'a> Canvas<'a> {
    /// Creates a canvas that draws into a list.
    #[must_use]
    pub fn new(list: &'a mut DrawList, camera: &'a Camera) -> Self {
        Canvas { list, camera }
    }

    /// The draw list, whose units are pixels.
    pub fn list(&mut self) -> &mut DrawList {
        self.list
    }

    /// Camera, which converts between metres and pixels.
    #[must_use]
    pub const fn camera(&self) -> &Camera {
        self.camera
    }

    /// Fills a circle with a radius in metres.
    pub fn circle(&mut self, centre: Vec2<Fx>, radius: Fx, fill: Colour) {
        let ([x, y], radius) = (self.camera.place(centre), self.camera.length(radius));
        if self.camera.sees([x, y], radius) {
            let corner = |corner: u16| {
                let (sin, cos) = (TAU * f32::from(corner) / f32::from(CORNERS)).sin_cos();
                [x + radius * cos, y - radius * sin]
            };
            self.list.polygon((0..CORNERS).map(corner), fill, Colour::NONE, 0.0);
        }
    }

    /// Fills a convex polygon.
    pub fn polygon(&mut self, vertices: &[Vec2<Fx>], fill: Colour) {
        let points: Vec<_> = vertices.iter().map(|&vertex| self.camera.place(vertex)).collect();
        if self.camera.sees_any(&points) {
            self.list.polygon(points, fill, Colour::NONE, 0.0);
        }
    }

    /// Draws a line through points, `width` pixels wide.
    pub fn line(&mut self, points: &[Vec2<Fx>], colour: Colour, width: f32) {
        for ends in points.windows(2) {
            let ends = [self.camera.place(ends[0]), self.camera.place(ends[1])];
            if let Some(ends) = self.camera.clipped(ends) {
                self.list.line(ends, colour, width);
            }
        }
    }

    /// Writes a line of text, centred at a world position.
    pub fn text(&mut self, at: Vec2<Fx>, colour: Colour, text: impl Into<String>) {
        let (text, [x, y]) = (text.into(), self.camera.place(at));
        let corner = [x - width_of(&text, 1.0) / 2.0, y - CELL_HEIGHT / 2.0];
        self.list.text(corner, 1.0, colour, text);
    }

    /// Writes a line of text at the top of the picture.
    pub fn headline(&mut self, colour: Colour, text: impl Into<String>) {
        let text = text.into();
        let (width, middle) = (width_of(&text, 1.0), self.camera.middle[0] as f32);
        let corner = [middle - width / 2.0, CELL_HEIGHT];
        let plate = [width + CELL_HEIGHT, CELL_HEIGHT * 1.5];
        self.list.rectangle(
            [corner[0] - CELL_HEIGHT / 2.0, corner[1] - CELL_HEIGHT / 4.0],
            plate,
            PLATE.with_opacity(220),
        );
        self.list.text(corner, 1.0, colour, text);
    }

    /// Paints the shapes of a body in a colour. Has no effect if the body is not in the world.
    pub fn body(&mut self, world: &World, id: BodyId, colour: Colour) {
        self.bodies(world, |other| (other == id).then_some(colour));
    }

    /// Paints the shapes of all bodies for which `colour` returns a colour. This is faster than many calls of
    /// [`Canvas::body`].
    pub fn bodies(&mut self, world: &World, colour: impl Fn(BodyId) -> Option<Colour>) {
        let outlines = Layers { outlines: true, ..Layers::NONE };
        for primitive in primitives(world, outlines) {
            let Subject::Body(id) = primitive.subject else { continue };
            if let Some(colour) = colour(id) {
                let inside = colour.with_opacity(INSIDE);
                filled(self.list, &primitive, self.camera, inside, colour);
            }
        }
    }

    /// Paints a primitive of `lockstep2d::draw`. If `colour` is `None`, the primitive has the colours of its style.
    pub fn primitive(&mut self, primitive: &Primitive, colour: Option<Colour>) {
        paint(self.list, primitive, self.camera, &Brush { tint: colour, ..Brush::default() });
    }
}
