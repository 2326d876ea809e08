//! Levels built from entities, dragging, and diagnostics.

mod common;

use std::time::Duration;

use bevy::diagnostic::{DiagnosticPath, DiagnosticsPlugin, DiagnosticsStore};
use bevy::prelude::*;
use bevy::reflect::GetPath;
use bevy::time::TimeUpdateStrategy;
use bevy_lockstep2d::*;
use lockstep2d::body::{BodyDef, BodyKind, Geometry, Polygon, ShapeDef, WorldError};
use lockstep2d::fx;
use lockstep2d::lockstep::{Game, Sandbox, SandboxSetup};
use lockstep2d::math::{Fx, Vec2 as FixedVec2};
use lockstep2d::solver::Revolute;
use lockstep2d::world::{Command, Config};

fn sandbox_app() -> App {
    let mut app = App::new();
    app.add_plugins((
        MinimalPlugins,
        DiagnosticsPlugin,
        LockstepPlugin::<Sandbox>::default(),
        LockstepDiagnosticsPlugin::<Sandbox>::default(),
        DragPlugin,
    ));
    app.insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_nanos(16_666_667)));
    app
}

#[derive(Component, PartialEq, Debug)]
struct Label(&'static str);

/// The ground, a bar that is hinged to the ground at the origin, and a ball. Returns their entities.
fn spawn_level(world: &mut World) -> Result<[Entity; 3], WorldError> {
    let solid = |x, y| Polygon::rectangle(x, y).map(ShapeDef::new);
    let ground = BodyDef::fixed().position((fx!(0), fx!(-5)));
    let ground = world.spawn((Label("ground"), SpawnBody::new(ground, solid(fx!(9), fx!(1))?))).id();
    let bar = BodyDef::dynamic().position((fx!(1), fx!(0)));
    let bar = world.spawn((Label("bar"), SpawnBody::new(bar, solid(fx!(1), fx!(0.1))?))).id();
    let ball = BodyDef::dynamic().position((fx!(6), fx!(-3)));
    let ball = SpawnBody::new(ball, ShapeDef::new(Geometry::circle(fx!(0.5))?));
    let ball = world
        .spawn((Label("ball"), ball, SpawnJoint::new([ground, bar], Revolute::new(), (fx!(0), fx!(0)))))
        .id();
    Ok([ground, bar, ball])
}

fn start(app: &mut App) -> [Entity; 3] {
    let entities = spawn_level(app.world_mut()).unwrap();
    start_level(app);
    entities
}

/// Starts a game whose level has no entities, so that the plugin spawns the views.
fn start_without_views(app: &mut App) {
    for entity in start(app) {
        app.world_mut().despawn(entity);
    }
}

fn start_level(app: &mut App) {
    let commands = build_level(app.world_mut(), Config::default()).unwrap();
    assert_eq!(commands.len(), 4);
    start_game(app, commands);
}

fn start_game(app: &mut App, commands: Vec<Command>) {
    let setup = SandboxSetup { commands, ..SandboxSetup::default() };
    app.insert_resource(Lockstep::<Sandbox>::local(&setup).unwrap());
}

#[test]
fn entities_become_the_views_of_the_bodies_that_they_describe() {
    let mut app = sandbox_app();
    let [_, bar, ball] = start(&mut app);
    (0..60).for_each(|_| app.update());
    let mut views = app.world_mut().query::<(Entity, &BodyView, &Label, &Transform)>();
    let world = app.world();
    assert_eq!(views.iter(world).count(), 3, "no other views");
    let physics = world.resource::<Lockstep<Sandbox>>().world().unwrap();
    assert_eq!(physics.joint_count(), 1);
    let (_, view, label, transform) = views.get(world, ball).unwrap();
    assert_eq!(label, &Label("ball"));
    let place = physics.body(view.body()).unwrap().position();
    assert_eq!(place.x, 6);
    assert!((transform.translation.x - 600.0).abs() < 1.0);
    // The bar hangs from its end.
    let bar = physics.body(world.get::<BodyView>(bar).unwrap().body()).unwrap();
    let distance = bar.position().length();
    assert!((distance - Fx::ONE).abs() < fx!(0.01), "{distance}");
    assert!(bar.position().y < fx!(-0.3));
}

/// Describes the level again, with the same entities.
fn describe_again(app: &mut App, [ground, bar, ball]: [Entity; 3]) {
    let again = spawn_level(app.world_mut()).unwrap();
    for (entity, other) in [ground, bar, ball].into_iter().zip(again) {
        let body = app.world_mut().entity_mut(other).take::<SpawnBody>().unwrap();
        app.world_mut().entity_mut(entity).insert(body);
        app.world_mut().despawn(other);
    }
    let joint = SpawnJoint::new([ground, bar], Revolute::new(), (fx!(0), fx!(0)));
    app.world_mut().entity_mut(ball).insert(joint);
}

/// Labels of all views, in the order of their bodies.
fn labels(app: &mut App) -> Vec<Option<&'static str>> {
    let mut query = app.world_mut().query::<(&BodyView, Option<&Label>)>();
    let mut found: Vec<_> = query.iter(app.world()).collect();
    found.sort_by_key(|(view, _)| view.body().index());
    found.iter().map(|(_, label)| label.map(|label| label.0)).collect()
}

