//! Commands and their parts are encoded as the tables of `docs/FORMAT.md` specify.

use lockstep2d::body::{
    Area, BodyDef, BodyId, BodyKind, BodySettings, Continuous, EventSwitches, Falloff, Filter, Geometry,
    JointId, MassSource, Material, Mixing, MotionLocks, Name, Polygon, ShapeDef, ShapeId, Sides, WorldError,
};
use lockstep2d::codec::encode;
use lockstep2d::fx;
use lockstep2d::lockstep::SandboxSetup;
use lockstep2d::math::{Angle, Vec2};
use lockstep2d::solver::{
    ContactTuning, Distance, Gear, JointDef, JointKind, Motor, Prismatic, Pulley, Rack, Revolute,
    SolverSettings, Threshold, ThresholdAction, Weld, Wheel,
};
use lockstep2d::world::{BodyPose, Command, Config, Explosion, World};

/// Expected bytes, field by field as in the tables.
#[derive(Clone, Default)]
struct Written(Vec<u8>);

impl Written {
    fn u8(mut self, value: u8) -> Self {
        self.0.push(value);
        self
    }

    fn u32(mut self, value: u32) -> Self {
        self.0.extend(value.to_le_bytes());
        self
    }

    fn u64(mut self, value: u64) -> Self {
        self.0.extend(value.to_le_bytes());
        self
    }

    /// Appends numbers of the type `fx`, given in units of 1/2.
    fn fx(mut self, halves: &[i64]) -> Self {
        for half in halves {
            self.0.extend((half << 31).to_le_bytes());
        }
        self
    }

    fn i32(mut self, values: &[i32]) -> Self {
        for value in values {
            self.0.extend(value.to_le_bytes());
        }
        self
    }

    /// Appends a `Some` that contains numbers of the type `fx`, given in units of 1/2.
    fn some(self, halves: &[i64]) -> Self {
        self.u8(1).fx(halves)
    }

    fn none(self) -> Self {
        self.u8(0)
    }

    fn then(mut self, other: Written) -> Self {
        self.0.extend(other.0);
        self
    }
}

fn w() -> Written {
    Written::default()
}

struct Handles {
    body: BodyId,
    other: BodyId,
    shape: ShapeId,
    joint: JointId,
}

/// Handles of a world in which a body and its shape have reused a slot.
fn handles() -> Result<Handles, WorldError> {
    let mut world = World::default();
    let ball = ShapeDef::new(Geometry::circle(fx!(1))?);
    let other = world.spawn(&BodyDef::fixed(), &[])?;
    let first = world.spawn(&BodyDef::dynamic(), &[ball])?;
    world.despawn(first)?;
    let body = world.spawn(&BodyDef::dynamic(), &[ball])?;
    let joint = world.add_joint(&JointDef::new(other, body, Revolute::new()))?;
    let shape = world.body(body).expect("just spawned").shapes()[0];
    Ok(Handles { body, other, shape, joint })
}

fn id() -> Written {
    w().u32(1).u32(1)
}

fn shape_id() -> Written {
    w().u32(0).u32(1)
}

/// A polygon whose settings all differ from their defaults.
fn polygon() -> (ShapeDef, Written) {
    polygon_with(None, w().u8(1))
}

/// The triangle of [`polygon`] as an area.
fn pool() -> (ShapeDef, Written) {
    let (area, bytes) = area();
    polygon_with(Some(area), w().u8(3).then(bytes))
}

/// An area with all effects.
fn area() -> (Area, Written) {
    let area = Area::fluid(fx!(9)).drag(fx!(7), fx!(8)).flow((fx!(5), fx!(6))).force((fx!(3), fx!(4)));
    let area = area.acceleration((fx!(1), fx!(2))).attraction(fx!(-1), fx!(2), Falloff::InverseSquare);
    let bytes = w().fx(&[2, 4]).some(&[-2, 4]).u32(2).fx(&[6, 8]).fx(&[10, 12]).fx(&[14, 16]).fx(&[18]);
    (area, bytes)
}

