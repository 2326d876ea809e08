//! Actions of the user in a live world, with the pointer and with keys.

use lockstep2d::fx;
use lockstep2d::math::{Fx, Vec2};
use lockstep2d_render::{Camera, DrawList};

use super::theme;
use crate::event::Key;
use crate::live::{Act, Aim, Form, Playground};
use crate::source::Source;

/// Largest distance in pixels from the pointer to a body that it can grab or delete.
const REACH: f32 = 6.0;

/// Magnitude of gravity, in m/s².
const GRAVITY: Fx = fx!(10);

/// Directions of gravity, in the order in which the key `g` selects them. y points up.
const GRAVITIES: [(Fx, Fx); 5] =
    [(fx!(0), fx!(-1)), (fx!(0), fx!(0)), (fx!(0), fx!(1)), (fx!(-1), fx!(0)), (fx!(1), fx!(0))];

#[derive(Debug, Default)]
pub(super) struct Hand {
    form: usize,
    gravity: usize,
    /// Start point of the body that is being drawn, in world coordinates.
    begun: Option<Vec2<Fx>>,
}

fn aim(camera: &Camera, at: Vec2<Fx>) -> Aim {
    let way = camera.point([REACH, 0.0]) - camera.point([0.0; 2]);
    Aim { at, within: way.x }
}

impl Hand {
    pub(super) fn form(&self) -> Form {
        Form::ALL[self.form % Form::ALL.len()]
    }

    pub(super) fn grab(playground: &mut dyn Playground, camera: &Camera, at: Vec2<Fx>) {
        playground.act(Act::Grab(aim(camera, at)));
    }

    pub(super) fn drag(playground: &mut dyn Playground, camera: &Camera, at: [f32; 2]) {
        playground.act(Act::DragTo(camera.point(at)));
    }

    /// Starts to draw a new body.
    pub(super) fn begin(&mut self, camera: &Camera, at: [f32; 2]) {
        self.begun = Some(camera.point(at));
    }

    /// Creates the body that was drawn.
    pub(super) fn put(&mut self, playground: &mut dyn Playground, camera: &Camera, at: [f32; 2]) {
        if let Some(begun) = self.begun.take() {
            playground.act(Act::Spawn { form: self.form(), at: begun, to: camera.point(at) });
        }
    }

    /// Handles a key. Returns `false` if the key has no action in a live world.
    pub(super) fn press(
        &mut self,
        key: Key,
        playground: &mut dyn Playground,
        camera: &Camera,
        at: [f32; 2],
    ) -> bool {
        match key {
            Key::Character('b') => self.form += 1,
            Key::Character('x') | Key::Delete => playground.act(Act::Delete(aim(camera, camera.point(at)))),
            Key::Character('e') => playground.act(Act::explode(camera.point(at))),
            Key::Character('g') => {
                self.gravity = (self.gravity + 1) % GRAVITIES.len();
                let (x, y) = GRAVITIES[self.gravity];
                playground.act(Act::Gravity(Vec2::new(x * GRAVITY, y * GRAVITY)));
            }
            _ => return false,
        }
        true
    }

    pub(super) fn draw(&self, list: &mut DrawList, source: &mut dyn Source, camera: &Camera, at: [f32; 2]) {
        let Some(held) = source.playground().map(|playground| playground.held()) else { return };
        if let Some(held) = held
            && let Some(body) = source.world().body(held.body)
        {
            let ends = [camera.place(body.transform().apply(held.point)), camera.place(held.towards)];
            camera.clipped(ends).into_iter().for_each(|ends| list.line(ends, theme::SELECTED, 2.0));
        }
        if let Some(begun) = self.begun {
            list.line([camera.place(begun), at], theme::SELECTED, 2.0);
        }
    }
}
