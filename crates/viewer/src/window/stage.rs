//! [`Stage`]: miniquad's event handler, which runs each frame.

use std::time::Duration;

use crate::mesh::{Mesh, Screen};
use crate::script::Script;
use crate::{App, Event};
use miniquad::{EventHandler, KeyCode, KeyMods, MouseButton, date, window};

use super::host::Host;
use super::keys::{Keyboard, button, notches};
#[cfg(not(target_arch = "wasm32"))]
use super::performance::Performance;
use super::renderer::Renderer;
use super::{Outcome, WindowError};

/// Longest time step of a frame, in seconds. Time beyond it is skipped, so the world does not catch up after a pause.
const PAUSE_MAX: f64 = 0.25;

pub(super) struct Stage {
    pub(super) app: App,
    pub(super) renderer: Renderer,
    pub(super) mesh: Mesh,
    pub(super) screen: Screen,
    keyboard: Keyboard,
    /// Wall clock at the last frame, in seconds.
    last: f64,
    #[cfg(not(target_arch = "wasm32"))]
    performance: Option<Performance>,
    host: Host,
    outcome: Outcome,
}

/// Event handler that does nothing. It replaces the stage if the graphics driver refuses the shader.
struct Nothing;

impl EventHandler for Nothing {
    fn update(&mut self) {}
    fn draw(&mut self) {}
}

impl Stage {
    pub(super) fn start(
        app: App,
        script: Option<Script>,
        host: Host,
        outcome: Outcome,
    ) -> Box<dyn EventHandler> {
        let renderer = match Renderer::new() {
            Ok(renderer) => renderer,
            Err(error) => {
                let error = WindowError::Graphics(error);
                // A page has no other output. On a desktop, the program prints the error when the window is closed.
                #[cfg(target_arch = "wasm32")]
                miniquad::error!("{}", error);
                *outcome.borrow_mut() = Err(error);
                window::order_quit();
                return Box::new(Nothing);
            }
        };
        let screen = Screen { size: [1.0; 2], pixel: 1.0 };
        #[cfg(target_arch = "wasm32")]
        let _ = script;
        let mut stage = Stage {
            app,
            renderer,
            mesh: Mesh::default(),
            screen,
            keyboard: Keyboard::default(),
            last: date::now(),
            #[cfg(not(target_arch = "wasm32"))]
            performance: script.map(Performance::new),
            host,
            outcome,
        };
        let (width, height) = window::screen_size();
        stage.resize_event(width, height);
        Box::new(stage)
    }

    /// Converts a position from screen pixels to units of the draw list.
    fn place(&self, x: f32, y: f32) -> [f32; 2] {
        [x, y].map(|at| at * self.screen.pixel)
    }

    fn moved(&mut self, x: f32, y: f32) {
        let place = self.place(x, y);
        self.app.handle(Event::Moved(place));
    }

    /// Runs a frame. Returns `false` at the end of a script.
    fn go_on(&mut self) -> Result<bool, WindowError> {
        #[cfg(not(target_arch = "wasm32"))]
        if let Some(mut performance) = self.performance.take() {
            let goes_on = performance.frame(self)?;
            self.performance = Some(performance);
            self.host.serve(&mut self.app)?;
            return Ok(goes_on);
        }
        self.live();
        self.host.serve(&mut self.app)?;
        Ok(true)
    }

    fn fail(&mut self, error: WindowError) {
        *self.outcome.borrow_mut() = Err(error);
        window::order_quit();
    }

    fn live(&mut self) {
        let now = date::now();
        let elapsed = (now - self.last).clamp(0.0, PAUSE_MAX);
        self.last = now;
        self.app.advance(Duration::from_secs_f64(elapsed));
        self.host.pace(elapsed);
    }
}

impl EventHandler for Stage {
    fn update(&mut self) {
        match self.go_on() {
            Ok(true) => {}
            Ok(false) => {
                self.quit_requested_event();
                window::order_quit();
            }
            Err(error) => self.fail(error),
        }
    }

    fn draw(&mut self) {
        self.mesh.build(self.app.draw(), &self.screen);
        self.renderer.show(&self.mesh, &self.screen);
    }

    fn resize_event(&mut self, width: f32, height: f32) {
        let scale = window::dpi_scale();
        let pixel = if scale > 0.0 { 1.0 / scale } else { 1.0 };
        self.screen = Screen { size: [width * pixel, height * pixel], pixel };
        self.app.handle(Event::Resized(self.screen.size));
    }

    fn mouse_motion_event(&mut self, x: f32, y: f32) {
        self.moved(x, y);
    }

    fn mouse_wheel_event(&mut self, _x: f32, y: f32) {
        self.app.handle(Event::Wheel(notches(y)));
    }

    fn mouse_button_down_event(&mut self, which: MouseButton, x: f32, y: f32) {
        self.moved(x, y);
        if let Some(button) = button(which) {
            self.app.handle(Event::Down(button));
        }
    }

    fn mouse_button_up_event(&mut self, which: MouseButton, x: f32, y: f32) {
        self.moved(x, y);
        if let Some(button) = button(which) {
            self.app.handle(Event::Up(button));
        }
    }

    fn key_down_event(&mut self, code: KeyCode, _mods: KeyMods, repeat: bool) {
        if let Some(key) = self.keyboard.down(code, repeat) {
            self.app.handle(Event::Pressed(key));
        }
    }

    fn key_up_event(&mut self, code: KeyCode, _mods: KeyMods) {
        if let Some(key) = self.keyboard.up(code) {
            self.app.handle(Event::Released(key));
        }
    }

    /// Releases all keys, because their releases will go to another window.
    fn window_minimized_event(&mut self) {
        for key in self.keyboard.release() {
            self.app.handle(Event::Released(key));
        }
    }

    fn quit_requested_event(&mut self) {
        self.app.close();
        if let Err(error) = self.host.finish(&mut self.app) {
            self.fail(error);
        }
    }

    fn files_dropped_event(&mut self) {
        for at in 0..window::dropped_file_count() {
            let name = window::dropped_file_path(at)
                .and_then(|path| path.file_name().map(|name| name.to_string_lossy().into_owned()));
            if let Some(bytes) = window::dropped_file_bytes(at) {
                self.host.open(&mut self.app, name.unwrap_or_default(), bytes);
            }
        }
    }
}