/// A polygon with or without an area. `sensor` contains the bytes of the flags and of the area.
fn polygon_with(area: Option<Area>, sensor: Written) -> (ShapeDef, Written) {
    let material = Material {
        friction: fx!(0.5),
        friction_mixing: Mixing::Minimum,
        restitution: fx!(1),
        restitution_mixing: Mixing::Product,
        restitution_threshold: Some(fx!(8)),
        rolling_resistance: fx!(0.5),
        surface_speed: fx!(-7),
    };
    let filter = Filter { category: 4, mask: 5, group: -6 };
    let corners = [Vec2::new(fx!(0), fx!(0)), Vec2::new(fx!(2), fx!(0)), Vec2::new(fx!(0), fx!(2))];
    let triangle = Polygon::new(&corners).and_then(|polygon| polygon.rounded(fx!(0.5))).expect("a triangle");
    let events = EventSwitches { contact: false, hit: true, sensor: false, detect_sensors: true };
    let shape = ShapeDef { material, events, area, ..ShapeDef::new(triangle) };
    let shape =
        shape.filter(filter).offset((fx!(3), fx!(4))).one_way(Angle::from_bits(11)).sensor().user_data(9);
    let one = 1 << 22;
    let bytes = w().u32(2).u64(3).i32(&[0, 0, 2 * one, 0, 0, 2 * one]).i32(&[one / 2]);
    let surface = w().fx(&[1]).u32(2).fx(&[2]).u32(3).u8(1).fx(&[16]).fx(&[1, -14]);
    let bytes = bytes.fx(&[6, 8]).fx(&[2]).then(surface).u64(4).u64(5).i32(&[-6]);
    (shape, bytes.u8(1).u32(11).then(sensor).u8(0).u8(1).u8(0).u8(1).u64(9))
}

fn settings() -> (BodySettings, Written) {
    let settings = BodySettings {
        linear_damping: fx!(4),
        angular_damping: fx!(0),
        gravity_scale: fx!(1),
        locks: MotionLocks { x: true, y: false, rotation: true },
        continuous: Continuous::Bullet,
        may_sleep: false,
        sleep_speed: fx!(0.5),
    };
    (settings, w().fx(&[8, 0, 2]).u8(1).u8(0).u8(1).u32(2).u8(0).fx(&[1]))
}

fn body() -> (BodyDef, Written) {
    let (settings, settings_bytes) = settings();
    let (mass, mass_bytes) = mass();
    let def = BodyDef::kinematic().position((fx!(5), fx!(6))).angle(Angle::from_bits(7)).mass(mass);
    let def = def.velocity((fx!(1), fx!(2))).angular_velocity(fx!(3)).asleep().user_data(8);
    let def = def.name(Name::new("ball").expect("valid"));
    let bytes = w().u32(1).fx(&[10, 12]).u32(7).fx(&[2, 4, 6]).then(mass_bytes).then(settings_bytes);
    (BodyDef { settings, ..def }, bytes.u8(1).u8(1).u64(8).u8(1).then(name_bytes()))
}

fn name_bytes() -> Written {
    b"ball".iter().chain(&[0; 12]).fold(w(), |bytes, &byte| bytes.u8(byte))
}

fn mass() -> (MassSource, Written) {
    let centre = Vec2::new(fx!(1), fx!(-0.5));
    (MassSource::Given { mass: fx!(2), centre, gyration: fx!(0.5) }, w().u32(1).fx(&[4, 2, -1, 1]))
}

/// A joint of each kind, with different optional parts.
fn joints(handles: &Handles) -> Vec<(JointDef, Written)> {
    let (one, two, three) = (fx!(1), fx!(2), fx!(3));
    let distance = Distance::rod(one).limit(one, two).motor(one, two).spring(one, two, three);
    let weld = Weld::rigid().linear(one, two).angular(two, three);
    let motor = Motor::new().linear(Vec2::new(one, two), three).angular(one, two);
    let pull = Motor::new().linear_spring(one, two, three).angular_spring(three, two, one);
    let bare = || w().none().none().none();
    let kinds: [(JointKind, Written); 14] = [
        (Revolute::new().into(), w().u32(0).then(bare())),
        (Revolute::new().limit(one, two).into(), w().u32(0).some(&[2, 4]).none().none()),
        (Prismatic::new().motor(one, two).into(), w().u32(1).none().some(&[2, 4]).none()),
        (distance.into(), w().u32(2).some(&[2]).some(&[2, 4]).some(&[2, 4]).some(&[2, 4, 6]).none()),
        (
            Distance::new().spring_force(-one, two).into(),
            w().u32(2).none().none().none().none().some(&[-2, 4]),
        ),
        (Weld::rigid().into(), w().u32(3).none().none()),
        (weld.into(), w().u32(3).some(&[2, 4]).some(&[4, 6])),
        (Wheel::new().spring(one, two, three).into(), w().u32(4).none().none().some(&[2, 4, 6])),
        (motor.into(), w().u32(5).some(&[2, 4, 6]).some(&[2, 4]).none().none()),
        (pull.into(), w().u32(5).none().none().some(&[2, 4, 6]).some(&[6, 4, 2])),
        (JointKind::Filter, w().u32(6)),
        (Gear::new(3, -4).into(), w().u32(7).i32(&[3, -4])),
        (Rack::new(two).into(), w().u32(8).fx(&[4])),
        (
            Pulley::new((one, two), (three, one), two).ratio(one).into(),
            w().u32(9).fx(&[2, 4, 6, 2]).fx(&[4, 2]),
        ),
    ];
    let threshold = Threshold { force: Some(one), torque: None, action: ThresholdAction::Break };
    let of_kind = |(kind, bytes): (JointKind, Written)| {
        let def =
            JointDef::new(handles.other, handles.body, kind).anchor_a((one, two)).anchor_b((three, two));
        let def = def.angle_a(Angle::from_bits(5)).colliding().threshold(threshold).user_data(12);
        let def = def.softness(two, one).disabled();
        let frames = w().fx(&[2, 4]).u32(5).fx(&[6, 4]).u32(0);
        let start = w().u32(0).u32(0).then(id()).then(frames).u8(1).u8(0);
        (def, start.then(bytes).some(&[4, 2]).some(&[2]).none().u32(1).u64(12))
    };
    kinds.map(of_kind).into()
}

