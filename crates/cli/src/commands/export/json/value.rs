//! Converts any value to JSON. `serde_json` alone would refuse integers of more than 64 bits, and maps whose keys are
//! structs or tuples.

use lockstep2d::inspect::{self, Field, fields};
use serde::ser::{self, Serialize, Serializer};
use serde_json::{Error, Map, Value, value};

/// Converts a value like [`serde_json::to_value`], with a decimal beside the bits of each fixed-point number. An integer
/// of more than 64 bits becomes text. A map key that is not a string, number or boolean becomes a string with its JSON.
pub(super) fn json<T: Serialize + ?Sized>(value: &T) -> Result<Value, Error> {
    let mut json = value.serialize(ToJson)?;
    if let Value::Object(entries) = &mut json
        && entries.len() == 1
        && entries.contains_key("bits")
        && let Ok([Field { value: number @ inspect::Value::Fixed { .. }, .. }]) = fields(value).as_deref()
    {
        entries.extend(number.decimal().map(|decimal| ("decimal".into(), decimal.into())));
    }
    Ok(json)
}

fn key<T: Serialize + ?Sized>(key: &T) -> Result<String, Error> {
    Ok(match json(key)? {
        Value::String(text) => text,
        other => other.to_string(),
    })
}

/// The value itself, or for an enum variant an object with the name of the variant as its key.
fn named(variant: Option<&str>, value: Value) -> Value {
    match variant {
        Some(name) => Map::from_iter([(name.into(), value)]).into(),
        None => value,
    }
}

struct ToJson;

struct Elements {
    variant: Option<&'static str>,
    elements: Vec<Value>,
}

struct Entries {
    variant: Option<&'static str>,
    entries: Map<String, Value>,
    key: String,
}

impl Entries {
    fn new(variant: Option<&'static str>) -> Self {
        Entries { variant, entries: Map::new(), key: String::new() }
    }
}

macro_rules! leaves {
    ($($method:ident $leaf:ty,)*) => {
        $(fn $method(self, leaf: $leaf) -> Result<Value, Error> {
            value::Serializer.$method(leaf)
        })*
    };
}

macro_rules! lists {
    ($($of:ident $method:ident,)*) => {
        $(impl ser::$of for Elements {
            type Ok = Value;
            type Error = Error;

            fn $method<T: Serialize + ?Sized>(&mut self, value: &T) -> Result<(), Error> {
                self.elements.push(json(value)?);
                Ok(())
            }

            fn end(self) -> Result<Value, Error> {
                Ok(named(self.variant, self.elements.into()))
            }
        })*
    };
}

macro_rules! structs {
    ($($of:ident)*) => {
        $(impl ser::$of for Entries {
            type Ok = Value;
            type Error = Error;

            fn serialize_field<T: Serialize + ?Sized>(
                &mut self,
                name: &'static str,
                value: &T,
            ) -> Result<(), Error> {
                self.entries.insert(name.into(), json(value)?);
                Ok(())
            }

            fn end(self) -> Result<Value, Error> {
                Ok(named(self.variant, self.entries.into()))
            }
        })*
    };
}

lists! {
    SerializeSeq serialize_element,
    SerializeTuple serialize_element,
    SerializeTupleStruct serialize_field,
    SerializeTupleVariant serialize_field,
}

structs! { SerializeStruct SerializeStructVariant }

impl ser::SerializeMap for Entries {
    type Ok = Value;
    type Error = Error;

    fn serialize_key<T: Serialize + ?Sized>(&mut self, name: &T) -> Result<(), Error> {
        self.key = key(name)?;
        Ok(())
    }

    fn serialize_value<T: Serialize + ?Sized>(&mut self, value: &T) -> Result<(), Error> {
        self.entries.insert(std::mem::take(&mut self.key), json(value)?);
        Ok(())
    }

    fn end(self) -> Result<Value, Error> {
        Ok(self.entries.into())
    }
}

impl Serializer for ToJson {
    type Ok = Value;
    type Error = Error;
    type SerializeSeq = Elements;
    type SerializeTuple = Elements;
    type SerializeTupleStruct = Elements;
    type SerializeTupleVariant = Elements;
    type SerializeMap = Entries;
    type SerializeStruct = Entries;
    type SerializeStructVariant = Entries;

    leaves! {
        serialize_bool bool,
        serialize_u8 u8,
        serialize_u16 u16,
        serialize_u32 u32,
        serialize_u64 u64,
        serialize_i8 i8,
        serialize_i16 i16,
        serialize_i32 i32,
        serialize_i64 i64,
        serialize_char char,
        serialize_str &str,
        serialize_bytes &[u8],
        serialize_unit_struct &'static str,
    }

    fn serialize_u128(self, number: u128) -> Result<Value, Error> {
        Ok(u64::try_from(number).map_or_else(|_| number.to_string().into(), Value::from))
    }

