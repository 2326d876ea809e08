//! The 2D examples of rapier that Box2D does not have as samples.

use lockstep2d::body::{BodyDef, Chain, EventSwitches, Filter, Geometry, ShapeDef};
use lockstep2d::fx;
use lockstep2d::math::{Angle, Fx, Rng, Vec2, widen};
use lockstep2d::solver::{ContactTuning, SolverSettings};
use lockstep2d::world::{Config, Probe, QueryFilter};

use super::{Stage, ball, degrees, hull, near, num, pill, rect, square};

/// Example `add_remove2`.
#[test]
fn what_falls_off_is_removed() {
    let mut stage = Stage::new();
    let turning = |x| BodyDef::kinematic().position(Vec2::new(x, fx!(-1))).angular_velocity(fx!(-1));
    for x in [fx!(5), fx!(-5)] {
        stage.spawn(turning(x), &[rect(fx!(5), fx!(0.5))]);
    }
    let mut rng = Rng::new(4);
    let (mut spawned, mut removed) = (0, 0);
    for tick in 0..900 {
        if tick % 10 == 0 && tick < 600 {
            stage.add(Vec2::new(rng.range(fx!(-5), fx!(5)), rng.range(fx!(10), fx!(20))), square(fx!(0.5)));
            spawned += 1;
        }
        stage.run(1);
        let below = stage.world.bodies().filter(|(_, body)| body.position().y < fx!(-10));
        let below: Vec<_> = below.map(|(id, _)| id).collect();
        removed += below.len();
        below.into_iter().for_each(|id| stage.world.despawn(id).expect("there"));
    }
    assert_eq!((spawned, stage.world.body_count() + removed), (60, 62));
    assert!(removed > 50, "only {removed} fell off");
}

/// Example `ccd2`.
#[test]
fn thin_walls_stop_fast_compounds() {
    let mut stage = Stage::new();
    let wall = |x| rect(fx!(0.1), fx!(25)).offset(Vec2::new(x, Fx::ZERO));
    let ground = [rect(fx!(25), fx!(0.1)), wall(fx!(-3)), wall(fx!(6)), wall(fx!(2.5)).sensor()];
    stage.spawn(BodyDef::fixed(), &ground);
    let upright = rect(fx!(0.05), fx!(0.4));
    let parts = [
        rect(fx!(0.4), fx!(0.05)).offset(at!(0, 0.35)),
        upright.offset(at!(-0.35, 0)),
        upright.offset(at!(0.35, 0)),
    ];
    let place = |i: i32| Vec2::new(num(i % 4) - fx!(2.2), num(i / 4) + fx!(4));
    let def = BodyDef::dynamic().velocity(at!(100, -10)).bullet();
    let bodies: Vec<_> = (0..16).map(|i| stage.spawn(def.position(place(i)), &parts)).collect();
    let mut seen = Vec::new();
    stage.run_and(180, |stage| {
        for event in &stage.world.events().sensor_begin {
            seen.push(stage.world.shape(event.visitor).expect("there").body());
        }
        for &id in &bodies {
            let place = stage.place(id);
            assert!(place.x > fx!(-3) && place.x < fx!(6) && place.y > fx!(0), "outside at {place:?}");
        }
    });
    seen.sort();
    seen.dedup();
    assert_eq!(seen.len(), 16, "expected the sensor to see all");
}

/// Example `collision_groups2`. A box that misses its floor lands on the ground.
#[test]
fn groups_land_on_their_floors() {
    let mut stage = Stage::with_floor();
    let group = |own: u64| Filter { category: own, mask: own, group: 0 };
    let (green, blue) = (group(2), group(4));
    let ground = Filter { category: 6, mask: u64::MAX, group: 0 };
    stage.fixed(at!(0, -1), rect(fx!(50), fx!(1)).filter(ground));
    stage.fixed(at!(0, 1), rect(fx!(1), fx!(0.1)).filter(green));
    stage.fixed(at!(0, 2), rect(fx!(1), fx!(0.1)).filter(blue));
    for i in 0..8 {
        let (filter, top) = if i % 2 == 0 { (green, fx!(1.1)) } else { (blue, fx!(2.1)) };
        let x = num(i) / 5 - fx!(0.7);
        let body = stage.add(Vec2::new(x, fx!(2.6)), square(fx!(0.09)).filter(filter));
        let beside = stage.add(Vec2::new(num(i) + fx!(2), fx!(2.6)), square(fx!(0.09)).filter(filter));
        stage.run(120);
        near(stage.place(body).y, top + fx!(0.09), fx!(0.01));
        near(stage.place(beside).y, fx!(0.09), fx!(0.01));
    }
}