#[test]
fn entities_of_a_level_become_the_views_of_its_next_game() {
    // Number of frames between the description of the level and the start of its game.
    for frames in 0..3 {
        let mut app = sandbox_app();
        let entities = start(&mut app);
        (0..30).for_each(|_| app.update());
        describe_again(&mut app, entities);
        let commands = build_level(app.world_mut(), Config::default()).unwrap();
        (0..frames).for_each(|_| app.update());
        start_game(&mut app, commands);
        for _ in 0..3 {
            app.update();
            assert_eq!(labels(&mut app), ["ground", "bar", "ball"].map(Some), "after {frames} frames");
        }
        // The level is not described for the third game.
        start_without_views(&mut app);
        (0..3).for_each(|_| app.update());
        assert_eq!(labels(&mut app), [None; 3], "after {frames} frames");
    }
}

#[test]
fn views_that_change_their_bodies_become_views_of_the_next_game() {
    let mut app = sandbox_app();
    let entities = start(&mut app);
    (0..30).for_each(|_| app.update());
    let [ground, bar, ball] = entities.map(|entity| *app.world().get::<BodyView>(entity).unwrap());
    for (entity, view) in entities.into_iter().zip([bar, ball, ground]) {
        app.world_mut().entity_mut(entity).insert(view);
    }
    app.update();
    start_without_views(&mut app);
    (0..3).for_each(|_| app.update());
    assert_eq!(labels(&mut app), ["ball", "ground", "bar"].map(Some));
}

#[test]
fn a_view_whose_component_is_removed_and_inserted_becomes_a_view_of_the_next_game() {
    // Number of frames after the start of the first game.
    for frames in 1..4 {
        let mut app = sandbox_app();
        start_without_views(&mut app);
        (0..frames).for_each(|_| app.update());
        assert_eq!(labels(&mut app), [None; 3]);
        let (body, ball) = app.world().resource::<BodyViews>().iter().last().unwrap();
        app.world_mut().entity_mut(ball).insert(Label("ball"));
        start_without_views(&mut app);
        app.world_mut().entity_mut(ball).remove::<BodyView>().insert(BodyView::new(body));
        for _ in 0..3 {
            app.update();
            assert_eq!(labels(&mut app), [None, None, Some("ball")], "after {frames} frames");
        }
        start_without_views(&mut app);
        app.update();
        assert_eq!(labels(&mut app), [None; 3], "after {frames} frames");
    }
}