    fn serialize_i128(self, number: i128) -> Result<Value, Error> {
        match u128::try_from(number) {
            Ok(number) => self.serialize_u128(number),
            Err(_) => Ok(i64::try_from(number).map_or_else(|_| number.to_string().into(), Value::from)),
        }
    }

    #[expect(clippy::disallowed_types, reason = "the trait requires this method")]
    fn serialize_f32(self, number: f32) -> Result<Value, Error> {
        value::Serializer.serialize_f32(number)
    }

    #[expect(clippy::disallowed_types, reason = "the trait requires this method")]
    fn serialize_f64(self, number: f64) -> Result<Value, Error> {
        value::Serializer.serialize_f64(number)
    }

    fn serialize_none(self) -> Result<Value, Error> {
        Ok(Value::Null)
    }

    fn serialize_some<T: Serialize + ?Sized>(self, value: &T) -> Result<Value, Error> {
        json(value)
    }

    fn serialize_unit(self) -> Result<Value, Error> {
        Ok(Value::Null)
    }

    fn serialize_unit_variant(self, _: &'static str, _: u32, name: &'static str) -> Result<Value, Error> {
        Ok(name.into())
    }

    fn serialize_newtype_struct<T: Serialize + ?Sized>(
        self,
        _: &'static str,
        value: &T,
    ) -> Result<Value, Error> {
        json(value)
    }

    fn serialize_newtype_variant<T: Serialize + ?Sized>(
        self,
        _: &'static str,
        _: u32,
        name: &'static str,
        value: &T,
    ) -> Result<Value, Error> {
        Ok(named(Some(name), json(value)?))
    }

    fn serialize_seq(self, _: Option<usize>) -> Result<Elements, Error> {
        Ok(Elements { variant: None, elements: Vec::new() })
    }

    fn serialize_tuple(self, _: usize) -> Result<Elements, Error> {
        self.serialize_seq(None)
    }

    fn serialize_tuple_struct(self, _: &'static str, _: usize) -> Result<Elements, Error> {
        self.serialize_seq(None)
    }

    fn serialize_map(self, _: Option<usize>) -> Result<Entries, Error> {
        Ok(Entries::new(None))
    }

    fn serialize_struct(self, _: &'static str, _: usize) -> Result<Entries, Error> {
        Ok(Entries::new(None))
    }

    fn serialize_tuple_variant(
        self,
        _: &'static str,
        _: u32,
        name: &'static str,
        _: usize,
    ) -> Result<Elements, Error> {
        Ok(Elements { variant: Some(name), elements: Vec::new() })
    }

    fn serialize_struct_variant(
        self,
        _: &'static str,
        _: u32,
        name: &'static str,
        _: usize,
    ) -> Result<Entries, Error> {
        Ok(Entries::new(Some(name)))
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use lockstep2d::fx;
    use lockstep2d::math::Fx;
    use serde_json::json;

    #[derive(serde::Serialize)]
    enum Kind {
        Plain,
        New(u8),
        Pair(u8, Option<Fx>),
        Fields { a: (), b: Vec<Kind> },
    }

    #[test]
    fn every_kind_of_value_has_the_json_of_serde() {
        let kinds =
            || vec![Kind::Plain, Kind::New(1), Kind::Pair(2, None), Kind::Fields { a: (), b: vec![] }];
        let kinds = Kind::Fields { a: (), b: kinds() };
        let integers = (u8::MAX, i16::MIN, i64::MIN, u64::MAX, u128::from(u64::MAX), i128::from(i64::MIN));
        let maps =
            (BTreeMap::from([(1u8, 'a')]), BTreeMap::from([('b', true)]), BTreeMap::from([(true, "c")]));
        let value = (kinds, integers, maps, Some(Some(5)), [1u8, 2]);
        assert_eq!(super::json(&value).unwrap(), serde_json::to_value(&value).unwrap());
    }

    #[test]
    fn values_that_serde_refuses_have_json_too() {
        let wide = (u128::MAX, i128::MIN, i128::from(u64::MAX));
        let expected = (u128::MAX.to_string(), i128::MIN.to_string(), u64::MAX);
        assert_eq!(super::json(&wide).unwrap(), json!(expected));
        let map = BTreeMap::from([((1, -2), 3)]);
        assert_eq!(super::json(&map).unwrap(), json!({"[1,-2]": 3}));
        let map = BTreeMap::from([(fx!(0.5), Kind::Pair(0, Some(fx!(2))))]);
        let number = json!({"bits": 8589934592i64, "decimal": "2"});
        let expected = json!({r#"{"bits":2147483648,"decimal":"0.5"}"#: {"Pair": [0, number]}});
        assert_eq!(super::json(&map).unwrap(), expected);
    }
}
