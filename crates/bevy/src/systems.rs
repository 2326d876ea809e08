//! The systems of the plugin.

use bevy::ecs::entity_disabling::Disabled;
use bevy::ecs::query::{Allow, SpawnDetails};
use bevy::math::Quat;
use bevy::platform::collections::HashMap;
use bevy::platform::time::Instant;
use bevy::prelude::{
    Commands, DetectChanges, DetectChangesMut, Entity, MessageWriter, Query, Real, Ref, Res, ResMut, Time,
    Transform,
};
use lockstep2d::body::BodyId;
use lockstep2d::lockstep::Game;
use lockstep2d::world::World;

use crate::drivers::FrameTime;
use crate::error::LockstepFailed;
use crate::events::{BodyEvent, ConfirmedEvent, LoggedEvent, MatchEvent, PredictedEvent, RetractedEvent};
use crate::game::LockstepGame;
use crate::inputs::Inputs;
use crate::lockstep::Lockstep;
use crate::plugin::{LockstepSettings, LockstepStatus};
use crate::poses::{Pose, Poses};
use crate::smoothing::{DrawnPose, Offset, metres};
use crate::step_log::StepLog;
use crate::views::{BodyView, BodyViews, View};

/// Removes inputs that were meant for a former game.
pub(crate) fn begin_inputs<G: LockstepGame>(lockstep: Res<Lockstep<G>>, mut inputs: ResMut<Inputs<G>>) {
    inputs.begin_game(lockstep.number());
}

pub(crate) fn step<G: LockstepGame>(
    mut lockstep: ResMut<Lockstep<G>>,
    mut inputs: ResMut<Inputs<G>>,
    mut status: ResMut<LockstepStatus>,
    (time, real): (Res<Time>, Res<Time<Real>>),
    mut matches: MessageWriter<MatchEvent>,
    mut failures: MessageWriter<LockstepFailed>,
) {
    let time = FrameTime { delta: time.delta(), real_delta: real.delta(), real_elapsed: real.elapsed() };
    // A system of `LockstepSystems::Inputs` may have replaced the game.
    inputs.begin_game(lockstep.number());
    let start = Instant::now();
    let result = lockstep.run(time, &mut inputs);
    let step_time = start.elapsed();
    if let Err(error) = result {
        bevy::log::error!("the game has stopped: {error}");
        failures.write(LockstepFailed(error));
    }
    while let Some(event) = lockstep.next_event() {
        matches.write(MatchEvent(event));
    }
    let (tick, confirmed, paused) = (lockstep.tick(), lockstep.confirmed(), lockstep.is_paused());
    let mut log = lockstep.observed().log();
    log.set_tick(tick);
    let (stepped, rolled_back) = (core::mem::take(&mut log.stepped), core::mem::take(&mut log.replayed));
    *status = LockstepStatus { tick, confirmed, stepped, rolled_back, paused, step_time };
}

pub(crate) fn write_views<G: LockstepGame>(
    mut commands: Commands,
    lockstep: Res<Lockstep<G>>,
    mut views: ResMut<BodyViews>,
    (settings, time): (Res<LockstepSettings>, Res<Time<Real>>),
    all: Query<(Entity, Ref<BodyView>, SpawnDetails), Allow<Disabled>>,
    mut shown: Query<(&BodyView, Entity, &mut Transform)>,
) {
    let mut inserted_again = Vec::new();
    views.retain(|view| {
        // The game may have despawned a view, or removed its component.
        let Ok((entity, shown, spawned)) = all.get(view.entity) else { return false };
        // `spawn_view` has inserted the component in the tick in which it has spawned the entity.
        if shown.is_changed() && shown.last_changed() != spawned.spawn_tick() {
            inserted_again.push(entity);
        }
        shown.body() == view.body
    });
    views.prepare(inserted_again);
    let former = views.begin_game(lockstep.number());
    // Entities that the game has prepared as views. Most are not in the table `views` yet. Views of the former game are
    // still in the table; those in `former` are prepared.
    let is_prepared = |entity: Entity, body: BodyId| {
        views.entity(body) != Some(entity) || former.as_ref().is_some_and(|former| former.contains(&entity))
    };
    let all = all.iter().map(|(entity, view, _)| (view.body(), entity));
    let prepared: HashMap<BodyId, Entity> =
        all.filter(|(body, entity)| is_prepared(*entity, *body)).collect();
    if former.is_some() {
        for view in views.take_all().into_iter().filter(|view| prepared.get(&view.body) != Some(&view.entity))
        {
            commands.entity(view.entity).try_despawn();
        }
    }
    let world = lockstep.world();
    {
        let mut log = lockstep.observed().log();
        if let Some(again) = log.shown_again.take() {
            for view in views.views_mut() {
                if let Some(pose) = again.get(view.body) {
                    view.offset.add(Offset::between(pose, view.current), settings.smoothing_limit);
                }
            }
        }
        replace_strangers(&mut commands, &mut views, &log, world);
        log.show(world);
        let jumps =
            Jumps { log: &log, tick_rate: lockstep.observed().tick_rate(), limit: settings.smoothing_limit };
        follow(&mut commands, &mut views, &jumps, &settings, &prepared);
    }
    let (fraction, redraw) = (lockstep.fraction(), settings.is_changed());
    if redraw {
        // Includes views without a `Transform` and disabled ones, which are drawn when they are complete again.
        views.views_mut().for_each(|view| view.is_settled = false);
    }
    let draw = |view: &View| {
        let pose = match settings.interpolate {
            true => DrawnPose::between(view.previous, view.current, fraction),
            false => DrawnPose::at(view.current),
        };
        pose.shifted(view.offset)
    };
    for view in views.views_mut() {
        view.offset.decay(time.delta(), settings.smoothing_half_life);
    }
    for (view, entity, mut transform) in &mut shown {
        let Some(view) = views.view_mut(view.body()).filter(|view| view.entity == entity) else { continue };
        // The game may have changed or replaced the `Transform`. Bevy does not report the writes of this system to the
        // system itself.
        if view.is_settled && !transform.is_changed() {
            continue;
        }
        let at_rest = view.offset == Offset::ZERO && (!settings.interpolate || view.previous == view.current);
        view.is_settled = at_rest;
        write_transform(&mut transform, draw(view), settings.pixels_per_metre);
    }
}

