//! Shared by the examples: a window with a camera that draws the world as gizmos, and a simulated line.

#[cfg(all(feature = "window", not(target_arch = "wasm32")))]
mod screenshot;
#[path = "versus_game.rs"]
pub mod versus;

use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use bevy::prelude::*;
use bevy_lockstep2d::prelude::*;
use bevy_lockstep2d::{LockstepGame, LockstepGizmosPlugin};
use lockstep2d::peer::Transport;
use lockstep2d::session::Address;

/// A window, and the plugin of a game in it. `metres` are visible from left to right, around `centre`.
pub fn app<G: LockstepGame>(title: &str, metres: f32, centre: Vec2) -> App {
    let (width, height) = (960_u16, 640_u16);
    let scale = f32::from(width) / metres;
    let window = Window {
        title: title.into(),
        resolution: (u32::from(width), u32::from(height)).into(),
        ..Window::default()
    };
    let mut app = App::new();
    app.add_plugins(
        DefaultPlugins.set(WindowPlugin { primary_window: Some(window), ..WindowPlugin::default() }),
    )
    .add_plugins(LockstepPlugin::<G>::default().pixels_per_metre(scale))
    .add_plugins(LockstepGizmosPlugin::<G>::default())
    .insert_resource(ClearColor(Color::srgb_u8(0xfa, 0xfa, 0xf7)))
    .add_systems(Startup, move |mut commands: Commands| {
        commands.spawn((Camera2d, Transform::from_translation((centre * scale).extend(0.0))));
    });
    #[cfg(all(feature = "window", not(target_arch = "wasm32")))]
    screenshot::take_when_asked(&mut app);
    app
}

/// A line between two peers that takes a tenth of a second and loses one packet of ten.
#[derive(Resource, Clone, Default)]
pub struct Line(Arc<Mutex<Traffic>>);

#[derive(Default)]
struct Traffic {
    now: Duration,
    sent: u32,
    /// When a packet arrives, at which end, and its bytes.
    packets: Vec<(Duration, u8, Vec<u8>)>,
}

/// One end of a [`Line`].
pub struct LineEnd {
    line: Line,
    own: u8,
}

impl Line {
    /// End 0 or 1.
    pub fn end(&self, own: u8) -> LineEnd {
        LineEnd { line: self.clone(), own }
    }

    /// Sets the time.
    pub fn set_time(&self, now: Duration) {
        self.with(|traffic| traffic.now = now);
    }

    fn with<T>(&self, change: impl FnOnce(&mut Traffic) -> T) -> T {
        change(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

impl Transport for LineEnd {
    fn send(&mut self, packet: &[u8], _: &Address) {
        self.line.with(|traffic| {
            traffic.sent += 1;
            if !traffic.sent.is_multiple_of(10) {
                let arrival = traffic.now + Duration::from_millis(100);
                traffic.packets.push((arrival, 1 - self.own, packet.to_vec()));
            }
        });
    }

    fn receive(&mut self) -> Option<(Address, Vec<u8>)> {
        let packet = self.line.with(|traffic| {
            let now = traffic.now;
            let place = traffic.packets.iter().position(|(at, end, _)| *end == self.own && *at <= now)?;
            Some(traffic.packets.remove(place).2)
        })?;
        Some((Address::new(&[1 - self.own])?, packet))
    }
}
