use alloc::collections::{BTreeMap, BTreeSet};
use alloc::vec::Vec;
use core::fmt;
use core::ops::Range;

use super::value::{Field, Value};

/// A field whose value differs between two lists, or that only one of them has.
///
/// ```
/// use lockstep2d::inspect::{Difference, differences, fields};
/// # use lockstep2d::{fx, math::Vec2, world::World};
/// # let (mut a, mut b) = (World::default(), World::default());
/// b.set_gravity(Vec2::new(fx!(0), fx!(-9.81)))?;
/// // The field in which the states of two machines differ.
/// let [a, b] = [a.save(), b.save()].map(|save| fields(&save).expect("a world"));
/// let found: Vec<Difference> = differences(&a, &b);
/// assert_eq!(found.iter().map(|found| found.field().name()).collect::<Vec<_>>(), ["settings.gravity.y"]);
/// # Ok::<(), lockstep2d::body::WorldError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Difference {
    field: Field,
    /// Value in the first list. `None` if the field is missing.
    pub a: Option<Value>,
    /// Value in the second list. `None` if the field is missing.
    pub b: Option<Value>,
}

impl Difference {
    fn new(field: &Field, a: Option<&Field>, b: Option<&Field>) -> Self {
        let value = |field: &Field| field.value.clone();
        Difference { field: field.clone(), a: a.map(value), b: b.map(value) }
    }

    /// The field, with its path and names. If both lists contain it, this is the field of the first list.
    #[must_use]
    pub fn field(&self) -> &Field {
        &self.field
    }
}

impl fmt::Display for Difference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {} | {}", self.field.path(), OrNothing(self.a.as_ref()), OrNothing(self.b.as_ref()))
    }
}

struct OrNothing<'a>(Option<&'a Value>);

impl fmt::Display for OrNothing<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0 {
            Some(value) => value.fmt(f),
            None => write!(f, "nothing"),
        }
    }
}

/// The fields that differ or are missing from one list, in the order of the first list. A field that only the second
/// list has is placed before the field that follows it in the second list.
#[must_use]
pub fn differences(a: &[Field], b: &[Field]) -> Vec<Difference> {
    let (positions_a, positions_b) = (positions(a), positions(b));
    let in_a: BTreeSet<_> = positions_a.iter().collect();
    let in_b: BTreeMap<_, usize> = positions_b.iter().zip(0..).collect();
    let mut found = Vec::new();
    let mut passed = 0;
    for (field, position) in a.iter().zip(&positions_a) {
        let Some(&at) = in_b.get(position) else {
            found.push(Difference::new(field, Some(field), None));
            continue;
        };
        found.extend(only_in_b(b, &positions_b, &in_a, passed..at));
        passed = passed.max(at);
        if b[at].value != field.value {
            found.push(Difference::new(field, Some(field), Some(&b[at])));
        }
    }
    found.extend(only_in_b(b, &positions_b, &in_a, passed..b.len()));
    found
}

/// Identifies a field of a list: its path, and the number of earlier fields with the same path. A map may have two keys
/// with the same text, which give equal paths.
type FieldPosition<'a> = (&'a str, u32);

fn positions(fields: &[Field]) -> Vec<FieldPosition<'_>> {
    let mut positions = Vec::with_capacity(fields.len());
    let mut seen: BTreeMap<&str, u32> = BTreeMap::new();
    for field in fields {
        let before = seen.entry(field.path()).or_default();
        positions.push((field.path(), *before));
        *before += 1;
    }
    positions
}

fn only_in_b<'a>(
    b: &'a [Field],
    positions: &'a [FieldPosition<'a>],
    in_a: &'a BTreeSet<&FieldPosition<'a>>,
    range: Range<usize>,
) -> impl Iterator<Item = Difference> + 'a {
    let lacking = range.filter(|&at| !in_a.contains(&positions[at]));
    lacking.map(|at| Difference::new(&b[at], None, Some(&b[at])))
}
