//! The bytes of a world and of commands are those of `docs/FORMAT.md`: read here without the engine's decoder, by
//! what the document says alone.

use std::fmt::Display;
use std::ops::Range;

use lockstep2d::body::{
    BodyDef, BodyId, Filter, Geometry, JointId, MassSource, Material, Mixing, Polygon, ShapeDef, ShapeId,
    WorldError,
};
use lockstep2d::codec::encode;
use lockstep2d::fx;
use lockstep2d::hash::StateHash;
use lockstep2d::lockstep::{Game, Sandbox, SandboxSetup};
use lockstep2d::math::{Angle, Vec2};
use lockstep2d::solver::{ContactTuning, JointDef, Revolute, SolverSettings};
use lockstep2d::world::{Command, Config, Section, World};

/// Reads a world's bytes from front to back and writes down what each of them is.
struct Reader<'a> {
    bytes: &'a [u8],
    at: usize,
    listing: String,
}

impl<'a> Reader<'a> {
    fn take(&mut self, count: usize, name: &str, show: impl FnOnce(&[u8]) -> String) -> &'a [u8] {
        let taken = &self.bytes[self.at..self.at + count];
        self.at += count;
        let shown = show(taken);
        let digits: Vec<String> = taken.iter().map(|byte| format!("{byte:02x}")).collect();
        for (row, chunk) in digits.chunks(16).enumerate() {
            let line = format!("{:47} | {}", chunk.join(" "), if row == 0 { name } else { "" });
            self.listing += line.trim_end();
            self.listing += if row == 0 && !shown.is_empty() { " " } else { "" };
            self.listing += if row == 0 { &shown } else { "" };
            self.listing += "\n";
        }
        taken
    }

    fn number<const N: usize, T: Display + Copy>(&mut self, name: &str, from: fn([u8; N]) -> T) -> T {
        let mut bytes = [0; N];
        let show = |taken: &[u8]| from(taken.try_into().expect("as many as asked for")).to_string();
        bytes.copy_from_slice(self.take(N, name, show));
        from(bytes)
    }

    fn u8(&mut self, name: &str) -> u8 {
        self.number(name, u8::from_le_bytes)
    }

    fn u16(&mut self, name: &str) -> u16 {
        self.number(name, u16::from_le_bytes)
    }

    fn u32(&mut self, name: &str) -> u32 {
        self.number(name, u32::from_le_bytes)
    }

    fn u64(&mut self, name: &str) -> u64 {
        self.number(name, u64::from_le_bytes)
    }

    fn i32(&mut self, name: &str) -> i32 {
        self.number(name, i32::from_le_bytes)
    }

    /// Fixed-point numbers side by side, of 4 or 8 bytes each.
    fn fixed(&mut self, name: &str, count: usize, bytes: usize, fraction_bits: u32) {
        self.take(count * bytes, name, |taken| {
            let number = |chunk: &[u8]| {
                let mut wide = [if chunk[bytes - 1] < 0x80 { 0 } else { 0xff }; 8];
                wide[..bytes].copy_from_slice(chunk);
                decimal(i64::from_le_bytes(wide), fraction_bits)
            };
            taken.chunks(bytes).map(number).collect::<Vec<_>>().join(", ")
        });
    }

    fn fx(&mut self, name: &str) {
        self.fixed(name, 1, 8, 32);
    }

    fn fx2(&mut self, name: &str) {
        self.fixed(name, 2, 8, 32);
    }

    fn count(&mut self, name: &str) -> u64 {
        self.u64(&format!("number of {name}:"))
    }

    fn handle(&mut self, name: &str) -> (u32, u32) {
        (self.u32(&format!("{name}: slot")), self.u32(&format!("{name}: generation")))
    }

    fn config(&mut self) {
        self.u32("ticks per second");
        self.fx2("gravity");
        self.u32("sub-steps");
        self.u32("iterations");
        match self.u32("contact tuning: variant") {
            0 => ["hertz", "damping ratio", "push speed"].map(|name| self.fx(name)),
            _ => ["share", "slop", "push speed"].map(|name| self.fx(name)),
        };
        for name in ["joint hertz", "joint damping ratio", "restitution threshold", "speed limit"] {
            self.fx(name);
        }
        self.fx("speculative distance");
        self.fx("fat margin");
        for name in ["body limit", "shape limit", "joint limit", "pair limit"] {
            self.u32(name);
        }
    }

    fn arena(&mut self, name: &str, value: fn(&mut Self)) {
        for slot in 0..self.count(&format!("{name} slots")) {
            self.u32(&format!("{name} slot {slot}: generation"));
            if self.u8("occupied") == 1 {
                value(self);
            }
        }
        for _ in 0..self.count(&format!("free {name} slots")) {
            self.u32("free slot");
        }
        self.u32(&format!("{name} slots used up"));
    }

    fn body(&mut self) {
        self.u32("kind");
        self.fx2("centre of mass");
        self.u32("angle");
        self.fixed("velocity", 2, 4, 21);
        self.fixed("spin", 1, 4, 21);
        self.fx2("force");
        self.fx("torque");
        if self.u32("mass source: variant") == 1 {
            self.fx("given mass");
            self.fx2("given centre of mass");
            self.fx("given radius of gyration");
        }
        self.fx("mass");
        self.fx2("centre of mass in the body's frame");
        self.fx("radius of gyration");
        self.i32("its reciprocal: mantissa");
        self.u32("its reciprocal: shift");
        for name in ["linear damping", "angular damping", "gravity scale"] {
            self.fx(name);
        }
        for _ in 0..self.count("shapes") {
            self.handle("shape");
        }
        self.u64("user data");
    }

    fn shape(&mut self) {
        self.handle("body");
        match self.u32("geometry: variant") {
            0 => self.fx("radius"),
            1 => {
                self.fx2("one end");
                self.fx2("other end");
            }
            _ => {
                for _ in 0..self.count("vertices") {
                    self.fixed("vertex", 2, 4, 22);
                }
                self.fixed("rounding radius", 1, 4, 22);
            }
        }
        self.fx2("offset");
        self.fx("density");
        self.fx("friction");
        self.u32("friction mixing");
        self.fx("restitution");
        self.u32("restitution mixing");
        self.u64("filter: category");
        self.u64("filter: mask");
        self.i32("filter: group");
        self.u64("user data");
        self.fx2("fat box: lower corner");
        self.fx2("fat box: upper corner");
    }

    fn joint(&mut self) {
        assert_eq!(self.u32("joint: variant"), 0, "a hinge");
        self.handle("body A");
        self.handle("body B");
        self.fx2("anchor in A's frame");
        self.fx2("anchor in B's frame");
        self.u8("the bodies collide");
        self.fixed("impulse L", 2, 4, 21);
    }

    fn contacts(&mut self) {
        for _ in 0..self.count("contacts") {
            self.u32("slot of shape A");
            self.u32("slot of shape B");
            self.u8("touching");
            self.u8("points with impulses");
            for _ in 0..2 {
                self.u16("feature");
                self.fixed("normal impulse", 1, 4, 21);
                self.fixed("tangential impulse", 1, 4, 21);
            }
        }
        self.u8("pairs were left out");
        for _ in 0..self.count("contacts that ended by removal") {
            self.handle("shape A");
            self.handle("shape B");
        }
    }

    /// The whole file; the result says which bytes each section of the state is.
    fn world(&mut self) -> Vec<(Section, Range<usize>)> {
        self.take(8, "magic, LS2DWRLD", |_| String::new());
        assert_eq!(self.u32("format version"), 1);
        assert_eq!(self.u32("semantics id"), lockstep2d::SEMANTICS);
        let length = self.u64("bytes of the state");
        let start = self.at;
        let mut sections = Vec::new();
        let mut end_section = |section, at| {
            let from = sections.last().map_or(start, |(_, range): &(Section, Range<usize>)| range.end);
            sections.push((section, from..at));
        };
        self.config();
        self.u64("tick");
        self.u64("faults");
        end_section(Section::World, self.at);
        self.arena("body", Self::body);
        end_section(Section::Bodies, self.at);
        self.arena("shape", Self::shape);
        end_section(Section::Shapes, self.at);
        self.arena("joint", Self::joint);
        end_section(Section::Joints, self.at);
        self.contacts();
        end_section(Section::Contacts, self.at);
        self.u64("random numbers: state");
        self.u64("random numbers: increment");
        end_section(Section::Random, self.at);
        assert_eq!((self.at - start) as u64, length);
        let hash = StateHash::of_bytes(&self.bytes[..self.at]);
        let stored = self.take(16, "hash of all bytes before it", |_| String::new());
        assert_eq!(stored, hash.0.to_le_bytes());
        assert_eq!(self.at, self.bytes.len(), "nothing follows");
        sections
    }
}

