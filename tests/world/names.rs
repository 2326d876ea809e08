//! Names of bodies.

use lockstep2d::body::{BodyDef, Name, WorldError};
use lockstep2d::codec;
use lockstep2d::fx;
use lockstep2d::inspect::{differences, fields};
use lockstep2d::world::World;

use super::{ball, run, spawn, world_with_floor};

fn name(text: &str) -> Name {
    Name::new(text).expect("valid")
}

#[test]
fn a_name_is_letters_digits_and_dashes() {
    for text in ["a", "Ball-2_x", "sixteen_letters_"] {
        assert_eq!(name(text).as_str(), text);
        assert_eq!(format!("{} {:?}", name(text), name(text)), format!("{text} {text:?}"));
    }
    for text in ["", "seventeen_letters", "two words", "dot.", "ä", "a\0b", "<b>"] {
        assert_eq!(Name::new(text), Err(WorldError::NameInvalid), "{text:?}");
    }
}

#[test]
fn names_are_in_snapshots_reports_and_differences() {
    let (mut world, floor) = world_with_floor();
    let falling =
        spawn(&mut world, BodyDef::dynamic().position((fx!(0), fx!(5))).name(name("ball")), ball(fx!(1)));
    assert_eq!(world.body(falling).expect("there").name(), Some(name("ball")));
    assert_eq!(
        (world.body_label(falling), world.body_label(floor)),
        (format!("{falling} ball"), format!("{floor}"))
    );
    let before = world.save();
    run(&mut world, 1);
    let listed = fields(&before).expect("readable");
    assert!(listed.iter().any(|field| field.path().contains(&format!("body {falling} ball"))));
    let found = differences(&fields(&before).expect("readable"), &fields(&world.save()).expect("readable"));
    assert!(format!("{found:?}").contains(&format!("body {falling} ball")), "{found:?}");
    let again = World::from_bytes(&world.to_bytes()).expect("its own bytes");
    assert_eq!(
        (again.body_label(falling), again.state_hash()),
        (world.body_label(falling), world.state_hash())
    );
    world.set_name(falling, None).expect("there");
    assert_ne!(again.state_hash(), world.state_hash());
    assert_eq!(world.body_label(falling), format!("{falling}"));
    world.restore(&before);
    assert_eq!(world.body_label(falling), format!("{falling} ball"));
    assert_eq!(world.validate(), Ok(()));
}

#[test]
fn a_named_body_moves_as_one_without_a_name() {
    let run_with = |name: Option<Name>| {
        let (mut world, _) = world_with_floor();
        let def = BodyDef { name, ..BodyDef::dynamic().position((fx!(0), fx!(5))) };
        let falling = spawn(&mut world, def, ball(fx!(1)));
        run(&mut world, 100);
        world.set_name(falling, None).expect("there");
        world.state_hash()
    };
    assert_eq!(run_with(None), run_with(Some(name("ball"))));
}

/// Decoding accepts any 16 bytes as a name, even bytes that no valid text encodes to. The world refuses such a name.
#[test]
fn invalid_bytes_are_refused_as_a_name() {
    let mut world = World::default();
    for bytes in [[0; 16], *b"two words\0\0\0\0\0\0\0", *b"a\0b\0\0\0\0\0\0\0\0\0\0\0\0\0", [0xff; 16]] {
        let decoded: Name = codec::decode(&bytes).expect("16 bytes");
        let def = BodyDef::fixed().name(decoded);
        assert_eq!(world.spawn(&def, &[]), Err(WorldError::NameInvalid));
        let body = world.spawn(&BodyDef::fixed(), &[]).expect("valid");
        assert_eq!(world.set_name(body, Some(decoded)), Err(WorldError::NameInvalid));
    }
}
