//! Edits beside bodies at rest: which bodies they wake, keep awake, and put to sleep.

use lockstep2d::body::{Area, BodyDef, BodyId, Filter, Geometry, Material, Polygon, ShapeDef};
use lockstep2d::fx;
use lockstep2d::math::{Angle, Fx, Rot, Vec2};
use lockstep2d::solver::{JointDef, JointKind, Revolute};
use lockstep2d::world::World;

use super::{is_asleep, rectangle, run, shape_of, spawn, square, weightless, world_with_floor};

fn place(world: &World, body: BodyId) -> Vec2<Fx> {
    world.body(body).expect("there").position()
}

/// An edit parts the lower of two boxes from the upper one, and the lower box is put to sleep in the same tick. The
/// upper box falls.
#[test]
fn a_body_that_an_edit_has_parted_from_others_sleeps_alone() {
    type Edit = fn(&mut World, BodyId, BodyId);
    let edits: [(Edit, Fx); 4] = [
        (
            |world, lower, _| world.set_transform(lower, (fx!(30), fx!(0.5)), Angle::ZERO).expect("there"),
            fx!(0.5),
        ),
        (
            |world, lower, _| {
                let nothing = Filter { mask: 0, ..Filter::default() };
                world.set_filter(shape_of(world, lower), nothing).expect("there");
            },
            fx!(0.5),
        ),
        (
            |world, lower, _| {
                let small = Geometry::from(Polygon::square(fx!(0.1)).expect("valid"));
                world.set_geometry(shape_of(world, lower), small).expect("valid");
            },
            fx!(0.7),
        ),
        (
            |world, lower, upper| {
                world.add_joint(&JointDef::new(lower, upper, JointKind::Filter)).expect("valid");
            },
            fx!(0.5),
        ),
    ];
    for (index, (edit, height)) in edits.into_iter().enumerate() {
        for ticks in [120, 20] {
            let (mut world, _) = world_with_floor();
            let at = |y: Fx| BodyDef::dynamic().position((fx!(0), y));
            let lower = spawn(&mut world, at(fx!(0.5)), square(fx!(0.5)));
            let upper = spawn(&mut world, at(fx!(1.5)), square(fx!(0.5)));
            run(&mut world, ticks);
            edit(&mut world, lower, upper);
            world.sleep(lower).expect("dynamic");
            assert_eq!([lower, upper].map(|id| is_asleep(&world, id)), [true, false], "edit {index}");
            run(&mut world, 120);
            let y = place(&world, upper).y;
            assert!((y - height).abs() < fx!(0.02), "edit {index}: {y}");
        }
    }
}

/// A ship that holds a body by its area leaves and goes to sleep in the same tick.
#[test]
fn a_body_that_an_area_has_left_does_not_sleep_with_it() {
    let mut world = World::default();
    let field = Area::new().acceleration((fx!(0), fx!(10)));
    let shapes = [rectangle(fx!(1), fx!(1)).sensor().area(field), square(fx!(0.1)).offset((fx!(0), fx!(5)))];
    let ship = world.spawn(&BodyDef::dynamic().gravity_scale(fx!(0)), &shapes).expect("valid");
    let held = spawn(&mut world, BodyDef::dynamic(), square(fx!(0.05)));
    run(&mut world, 20);
    world.set_transform(ship, (fx!(100), fx!(0)), Angle::ZERO).expect("there");
    world.sleep(ship).expect("dynamic");
    let before = place(&world, held).y;
    run(&mut world, 60);
    assert!(is_asleep(&world, ship));
    let fallen = before - place(&world, held).y;
    assert!(fallen > fx!(4), "{fallen} m in a second");
}

