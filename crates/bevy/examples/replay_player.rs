//! Plays a replay of the sandbox: `replay_player ../../replays/drum.replay`. Space pauses, arrow keys step, Home and
//! End go to the first and the last tick, PageUp and PageDown jump by 60 ticks.

use bevy::prelude::*;
use bevy_lockstep2d::LockstepError;
use bevy_lockstep2d::prelude::*;
use bevy_lockstep2d_examples::app;
use lockstep2d::lockstep::Sandbox;
use lockstep2d::replay::Limits;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let Some(path) = std::env::args().nth(1) else { return Err("usage: replay_player FILE".into()) };
    let lockstep = Lockstep::<Sandbox>::replay(std::fs::read(path)?, &Limits::default())?;
    app::<Sandbox>("replay_player", 24.0, Vec2::new(0.0, 5.0))
        .insert_resource(lockstep)
        .add_systems(PreUpdate, control)
        .add_systems(Update, show_tick)
        .run();
    Ok(())
}

fn control(keys: Res<ButtonInput<KeyCode>>, mut lockstep: ResMut<Lockstep<Sandbox>>) {
    // With change detection, every mutable access would count as a change of the resource.
    let lockstep = lockstep.bypass_change_detection();
    let (tick, end) = (lockstep.tick(), lockstep.replay_ticks().unwrap_or(0));
    if keys.just_pressed(KeyCode::Space) {
        if lockstep.is_paused() { lockstep.resume() } else { lockstep.pause() }
    }
    let targets = [
        (KeyCode::ArrowLeft, tick.saturating_sub(1)),
        (KeyCode::ArrowRight, tick + 1),
        (KeyCode::PageUp, tick.saturating_sub(60)),
        (KeyCode::PageDown, tick + 60),
        (KeyCode::Home, 0),
        (KeyCode::End, end),
    ];
    for (_, target) in targets.into_iter().filter(|(key, _)| keys.just_pressed(*key)) {
        let sought: Result<(), LockstepError> = lockstep.seek(target.min(end));
        if let Err(error) = sought {
            eprintln!("{error}");
        }
    }
}

fn show_tick(status: Res<LockstepStatus>, lockstep: Res<Lockstep<Sandbox>>, mut window: Single<&mut Window>) {
    let title = format!("tick {} of {}", status.tick, lockstep.replay_ticks().unwrap_or(0));
    if window.title != title {
        window.title = title;
    }
}
