use super::super::area::Falloff;
use super::*;
use crate::codec::{decode, encode};
use crate::fx;

fn shape() -> ShapeDef {
    ShapeDef::new(Geometry::circle(fx!(1)).unwrap())
}

#[test]
fn shapes_come_back_with_every_mixture_of_sensor_and_area() {
    let area = Area::fluid(fx!(2)).attraction(fx!(3), fx!(4), Falloff::Inverse);
    for sensor in [false, true] {
        for area in [None, Some(area)] {
            let def = ShapeDef { sensor, area, ..shape() };
            assert_eq!(decode::<ShapeDef>(&encode(&def)), Ok(def));
        }
    }
}

/// Flags 2 and 3 are rejected too, because they announce an area that these bytes lack.
#[test]
fn unknown_flags_are_refused() {
    let solid = encode(&shape());
    let differs = |other: &ShapeDef| {
        let other = encode(other);
        let at: alloc::vec::Vec<_> = (0..solid.len()).filter(|&at| solid[at] != other[at]).collect();
        assert_eq!((at.len(), solid.len()), (1, other.len()));
        at[0]
    };
    let at = differs(&shape().sensor());
    for flags in 0..=u8::MAX {
        let mut bytes = solid.clone();
        bytes[at] = flags;
        assert_eq!(decode::<ShapeDef>(&bytes).is_ok(), flags < 2, "flags {flags}");
    }
}
