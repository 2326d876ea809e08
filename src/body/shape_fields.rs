//! Encoding of a shape definition, with the sensor flag and the area in one field. In binary formats, this field is a
//! byte of flags (1 for a sensor, 2 for an area), followed by the area if there is one. Without an area, the byte
//! equals the encoding of a `bool`.

#[cfg(test)]
mod tests;

use core::fmt;

use serde::de::{Error, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::area::Area;
use super::event_switches::EventSwitches;
use super::filter::Filter;
use super::geometry::Geometry;
use super::material::Material;
use super::shape::ShapeDef;
use crate::math::{Angle, Fx, Vec2};

const SENSOR: u8 = 1;
const AREA: u8 = 2;

#[derive(Serialize, Deserialize)]
#[serde(rename = "ShapeDef")]
pub(super) struct ShapeFields {
    geometry: Geometry,
    offset: Vec2<Fx>,
    density: Fx,
    material: Material,
    filter: Filter,
    one_way: Option<Angle>,
    sensor: Detection,
    events: EventSwitches,
    user_data: u64,
}

struct Detection {
    sensor: bool,
    area: Option<Area>,
}

/// Form of the field in human-readable formats.
#[derive(Serialize, Deserialize)]
#[serde(untagged)]
enum Readable {
    Plain(bool),
    WithArea { sensor: bool, area: Area },
}

impl From<ShapeDef> for ShapeFields {
    fn from(def: ShapeDef) -> Self {
        let ShapeDef {
            geometry,
            offset,
            density,
            material,
            filter,
            one_way,
            sensor,
            area,
            events,
            user_data,
        } = def;
        let sensor = Detection { sensor, area };
        ShapeFields { geometry, offset, density, material, filter, one_way, sensor, events, user_data }
    }
}

impl From<ShapeFields> for ShapeDef {
    fn from(fields: ShapeFields) -> Self {
        let ShapeFields { geometry, offset, density, material, filter, one_way, sensor, events, user_data } =
            fields;
        let Detection { sensor, area } = sensor;
        ShapeDef { geometry, offset, density, material, filter, one_way, sensor, area, events, user_data }
    }
}

impl Serialize for Detection {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let Detection { sensor, area } = *self;
        if serializer.is_human_readable() {
            let plain = Readable::Plain(sensor);
            return area.map_or(plain, |area| Readable::WithArea { sensor, area }).serialize(serializer);
        }
        let flag = u8::from(sensor) * SENSOR;
        match area {
            None => (flag,).serialize(serializer),
            Some(area) => (flag | AREA, area).serialize(serializer),
        }
    }
}

impl<'de> Deserialize<'de> for Detection {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        if deserializer.is_human_readable() {
            return Ok(match Readable::deserialize(deserializer)? {
                Readable::Plain(sensor) => Detection { sensor, area: None },
                Readable::WithArea { sensor, area } => Detection { sensor, area: Some(area) },
            });
        }
        deserializer.deserialize_tuple(2, DetectionBytes)
    }
}

struct DetectionBytes;

impl<'de> Visitor<'de> for DetectionBytes {
    type Value = Detection;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "the flags of a sensor, and its area")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut parts: A) -> Result<Detection, A::Error> {
        let missing = || A::Error::custom("a sensor without flags or area");
        let flags: u8 = parts.next_element()?.ok_or_else(missing)?;
        if flags & !(SENSOR | AREA) != 0 {
            return Err(A::Error::custom("unknown flags of a sensor"));
        }
        let area = match flags & AREA {
            0 => None,
            _ => Some(parts.next_element()?.ok_or_else(missing)?),
        };
        Ok(Detection { sensor: flags & SENSOR != 0, area })
    }
}
