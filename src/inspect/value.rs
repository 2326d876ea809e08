use alloc::format;
use alloc::string::String;
use alloc::vec::Vec;
use core::fmt;

use super::decimal::Decimal;
use crate::math::Angle;

/// A value without parts, stored exactly.
///
/// ```
/// use lockstep2d::{fx, inspect::{Value, fields}, math::{Angle, Fx}};
/// #[derive(serde::Serialize)]
/// struct Ship { fuel: Fx, heading: Angle, docked: bool }
/// let ship = Ship { fuel: fx!(2.5), heading: Angle::QUARTER, docked: false };
/// let values: Vec<Value> = fields(&ship)?.into_iter().map(|field| field.value).collect();
/// assert_eq!(values[1..], [Value::Angle(Angle::QUARTER), Value::Bool(false)]);
/// // A fixed-point number gives its exact bits, and a decimal text to display.
/// assert_eq!((values[0].bits(), values[0].decimal()), (Some(5 << 31), Some("2.5".into())));
/// # Ok::<(), lockstep2d::inspect::InspectError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Value {
    /// True or false.
    Bool(bool),
    /// An unsigned integer.
    Unsigned(u128),
    /// A signed integer.
    Signed(i128),
    /// A fixed-point number.
    Fixed {
        /// The number times 2^`fraction_bits`.
        bits: i128,
        /// Number of fraction bits, if known.
        fraction_bits: Option<u32>,
    },
    /// An angle.
    Angle(Angle),
    /// A floating-point number, as its bits.
    Float(u64),
    /// Text.
    Text(String),
    /// Bytes.
    Bytes(Vec<u8>),
    /// The name of a variant. `none` stands for `None`, and `some none` for `Some(None)`.
    Name(&'static str),
    /// A list, map or struct without parts, or a unit.
    Empty,
}

impl Value {
    /// Raw integer of a number, an angle or a boolean. `None` for other values, and for integers above 127 bits.
    #[must_use]
    pub fn bits(&self) -> Option<i128> {
        match self {
            Value::Bool(bit) => Some(i128::from(*bit)),
            Value::Unsigned(number) => i128::try_from(*number).ok(),
            Value::Signed(bits) | Value::Fixed { bits, .. } => Some(*bits),
            Value::Angle(angle) => Some(i128::from(angle.to_bits())),
            Value::Float(bits) => Some(i128::from(*bits)),
            Value::Text(_) | Value::Bytes(_) | Value::Name(_) | Value::Empty => None,
        }
    }
}

impl Value {
    /// A fixed-point number in decimal, with enough digits to distinguish it from its neighbours. `None` for other
    /// values, if the number of fraction bits is unknown, or if the computation exceeds 128 bits.
    #[must_use]
    pub fn decimal(&self) -> Option<String> {
        match self {
            Value::Fixed { bits, fraction_bits } => {
                fraction_bits.and_then(|count| Decimal::new(*bits, count)).map(|decimal| format!("{decimal}"))
            }
            _ => None,
        }
    }
}

impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Value::Bool(bit) => write!(f, "{bit}"),
            Value::Unsigned(number) => write!(f, "{number}"),
            Value::Signed(number) => write!(f, "{number}"),
            Value::Fixed { bits, fraction_bits } => {
                match fraction_bits.and_then(|count| Decimal::new(*bits, count)) {
                    Some(decimal) => write!(f, "{decimal} (bits {bits})"),
                    None => write!(f, "bits {bits}"),
                }
            }
            Value::Angle(angle) => {
                let degrees = Decimal::new(angle.to_degrees().to_bits().into(), 32);
                match degrees {
                    Some(degrees) => write!(f, "{degrees} degrees (bits {})", angle.to_bits()),
                    None => write!(f, "bits {}", angle.to_bits()),
                }
            }
            Value::Float(bits) => write!(f, "a float (bits {bits:#x})"),
            Value::Text(text) => write!(f, "{text:?}"),
            Value::Bytes(bytes) => {
                write!(f, "{} bytes", bytes.len())?;
                let shown = &bytes[..bytes.len().min(16)];
                shown.iter().try_for_each(|byte| write!(f, " {byte:02x}"))?;
                f.write_str(if shown.len() < bytes.len() { " ..." } else { "" })
            }
            Value::Name(name) => f.write_str(name),
            Value::Empty => write!(f, "empty"),
        }
    }
}

/// A value without parts, with its path.
///
/// ```
/// # use lockstep2d::{body::BodyDef, world::World};
/// use lockstep2d::inspect::{Field, fields};
/// # let mut world = World::default();
/// world.spawn(&BodyDef::dynamic(), &[])?;
/// let fields = fields(&world.save()).expect("a world");
/// // A custom inspector, which lists all fields of one body.
/// let of_body = |field: &&Field| field.subject().is_some_and(|subject| subject.ends_with("body 0v0"));
/// let names: Vec<_> = fields.iter().filter(of_body).map(Field::name).collect();
/// assert!(names.contains(&"velocity.x"), "{names:?}");
/// # Ok::<(), lockstep2d::body::WorldError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Field {
    pub(super) path: String,
    /// Lengths in bytes of two prefixes of the path: the path of the enclosing object, and of its section.
    pub(super) subject: Option<(usize, usize)>,
    /// Value of the field.
    pub value: Value,
}

impl Field {
    /// Path: names separated by dots, and indices in brackets. The path is empty if the inspected value has no parts.
    /// It is also empty for the field with the variant's name if the inspected value is an enum.
    #[must_use]
    pub fn path(&self) -> &str {
        &self.path
    }

    /// Path of the object that contains the field, such as `world.bodies.body 12v1`: an entry of the outermost map.
    /// `None` if the field is not in a map.
    #[must_use]
    pub fn subject(&self) -> Option<&str> {
        self.subject.map(|(end, _)| &self.path[..end])
    }

    /// Section that contains the field, such as `world.bodies`: the path of the outermost map. For a field that is not
    /// in a map, the first name of the path, or an empty text if the path begins with an index.
    #[must_use]
    pub fn section(&self) -> &str {
        let end = match self.subject {
            Some((_, end)) => end,
            None => self.path.find(['.', '[']).unwrap_or(self.path.len()),
        };
        &self.path[..end]
    }

    /// Name of the field within its object, such as `velocity.x`, or the whole path if the field is not in a map.
    #[must_use]
    pub fn name(&self) -> &str {
        match self.subject {
            Some((end, _)) => self.path[end..].trim_start_matches('.'),
            None => &self.path,
        }
    }
}