/// A kinematic platform whose upper side is at height 0, with sleeping bodies at x = -50 and 50, and a sleeping post
/// that hangs from it.
fn platform() -> (World, BodyId, [BodyId; 3]) {
    let mut world = World::default();
    let platform = BodyDef::kinematic().position((fx!(0), fx!(-0.5)));
    let platform = spawn(&mut world, platform, rectangle(fx!(60), fx!(0.5)));
    let sleepers = [(-50, fx!(0.5)), (50, fx!(0.5)), (0, fx!(-2))]
        .map(|(x, y)| BodyDef::dynamic().position((Fx::from_num(x), y)));
    let [x, y, post] = sleepers.map(|def| spawn(&mut world, def, square(fx!(0.5))));
    let hinge = JointDef::new(platform, post, Revolute::new()).anchor_b((fx!(0), fx!(1.5)));
    world.add_joint(&hinge).expect("valid");
    run(&mut world, 120);
    assert!([x, y, post].iter().all(|id| is_asleep(&world, *id)));
    (world, platform, [x, y, post])
}

#[test]
fn an_edit_of_one_rider_wakes_no_other_rider() {
    let edits: [fn(&mut World, BodyId, BodyId, BodyId); 7] = [
        |world, x, _, _| {
            let icy = Material { friction: fx!(0), ..Material::default() };
            world.set_material(shape_of(world, x), icy).expect("there");
        },
        |world, x, _, _| world.despawn(x).expect("there"),
        |world, x, _, _| world.set_transform(x, (fx!(-50), fx!(3)), Angle::ZERO).expect("there"),
        |world, x, _, _| {
            world.add_shape(x, &square(fx!(0.1))).expect("valid");
        },
        |world, x, platform, _| {
            let hinge = JointDef::new(platform, x, Revolute::new()).anchor_a((fx!(-50), fx!(1)));
            world.add_joint(&hinge).expect("valid");
        },
        |world, _, _, post| world.set_transform(post, (fx!(0), fx!(-2)), Angle::ZERO).expect("there"),
        |world, _, _, _| {
            let hinge = world.joints().next().expect("one").0;
            world.remove_joint(hinge).expect("there");
        },
    ];
    for (index, edit) in edits.into_iter().enumerate() {
        let (mut world, platform, [x, y, post]) = platform();
        edit(&mut world, x, platform, post);
        run(&mut world, 3);
        assert!(is_asleep(&world, y), "edit {index}");
    }
}

#[test]
fn a_platform_that_is_told_to_stay_lets_its_riders_sleep() {
    let (mut world, platform, sleepers) = platform();
    for tick in 0..60 {
        let there = place(&world, platform);
        world.move_to(platform, there, Angle::ZERO).expect("there");
        run(&mut world, 1);
        assert!(sleepers.iter().all(|id| is_asleep(&world, *id)), "tick {tick}");
    }
    world.set_transform(platform, (fx!(0), fx!(-1)), Angle::ZERO).expect("there");
    run(&mut world, 1);
    assert!(sleepers.iter().all(|id| !is_asleep(&world, *id)));
}

/// A kinematic bar turns by 90 degrees in a tick. A path predicted along the tangent at the start misses the box.
#[test]
fn a_bar_wakes_what_it_reaches_in_its_last_moving_tick() {
    let mut world = weightless();
    let bar = spawn(&mut world, BodyDef::kinematic(), rectangle(fx!(5), fx!(0.1)));
    let target =
        spawn(&mut world, BodyDef::dynamic().position((fx!(0), fx!(5.3))).asleep(), square(fx!(0.4)));
    run(&mut world, 3);
    assert!(is_asleep(&world, target));
    world.move_to(bar, Vec2::ZERO, Angle::from_degrees(fx!(90))).expect("in reach");
    run(&mut world, 2);
    assert!(!is_asleep(&world, target));
}

