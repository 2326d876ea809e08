//! Event handling: maps keys and pointer events to actions of the app.

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
    /// The button went down at this position. If the pointer moves further than [`CLICK`], the view pans.
    Pressing([f32; 2]),
    Panning,
    /// The pointer moves along the timeline.
    Scrubbing,
    /// The pointer drags a body from this position. A release within [`CLICK`] is also a click.
    Dragging([f32; 2]),
    Spawning,
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
        let movable = |source: &mut dyn crate::Source| {
            let world = source.world();
            body_at(world, &camera, at).is_some_and(|id| world.body(id).is_some_and(|body| body.is_dynamic()))
        };
        pointer.button = Some(button);
        pointer.doing = match button {
            Button::Left if source.playground().is_some() && movable(source.as_mut()) => Doing::Dragging(at),
            Button::Left => Doing::Pressing(at),
            Button::Right if source.playground().is_some() => Doing::Spawning,
            Button::Right | Button::Middle => Doing::Panning,
        };
        match (pointer.doing, source.playground()) {
            (Doing::Dragging(_), Some(playground)) => Hand::grab(playground, &camera, at),
            (Doing::Spawning, Some(_)) => hand.begin(&camera, at),
            _ => {}
        }
    }

    fn move_to(&mut self, at: [f32; 2]) {
        let before = std::mem::replace(&mut self.pointer.at, at);
        if let Doing::Pressing(from) = self.pointer.doing
            && !is_click(from, at)
        {
            self.pointer.doing = Doing::Panning;
            self.view.pan([before[0] - from[0], before[1] - from[1]]);
        }
        match self.pointer.doing {
            Doing::Panning => self.view.pan([at[0] - before[0], at[1] - before[1]]),
            Doing::Scrubbing => self.scrub(),
            Doing::Dragging(_) => {
                let App { source: Some(source), view, size, .. } = self else { return };
                let camera = view.camera(source.world(), *size);
                source.playground().into_iter().for_each(|playground| Hand::drag(playground, &camera, at));
            }
            Doing::Nothing | Doing::Pressing(_) | Doing::Spawning => {}
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
            (Doing::Pressing(_), _) => self.select(),
            (Doing::Dragging(from), Some(playground)) => {
                playground.act(Act::Release);
                if is_click(from, pointer.at) {
                    self.select();
                }
            }
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
