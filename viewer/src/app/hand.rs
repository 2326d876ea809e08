//! What a person's hand does in a live world, with the pointer and with keys.

use lockstep2d::fx;
use lockstep2d::math::{Fx, Vec2};
use lockstep2d_picture::{Camera, DrawList};

use super::theme;
use crate::event::Key;
use crate::live::{Act, Aim, Form, Playground};
use crate::source::Source;

/// How far beside a body the pointer may be, in pixels.
const REACH: f32 = 6.0;

/// Strength of gravity, in m/s².
const GRAVITY: Fx = fx!(10);

/// The directions that a person goes through.
const GRAVITIES: [(Fx, Fx); 5] =
    [(fx!(0), fx!(-1)), (fx!(0), fx!(0)), (fx!(0), fx!(1)), (fx!(-1), fx!(0)), (fx!(1), fx!(0))];

/// What is chosen, and what is about to be put somewhere.
#[derive(Debug, Default)]
pub(super) struct Hand {
    form: usize,
    gravity: usize,
    /// Where a new body was begun.
    begun: Option<Vec2<Fx>>,
}

fn aim(camera: &Camera, at: [f32; 2]) -> Aim {
    let way = camera.point([at[0] + REACH, at[1]]) - camera.point(at);
    Aim { at: camera.point(at), within: way.x }
}

impl Hand {
    pub(super) fn form(&self) -> Form {
        Form::ALL[self.form % Form::ALL.len()]
    }

    pub(super) fn grab(playground: &mut dyn Playground, camera: &Camera, at: [f32; 2]) {
        playground.act(Act::Grab(aim(camera, at)));
    }

    pub(super) fn drag(playground: &mut dyn Playground, camera: &Camera, at: [f32; 2]) {
        playground.act(Act::DragTo(camera.point(at)));
    }

    /// The place at which a new body begins.
    pub(super) fn begin(&mut self, camera: &Camera, at: [f32; 2]) {
        self.begun = Some(camera.point(at));
    }

    /// Puts the body that was begun there, as large as the way.
    pub(super) fn put(&mut self, playground: &mut dyn Playground, camera: &Camera, at: [f32; 2]) {
        if let Some(begun) = self.begun.take() {
            playground.act(Act::Spawn { form: self.form(), at: begun, to: camera.point(at) });
        }
    }

    /// What a key does. `false` if nothing.
    pub(super) fn press(
        &mut self,
        key: Key,
        playground: &mut dyn Playground,
        camera: &Camera,
        at: [f32; 2],
    ) -> bool {
        match key {
            Key::Character('b') => self.form += 1,
            Key::Character('x') | Key::Delete => playground.act(Act::Delete(aim(camera, at))),
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

    /// The band at which a body is held, and the body that is begun.
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
