use alloc::collections::BTreeMap;
use alloc::string::{String, ToString};
use alloc::vec;
use alloc::vec::Vec;

use serde::Serialize;

use super::{Field, InspectError, Value, differences, fields};
use crate::math::{Angle, FrictionRatio, Fx, Length, Rate, Ratio, Shift, Speed, Step, Unit, Vec2};

#[derive(Clone, Serialize)]
enum Kind {
    Plain,
    One(u8),
    Two(u8, bool),
    Named { x: i8 },
}

#[derive(Clone, Serialize)]
struct Everything {
    small: u8,
    wide: i128,
    bit: bool,
    text: String,
    place: Vec2<Fx>,
    speed: Speed,
    angle: Angle,
    maybe: Option<Option<u8>>,
    list: Vec<u16>,
    map: BTreeMap<(u8, i8), Vec2<Speed>>,
    kind: Kind,
    pair: (char, ()),
}

fn everything() -> Everything {
    Everything {
        small: 1,
        wide: -2,
        bit: true,
        text: "a\"b".into(),
        place: Vec2::new(Fx::lit("1.5"), Fx::lit("-2")),
        speed: Speed::lit("0.25"),
        angle: Angle::QUARTER,
        maybe: Some(Some(3)),
        list: vec![4, 5],
        map: BTreeMap::from([((6, -7), Vec2::new(Speed::ZERO, Speed::DELTA))]),
        kind: Kind::Two(8, false),
        pair: ('z', ()),
    }
}

fn of<T: Serialize>(value: &T) -> Vec<Field> {
    fields(value).expect("serialization should succeed")
}

fn lines<T: Serialize>(value: &T) -> Vec<String> {
    of(value).iter().map(|field| alloc::format!("{} = {}", field.path(), field.value)).collect()
}

#[test]
fn every_kind_of_value_has_its_fields() {
    let expected = [
        "small = 1",
        "wide = -2",
        "bit = true",
        "text = \"a\\\"b\"",
        "place.x = 1.5 (bits 6442450944)",
        "place.y = -2 (bits -8589934592)",
        "speed = 0.25 (bits 524288)",
        "angle = 90 degrees (bits 1073741824)",
        "maybe = 3",
        "list[0] = 4",
        "list[1] = 5",
        "map.6, -7.x = 0 (bits 0)",
        "map.6, -7.y = 0.0000005 (bits 1)",
        "kind = Two",
        "kind[0] = 8",
        "kind[1] = false",
        "pair[0] = \"z\"",
        "pair[1] = empty",
    ];
    assert_eq!(lines(&everything()), expected);
    assert_eq!(lines(&5u8), [" = 5"]);
    assert_eq!(lines(&Kind::Named { x: -1 }), [" = Named", "x = -1"]);
    assert_eq!(lines(&Kind::One(1)), [" = One", "One = 1"]);
}

#[test]
fn every_format_is_known_by_its_fraction_bits() {
    fn bits<T: Serialize>(value: T) -> Option<u32> {
        match of(&value)[0].value {
            Value::Fixed { fraction_bits, .. } => fraction_bits,
            ref other => panic!("expected a fixed-point number, got {other:?}"),
        }
    }
    let found = [
        bits(Fx::ZERO),
        bits(Length::ZERO),
        bits(Speed::ZERO),
        bits(Step::ZERO),
        bits(Shift::ZERO),
        bits(Unit::ZERO),
        bits(Ratio::ZERO),
        bits(Rate::ZERO),
        bits(FrictionRatio::ZERO),
        bits([Fx::ZERO]),
        bits(fixed::types::I64F0::ZERO),
    ];
    assert_eq!(found, [32, 22, 21, 27, 26, 30, 24, 18, 20, 32, 0].map(Some));
}