fn geometries() -> [(Geometry, Written); 4] {
    let (a, b, c) = (Vec2::ZERO, Vec2::new(fx!(1), fx!(0)), Vec2::new(fx!(2), fx!(1)));
    let link = Geometry::Link { a, b, before: None, after: Some(c), sides: Sides::Right };
    [
        (Geometry::Circle { radius: fx!(3) }, w().u32(0).fx(&[6])),
        (Geometry::Segment { a, b }, w().u32(1).fx(&[0, 0, 2, 0])),
        (Geometry::Capsule { a, b, radius: fx!(1) }, w().u32(3).fx(&[0, 0, 2, 0, 2])),
        (link, w().u32(4).fx(&[0, 0, 2, 0]).none().some(&[4, 2]).u32(1)),
    ]
}

/// Commands in the order of the document's table.
fn cases(handles: &Handles) -> Vec<(Command, Written)> {
    let &Handles { body, other, shape, joint } = handles;
    let vector = Vec2::new(fx!(1), fx!(-0.5));
    let angle = Angle::from_bits(9);
    let (polygon, polygon_bytes) = polygon();
    let (pool, pool_bytes) = pool();
    let (def, def_bytes) = self::body();
    let (settings, settings_bytes) = settings();
    let (mass, mass_bytes) = mass();
    let (hinge, hinge_bytes) = joints(handles).swap_remove(0);
    let on_body = |variant| w().u32(variant).then(id());
    let explosion = Explosion { radius: fx!(2), falloff: fx!(3), mask: 7, ..Explosion::new(vector, fx!(4)) };
    let shapes = || w().u64(1).then(polygon_bytes.clone());
    vec![
        (
            Command::Spawn { body: def, shapes: vec![polygon] },
            w().u32(0).then(def_bytes.clone()).then(shapes()),
        ),
        (
            Command::SpawnEach {
                body: def,
                shapes: vec![polygon],
                poses: vec![BodyPose { position: vector, angle }],
            },
            w().u32(1).then(def_bytes).then(shapes()).u64(1).fx(&[2, -1]).u32(9),
        ),
        (Command::Despawn { body }, on_body(2)),
        (Command::AddShape { body, shape: pool }, on_body(3).then(pool_bytes)),
        (Command::RemoveShape { shape }, w().u32(4).then(shape_id())),
        (Command::AddJoint { joint: hinge }, w().u32(5).then(hinge_bytes.clone())),
        (
            Command::AddJointEach { joint: hinge, ends: vec![(body, other)] },
            w().u32(6).then(hinge_bytes.clone()).u64(1).then(id()).u32(0).u32(0),
        ),
        (Command::RemoveJoint { joint }, w().u32(7).u32(0).u32(0)),
        (Command::ApplyForce { body, force: vector, point: vector }, on_body(8).fx(&[2, -1, 2, -1])),
        (Command::ApplyTorque { body, torque: fx!(1) }, on_body(9).fx(&[2])),
        (Command::ApplyImpulse { body, impulse: vector, point: vector }, on_body(10).fx(&[2, -1, 2, -1])),
        (Command::ApplyAngularImpulse { body, impulse: fx!(1) }, on_body(11).fx(&[2])),
        (
            Command::SetVelocity { body, velocity: vector, angular_velocity: fx!(3) },
            on_body(12).fx(&[2, -1, 6]),
        ),
        (Command::SetTransform { body, position: vector, angle }, on_body(13).fx(&[2, -1]).u32(9)),
        (Command::SetGravity { gravity: vector }, w().u32(14).fx(&[2, -1])),
        (Command::MoveTo { body, position: vector, angle }, on_body(15).fx(&[2, -1]).u32(9)),
        (Command::SetBody { body, settings }, on_body(16).then(settings_bytes)),
        (Command::SetKind { body, kind: BodyKind::Dynamic }, on_body(17).u32(2)),
        (Command::SetMass { body, mass }, on_body(18).then(mass_bytes)),
        (Command::SetUserData { body, user_data: 6 }, on_body(19).u64(6)),
        (Command::Enable { body }, on_body(20)),
        (Command::Disable { body }, on_body(21)),
        (Command::Wake { body }, on_body(22)),
        (Command::Sleep { body }, on_body(23)),
        (Command::SetShape { shape, def: polygon }, w().u32(24).then(shape_id()).then(polygon_bytes.clone())),
        (Command::SetJoint { joint, def: hinge }, w().u32(25).u32(0).u32(0).then(hinge_bytes)),
        (Command::Explode { explosion }, w().u32(26).fx(&[2, -1]).fx(&[4, 6, 8]).u64(7)),
        (Command::EnableJoint { joint }, w().u32(27).u32(0).u32(0)),
        (Command::DisableJoint { joint }, w().u32(28).u32(0).u32(0)),
        (Command::SetConfig { config: settings_of_world().0 }, w().u32(29).then(settings_of_world().1)),
        (Command::SetName { body, name: Name::new("ball").ok() }, on_body(30).u8(1).then(name_bytes())),
        (Command::SetArea { shape, area: pool.area }, w().u32(31).then(shape_id()).u8(1).then(area().1)),
        (Command::SetArea { shape, area: None }, w().u32(31).then(shape_id()).u8(0)),
    ]
}

