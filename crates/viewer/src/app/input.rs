//! Event handling: maps keys and pointer events to actions of the app.

use lockstep2d::body::BodyId;
use lockstep2d::math::{Fx, Vec2};
use lockstep2d::world::World;
use lockstep2d_render::Camera;

use crate::event::{Button, Event, Key};
use crate::live::Act;

use super::App;
use super::hand::Hand;
use super::inspector::{Inspector, body_at};
use super::layers;
use super::timeline::Bar;

/// Largest distance in pixels that the pointer may move between press and release of a click.
const CLICK: f32 = 4.0;

#[derive(Debug, Default)]
pub(super) struct Pointer {
    pub(super) at: [f32; 2],
    doing: Doing,
    /// The button that began the action in [`Self::doing`]. Other buttons have no effect until it is released.
    button: Option<Button>,
    shift: bool,
}

impl Pointer {
    /// Cancels the action of the pointer: the release of its button then has no effect.
    pub(super) fn cease(&mut self) {
        (self.doing, self.button) = (Doing::Nothing, None);
    }
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
enum Doing {
    #[default]
    Nothing,
    /// The button went down at the position `from`, and the pointer has stayed within [`CLICK`] of it. When the pointer
    /// moves further, it drags the body at the grip or, without a grip, pans the view. A release before that is a
    /// click: it must not act in a live world, because an act at an earlier tick drops the later recorded ticks.
    Pressing {
        from: [f32; 2],
        grip: Option<Grip>,
    },
    Panning,
    /// The pointer moves along the timeline.
    Scrubbing,
    /// The pointer drags a body.
    Dragging,
    Spawning,
}

/// Point of a dynamic body, in the body's frame. The body may move until the pointer drags it.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Grip {
    body: BodyId,
    point: Vec2<Fx>,
}

impl Grip {
    /// The grip at a screen position. `None` if no dynamic body is there.
    fn at(world: &World, camera: &Camera, at: [f32; 2]) -> Option<Self> {
        let id = body_at(world, camera, at)?;
        let body = world.body(id).filter(|body| body.is_dynamic())?;
        Some(Grip { body: id, point: body.transform().apply_inverse(camera.point(at)) })
    }

    /// The gripped point in world coordinates. `None` if the body no longer exists.
    fn place(self, world: &World) -> Option<Vec2<Fx>> {
        world.body(self.body).map(|body| body.transform().apply(self.point))
    }
}

fn is_click(from: [f32; 2], to: [f32; 2]) -> bool {
    (to[0] - from[0]).hypot(to[1] - from[1]) <= CLICK
}

impl App {
    /// Handles an input event. The source receives it first, so that a game can consume its players' keys.
    pub fn handle(&mut self, event: Event) {
        match event {
            Event::Pressed(Key::Shift) => self.pointer.shift = true,
            Event::Released(Key::Shift) => self.pointer.shift = false,
            _ => {}
        }
        if self.source.as_mut().is_some_and(|source| source.handle(&event)) {
            return;
        }
        match event {
            Event::Resized(size) => self.size = size,
            Event::Pressed(key) => self.press(key),
            Event::Released(_) => {}
            Event::Moved(at) => self.move_to(at),
            Event::Down(button) => self.down(button),
            Event::Up(button) => self.up(button),
            Event::Wheel(notches) => self.turn(notches),
            Event::Dropped { name, bytes } => {
                // Both functions show their errors as messages, so the results are not needed.
                let _shown = match self.pointer.shift {
                    true => self.compare_with(&name, bytes),
                    false => self.show_file(&name, bytes),
                };
            }
        }
    }

    fn press(&mut self, key: Key) {
        // Dismisses the message, so that the status of the source shows again.
        self.message = None;
        if layers::switch(&mut self.layers, key) {
            return;
        }
        match key {
            Key::Character('h') => self.help = !self.help,
            Key::Character('r') => self.view.reset(),
            Key::Character('+' | '=') => self.view.zoom(1.0, self.size.map(|side| side / 2.0)),
            Key::Character('-') => self.view.zoom(-1.0, self.size.map(|side| side / 2.0)),
            Key::Character('f') => {
                self.view.followed = self.inspector.body.filter(|_| self.view.followed.is_none())
            }
            Key::Character('s') => self.save(),
            Key::Character(']') => self.show_neighbour(1),
            Key::Character('[') => self.show_neighbour(self.content.scenes.len().saturating_sub(1)),
            Key::Character('t') => self.inspector.toggle_state(),
            Key::Escape => {
                self.help = false;
                self.inspector = Inspector::default();
            }
            _ if self.act(key) => {}
            _ => self.travel(key),
        }
    }

    /// Handles a key in a live world. Returns `false` if it has no action there.
    fn act(&mut self, key: Key) -> bool {
        let App { source: Some(source), view, hand, pointer, size, .. } = self else { return false };
        let camera = view.camera(source.world(), *size);
        source.playground().is_some_and(|playground| hand.press(key, playground, &camera, pointer.at))
    }

