use alloc::string::String;
use alloc::vec;
use alloc::vec::Vec;

use serde::de::value::{Error, U32Deserializer};
use serde::de::{self, DeserializeSeed, Deserializer, IntoDeserializer, Visitor};

use crate::lockstep::{EncodedInputs, Game};
use crate::math::Rng;

/// Generates inputs for `players` players, tick by tick, from bytes. Any byte string gives a log, and a small change of
/// the bytes usually causes a small change of the log.
///
/// The first byte of a tick decides whether all players repeat their inputs, for up to 16 ticks, or whether one player
/// or all players get new inputs. The `Deserialize` of the input type makes new inputs from bytes. Lists are short, and
/// integers are often small, or near the maximum or the middle of their range. If `Deserialize` fails, the default
/// replaces the input. If the inputs of a tick cannot be encoded and decoded, the default replaces all of them.
#[must_use]
pub fn inputs_from_bytes<G: Game>(players: u32, bytes: &[u8]) -> Vec<Vec<G::Input>> {
    let mut source = Source { bytes, depth: 0 };
    let mut log: Vec<Vec<G::Input>> = Vec::new();
    let mut inputs = vec![G::Input::default(); players as usize];
    while let Some(kind) = source.next() {
        let rest = usize::from(kind >> 3);
        match kind & 7 {
            0..=4 => {
                if let Some(input) = inputs.get_mut(rest % (players as usize).max(1)) {
                    *input = source.input();
                }
            }
            5 => inputs.iter_mut().for_each(|input| *input = source.input()),
            _ => (0..rest % 16).for_each(|_| log.push(inputs.clone())),
        }
        inputs = canonical(inputs, players);
        log.push(inputs.clone());
    }
    log
}

/// Generates random inputs for `players` players and `ticks` ticks. Equal states of `rng` give equal inputs.
#[must_use]
pub fn random_inputs<G: Game>(players: u32, ticks: u64, rng: &mut Rng) -> Vec<Vec<G::Input>> {
    let mut log = Vec::new();
    while (log.len() as u64) < ticks {
        let bytes: Vec<u8> = (0..64).flat_map(|_| rng.next_u64().to_le_bytes()).collect();
        log.extend(inputs_from_bytes::<G>(players, &bytes).into_iter().take(64));
    }
    log.truncate(usize::try_from(ticks).unwrap_or(usize::MAX));
    log
}

/// The inputs after encoding and decoding, or default inputs if encoding fails.
fn canonical<I>(inputs: Vec<I>, players: u32) -> Vec<I>
where
    I: Clone + Default + serde::Serialize + de::DeserializeOwned,
{
    match EncodedInputs::new(&inputs, players) {
        Ok(encoded) => encoded.inputs().to_vec(),
        Err(_) => vec![I::default(); players as usize],
    }
}

const DEPTH_MAX: u32 = 32;

/// A deserializer that generates values from bytes, and from zeros after the last byte. Floating-point numbers are 0.
struct Source<'a> {
    bytes: &'a [u8],
    depth: u32,
}

impl Source<'_> {
    fn next(&mut self) -> Option<u8> {
        let (first, rest) = self.bytes.split_first()?;
        self.bytes = rest;
        Some(*first)
    }

    fn byte(&mut self) -> u8 {
        self.next().unwrap_or(0)
    }

    fn input<I: de::DeserializeOwned + Default>(&mut self) -> I {
        self.depth = 0;
        I::deserialize(self).unwrap_or_default()
    }

    /// A number of which the caller uses the low `count` bits. With more than 8 bits, it is often small, or near the
    /// maximum or the middle of the range of an unsigned number.
    fn bits(&mut self, count: u32) -> u128 {
        if count <= 8 {
            return self.byte().into();
        }
        match self.byte() % 8 {
            0..=3 => self.byte().into(),
            // Near the maximum of an unsigned type, or a small negative number of a signed type.
            4 => !u128::from(self.byte()),
            // Near the middle of the range of an unsigned type, or near a limit of a signed type.
            5 => (1u128 << (count - 1)).wrapping_add(u128::from(self.byte())).wrapping_sub(128),
            _ => (0..count / 8).fold(0, |bits, _| bits << 8 | u128::from(self.byte())),
        }
    }

    fn text(&mut self) -> String {
        let length = self.byte() % 8;
        (0..length).map(|_| char::from(b' ' + self.byte() % 95)).collect()
    }

    fn deeper<T>(&mut self, inner: impl FnOnce(&mut Self) -> Result<T, Error>) -> Result<T, Error> {
        if self.depth >= DEPTH_MAX {
            return Err(de::Error::custom("too deep"));
        }
        self.depth += 1;
        let result = inner(self);
        self.depth -= 1;
        result
    }

    fn list<'de, V: Visitor<'de>>(&mut self, length: usize, visitor: V) -> Result<V::Value, Error> {
        self.deeper(|source| visitor.visit_seq(List { source, left: length }))
    }
}

macro_rules! integers {
    ($($method:ident $visit:ident $type:ty)*) => {$(
        fn $method<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
            let bytes = self.bits(<$type>::BITS).to_le_bytes();
            let mut own = [0; size_of::<$type>()];
            own.copy_from_slice(&bytes[..size_of::<$type>()]);
            visitor.$visit(<$type>::from_le_bytes(own))
        }
    )*};
}

