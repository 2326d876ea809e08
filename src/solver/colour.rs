//! Colours: groups of constraints of which no two touch the same dynamic body, so that inside a group the order
//! cannot matter. That makes a scalar, a wide and a threaded solver give the same bits.
//!
//! Constraints are coloured greedily in the order of a hash of what they join: in sorted order the sweep always
//! runs the same way and a pyramid sways by 0.1 to 0.4 m, in hashed order by 0.006 m.

use alloc::vec::Vec;

/// More colours than this would be nearly empty: what does not fit (a drum touched by hundreds of boxes) is one
/// serial list before them, in its own order.
const COLOURS_MAX: u8 = 24;

const BUCKETS: usize = 256;

/// A constraint to be coloured: its key for the order, and the dynamic bodies it touches.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Node {
    pub(crate) key: u64,
    pub(crate) body_a: Option<u32>,
    pub(crate) body_b: Option<u32>,
    /// Constraints of one colour that are of the same size are solved together.
    pub(crate) size: Size,
}

/// How much there is to solve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Size {
    Large,
    Small,
}

/// Constraints to be solved at a time.
pub(crate) enum Group<'a> {
    /// One after the other.
    Serial(&'a [u32]),
    /// In any order: no two of them touch the same dynamic body.
    Coloured(&'a [u32]),
}

/// Places in the order: the overflow, then the large and the small ones of each colour.
const PLACES: usize = 2 * COLOURS_MAX as usize + 1;

/// Scratch of the colouring.
#[derive(Clone, Debug, Default)]
pub(crate) struct Colouring {
    /// For each body, the colours of its constraints so far, one bit each.
    used: Vec<u32>,
    hashed: Vec<u32>,
    colours: Vec<u8>,
    order: Vec<u32>,
    /// For each place in the order, where it ends.
    ends: Vec<u32>,
}

impl Colouring {
    /// The order in which to solve: indices into `nodes`, the overflow first and then colour by colour.
    pub(crate) fn order(&mut self, nodes: &[Node], body_slots: usize) -> &[u32] {
        self.used.clear();
        self.used.resize(body_slots, 0);
        counting_sort(nodes.len(), BUCKETS, |i| usize::from(bucket_of(nodes[i].key)), &mut self.hashed);

        self.colours.clear();
        self.colours.resize(nodes.len(), 0);
        for &index in &self.hashed {
            let node = nodes[index as usize];
            let bodies = [node.body_a, node.body_b].into_iter().flatten();
            let taken = bodies.clone().fold(0, |taken, body| taken | self.used[body as usize]);
            let colour = taken.trailing_ones().min(COLOURS_MAX.into());
            for body in bodies {
                self.used[body as usize] |= 1 << colour;
            }
            self.colours[index as usize] = colour_byte(colour);
        }
        let colours = &self.colours;
        let place_of = |i: usize| match colours[i] {
            COLOURS_MAX => 0,
            colour => 2 * usize::from(colour) + if nodes[i].size == Size::Large { 1 } else { 2 },
        };
        counting_sort(nodes.len(), PLACES, place_of, &mut self.order);
        self.ends.clear();
        self.ends.resize(PLACES, 0);
        (0..nodes.len()).for_each(|i| self.ends[place_of(i)] += 1);
        (1..PLACES).for_each(|place| self.ends[place] += self.ends[place - 1]);
        &self.order
    }

    /// The last order, in the groups in which it may be solved.
    pub(crate) fn groups(&self) -> impl Iterator<Item = Group<'_>> {
        let starts = core::iter::once(0).chain(self.ends.iter().copied());
        let places = starts.zip(&self.ends).map(|(start, &end)| &self.order[start as usize..end as usize]);
        places.enumerate().map(|(place, indices)| match place {
            0 => Group::Serial(indices),
            _ => Group::Coloured(indices),
        })
    }

}

#[expect(clippy::cast_possible_truncation, reason = "at most COLOURS_MAX")]
fn colour_byte(colour: u32) -> u8 {
    colour as u8
}

/// The top bits of a multiplicative hash (D. Knuth, The Art of Computer Programming 3, 6.4).
fn bucket_of(key: u64) -> u8 {
    (key.wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 56) as u8
}

/// The indices `0..count`, stably sorted by bucket.
#[expect(clippy::cast_possible_truncation, reason = "constraints are counted in 32 bits")]
fn counting_sort(count: usize, buckets: usize, bucket_of: impl Fn(usize) -> usize, sorted: &mut Vec<u32>) {
    let mut starts = [0u32; BUCKETS + 1];
    assert!(buckets <= BUCKETS, "at most 256 buckets");
    for i in 0..count {
        starts[bucket_of(i) + 1] += 1;
    }
    for i in 0..buckets {
        starts[i + 1] += starts[i];
    }
    sorted.clear();
    sorted.resize(count, 0);
    for i in 0..count {
        let start = &mut starts[bucket_of(i)];
        sorted[*start as usize] = i as u32;
        *start += 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Rng;

    #[test]
    fn no_colour_holds_a_body_twice_and_nothing_is_lost() {
        let mut rng = Rng::new(11);
        for bodies in [2u32, 10, 300] {
            // Body 0 is a hub, so that the overflow list is used too.
            let nodes: Vec<Node> = (0..400)
                .map(|key| {
                    let a = if key % 3 == 0 { 0 } else { rng.below(bodies) };
                    let b = (a + 1 + rng.below(bodies - 1)) % bodies;
                    let fixed = key % 7 == 0;
                    let size = if key % 2 == 0 { Size::Large } else { Size::Small };
                    Node { key, body_a: Some(a), body_b: if fixed { None } else { Some(b) }, size }
                })
                .collect();
            let mut colouring = Colouring::default();
            let order = colouring.order(&nodes, bodies as usize).to_vec();
            let mut seen = order.clone();
            seen.sort_unstable();
            assert!(seen.iter().copied().eq(0..400));
            let mut solved = Vec::new();
            for group in colouring.groups() {
                let indices = match group {
                    Group::Serial(indices) => {
                        assert!(!indices.is_empty(), "the hub overflows");
                        assert!(indices.iter().all(|&i| colouring.colours[i as usize] == COLOURS_MAX));
                        indices
                    }
                    Group::Coloured(indices) => {
                        let mut bodies = std::collections::BTreeSet::new();
                        for node in indices.iter().map(|&i| nodes[i as usize]) {
                            assert_eq!(node.size, nodes[indices[0] as usize].size);
                            for body in [node.body_a, node.body_b].into_iter().flatten() {
                                assert!(bodies.insert(body), "body {body} twice in a colour");
                            }
                        }
                        indices
                    }
                };
                solved.extend_from_slice(indices);
            }
            assert_eq!(solved, order, "groups follow the order");
        }
    }
}