/// `bits / 2^fraction_bits` in decimal with at most six digits after the point, towards zero.
fn decimal(bits: i64, fraction_bits: u32) -> String {
    let sign = if bits < 0 { "-" } else { "" };
    let micro = (u128::from(bits.unsigned_abs()) * 1_000_000) >> fraction_bits;
    let text = format!("{}.{:06}", micro / 1_000_000, micro % 1_000_000);
    format!("{sign}{}", text.trim_end_matches('0').trim_end_matches('.'))
}

/// A ball that is pinned where it rests on a line, and the free slots that a removed triangle has left.
fn example() -> Result<World, WorldError> {
    let config =
        Config { body_limit: 100, shape_limit: 100, joint_limit: 100, pair_limit: 100, ..Config::default() };
    let mut world = World::new(config)?;
    let line = Geometry::segment(Vec2::new(fx!(-2), fx!(0)), Vec2::new(fx!(2), fx!(0)))?;
    let ground = world.spawn(&BodyDef::fixed(), &[ShapeDef::new(line)])?;
    let triangle = ShapeDef::new(Polygon::regular(3, fx!(1))?);
    let removed = world.spawn(&BodyDef::dynamic(), &[triangle])?;
    let ball = ShapeDef::new(Geometry::circle(fx!(0.5))?).user_data(7);
    let ball = world.spawn(&BodyDef::dynamic().position(fx!(1), fx!(0.5)), &[ball])?;
    world.despawn(removed)?;
    world.add_joint(&JointDef::new(ground, ball, Revolute::new()).anchor_a(fx!(1), fx!(0.5)).colliding())?;
    world.step();
    world.step();
    Ok(world)
}