    fn travel(&mut self, key: Key) {
        let App { source: Some(source), player, pointer, comparison, .. } = self else { return };
        let second = i64::from(source.tick_rate());
        let one = if pointer.shift { 10 } else { 1 };
        match key {
            Key::Space | Key::Character('p') => {
                let at_end = source.ticks() == Some(source.tick());
                player.toggle(if at_end { Some(source.first()) } else { None });
            }
            Key::Left | Key::Character(',') => player.go_by(-one, source.as_ref()),
            Key::Right | Key::Character('.') => player.go_by(one, source.as_ref()),
            Key::PageUp => player.go_by(-second, source.as_ref()),
            Key::PageDown => player.go_by(second, source.as_ref()),
            Key::Home => player.go_to(source.first()),
            Key::End => player.go_to(source.ticks().unwrap_or_else(|| source.recorded())),
            Key::Up => player.faster(1),
            Key::Down => player.faster(-1),
            Key::Character('j') => {
                let first = comparison.as_ref().and_then(|comparison| comparison.first.as_ref());
                first.into_iter().for_each(|first| player.go_to(first.tick));
            }
            _ => {}
        }
    }

    fn down(&mut self, button: Button) {
        let at = self.pointer.at;
        let App { source: Some(source), view, hand, size, pointer, inspector, layer_list, .. } = self else {
            return;
        };
        if pointer.button.is_some_and(|other| other != button) {
            return;
        }
        pointer.cease();
        if button == Button::Left && Bar::new(*size, source.as_ref()).holds(at) {
            (pointer.doing, pointer.button) = (Doing::Scrubbing, Some(button));
            return self.scrub();
        }
        if inspector.holds(at, *size) {
            return;
        }
        if let Some(key) = layer_list.and_then(|list| list.key_at(at)).filter(|_| button == Button::Left) {
            return self.press(key);
        }
        let camera = view.camera(source.world(), *size);
        let is_live = source.playground().is_some();
        pointer.button = Some(button);
        pointer.doing = match button {
            Button::Left => {
                let grip = if is_live { Grip::at(source.world(), &camera, at) } else { None };
                Doing::Pressing { from: at, grip }
            }
            Button::Right if is_live => Doing::Spawning,
            Button::Right | Button::Middle => Doing::Panning,
        };
        if pointer.doing == Doing::Spawning {
            hand.begin(&camera, at);
        }
    }

    fn move_to(&mut self, at: [f32; 2]) {
        let before = std::mem::replace(&mut self.pointer.at, at);
        if let Doing::Pressing { from, grip } = self.pointer.doing
            && !is_click(from, at)
        {
            match grip {
                Some(grip) => self.grab(grip),
                None => {
                    self.pointer.doing = Doing::Panning;
                    self.view.pan([before[0] - from[0], before[1] - from[1]]);
                }
            }
        }
        match self.pointer.doing {
            Doing::Panning => self.view.pan([at[0] - before[0], at[1] - before[1]]),
            Doing::Scrubbing => self.scrub(),
            Doing::Dragging => {
                let App { source: Some(source), view, size, .. } = self else { return };
                let camera = view.camera(source.world(), *size);
                source.playground().into_iter().for_each(|playground| Hand::drag(playground, &camera, at));
            }
            Doing::Nothing | Doing::Pressing { .. } | Doing::Spawning => {}
        }
    }

    fn grab(&mut self, grip: Grip) {
        self.pointer.doing = Doing::Dragging;
        let App { source: Some(source), view, size, .. } = self else { return };
        let camera = view.camera(source.world(), *size);
        let place = grip.place(source.world());
        if let (Some(place), Some(playground)) = (place, source.playground()) {
            Hand::grab(playground, &camera, place);
        }
    }

    fn up(&mut self, button: Button) {
        if self.pointer.button != Some(button) {
            return;
        }
        let doing = self.pointer.doing;
        self.pointer.cease();
        let App { source: Some(source), view, size, hand, pointer, .. } = self else { return };
        let camera = view.camera(source.world(), *size);
        match (doing, source.playground()) {
            (Doing::Pressing { .. }, _) => self.select(),
            (Doing::Dragging, Some(playground)) => playground.act(Act::Release),
            (Doing::Spawning, Some(playground)) => hand.put(playground, &camera, pointer.at),
            _ => {}
        }
    }

    fn turn(&mut self, notches: f32) {
        let at = self.pointer.at;
        if self.inspector.holds(at, self.size) {
            self.inspector.scroll(notches)
        } else {
            self.view.zoom(notches, at)
        }
    }

    fn scrub(&mut self) {
        let App { source: Some(source), player, size, pointer, .. } = self else { return };
        player.go_to(Bar::new(*size, source.as_ref()).tick_at(pointer.at[0]));
    }

    fn select(&mut self) {
        let App { source: Some(source), view, size, pointer, inspector, .. } = self else { return };
        let camera = view.camera(source.world(), *size);
        inspector.select(body_at(source.world(), &camera, pointer.at));
    }
}
