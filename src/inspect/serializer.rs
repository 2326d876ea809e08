use alloc::format;
use alloc::string::{String, ToString};
use alloc::vec::Vec;
use core::any::type_name;
use core::fmt::{self, Display};

use serde::{Serialize, Serializer};

use super::DEPTH_MAX;
use super::compound::Compound;
use super::value::{Field, Value};
use crate::math::Angle;

/// Error of inspecting a value.
///
/// ```
/// use lockstep2d::inspect::{InspectError, fields};
/// /// A value that must not be displayed.
/// struct Secret;
/// impl serde::Serialize for Secret {
///     fn serialize<S: serde::Serializer>(&self, _: S) -> Result<S::Ok, S::Error> {
///         Err(serde::ser::Error::custom("not for display"))
///     }
/// }
/// assert_eq!(fields(&Secret), Err(InspectError { why: "not for display".into() }));
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct InspectError {
    /// Message of the value's `Serialize`, or a message that the value is nested too deep.
    pub why: String,
}

impl fmt::Display for InspectError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "the value cannot be inspected: {}", self.why)
    }
}

impl core::error::Error for InspectError {}

impl serde::ser::Error for InspectError {
    fn custom<T: Display>(why: T) -> Self {
        InspectError { why: why.to_string() }
    }
}

#[derive(Default)]
pub(super) struct Collector {
    fields: Vec<Field>,
    path: String,
    subject: Option<(usize, usize)>,
    depth: u32,
    /// Type name of the current value. It only decides which kind of [`Value`] represents a number.
    kind: &'static str,
}

impl Collector {
    pub(super) fn into_fields(self) -> Vec<Field> {
        self.fields
    }

    pub(super) fn count(&self) -> usize {
        self.fields.len()
    }

    pub(super) fn push(&mut self, value: Value) {
        self.fields.push(Field { path: self.path.clone(), subject: self.subject, value });
    }

    pub(super) fn nested<T: Serialize + ?Sized>(&mut self, value: &T) -> Result<(), InspectError> {
        if self.depth == DEPTH_MAX {
            return Err(InspectError { why: format!("nested deeper than {DEPTH_MAX}") });
        }
        let kind = core::mem::replace(&mut self.kind, type_name::<T>());
        self.depth += 1;
        let result = value.serialize(&mut *self);
        self.depth -= 1;
        self.kind = kind;
        result
    }

    pub(super) fn named<T: Serialize + ?Sized>(&mut self, name: &str, value: &T) -> Result<(), InspectError> {
        self.within(|path| push_name(path, name), value)
    }

    pub(super) fn numbered<T: Serialize + ?Sized>(&mut self, at: u64, value: &T) -> Result<(), InspectError> {
        self.within(|path| path.push_str(&format!("[{at}]")), value)
    }

    /// Adds an entry of a map. An entry of the outermost map is the [`Field::subject`] of the fields in it.
    pub(super) fn entry<T: Serialize + ?Sized>(&mut self, key: &str, value: &T) -> Result<(), InspectError> {
        let (outer, section) = (self.subject, self.path.len());
        let length = section + usize::from(section > 0) + key.len();
        self.subject = outer.or(Some((length, section)));
        let result = self.named(key, value);
        self.subject = outer;
        result
    }

    /// Converts a map key to text: the values of its fields, separated by commas. The nesting depth of the map counts
    /// towards the depth of the key.
    pub(super) fn key<T: Serialize + ?Sized>(&self, key: &T) -> Result<String, InspectError> {
        let mut collector = Collector { depth: self.depth, ..Collector::default() };
        collector.nested(key)?;
        let parts = collector.fields.into_iter().map(|field| match field.value {
            Value::Text(text) => text,
            value => value.to_string(),
        });
        Ok(parts.collect::<Vec<_>>().join(", "))
    }

    /// Replaces the last field, which has the bits of a fixed-point number, by a field with the number. `before` is the
    /// number of fields before it. Leaves numbers of more than 127 bits, and other structs whose name begins with
    /// `FixedI` or `FixedU`, as they are.
    pub(super) fn join_fixed(&mut self, before: usize, fraction_bits: Option<u32>) {
        if let [Field { value, path, .. }] = &mut self.fields[before..]
            && let Some(bits) = value.bits()
        {
            *value = Value::Fixed { bits, fraction_bits };
            path.clone_from(&self.path);
        }
    }

    fn within<T: Serialize + ?Sized>(
        &mut self,
        extend: impl FnOnce(&mut String),
        value: &T,
    ) -> Result<(), InspectError> {
        let length = self.path.len();
        extend(&mut self.path);
        let result = self.nested(value);
        self.path.truncate(length);
        result
    }

    /// Number of fraction bits of the current value, if its type is one of the crate `fixed`. The type name contains
    /// this number as binary digits, `B1` and `B0`.
    pub(super) fn fraction_bits(&self) -> Option<u32> {
        let name = self.kind.trim_start_matches('&').strip_prefix("fixed::")?;
        let digits = name.split(|c: char| !c.is_alphanumeric()).filter_map(|word| match word {
            "B0" => Some(0),
            "B1" => Some(1),
            _ => None,
        });
        let bits = digits.fold(0u32, |bits, digit| bits.saturating_mul(2).saturating_add(digit));
        (name.contains("UTerm") && bits <= 128).then_some(bits)
    }
}