#[test]
fn the_bytes_of_a_world_are_those_of_the_document() {
    let world = example().expect("a valid world");
    let bytes = world.to_bytes();
    let mut reader = Reader { bytes: &bytes, at: 0, listing: String::new() };
    reader.world();
    let document = include_str!("../docs/FORMAT.md");
    let (_, rest) = document.split_once("```hex world\n").expect("an example in the document");
    let (documented, _) = rest.split_once("```").expect("an end of the example");
    assert!(
        documented == reader.listing,
        "the example in docs/FORMAT.md is no longer what is written. If the layout was meant to change, raise the \
         format version of snapshots; if the arithmetic was, raise SEMANTICS; then put this there:\n{}",
        reader.listing
    );
    assert_eq!(World::from_bytes(&bytes).map(|world| world.state_hash()), Ok(world.state_hash()));
}

#[test]
fn the_state_hash_is_made_of_the_sections_bytes() {
    let mut scenes: Vec<World> = vec![example().expect("a valid world")];
    for name in ["hundred_polygons", "pendulum", "slope"] {
        let scene = lockstep2d::scenes::Scene::find(name).expect("a scene");
        let mut game = Sandbox::new(&scene.setup(1)).expect("a valid scene");
        for tick in 0..90 {
            game.step(&[scene.commands(tick, &game)]);
        }
        let refused = StateHash::of_bytes(&game.refused().to_le_bytes());
        let expected = hash_of_hashes(&[game.world().state_hash(), refused]);
        assert_eq!(game.state_hash(), expected, "the sandbox binds its count of refused commands");
        scenes.push(game.world().clone());
    }
    for world in scenes {
        let bytes = world.to_bytes();
        let mut reader = Reader { bytes: &bytes, at: 0, listing: String::new() };
        let sections = reader.world();
        let digests: Vec<_> = sections
            .into_iter()
            .map(|(section, range)| (section, StateHash::of_bytes(&bytes[range])))
            .collect();
        assert_eq!(digests, world.digest().sections);
        let hashes: Vec<_> = digests.into_iter().map(|(_, digest)| digest).collect();
        assert_eq!(world.state_hash(), hash_of_hashes(&hashes));
    }
}