#[test]
fn every_change_is_found_where_it_is() {
    let before = everything();
    assert!(differences(&of(&before), &of(&before)).is_empty());
    type Change = fn(&mut Everything);
    let changes: &[(&str, Change)] = &[
        ("small: 1 | 2", |value| value.small = 2),
        ("wide: -2 | -3", |value| value.wide = -3),
        ("bit: true | false", |value| value.bit = false),
        ("place.y: -2 (bits -8589934592) | -1.9999999998 (bits -8589934591)", |value| {
            value.place.y += Fx::DELTA;
        }),
        ("maybe: 3 | some none", |value| value.maybe = Some(None)),
        ("maybe: 3 | none", |value| value.maybe = None),
        ("list[2]: nothing | 6", |value| value.list.push(6)),
        ("list[1]: 5 | nothing", |value| value.list.truncate(1)),
        ("map.6, -7.x: 0 (bits 0) | 0.0000005 (bits 1)", |value| {
            value.map.values_mut().for_each(|v| v.x = Speed::DELTA);
        }),
        ("kind[1]: false | true", |value| value.kind = Kind::Two(8, true)),
        ("kind: Two | Plain; kind[0]: 8 | nothing; kind[1]: false | nothing", |value| {
            value.kind = Kind::Plain;
        }),
        ("list[0]: 4 | nothing; list[1]: 5 | nothing; list: nothing | empty", |value| value.list.clear()),
    ];
    for (expected, change) in changes {
        let mut after = before.clone();
        change(&mut after);
        let found = differences(&of(&before), &of(&after));
        let found: Vec<String> = found.iter().map(ToString::to_string).collect();
        assert_eq!(found.join("; "), *expected);
    }
}

#[test]
fn what_only_the_second_has_stands_where_it_has_it() {
    let map = |names: &[&str]| names.iter().map(|name| (name.to_string(), 0)).collect::<BTreeMap<_, u8>>();
    let found = differences(&of(&map(&["b", "d", "e"])), &of(&map(&["a", "b", "c", "e", "f"])));
    let paths: Vec<&str> = found.iter().map(|difference| difference.field().path()).collect();
    assert_eq!(paths, ["a", "d", "c", "f"]);
}

#[test]
fn a_field_knows_its_thing_and_its_section() {
    #[derive(Serialize)]
    struct World {
        bodies: BTreeMap<String, BTreeMap<String, Vec2<u8>>>,
        tick: [u8; 1],
    }
    let inner = BTreeMap::from([("velocity".to_string(), Vec2::new(1, 2))]);
    let world = World { bodies: BTreeMap::from([("body 1v0".to_string(), inner)]), tick: [3] };
    let found = of(&(0u8, world));
    let parts = |at: usize| (found[at].section(), found[at].subject(), found[at].name());
    assert_eq!(parts(0), ("", None, "[0]"));
    assert_eq!(parts(1), ("[1].bodies", Some("[1].bodies.body 1v0"), "velocity.x"));
    assert_eq!(parts(3), ("", None, "[1].tick[0]"));
}

#[test]
fn depth_is_limited() {
    #[derive(Serialize)]
    struct Chain(Option<alloc::boxed::Box<Chain>>);
    let mut chain = Chain(None);
    for _ in 0..10_000 {
        chain = Chain(Some(alloc::boxed::Box::new(chain)));
    }
    assert!(matches!(fields(&chain), Err(InspectError { why }) if why.contains("deep")));
    // Drops the chain iteratively, because the derived drop would recurse to the full depth.
    while let Some(next) = chain.0.take() {
        chain = *next;
    }
}

/// A struct whose name begins like that of a fixed-point number, and a key of a map, count as levels of nesting. Each
/// level is serialized once.
#[test]
fn depth_is_limited_in_structs_and_keys_of_every_name() {
    #[derive(Serialize)]
    struct FixedIcon {
        child: Option<alloc::boxed::Box<FixedIcon>>,
    }
    #[derive(PartialEq, Eq, PartialOrd, Ord, Serialize)]
    struct Key(BTreeMap<Key, u8>);
    let icon = |levels| {
        (1..levels).fold(FixedIcon { child: None }, |icon, _| FixedIcon { child: Some(icon.into()) })
    };
    let key = |levels| (1..levels).fold(Key(BTreeMap::new()), |key, _| Key(BTreeMap::from([(key, 1)])));
    let deep = |error: InspectError| error.why.contains("deep");
    assert_eq!(lines(&icon(40)), [alloc::format!("{} = some none", ["child"; 40].join("."))]);
    assert!(fields(&icon(5_000)).is_err_and(deep));
    assert_eq!(of(&key(40)).len(), 1);
    assert!(fields(&key(5_000)).is_err_and(deep));
}