#[test]
fn the_bytes_of_commands_are_those_of_the_document() {
    let handles = handles().expect("a valid world");
    let cases = cases(&handles);
    for (command, expected) in &cases {
        assert_eq!(encode(command), expected.0, "{command:?}");
    }
    for (def, expected) in joints(&handles) {
        assert_eq!(encode(&def), expected.0, "{def:?}");
    }
    for (geometry, expected) in geometries() {
        assert_eq!(encode(&geometry), expected.0, "{geometry:?}");
    }
    let inputs: Vec<Command> = cases.iter().map(|(command, _)| command.clone()).collect();
    let all = cases.into_iter().fold(w().u64(33), |all, (_, bytes)| all.then(bytes));
    assert_eq!(encode(&inputs), all.0, "an input of the sandbox");
}

fn settings_of_world() -> (Config, Written) {
    let solver = SolverSettings {
        contact: ContactTuning::Baumgarte { share: fx!(0.5), slop: fx!(1), push_speed: fx!(3) },
        ..SolverSettings::default()
    };
    let config = Config { solver, fat_margin: fx!(0.5), speculative_distance: fx!(0.5), ..Config::default() };
    let config = Config { continuous: false, hit_speed: fx!(2), ..config };
    let settings = w().u32(4).u32(1).u32(1).fx(&[1, 2, 6]).fx(&[120, 4, 2, 800]);
    let limits = w().u32(1 << 20).u32(1 << 20).u32(1 << 20).u32(1 << 18);
    let expected = w().u32(60).fx(&[0, -20]).then(settings).fx(&[1, 1]).u8(1).u8(0).fx(&[4]).then(limits);
    (config, expected)
}

#[test]
fn the_bytes_of_a_setup_are_those_of_the_document() {
    let (config, expected) = settings_of_world();
    let setup = SandboxSetup { config, commands: vec![Command::SetGravity { gravity: Vec2::ZERO }] };
    assert_eq!(encode(&setup), expected.u64(1).u32(14).fx(&[0, 0]).0);
}

/// Reports name every value of an area. A sensor without an area is listed as `sensor` only.
#[test]
fn an_area_is_listed_by_its_names() {
    let paths = |def: &ShapeDef| -> Vec<String> {
        let fields = lockstep2d::inspect::fields(def).expect("plain data");
        fields.iter().map(|field| field.path().to_string()).collect()
    };
    assert!(paths(&pool().0).contains(&"sensor.area.density".to_string()));
    assert!(paths(&polygon().0).contains(&"sensor".to_string()));
}
