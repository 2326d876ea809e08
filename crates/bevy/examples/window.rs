//! What the examples share: a window with a camera that draws the world as gizmos.

use bevy::prelude::*;
use bevy_lockstep2d::prelude::*;
use bevy_lockstep2d::{DragHand, LockstepGame, LockstepGizmosPlugin};

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
    app
}

/// Moves the hand of the `DragPlugin` with the mouse. Add it to `PreUpdate`.
pub fn drag_with_mouse(
    mut hand: ResMut<DragHand>,
    buttons: Res<ButtonInput<MouseButton>>,
    window: Single<&Window>,
    camera: Single<(&Camera, &GlobalTransform)>,
) {
    let (camera, place) = *camera;
    let pointer = window.cursor_position().and_then(|at| camera.viewport_to_world_2d(place, at).ok());
    match pointer {
        Some(at) if buttons.pressed(MouseButton::Left) => hand.hold(at),
        _ => hand.release(),
    }
}