/// Example `damping2`: `v = v0 exp(-c t)`.
#[test]
fn damping_is_exponential() {
    // Shares of the velocity that are left after half a second: exp(-c / 2) for a damping c of 1 to 10.
    let left = [
        fx!(0.60653),
        fx!(0.36788),
        fx!(0.22313),
        fx!(0.13534),
        fx!(0.08208),
        fx!(0.04979),
        fx!(0.0302),
        fx!(0.01832),
        fx!(0.01111),
        fx!(0.00674),
    ];
    for (i, (&slow, &spin)) in (0..).zip(left.iter().zip(left.iter().rev())) {
        let mut stage = Stage::weightless();
        let def = BodyDef::dynamic().velocity(at!(6, 8)).angular_velocity(fx!(100));
        let body =
            stage.spawn(def.linear_damping(num(i + 1)).angular_damping(num(10 - i)), &[square(fx!(0.2))]);
        stage.run(30);
        // Each sub-step divides the velocity by 1 + c / 240. After a time t, the velocity is therefore larger than
        // `v0 exp(-c t)` by a share of about c^2 t / 480.
        near(stage.velocity(body).length(), slow * 10, fx!(0.04));
        near(stage.body(body).angular_velocity(), spin * 100, fx!(0.4));
    }
}

/// Example `debug_box_ball2`.
#[test]
fn a_ball_on_a_corner_does_not_sink() {
    let mut stage = Stage::new();
    let corner = stage.spawn(BodyDef::fixed().position(at!(0, -1)).angle(degrees(45)), &[square(fx!(1))]);
    let ball = stage.spawn(BodyDef::dynamic().position(at!(0, 3)).never_sleeps(), &[ball(fx!(1))]);
    let (corner, shape) = (stage.shape(corner), stage.shape(ball));
    stage.run_and(300, |stage| {
        let apart = stage.world.distance(corner, shape).expect("there").distance;
        assert!(apart > fx!(-0.02), "{apart} m deep");
    });
}

/// Example `debug_compression2`.
#[test]
fn a_press_does_not_squeeze_balls_out() {
    let mut stage = Stage::new();
    stage.fixed(at!(0, -6), rect(fx!(30), fx!(2)));
    stage.fixed(at!(0, 6), rect(fx!(30), fx!(2)));
    let planks = [-9, 9].map(|x| stage.add(Vec2::new(num(x), Fx::ZERO), rect(fx!(1), fx!(3.99))));
    let balls: Vec<_> = (0..36)
        .map(|i| {
            stage.add(
                Vec2::new(num(i % 6) * 4 / 3 - fx!(3.33), num(i / 6) * 4 / 3 - fx!(3.33)),
                ball(fx!(0.66)),
            )
        })
        .collect();
    for tick in 0..240 {
        let force = Vec2::new(num(20 * tick), Fx::ZERO);
        stage.world.apply_force_to_centre(planks[0], force).expect("valid");
        stage.world.apply_force_to_centre(planks[1], -force).expect("valid");
        stage.run(1);
        for &id in &balls {
            let (left, right) = (stage.place(planks[0]).x, stage.place(planks[1]).x);
            let place = stage.place(id);
            assert!(place.y.abs() < fx!(4) && place.x > left && place.x < right, "squeezed out to {place:?}");
        }
    }
}

/// Example `debug_intersection2`.
#[test]
fn a_circling_probe_finds_its_ball() {
    let mut stage = Stage::new();
    let centre = |i: i32| Vec2::new(num(i % 20 - 10) * 3, num(i / 20 - 10) * 3);
    let shapes: Vec<_> = (0..400)
        .map(|i| {
            let id = stage.fixed(centre(i), ball(fx!(1)));
            stage.shape(id)
        })
        .collect();
    let mut found = 0;
    for step in 0..200 {
        let place = Angle::from_radians(num(step) / 30).direction().widen().scale(fx!(10));
        let probe = Probe::new(Geometry::circle(fx!(0.5)).expect("valid"), place).expect("valid");
        let naive: Vec<_> = (0..400)
            .zip(&shapes)
            .filter(|&(i, _)| centre(i).distance(place) < fx!(1.5))
            .map(|(_, &id)| id)
            .collect();
        found += naive.len();
        assert_eq!(stage.world.overlap_shape(&probe, QueryFilter::default()), naive);
    }
    assert!(found > 50);
}

/// Example `debug_many_colliders2`.
#[test]
fn bodies_of_hundreds_of_parts_stack() {
    let mut stage = Stage::with_floor();
    let part = |i: i32| {
        hull(&[at!(0, 0), at!(0.1, 0), at!(0.1, 0.1)])
            .offset(Vec2::new(num(i % 20 - 10) / 10, num(i / 20) / 10))
    };
    let parts: Vec<_> = (0..200).map(part).collect();
    let bodies: Vec<_> = (0..3)
        .map(|i| stage.spawn(BodyDef::dynamic().position(Vec2::new(Fx::ZERO, num(2 * i))), &parts))
        .collect();
    stage.run(400);
    for (i, &id) in (0..).zip(&bodies) {
        near(stage.place(id).y, num(i), fx!(0.05));
    }
}