fn push_name(path: &mut String, name: &str) {
    if !path.is_empty() {
        path.push('.');
    }
    path.push_str(name);
}

macro_rules! integers {
    ($($method:ident $integer:ty: $variant:ident,)*) => {
        $(fn $method(self, number: $integer) -> Result<(), InspectError> {
            self.push(Value::$variant(number.into()));
            Ok(())
        })*
    };
}

impl<'a> Serializer for &'a mut Collector {
    type Ok = ();
    type Error = InspectError;
    type SerializeSeq = Compound<'a>;
    type SerializeTuple = Compound<'a>;
    type SerializeTupleStruct = Compound<'a>;
    type SerializeTupleVariant = Compound<'a>;
    type SerializeMap = Compound<'a>;
    type SerializeStruct = Compound<'a>;
    type SerializeStructVariant = Compound<'a>;

    integers! {
        serialize_bool bool: Bool,
        serialize_u8 u8: Unsigned,
        serialize_u16 u16: Unsigned,
        serialize_u64 u64: Unsigned,
        serialize_u128 u128: Unsigned,
        serialize_i8 i8: Signed,
        serialize_i16 i16: Signed,
        serialize_i32 i32: Signed,
        serialize_i64 i64: Signed,
        serialize_i128 i128: Signed,
        serialize_str &str: Text,
        serialize_char char: Text,
        serialize_bytes &[u8]: Bytes,
    }

    fn serialize_u32(self, number: u32) -> Result<(), InspectError> {
        let is_angle = self.kind.trim_start_matches('&') == type_name::<Angle>();
        self.push(if is_angle {
            Value::Angle(Angle::from_bits(number))
        } else {
            Value::Unsigned(number.into())
        });
        Ok(())
    }

    #[expect(clippy::disallowed_types, reason = "the trait requires this method; only the bits are kept")]
    fn serialize_f32(self, number: f32) -> Result<(), InspectError> {
        self.push(Value::Float(number.to_bits().into()));
        Ok(())
    }

    #[expect(clippy::disallowed_types, reason = "the trait requires this method; only the bits are kept")]
    fn serialize_f64(self, number: f64) -> Result<(), InspectError> {
        self.push(Value::Float(number.to_bits()));
        Ok(())
    }

    fn serialize_none(self) -> Result<(), InspectError> {
        self.push(Value::Name("none"));
        Ok(())
    }

    fn serialize_some<T: Serialize + ?Sized>(self, value: &T) -> Result<(), InspectError> {
        let before = self.count();
        self.nested(value)?;
        // `Some(None)` must differ from `None`.
        if let [Field { value: value @ Value::Name("none" | "some none"), .. }] = &mut self.fields[before..] {
            *value = Value::Name("some none");
        }
        Ok(())
    }

    fn serialize_unit(self) -> Result<(), InspectError> {
        self.push(Value::Empty);
        Ok(())
    }

    fn serialize_unit_struct(self, _: &'static str) -> Result<(), InspectError> {
        self.serialize_unit()
    }

    fn serialize_unit_variant(self, _: &'static str, _: u32, name: &'static str) -> Result<(), InspectError> {
        self.push(Value::Name(name));
        Ok(())
    }

    fn serialize_newtype_struct<T: Serialize + ?Sized>(
        self,
        _: &'static str,
        value: &T,
    ) -> Result<(), InspectError> {
        self.nested(value)
    }

    fn serialize_newtype_variant<T: Serialize + ?Sized>(
        self,
        _: &'static str,
        _: u32,
        name: &'static str,
        value: &T,
    ) -> Result<(), InspectError> {
        self.push(Value::Name(name));
        self.named(name, value)
    }

    fn serialize_seq(self, _: Option<usize>) -> Result<Compound<'a>, InspectError> {
        Ok(Compound::new(self, None))
    }

    fn serialize_tuple(self, _: usize) -> Result<Compound<'a>, InspectError> {
        Ok(Compound::new(self, None))
    }

    fn serialize_tuple_struct(self, _: &'static str, _: usize) -> Result<Compound<'a>, InspectError> {
        Ok(Compound::new(self, None))
    }

    fn serialize_map(self, _: Option<usize>) -> Result<Compound<'a>, InspectError> {
        Ok(Compound::new(self, None))
    }

    fn serialize_struct(self, name: &'static str, _: usize) -> Result<Compound<'a>, InspectError> {
        let is_fixed = name.starts_with("FixedI") || name.starts_with("FixedU");
        Ok(if is_fixed { Compound::fixed(self) } else { Compound::new(self, None) })
    }

    fn serialize_tuple_variant(
        self,
        _: &'static str,
        _: u32,
        name: &'static str,
        _: usize,
    ) -> Result<Compound<'a>, InspectError> {
        Ok(Compound::new(self, Some(name)))
    }

    fn serialize_struct_variant(
        self,
        _: &'static str,
        _: u32,
        name: &'static str,
        _: usize,
    ) -> Result<Compound<'a>, InspectError> {
        Ok(Compound::new(self, Some(name)))
    }
}
