//! Picking: pointers hit the views of bodies, and drag them.

use std::time::Duration;

use bevy::camera::{Camera, NormalizedRenderTarget};
use bevy::picking::backend::HitData;
use bevy::picking::backend::ray::{RayId, RayMap};
use bevy::picking::events::{Click, Pointer, Press};
use bevy::picking::pointer::{Location, PointerAction, PointerButton, PointerId, PointerInput};
use bevy::picking::{InteractionPlugin, Pickable, PickingPlugin, PickingSettings};
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_lockstep2d::prelude::*;
use bevy_lockstep2d::{DragHand, PointerDragPlugin};
use lockstep2d::body::{BodyDef, BodyId, Geometry, Polygon, ShapeDef};
use lockstep2d::fx;
use lockstep2d::lockstep::{Sandbox, SandboxSetup};
use lockstep2d::world::Command;

#[derive(Resource, Default)]
struct Clicked(Vec<BodyId>);

/// A platform below a ball, 10 units per metre, and a pointer whose ray is set by the test.
struct Screen {
    app: App,
    camera: Entity,
    bodies: [BodyId; 2],
}

impl Screen {
    fn new() -> Self {
        let spawn = |body, shape| Command::Spawn { body, shapes: vec![ShapeDef::new(shape)] };
        let commands = vec![
            spawn(BodyDef::fixed(), Geometry::from(Polygon::rectangle(fx!(5), fx!(1)).unwrap())),
            spawn(BodyDef::dynamic().position((fx!(2), fx!(1.5))), Geometry::circle(fx!(0.5)).unwrap()),
        ];
        let setup = SandboxSetup { commands, ..SandboxSetup::default() };
        let mut app = App::new();
        app.add_plugins((MinimalPlugins, PickingPlugin, InteractionPlugin))
            // The test supplies the rays.
            .insert_resource(PickingSettings { is_input_enabled: false, ..PickingSettings::default() })
            .insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_nanos(16_666_667)))
            .add_plugins((LockstepPlugin::<Sandbox>::default().pixels_per_metre(10.0), PointerDragPlugin))
            .insert_resource(Lockstep::<Sandbox>::local(&setup).unwrap())
            .init_resource::<Clicked>()
            .add_observer(click);
        app.world_mut().spawn(PointerId::Mouse);
        // Without this component, Bevy does not pass the events of pointers to parents.
        app.world_mut().register_component::<Window>();
        let camera = app.world_mut().spawn(Camera::default()).id();
        (0..3).for_each(|_| app.update());
        let bodies: Vec<BodyId> = app.world().resource::<BodyViews>().iter().map(|(body, _)| body).collect();
        let bodies = [bodies[0], bodies[1]];
        Screen { app, camera, bodies }
    }

    /// Moves the pointer, in units of `Transform`.
    fn point_at(&mut self, x: f32, y: f32) {
        let ray = Ray3d::new(Vec3::new(x, y, 100.0), Dir3::NEG_Z);
        let id = RayId::new(self.camera, PointerId::Mouse);
        self.app.world_mut().resource_mut::<RayMap>().map.insert(id, ray);
        self.app.update();
    }

    fn act(&mut self, action: PointerAction) {
        self.act_in_a_frame(&[action]);
    }

    fn act_in_a_frame(&mut self, actions: &[PointerAction]) {
        for action in actions {
            self.app.world_mut().write_message(PointerInput::new(PointerId::Mouse, location(), *action));
        }
        self.app.update();
    }

    /// Sends an event as if the pointer was pressed on an entity.
    fn press_event(&mut self, entity: Entity) {
        let hit = HitData::new(self.camera, 0.0, Some(Vec3::ZERO), None);
        let press = Press { button: PointerButton::Primary, hit, count: 1 };
        self.app.world_mut().trigger(Pointer::new(PointerId::Mouse, location(), press, entity));
    }

    /// Adds a ball to the left of the first ball, pauses the game and returns the new body.
    fn add_ball(&mut self) -> BodyId {
        let spawn = Command::Spawn {
            body: BodyDef::dynamic().position((fx!(-3), fx!(1.5))),
            shapes: vec![ShapeDef::new(Geometry::circle(fx!(0.5)).unwrap())],
        };
        self.app.world_mut().resource_mut::<Inputs<Sandbox>>().once(0).push(spawn);
        self.app.update();
        self.app.world_mut().resource_mut::<Lockstep<Sandbox>>().pause();
        self.app.world().resource::<BodyViews>().iter().nth(2).unwrap().0
    }

    fn click(&mut self) {
        self.act(PointerAction::Press(PointerButton::Primary));
        self.act(PointerAction::Release(PointerButton::Primary));
    }

    fn clicked(&mut self) -> Vec<BodyId> {
        core::mem::take(&mut self.app.world_mut().resource_mut::<Clicked>().0)
    }

    fn ball(&self) -> Vec2 {
        let view = self.app.world().resource::<BodyViews>().entity(self.bodies[1]).unwrap();
        self.app.world().get::<Transform>(view).unwrap().translation.truncate()
    }

    fn held(&self) -> Option<BodyId> {
        self.app.world().resource::<DragHand>().body()
    }
}