impl<'de> Deserializer<'de> for &mut Source<'_> {
    type Error = Error;

    integers! {
        deserialize_u8 visit_u8 u8
        deserialize_u16 visit_u16 u16
        deserialize_u32 visit_u32 u32
        deserialize_u64 visit_u64 u64
        deserialize_u128 visit_u128 u128
        deserialize_i8 visit_i8 i8
        deserialize_i16 visit_i16 i16
        deserialize_i32 visit_i32 i32
        deserialize_i64 visit_i64 i64
        deserialize_i128 visit_i128 i128
    }

    fn is_human_readable(&self) -> bool {
        false
    }

    fn deserialize_any<V: Visitor<'de>>(self, _: V) -> Result<V::Value, Error> {
        Err(de::Error::custom("the bytes are not self-describing"))
    }

    fn deserialize_bool<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
        visitor.visit_bool(self.byte() & 1 == 1)
    }

    fn deserialize_f32<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
        visitor.visit_f32(0.0)
    }

    fn deserialize_f64<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
        visitor.visit_f64(0.0)
    }

    fn deserialize_char<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
        visitor.visit_char(char::from(self.byte()))
    }

    fn deserialize_str<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
        visitor.visit_string(self.text())
    }

    fn deserialize_string<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
        visitor.visit_string(self.text())
    }

    fn deserialize_bytes<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
        self.deserialize_byte_buf(visitor)
    }

    fn deserialize_byte_buf<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
        let length = self.byte() % 8;
        visitor.visit_byte_buf((0..length).map(|_| self.byte()).collect())
    }

    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
        if self.byte() & 1 == 0 {
            return visitor.visit_none();
        }
        self.deeper(|source| visitor.visit_some(source))
    }

    fn deserialize_unit<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
        visitor.visit_unit()
    }

    fn deserialize_unit_struct<V: Visitor<'de>>(
        self,
        _: &'static str,
        visitor: V,
    ) -> Result<V::Value, Error> {
        visitor.visit_unit()
    }

    fn deserialize_newtype_struct<V: Visitor<'de>>(
        self,
        _: &'static str,
        visitor: V,
    ) -> Result<V::Value, Error> {
        self.deeper(|source| visitor.visit_newtype_struct(source))
    }

    fn deserialize_seq<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
        let length = usize::from(self.byte() % 5);
        self.list(length, visitor)
    }

    fn deserialize_tuple<V: Visitor<'de>>(self, length: usize, visitor: V) -> Result<V::Value, Error> {
        self.list(length, visitor)
    }

    fn deserialize_tuple_struct<V: Visitor<'de>>(
        self,
        _: &'static str,
        length: usize,
        visitor: V,
    ) -> Result<V::Value, Error> {
        self.list(length, visitor)
    }

    fn deserialize_map<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
        let left = usize::from(self.byte() % 5);
        self.deeper(|source| visitor.visit_map(List { source, left }))
    }

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        _: &'static str,
        fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Error> {
        self.list(fields.len(), visitor)
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        _: &'static str,
        variants: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Error> {
        let index = u32::from(self.byte()) % u32::try_from(variants.len()).unwrap_or(u32::MAX).max(1);
        self.deeper(|source| visitor.visit_enum(Variant { source, index }))
    }

    fn deserialize_identifier<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
        visitor.visit_u32(self.byte().into())
    }

    fn deserialize_ignored_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
        visitor.visit_unit()
    }
}

struct List<'s, 'a> {
    source: &'s mut Source<'a>,
    left: usize,
}

impl<'de> de::SeqAccess<'de> for List<'_, '_> {
    type Error = Error;

    fn next_element_seed<T: DeserializeSeed<'de>>(&mut self, seed: T) -> Result<Option<T::Value>, Error> {
        let Some(left) = self.left.checked_sub(1) else {
            return Ok(None);
        };
        self.left = left;
        seed.deserialize(&mut *self.source).map(Some)
    }

    fn size_hint(&self) -> Option<usize> {
        Some(self.left)
    }
}

impl<'de> de::MapAccess<'de> for List<'_, '_> {
    type Error = Error;

    fn next_key_seed<K: DeserializeSeed<'de>>(&mut self, seed: K) -> Result<Option<K::Value>, Error> {
        de::SeqAccess::next_element_seed(self, seed)
    }

    fn next_value_seed<V: DeserializeSeed<'de>>(&mut self, seed: V) -> Result<V::Value, Error> {
        seed.deserialize(&mut *self.source)
    }
}

struct Variant<'s, 'a> {
    source: &'s mut Source<'a>,
    index: u32,
}

impl<'de> de::EnumAccess<'de> for Variant<'_, '_> {
    type Error = Error;
    type Variant = Self;

    fn variant_seed<V: DeserializeSeed<'de>>(self, seed: V) -> Result<(V::Value, Self), Error> {
        let index: U32Deserializer<Error> = self.index.into_deserializer();
        Ok((seed.deserialize(index)?, self))
    }
}

impl<'de> de::VariantAccess<'de> for Variant<'_, '_> {
    type Error = Error;

    fn unit_variant(self) -> Result<(), Error> {
        Ok(())
    }

    fn newtype_variant_seed<T: DeserializeSeed<'de>>(self, seed: T) -> Result<T::Value, Error> {
        seed.deserialize(self.source)
    }

    fn tuple_variant<V: Visitor<'de>>(self, length: usize, visitor: V) -> Result<V::Value, Error> {
        self.source.list(length, visitor)
    }

    fn struct_variant<V: Visitor<'de>>(
        self,
        fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Error> {
        self.source.list(fields.len(), visitor)
    }
}
