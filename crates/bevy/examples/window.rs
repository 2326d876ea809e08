//! Shared by the examples: a window that draws the world as gizmos.

#[cfg(all(feature = "window", not(target_arch = "wasm32")))]
mod screenshot;
#[path = "versus_game.rs"]
pub mod versus;

use bevy::prelude::*;
use bevy_lockstep2d::prelude::*;
use bevy_lockstep2d::{LockstepGame, LockstepGizmosPlugin};

/// An app with the plugin and a window, which is `metres` wide and has `centre` in its middle.
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