/// A resting kinematic sensor notices fixed shapes that are moved or changed.
#[test]
fn a_resting_sensor_notices_edits_of_fixed_shapes() {
    let mut world = weightless();
    let zone = spawn(&mut world, BodyDef::kinematic(), square(fx!(1)).sensor());
    let wall = spawn(&mut world, BodyDef::fixed().position((fx!(1.4), fx!(0))), square(fx!(0.5)));
    let mut seen = |edit: &dyn Fn(&mut World)| {
        edit(&mut world);
        run(&mut world, 1);
        let seen = (world.events().sensor_begin.len(), world.events().sensor_end.len());
        run(&mut world, 5);
        seen
    };
    let resize = |half: Fx| {
        move |world: &mut World| {
            let square = Geometry::from(Polygon::square(half).expect("valid"));
            world.set_geometry(shape_of(world, wall), square).expect("valid");
        }
    };
    let go = |x: Fx| {
        move |world: &mut World| world.set_transform(wall, (x, Fx::ZERO), Angle::ZERO).expect("there")
    };
    assert_eq!(seen(&|_| ()), (1, 0));
    assert_eq!(seen(&resize(fx!(0.39))), (0, 1));
    assert_eq!(seen(&resize(fx!(0.41))), (1, 0));
    assert_eq!(seen(&go(fx!(1.42))), (0, 1));
    assert_eq!(seen(&go(fx!(1.3))), (1, 0));
    assert!(world.body(zone).is_some());
}

/// The ground changes at any time before or after a box on it falls asleep. In the first tick after the change, the box
/// is slower than its sleep speed.
#[test]
fn a_box_whose_ground_changes_slides() {
    let grounds: [(Fx, Material, Material); 2] = [
        (fx!(10), Material::default(), Material { friction: fx!(0), ..Material::default() }),
        (
            fx!(0),
            Material { friction: fx!(0.15), ..Material::default() },
            Material { friction: fx!(0.15), surface_speed: fx!(1), ..Material::default() },
        ),
    ];
    for (degrees, before, after) in grounds {
        for kind in [BodyDef::fixed(), BodyDef::kinematic()] {
            for tick in 0..60 {
                let mut world = World::default();
                let angle = Angle::from_degrees(degrees);
                let ground = spawn(
                    &mut world,
                    kind.angle(angle),
                    ShapeDef { material: before, ..rectangle(fx!(50), fx!(1)) },
                );
                let up = Rot::from_angle(angle).apply_wide(Vec2::new(fx!(0), fx!(1.5)));
                let def = BodyDef::dynamic().position(up).angle(angle);
                let id = spawn(&mut world, def, ShapeDef { material: before, ..square(fx!(0.5)) });
                run(&mut world, tick);
                let start = place(&world, id);
                world.set_material(shape_of(&world, ground), after).expect("there");
                run(&mut world, 60);
                let moved = (place(&world, id) - start).length();
                assert!(moved > fx!(0.4), "{degrees} degrees, tick {tick}: {moved} m in a second");
            }
        }
    }
}

/// A body that is hinged to a moving kinematic body, directly or through another body, goes with it.
#[test]
fn a_body_that_is_joined_to_a_moving_anchor_does_not_sleep() {
    for by_target in [false, true] {
        let mut world = weightless();
        let anchor = spawn(&mut world, BodyDef::kinematic(), square(fx!(0.2)));
        let at = |x: Fx| BodyDef::dynamic().position((x, fx!(0)));
        let [near, far] = [fx!(1), fx!(2)].map(|x| spawn(&mut world, at(x), square(fx!(0.2))));
        for (a, b) in [(anchor, near), (near, far)] {
            world.add_joint(&JointDef::new(a, b, Revolute::new()).anchor_a((fx!(1), fx!(0)))).expect("valid");
        }
        for tick in 1..=120 {
            if by_target {
                world.move_to(anchor, (Fx::from_num(tick) / 60, fx!(0)), Angle::ZERO).expect("in reach");
            } else {
                world.set_velocity(anchor, (fx!(1), fx!(0)), fx!(0)).expect("valid");
            }
            if tick == 30 {
                world.sleep(far).expect("dynamic");
            }
            run(&mut world, 1);
            assert!(!is_asleep(&world, near) && !is_asleep(&world, far));
        }
        let gap = (place(&world, far) - place(&world, anchor)).length() - fx!(2);
        assert!(gap.abs() < fx!(0.05), "{gap}");
    }
}
