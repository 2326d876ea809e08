use alloc::string::String;

use serde::Serialize;
use serde::ser;

use super::serializer::{Collector, InspectError};
use super::value::Value;

/// The parts of a list, map, struct or variant that is being collected.
pub(super) struct Compound<'a> {
    collector: &'a mut Collector,
    variant: Option<&'static str>,
    /// `Some` for a fixed-point number, with its number of fraction bits if known.
    fixed: Option<Option<u32>>,
    count: u64,
    key: String,
}

impl<'a> Compound<'a> {
    pub(super) fn new(collector: &'a mut Collector, variant: Option<&'static str>) -> Self {
        if let Some(name) = variant {
            collector.push(Value::Name(name));
        }
        Compound { collector, variant, fixed: None, count: 0, key: String::new() }
    }

    pub(super) fn fixed(collector: &'a mut Collector) -> Self {
        let fixed = Some(collector.fraction_bits());
        Compound { fixed, ..Compound::new(collector, None) }
    }

    fn element<T: Serialize + ?Sized>(&mut self, value: &T) -> Result<(), InspectError> {
        self.count += 1;
        self.collector.numbered(self.count - 1, value)
    }

    fn field<T: Serialize + ?Sized>(&mut self, name: &str, value: &T) -> Result<(), InspectError> {
        self.count += 1;
        let Some(fraction_bits) = self.fixed else {
            return self.collector.named(name, value);
        };
        let before = self.collector.count();
        self.collector.named(name, value)?;
        self.collector.join_fixed(before, fraction_bits);
        Ok(())
    }

    fn finish(self) -> Result<(), InspectError> {
        if self.count == 0 && self.variant.is_none() {
            self.collector.push(Value::Empty);
        }
        Ok(())
    }
}

macro_rules! lists {
    ($($of:ident $method:ident,)*) => {
        $(impl ser::$of for Compound<'_> {
            type Ok = ();
            type Error = InspectError;

            fn $method<T: Serialize + ?Sized>(&mut self, value: &T) -> Result<(), InspectError> {
                self.element(value)
            }

            fn end(self) -> Result<(), InspectError> {
                self.finish()
            }
        })*
    };
}

macro_rules! structs {
    ($($of:ident)*) => {
        $(impl ser::$of for Compound<'_> {
            type Ok = ();
            type Error = InspectError;

            fn serialize_field<T: Serialize + ?Sized>(
                &mut self,
                name: &'static str,
                value: &T,
            ) -> Result<(), InspectError> {
                self.field(name, value)
            }

            fn end(self) -> Result<(), InspectError> {
                self.finish()
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

impl ser::SerializeMap for Compound<'_> {
    type Ok = ();
    type Error = InspectError;

    fn serialize_key<T: Serialize + ?Sized>(&mut self, name: &T) -> Result<(), InspectError> {
        self.key = self.collector.key(name)?;
        Ok(())
    }

    fn serialize_value<T: Serialize + ?Sized>(&mut self, value: &T) -> Result<(), InspectError> {
        self.count += 1;
        self.collector.entry(&self.key, value)
    }

    fn end(self) -> Result<(), InspectError> {
        self.finish()
    }
}