#[test]
fn a_joint_without_a_body_is_refused_and_nothing_is_taken() {
    let mut world = World::new();
    let [ground, ..] = spawn_level(&mut world).unwrap();
    let stranger = world.spawn_empty().id();
    let joint = world.spawn(SpawnJoint::new([ground, stranger], Revolute::new(), (fx!(0), fx!(0)))).id();
    let result = build_level(&mut world, Config::default());
    assert_eq!(result, Err(LevelError::NoBody { joint, body: stranger }));
    assert_eq!(world.query::<&SpawnBody>().iter(&world).count(), 3);
    assert_eq!(world.query::<&BodyView>().iter(&world).count(), 0);
}

#[test]
fn a_hand_drags_what_it_grabs() {
    let mut app = sandbox_app();
    let [_, _, ball] = start(&mut app);
    (0..60).for_each(|_| app.update());
    let at = app.world().get::<Transform>(ball).unwrap().translation.truncate();
    app.world_mut().resource_mut::<DragHand>().hold(at);
    app.update();
    let body = app.world().get::<BodyView>(ball).unwrap().body();
    assert_eq!(app.world().resource::<DragHand>().body(), Some(body));
    let goal = at + Vec2::new(100.0, 250.0);
    app.world_mut().resource_mut::<DragHand>().hold(goal);
    (0..120).for_each(|_| app.update());
    let held = app.world().get::<Transform>(ball).unwrap().translation.truncate();
    assert!(held.distance(goal) < 20.0, "{held} {goal}");
    app.world_mut().resource_mut::<DragHand>().release();
    (0..120).for_each(|_| app.update());
    let fallen = app.world().get::<Transform>(ball).unwrap().translation.truncate();
    assert!(fallen.y < goal.y - 200.0);
    assert_eq!(app.world().resource::<Lockstep<Sandbox>>().game().refused(), 0);
}

#[test]
fn a_body_that_is_released_during_a_pause_is_not_pulled() {
    let mut app = sandbox_app();
    let [_, _, ball] = start(&mut app);
    (0..60).for_each(|_| app.update());
    let at = app.world().get::<Transform>(ball).unwrap().translation.truncate();
    let body = app.world().get::<BodyView>(ball).unwrap().body();
    app.world_mut().resource_mut::<Lockstep<Sandbox>>().pause();
    app.world_mut().resource_mut::<DragHand>().hold(at);
    app.update();
    app.world_mut().resource_mut::<DragHand>().move_to(at + Vec2::new(0.0, 900.0));
    app.update();
    let pending = app.world_mut().resource_mut::<Inputs<Sandbox>>().once(0).clone();
    assert!(matches!(pending[..], [Command::ApplyForce { .. }]), "the latest pull: {pending:?}");
    app.world_mut().resource_mut::<DragHand>().release();
    app.update();
    app.world_mut().resource_mut::<Lockstep<Sandbox>>().resume();
    (0..3).for_each(|_| app.update());
    let physics = app.world().resource::<Lockstep<Sandbox>>().world().unwrap();
    let velocity = physics.body(body).unwrap().velocity();
    assert!(velocity.length() < fx!(0.1), "{velocity:?}");
}

#[test]
fn a_drag_keeps_the_forces_of_the_game() {
    let mut app = sandbox_app();
    let [_, _, ball] = start(&mut app);
    app.update();
    let body = app.world().get::<BodyView>(ball).unwrap().body();
    let at = app.world().get::<Transform>(ball).unwrap().translation.truncate();
    app.world_mut().resource_mut::<DragHand>().hold_body(body, at);
    app.world_mut().resource_mut::<Lockstep<Sandbox>>().pause();
    let (force, point) = (FixedVec2::new(fx!(3), fx!(0)), FixedVec2::default());
    let wind = Command::ApplyForce { body, force, point };
    app.world_mut().resource_mut::<Inputs<Sandbox>>().once(0).push(wind.clone());
    (0..3).for_each(|_| app.update());
    let pending = app.world_mut().resource_mut::<Inputs<Sandbox>>().once(0).clone();
    assert!(pending.len() == 2 && pending[0] == wind, "{pending:?}");
}