fn location() -> Location {
    Location { target: NormalizedRenderTarget::None { width: 100, height: 100 }, position: Vec2::ZERO }
}

fn click(click: On<Pointer<Click>>, views: Query<&BodyView>, mut clicked: ResMut<Clicked>) {
    clicked.0.extend(views.get(click.entity).map(|view| view.body()));
}

#[test]
fn a_click_finds_the_body_below_the_pointer() {
    let mut screen = Screen::new();
    let [platform, ball] = screen.bodies;
    screen.point_at(20.0, 15.0);
    screen.click();
    assert_eq!(screen.clicked(), [ball]);
    // This point is within the bounding box of the ball, but outside of the ball.
    screen.point_at(24.5, 19.5);
    screen.click();
    assert_eq!(screen.clicked(), []);
    screen.point_at(-30.0, 5.0);
    screen.click();
    assert_eq!(screen.clicked(), [platform]);
    let view = screen.app.world().resource::<BodyViews>().entity(platform).unwrap();
    screen.app.world_mut().entity_mut(view).insert(Pickable::IGNORE);
    screen.point_at(-30.0, 5.0);
    screen.click();
    assert_eq!(screen.clicked(), []);
}

#[test]
fn the_view_with_the_larger_z_is_in_front() {
    let mut screen = Screen::new();
    for (z, front) in [(1.0, 1), (-1.0, 0)] {
        // The ball is inside the platform: z decides which view is in front.
        let ball = screen.app.world().resource::<BodyViews>().entity(screen.bodies[1]).unwrap();
        screen.app.world_mut().get_mut::<Transform>(ball).unwrap().translation.z = z;
        screen.app.world_mut().resource_mut::<Lockstep<Sandbox>>().resume();
        screen.app.world_mut().resource_mut::<Inputs<Sandbox>>().once(0).push(Command::SetTransform {
            body: screen.bodies[1],
            position: lockstep2d::math::Vec2::new(fx!(2), fx!(0)),
            angle: Default::default(),
        });
        screen.point_at(20.0, 0.0);
        screen.app.world_mut().resource_mut::<Lockstep<Sandbox>>().pause();
        screen.point_at(20.0, 0.0);
        screen.click();
        assert_eq!(screen.clicked(), [screen.bodies[front]]);
    }
}

#[test]
fn a_pointer_drags_a_dynamic_body_until_its_button_is_up() {
    let mut screen = Screen::new();
    screen.point_at(-30.0, 5.0);
    screen.act(PointerAction::Press(PointerButton::Primary));
    screen.act(PointerAction::Release(PointerButton::Primary));
    assert_eq!(screen.held(), None, "the platform is fixed");
    screen.point_at(20.0, 15.0);
    screen.act(PointerAction::Press(PointerButton::Secondary));
    assert_eq!(screen.held(), None, "another button");
    screen.act(PointerAction::Release(PointerButton::Secondary));
    screen.act(PointerAction::Press(PointerButton::Primary));
    assert_eq!(screen.held(), Some(screen.bodies[1]));
    screen.point_at(-10.0, 60.0);
    (0..120).for_each(|_| screen.app.update());
    assert!(screen.ball().distance(Vec2::new(-10.0, 60.0)) < 3.0, "{}", screen.ball());
    assert_eq!(screen.held(), Some(screen.bodies[1]), "though the pointer has left it for a while");
    screen.act(PointerAction::Release(PointerButton::Primary));
    assert_eq!(screen.held(), None);
    (0..60).for_each(|_| screen.app.update());
    assert!(screen.ball().y < 40.0, "{}", screen.ball());
}