/// Example `debug_total_overlap2`. The total momentum stays zero.
#[test]
fn boxes_in_one_place_come_apart() {
    let mut stage = Stage::weightless();
    for _ in 0..50 {
        stage.add(Vec2::ZERO, square(fx!(0.5)));
    }
    stage.run(900);
    assert!(stage.world.deepest_overlap() < fx!(0.05), "{} m deep", stage.world.deepest_overlap());
    let momentum = stage.world.bodies().fold(Vec2::ZERO, |sum, (_, body)| sum + body.velocity());
    assert!(momentum.length() < fx!(0.01), "{momentum:?}");
}

/// Example `inv_pyramid2`. Each box carries a box of twice its size. The lowest box, of 1 kg, carries four boxes, or
/// five with contacts of 120 Hz. At 30 Hz the lowest of six boxes would yield by 1364 g / (2 pi 30 Hz)^2 = 0.38 m.
#[test]
fn an_inverted_pyramid_stands() {
    for (count, sub_steps, hertz) in [(5, 4, fx!(30)), (6, 16, fx!(120))] {
        let contact = ContactTuning::Soft { hertz, damping_ratio: fx!(10), push_speed: fx!(3) };
        let solver = SolverSettings { sub_steps, contact, ..SolverSettings::default() };
        let mut stage = Stage::of(Config { solver, ..Config::default() });
        stage.floor();
        let (mut half, mut y, mut tower) = (fx!(0.5), Fx::ZERO, Vec::new());
        for _ in 0..count {
            tower.push((stage.add(Vec2::new(Fx::ZERO, y + half), square(half)), y + half));
            y += half * 2;
            half += half;
        }
        stage.run(600);
        for (id, height) in tower {
            near(stage.place(id).y, height, fx!(0.25));
            near(stage.place(id).x, fx!(0), fx!(0.1));
        }
    }
}

/// Example `one_way_platforms2`. A body rides a belt that is solid from above. Reversed gravity then pulls the body to
/// the lower side of a second belt.
#[test]
fn one_way_belts_pass_bodies_on() {
    let mut stage = Stage::new();
    let belt = rect(fx!(25), fx!(0.5)).surface_speed(fx!(-12));
    stage.fixed(at!(30, 2), belt.one_way(degrees(90)));
    stage.fixed(at!(-30, -2), belt.one_way(degrees(-90)));
    let body = stage.add(at!(20, 10), rect(fx!(1.5), fx!(2)));
    let (mut rode, mut hung) = (false, false);
    for _ in 0..1500 {
        let place = stage.place(body);
        let mut settings = *stage.body(body).settings();
        settings.gravity_scale = if place.y > fx!(1) {
            fx!(1)
        } else if place.y < fx!(-1) {
            fx!(-1)
        } else {
            settings.gravity_scale
        };
        stage.world.set_body(body, &settings).expect("valid");
        stage.run(1);
        rode |= (stage.place(body).y - fx!(4.5)).abs() < fx!(0.05) && stage.velocity(body).x < fx!(-11);
        // The body may have turned and rest on another side.
        let depth = -stage.place(body).y;
        let touches = (depth - fx!(4.5)).abs() < fx!(0.05) || (depth - fx!(4)).abs() < fx!(0.05);
        hung |= touches && stage.velocity(body).x > fx!(11);
    }
    assert!(rode && hung, "rode {rode}, hung {hung}: {:?}", stage.place(body));
}

/// Example `platform2`.
#[test]
fn platforms_carry_boxes() {
    for moved in [false, true] {
        let mut stage = Stage::with_floor();
        let platform =
            stage.spawn(BodyDef::kinematic().position(at!(0, 3)), &[rect(fx!(2), fx!(0.2)).friction(fx!(1))]);
        let boxes: Vec<_> = (0..6)
            .map(|i| {
                stage.add(
                    Vec2::new(num(i % 3) - fx!(1), num(i / 3) / 2 + fx!(3.4)),
                    square(fx!(0.2)).friction(fx!(1)),
                )
            })
            .collect();
        stage.run(30);
        for tick in 0..600 {
            // The platform accelerates by at most 3 m/s² sideways, a third of what a friction of 1 can give.
            let time = Angle::from_radians(num(tick) / 60);
            let velocity = Vec2::new(widen(time.sin()) * 3, widen((time + time).sin()) / 2);
            if moved {
                let place = stage.place(platform) + velocity.scale(fx!(1 / 60));
                stage.world.move_to(platform, place, Angle::ZERO).expect("valid");
            } else {
                stage.world.set_velocity(platform, velocity, fx!(0)).expect("valid");
            }
            stage.run(1);
        }
        for &id in &boxes {
            let apart = stage.place(id) - stage.place(platform);
            assert!(apart.x.abs() < fx!(2) && apart.y > fx!(0.3), "moved {moved}: at {apart:?}");
        }
    }
}