fn hash_of_hashes(hashes: &[StateHash]) -> StateHash {
    let bytes: Vec<u8> = hashes.iter().flat_map(|hash| hash.0.to_le_bytes()).collect();
    StateHash::of_bytes(&bytes)
}

/// Bytes written by the tables of the document.
#[derive(Default)]
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

    /// World quantities, in halves.
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

    fn then(mut self, other: Written) -> Self {
        self.0.extend(other.0);
        self
    }
}

fn w() -> Written {
    Written::default()
}

/// Handles of a world that has had two bodies with a shape in the same slot, and a joint.
fn handles() -> Result<(BodyId, ShapeId, JointId, BodyId), WorldError> {
    let mut world = World::default();
    let ball = ShapeDef::new(Geometry::circle(fx!(1))?);
    let other = world.spawn(&BodyDef::fixed(), &[])?;
    let first = world.spawn(&BodyDef::dynamic(), &[ball])?;
    world.despawn(first)?;
    let body = world.spawn(&BodyDef::dynamic(), &[ball])?;
    let joint = world.add_joint(&JointDef::new(other, body, Revolute::new()))?;
    let shape = world.body(body).expect("just spawned").shapes()[0];
    Ok((body, shape, joint, other))
}

#[test]
fn the_bytes_of_commands_are_those_of_the_document() {
    let (body, shape, joint, other) = handles().expect("a valid world");
    let vector = Vec2::new(fx!(1), fx!(-0.5));
    let material = Material {
        friction: fx!(0.5),
        friction_mixing: Mixing::Minimum,
        restitution: fx!(1),
        restitution_mixing: Mixing::Product,
        ..Material::default()
    };
    let filter = Filter { category: 4, mask: 5, group: -6 };
    let corners = [Vec2::new(fx!(0), fx!(0)), Vec2::new(fx!(2), fx!(0)), Vec2::new(fx!(0), fx!(2))];
    let triangle = Polygon::new(&corners).and_then(|polygon| polygon.rounded(fx!(0.5))).expect("a triangle");
    let polygon = ShapeDef { material, ..ShapeDef::new(triangle) }.filter(filter).offset(fx!(3), fx!(4));
    let polygon_bytes = || {
        let one = 1 << 22;
        let geometry = w().u32(2).u64(3).i32(&[0, 0, 2 * one, 0, 0, 2 * one]).i32(&[one / 2]);
        let surface = w().fx(&[1]).u32(2).fx(&[2]).u32(3);
        geometry.fx(&[6, 8]).fx(&[2]).then(surface).u64(4).u64(5).i32(&[-6]).u64(9)
    };
    let polygon = polygon.user_data(9);
    let mass = MassSource::Given { mass: fx!(2), centre: vector, gyration: fx!(0.5) };
    let def = BodyDef::kinematic().position(fx!(5), fx!(6)).angle(Angle::from_bits(7)).mass(mass);
    let def = def.velocity(fx!(1), fx!(2)).angular_velocity(fx!(3)).linear_damping(fx!(4)).user_data(8);
    let def_bytes =
        w().u32(1).fx(&[10, 12]).u32(7).fx(&[2, 4, 6]).u32(1).fx(&[4, 2, -1, 1]).fx(&[8, 0, 2]).u64(8);
    let hinge = JointDef::new(other, body, Revolute::new())
        .anchor_a(fx!(1), fx!(2))
        .anchor_b(fx!(3), fx!(4))
        .colliding();

    let id = || w().u32(1).u32(1);
    let shape_id = || w().u32(0).u32(1);
    let cases = [
        (
            Command::Spawn { body: def, shapes: vec![polygon] },
            w().u32(0).then(def_bytes).u64(1).then(polygon_bytes()),
        ),
        (Command::Despawn { body }, w().u32(1).then(id())),
        (Command::AddShape { body, shape: polygon }, w().u32(2).then(id()).then(polygon_bytes())),
        (Command::RemoveShape { shape }, w().u32(3).then(shape_id())),
        (
            Command::AddJoint { joint: hinge },
            w().u32(4).u32(0).u32(0).u32(0).then(id()).fx(&[2, 4, 6, 8]).u8(1),
        ),
        (Command::RemoveJoint { joint }, w().u32(5).u32(0).u32(0)),
        (
            Command::ApplyForce { body, force: vector, point: vector },
            w().u32(6).then(id()).fx(&[2, -1, 2, -1]),
        ),
        (Command::ApplyTorque { body, torque: fx!(1) }, w().u32(7).then(id()).fx(&[2])),
        (
            Command::ApplyImpulse { body, impulse: vector, point: vector },
            w().u32(8).then(id()).fx(&[2, -1, 2, -1]),
        ),
        (Command::ApplyAngularImpulse { body, impulse: fx!(1) }, w().u32(9).then(id()).fx(&[2])),
        (
            Command::SetVelocity { body, velocity: vector, angular_velocity: fx!(3) },
            w().u32(10).then(id()).fx(&[2, -1, 6]),
        ),
        (
            Command::SetTransform { body, position: vector, angle: Angle::from_bits(9) },
            w().u32(11).then(id()).fx(&[2, -1]).u32(9),
        ),
        (Command::SetGravity { gravity: vector }, w().u32(12).fx(&[2, -1])),
    ];
    for (command, expected) in &cases {
        assert_eq!(encode(command), expected.0, "{command:?}");
    }
    let inputs: Vec<Command> = cases.iter().map(|(command, _)| command.clone()).collect();
    let all = cases.into_iter().fold(w().u64(13), |all, (_, bytes)| all.then(bytes));
    assert_eq!(encode(&inputs), all.0, "an input of the sandbox");
}

#[test]
fn the_bytes_of_a_setup_are_those_of_the_document() {
    let solver = SolverSettings {
        contact: ContactTuning::Baumgarte { share: fx!(0.5), slop: fx!(1), push_speed: fx!(3) },
        ..SolverSettings::default()
    };
    let config = Config { solver, fat_margin: fx!(0.5), speculative_distance: fx!(0.5), ..Config::default() };
    let setup = SandboxSetup { config, commands: vec![Command::SetGravity { gravity: Vec2::ZERO }] };
    let settings = w().u32(4).u32(1).u32(1).fx(&[1, 2, 6]).fx(&[120, 4, 2, 800]);
    let limits = w().u32(1 << 20).u32(1 << 20).u32(1 << 20).u32(1 << 18);
    let expected = w().u32(60).fx(&[0, -20]).then(settings).fx(&[1, 1]).then(limits);
    assert_eq!(encode(&setup), expected.u64(1).u32(12).fx(&[0, 0]).0);
}