#[test]
fn layers_are_in_front_of_each_other() {
    let mut screen = Screen::new();
    let ball = screen.app.world().resource::<BodyViews>().entity(screen.bodies[1]).unwrap();
    screen.app.world_mut().resource_mut::<Inputs<Sandbox>>().once(0).push(Command::SetTransform {
        body: screen.bodies[1],
        position: lockstep2d::math::Vec2::new(fx!(2), fx!(0)),
        angle: Default::default(),
    });
    screen.app.update();
    screen.app.world_mut().resource_mut::<Lockstep<Sandbox>>().pause();
    for (z, front) in [(1.0, 1), (-1.0, 0)] {
        // The view of the ball is a child of a layer, and its z relative to the layer is 0.
        let layer = screen.app.world_mut().spawn(Transform::from_xyz(0.0, 0.0, z)).id();
        screen.app.world_mut().entity_mut(ball).insert(ChildOf(layer));
        screen.point_at(20.0, 0.0);
        screen.click();
        assert_eq!(screen.clicked(), [screen.bodies[front]]);
    }
}

#[test]
fn a_pointer_that_is_released_and_pressed_in_one_frame_holds_what_it_presses() {
    use PointerAction::{Press, Release};
    const LEFT: PointerButton = PointerButton::Primary;
    let mut screen = Screen::new();
    let second = screen.add_ball();
    // A point of the platform, which is not held.
    screen.point_at(-30.0, 5.0);
    screen.act(Press(LEFT));
    screen.point_at(20.0, 15.0);
    screen.act_in_a_frame(&[Release(LEFT), Press(LEFT)]);
    assert_eq!(screen.held(), Some(screen.bodies[1]));
    screen.point_at(-30.0, 15.0);
    screen.act_in_a_frame(&[Release(LEFT), Press(LEFT)]);
    assert_eq!(screen.held(), Some(second));
    screen.point_at(0.0, 500.0);
    screen.act_in_a_frame(&[Release(LEFT), Press(LEFT)]);
    assert_eq!(screen.held(), None, "it is pressed beside all bodies");
    screen.point_at(20.0, 15.0);
    screen.act_in_a_frame(&[Release(LEFT), Press(LEFT), Release(LEFT)]);
    assert_eq!(screen.held(), None);
    screen.act(Press(LEFT));
    assert_eq!(screen.held(), Some(screen.bodies[1]));
}

/// The view of a body is a child of the view of another body.
#[test]
fn a_press_on_a_view_does_not_hold_the_parent_of_the_view() {
    use PointerAction::{Press, Release};
    const LEFT: PointerButton = PointerButton::Primary;
    let mut screen = Screen::new();
    let parent = screen.add_ball();
    let [platform, ball] = screen.bodies;
    let view = |screen: &Screen, body| screen.app.world().resource::<BodyViews>().entity(body).unwrap();
    let (parent_view, ball_view) = (view(&screen, parent), view(&screen, ball));
    screen.app.world_mut().entity_mut(ball_view).insert(ChildOf(parent_view));
    screen.point_at(20.0, 15.0);
    screen.act(Press(LEFT));
    assert_eq!(screen.held(), Some(ball));
    screen.act_in_a_frame(&[Release(LEFT), Press(LEFT)]);
    assert_eq!(screen.held(), Some(ball));
    screen.act(Release(LEFT));
    screen.act_in_a_frame(&[Press(LEFT), Release(LEFT), Press(LEFT)]);
    assert_eq!(screen.held(), Some(ball), "it is pressed twice in a frame");
    screen.act(Release(LEFT));
    assert_eq!(screen.held(), None);
    // The view of the platform is pressed, and then a child without a body of the view of the ball.
    let child = screen.app.world_mut().spawn(ChildOf(ball_view)).id();
    let platform_view = view(&screen, platform);
    screen.point_at(0.0, 500.0);
    for presses in [[ball_view, parent_view], [parent_view, ball_view], [platform_view, child]] {
        presses.into_iter().for_each(|entity| screen.press_event(entity));
        screen.act_in_a_frame(&[Press(LEFT), Release(LEFT), Press(LEFT)]);
        let last = if presses[1] == parent_view { parent } else { ball };
        assert_eq!(screen.held(), Some(last), "{presses:?}");
        screen.act(Release(LEFT));
    }
}