/// Despawns views of bodies that a rollback or a seek has replaced by other bodies with the same ids.
fn replace_strangers(commands: &mut Commands, views: &mut BodyViews, log: &StepLog, world: Option<&World>) {
    for (&body, shown) in &log.missing {
        if !shown.identity.is_of(world, body)
            && let Some(entity) = views.take(body)
        {
            commands.entity(entity).try_despawn();
        }
    }
}

/// Recognises bodies that the game has teleported in the last tick.
struct Jumps<'a> {
    log: &'a StepLog,
    /// Ticks of the game per second. Its world may make several steps in a tick.
    tick_rate: u32,
    /// A movement of at most this distance, in metres, is no jump.
    limit: f32,
}

impl Jumps<'_> {
    /// Whether the origin of a body moved by more than the limit, and by more than twice its speed times the duration
    /// of a tick. The speed is the larger of the speeds before and after the tick.
    fn is_jump(&self, body: BodyId, previous: Pose, current: Pose) -> bool {
        if previous.position == current.position {
            return false;
        }
        let way = metres(current.position - previous.position).length();
        if way <= self.limit {
            return false;
        }
        let speed = |poses: &Poses| poses.velocity(body).map_or(0.0, |velocity| metres(velocity).length());
        way > 2.0 * speed(&self.log.before).max(speed(&self.log.after)) / self.tick_rate as f32
    }
}

fn follow(
    commands: &mut Commands,
    views: &mut BodyViews,
    jumps: &Jumps<'_>,
    settings: &LockstepSettings,
    prepared: &HashMap<BodyId, Entity>,
) {
    views.begin_frame();
    for (body, current) in jumps.log.after.iter() {
        let is_way = |previous: &Pose| !jumps.is_jump(body, *previous, current);
        let previous = jumps.log.before.get(body).filter(is_way).unwrap_or(current);
        if views.see(body, previous, current) {
            continue;
        }
        let entity = prepared
            .get(&body)
            .copied()
            .unwrap_or_else(|| spawn_view(commands, body, current, settings.pixels_per_metre));
        if let Some(old) = views.insert(body, entity, current) {
            commands.entity(old).try_despawn();
        }
    }
    views.take_unseen().into_iter().for_each(|view| commands.entity(view).try_despawn());
}

fn spawn_view(commands: &mut Commands, body: BodyId, pose: Pose, scale: f32) -> Entity {
    let mut transform = Transform::default();
    write_transform(&mut transform, DrawnPose::at(pose), scale);
    commands.spawn((BodyView::new(body), transform)).id()
}

/// Writes x, y and rotation. Z and scale belong to the game.
fn write_transform(transform: &mut Transform, pose: DrawnPose, scale: f32) {
    (transform.translation.x, transform.translation.y) = (pose.position * scale).into();
    transform.rotation = Quat::from_rotation_z(pose.angle);
}

/// Resets the status while there is no game.
pub(crate) fn clear_status(mut status: ResMut<LockstepStatus>) {
    status.set_if_neq(LockstepStatus::default());
}

pub(crate) fn remove_views(mut commands: Commands, mut views: ResMut<BodyViews>) {
    views.take_all().into_iter().for_each(|view| commands.entity(view.entity).try_despawn());
}

pub(crate) fn send_events<G: LockstepGame>(
    mut commands: Commands,
    lockstep: Res<Lockstep<G>>,
    views: Res<BodyViews>,
    mut predicted: MessageWriter<PredictedEvent>,
    mut retracted: MessageWriter<RetractedEvent>,
    mut confirmed: MessageWriter<ConfirmedEvent>,
) {
    let mut log = lockstep.observed().log();
    let views_of = |event: &LoggedEvent| event.bodies.map(|body| views.entity(body?));
    for logged in log.announce() {
        predicted.write(PredictedEvent { tick: logged.tick, event: logged.event, views: views_of(&logged) });
    }
    for LoggedEvent { tick, event, .. } in log.retract(lockstep.has_ended()) {
        retracted.write(RetractedEvent { tick, event });
    }
    for logged in log.confirm(lockstep.confirmed()) {
        let LoggedEvent { tick, event, .. } = logged;
        let views = views_of(&logged);
        confirmed.write(ConfirmedEvent { tick, event, views });
        for (entity, other) in [(views[0], views[1]), (views[1], views[0])] {
            if let Some(entity) = entity {
                commands.trigger(BodyEvent { entity, other, tick, event });
            }
        }
    }
}
