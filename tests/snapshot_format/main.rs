//! The bytes of worlds and commands follow `docs/FORMAT.md`.

mod commands;
mod reader;

use lockstep2d::body::{BodyDef, Geometry, Polygon, ShapeDef, WorldError};
use lockstep2d::fx;
use lockstep2d::hash::StateHash;
use lockstep2d::lockstep::{Game, Sandbox};
use lockstep2d::math::Vec2;
use lockstep2d::solver::{JointDef, Revolute};
use lockstep2d::world::{Config, Section, World};

use reader::Reader;

/// A world with a pinned ball that rests on a line, a sleeping capsule on the line, and the vacant slots of a removed
/// triangle.
fn example() -> Result<World, WorldError> {
    let config =
        Config { body_limit: 100, shape_limit: 100, joint_limit: 100, pair_limit: 100, ..Config::default() };
    let mut world = World::new(config)?;
    let line = Geometry::segment(Vec2::new(fx!(-2), fx!(0)), Vec2::new(fx!(2), fx!(0)))?;
    let ground = world.spawn(&BodyDef::fixed(), &[ShapeDef::new(line)])?;
    let triangle = ShapeDef::new(Polygon::regular(3, fx!(1))?);
    let removed = world.spawn(&BodyDef::dynamic().position((fx!(50), fx!(0))), &[triangle])?;
    let ball = ShapeDef::new(Geometry::circle(fx!(0.5))?).user_data(7);
    let ball = world.spawn(&BodyDef::dynamic().position((fx!(1), fx!(0.5))), &[ball])?;
    let pill = Geometry::capsule(Vec2::new(fx!(-0.5), fx!(0)), Vec2::new(fx!(0.5), fx!(0)), fx!(0.25))?;
    let sleeper = BodyDef::dynamic().position((fx!(-1), fx!(0.25))).asleep();
    world.spawn(&sleeper, &[ShapeDef::new(pill)])?;
    world.despawn(removed)?;
    let hinge = Revolute::new().limit(fx!(-1), fx!(1));
    world.add_joint(&JointDef::new(ground, ball, hinge).anchor_a((fx!(1), fx!(0.5))).colliding())?;
    world.step();
    world.step();
    Ok(world)
}

#[test]
fn the_bytes_of_a_world_are_those_of_the_document() {
    let world = example().expect("a valid world");
    let bytes = world.to_bytes();
    let mut reader = Reader::new(&bytes);
    reader.world();
    let document = include_str!("../../docs/FORMAT.md");
    let (_, rest) = document.split_once("```hex world\n").expect("an example in the document");
    let (documented, _) = rest.split_once("```").expect("an end of the example");
    assert!(
        documented == reader.listing,
        "the example in docs/FORMAT.md differs from the encoding. If the layout change is intended, raise the \
         format version of snapshots; if the arithmetic changed, raise SEMANTICS; then replace it by:\n{}",
        reader.listing
    );
    assert_eq!(World::from_bytes(&bytes).map(|world| world.state_hash()), Ok(world.state_hash()));
}

#[test]
fn the_state_hash_is_made_of_the_sections() {
    let mut scenes: Vec<World> = vec![example().expect("a valid world")];
    for name in ["hundred_polygons", "chain", "game", "ragdoll"] {
        let scene = lockstep2d_scenes::Scene::find(name).expect("a scene");
        let mut game = Sandbox::new(&scene.setup(1)).expect("a valid scene");
        for tick in 0..90 {
            game.step(&[scene.commands(tick, &game)]);
        }
        let refused = StateHash::of_bytes(&game.refused().to_le_bytes());
        let expected = hash_of_hashes(&[game.world().state_hash(), refused]);
        assert_eq!(game.state_hash(), expected, "the hash must include the count of refused commands");
        scenes.push(game.world().clone());
    }
    for world in scenes {
        let bytes = world.to_bytes();
        let mut reader = Reader::new(&bytes);
        let mut sections = reader.world();
        // In the bytes, islands come before contacts. The digests are in the order of `Section`.
        sections.sort_by_key(|(section, _)| *section);
        let read = World::from_bytes(&bytes).expect("what was written");
        assert_eq!(read.digest(), world.digest(), "digests must not depend on earlier saves");
        let digests = world.digest().sections;
        assert!(sections.iter().map(|(section, _)| section).eq(digests.iter().map(|(section, _)| section)));
        // Two sections are hashed as a whole. The others are hashed in pages.
        for ((section, range), (_, digest)) in sections.into_iter().zip(&digests) {
            if matches!(section, Section::World | Section::Random) {
                assert_eq!(*digest, StateHash::of_bytes(&bytes[range]), "{section}");
            }
        }
        let hashes: Vec<_> = digests.iter().map(|(_, digest)| *digest).collect();
        assert_eq!(world.state_hash(), hash_of_hashes(&hashes));
    }
}

fn hash_of_hashes(hashes: &[StateHash]) -> StateHash {
    let bytes: Vec<u8> = hashes.iter().flat_map(|hash| hash.0.to_le_bytes()).collect();
    StateHash::of_bytes(&bytes)
}