/// Example `sensor2`.
#[test]
fn a_carried_sensor_sees_what_it_passes() {
    let mut stage = Stage::with_floor();
    let boxes: Vec<_> =
        (0..10).map(|i| stage.add(Vec2::new(num(i) - fx!(4.5), fx!(0.2)), square(fx!(0.2)))).collect();
    let switches = EventSwitches::default();
    let eye = ball(fx!(1)).density(fx!(0)).sensor().events(switches);
    let carrier = stage.spawn(BodyDef::dynamic().position(at!(0, 10)), &[square(fx!(0.2)), eye]);
    // A sensor without density adds no mass.
    near(stage.body(carrier).mass(), fx!(0.16), fx!(0.0001));
    let mut seen = Vec::new();
    stage.run_and(180, |stage| {
        let begun = stage.world.events().sensor_begin.iter();
        seen.extend(begun.map(|event| stage.world.shape(event.visitor).expect("there").body()));
    });
    // These boxes are within 1 m of the place where the sensor lands.
    assert!(seen.contains(&boxes[4]) && seen.contains(&boxes[5]), "{seen:?}");
    assert!(!seen.contains(&boxes[0]) && !seen.contains(&boxes[9]));
    let eye = *stage.world.shapes_of(carrier).last().expect("two shapes");
    let before = stage.world.sensor_overlaps(eye).len();
    stage.world.set_transform(boxes[4], at!(50, 0.2), Angle::ZERO).expect("valid");
    stage.run(2);
    assert_eq!(stage.world.sensor_overlaps(eye).len(), before - 1);
}

/// Examples `heightfield2`, `polyline2`, `trimesh2` and `voxels2`: a hill as a chain, as triangles and as boxes.
#[test]
fn terrain_of_every_kind_carries() {
    let height = |i: i32| widen(Angle::from_turns(num(i) / 10).cos());
    let top = |i: i32| Vec2::new(num(i), height(i));
    let chain: Vec<_> = (-20..=20).map(top).collect();
    let chain = Chain::new(&chain).links().expect("valid");
    let low = |i: i32| Vec2::new(num(i), fx!(-3));
    let triangles: Vec<ShapeDef> = (-20..20)
        .flat_map(|i| [hull(&[low(i), low(i + 1), top(i + 1)]), hull(&[low(i), top(i + 1), top(i)])])
        .collect();
    let voxels: Vec<_> = (-20..20)
        .map(|i| {
            rect(fx!(0.5), fx!(2) + height(i) / 2)
                .offset(Vec2::new(num(i) + fx!(0.5), height(i) / 2 - fx!(2)))
        })
        .collect();
    for ground in [chain, triangles, voxels] {
        let mut stage = Stage::new();
        stage.spawn(BodyDef::fixed(), &ground);
        let shapes = [
            ball(fx!(0.3)),
            square(fx!(0.3)),
            pill(fx!(0.3), fx!(0.2)),
            hull(&[at!(-0.3, -0.3), at!(0.3, -0.3), at!(0, 0.4)]),
        ];
        for (i, &shape) in (0..32).zip(shapes.iter().cycle()) {
            stage.add(Vec2::new(num(i) - fx!(15.5), num(4 + i % 3)), shape);
        }
        stage.run(400);
        for (_, body) in stage.world.bodies().filter(|(_, body)| body.is_dynamic()) {
            assert!(body.position().y > fx!(-1.5), "fell through: {:?}", body.position());
        }
    }
    let mut stage = Stage::new();
    let level = |i: i32| {
        [at!(0, -1), at!(1, -1), at!(1, 0), at!(0, 0)].map(|corner| corner + Vec2::new(num(i), Fx::ZERO))
    };
    let tiles: Vec<_> =
        (-10..30).map(level).flat_map(|[a, b, c, d]| [hull(&[a, b, c]), hull(&[a, c, d])]).collect();
    stage.spawn(BodyDef::fixed(), &tiles.iter().map(|tile| tile.friction(fx!(0))).collect::<Vec<_>>());
    let body = stage.throw(at!(-5, 0.5), at!(8, 0), square(fx!(0.5)).friction(fx!(0)));
    stage.run_and(180, |stage| near(stage.velocity(body).x, fx!(8), fx!(0.01)));
}