#[test]
fn a_hand_drags_only_dynamic_bodies_of_the_current_game() {
    let mut app = sandbox_app();
    let [_, _, ball] = start(&mut app);
    app.update();
    let body = app.world().get::<BodyView>(ball).unwrap().body();
    let at = app.world().get::<Transform>(ball).unwrap().translation.truncate();
    app.world_mut().resource_mut::<DragHand>().hold_body(body, at);
    app.update();
    let fix = Command::SetKind { body, kind: BodyKind::Fixed };
    app.world_mut().resource_mut::<Inputs<Sandbox>>().once(0).push(fix);
    let refused = |app: &App| app.world().resource::<Lockstep<Sandbox>>().game().refused();
    (0..3).for_each(|_| app.update());
    // Only the pull in the tick in which the body became fixed was refused.
    assert_eq!(refused(&app), 1);
    (0..10).for_each(|_| app.update());
    assert_eq!(refused(&app), 1);
    assert_eq!(app.world().resource::<DragHand>().body(), Some(body));
    // In the next game, another body may have this id.
    start(&mut app);
    app.update();
    assert_eq!(app.world().resource::<DragHand>().body(), None);
    let commands = app.world_mut().resource_mut::<Inputs<Sandbox>>().once(0).clone();
    assert_eq!(commands, []);
}

#[test]
fn diagnostics_are_measured() {
    let mut app = sandbox_app();
    start(&mut app);
    (0..3).for_each(|_| app.update());
    let store = app.world().resource::<DiagnosticsStore>();
    let value = |path: DiagnosticPath| store.get(&path).and_then(|diagnostic| diagnostic.value());
    type Paths = LockstepDiagnosticsPlugin<Sandbox>;
    assert!(value(Paths::STEP).unwrap() > 0.0);
    assert_eq!(value(Paths::ROLLBACK), Some(0.0));
    assert_eq!(value(Paths::PREDICTED), Some(0.0));
    let save = app.world().resource::<Lockstep<Sandbox>>().game().save();
    let bytes = lockstep2d::codec::encode(&save).len() as f64;
    assert!((value(Paths::SAVE).unwrap() - bytes).abs() < 200.0);
}

fn entity_of<R: Resource>(world: &World) -> Entity {
    let id = world.component_id::<R>().unwrap();
    world.resource_entities().get(id).unwrap()
}

/// Finds fields by their names, as an inspector does.
#[test]
fn an_inspector_can_read_and_change_what_is_shown() {
    let mut app = sandbox_app();
    let [_, bar, _] = start(&mut app);
    (0..10).for_each(|_| app.update());
    let registry = app.world().resource::<AppTypeRegistry>().clone();
    let registry = registry.read();
    let shown = |name: &str| {
        let registration = registry.get_with_short_type_path(name).unwrap_or_else(|| panic!("{name}"));
        registration.data::<ReflectComponent>().unwrap()
    };
    let world = app.world();
    let status = world.entity(entity_of::<LockstepStatus>(world));
    let status = shown("LockstepStatus").reflect(status).unwrap();
    let tick = world.resource::<Lockstep<Sandbox>>().tick();
    assert_eq!(status.path::<u64>("tick").unwrap(), &tick);
    let slot = world.get::<BodyView>(bar).unwrap().body().index();
    let view = shown("BodyView").reflect(world.entity(bar)).unwrap();
    assert_eq!(view.path::<u32>("slot").unwrap(), &slot);
    let hand = shown("DragHand").reflect(world.entity(entity_of::<DragHand>(world))).unwrap();
    assert_eq!(hand.path::<Option<Vec2>>("at").unwrap(), &None);
    let settings = entity_of::<LockstepSettings>(world);
    let mut settings = shown("LockstepSettings").reflect_mut(app.world_mut().entity_mut(settings)).unwrap();
    *settings.path_mut::<f32>("pixels_per_metre").unwrap() = 7.0;
    app.update();
    let place = app.world().get::<Transform>(bar).unwrap().translation;
    assert!(place.truncate().length() < 7.5, "a metre is 7 units wide: {place}");
}
