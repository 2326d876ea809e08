//! Colours: groups of constraints of which no two touch the same dynamic body, so that inside a group the order
//! cannot matter. That makes a scalar, a wide and a threaded solver give the same bits.
//!
//! Constraints are coloured greedily in the order of a hash of what they join: in sorted order the sweep always
//! runs the same way and a pyramid sways by 0.1 to 0.4 m, in hashed order by 0.006 m.

use alloc::vec::Vec;

use super::body_list::GROUND;

/// More colours than this would be nearly empty: what does not fit (a drum touched by hundreds of boxes) is one
/// serial list before them, in its own order.
const COLOURS_MAX: u8 = 24;

const BUCKETS: usize = 256;

/// A constraint to be coloured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Node {
    /// Its bucket in the order in which constraints are coloured.
    bucket: u8,
    /// Constraints of one colour that are of the same size are solved together.
    size: Size,
    /// The bodies that it changes: [`GROUND`] for one that it does not.
    bodies: [u32; 2],
}

impl Node {
    /// The key stands for what the constraint joins.
    pub(crate) fn new(key: u64, bodies: [u32; 2], size: Size) -> Self {
        Node { bucket: bucket_of(key), size, bodies }
    }
}

/// How much there is to solve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Size {
    Large,
    Small,
}

/// Where the solver has a contact: contacts of one colour are independent of each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SolverColour {
    /// It is solved together with all others of this colour, from 0.
    Group(u8),
    /// Its bodies have more contacts than there are colours: it is solved by itself, before all groups.
    Overflow,
}

/// Constraints to be solved at a time.
pub(crate) enum Group<'a> {
    /// One after the other.
    Serial(&'a [u32]),
    /// In any order: no two of them touch the same dynamic body.
    Coloured(&'a [u32]),
}

/// Scratch of the colouring.
#[derive(Clone, Debug, Default)]
pub(crate) struct Colouring {
    /// For each body, the colours of its constraints so far, one bit each.
    used: Vec<u32>,
    hashed: Vec<u32>,
    /// For each constraint, its place in the order.
    places: Vec<u8>,
    order: Vec<u32>,
    /// For each place in the order, where it ends.
    ends: Vec<u32>,
    /// What has been ordered. Most ticks of what rests ask for the same again.
    nodes: Vec<Node>,
}

impl Colouring {
    /// The order in which to solve: indices into `nodes`, the overflow first and then colour by colour.
    pub(crate) fn order(&mut self, nodes: &[Node], body_slots: usize) -> &[u32] {
        let Colouring { used, hashed, places, order, ends, nodes: ordered } = self;
        if ordered == nodes {
            return order;
        }
        ordered.clear();
        ordered.extend_from_slice(nodes);
        used.clear();
        used.resize(body_slots, 0);
        counting_sort(nodes.len(), |i| nodes[i].bucket, hashed, ends);
        places.clear();
        places.resize(nodes.len(), 0);
        for &index in hashed.iter() {
            let Node { bodies: [a, b], size, .. } = nodes[index as usize];
            let taken = used[a as usize] | used[b as usize];
            let colour = taken.trailing_ones().min(COLOURS_MAX.into());
            used[a as usize] |= 1 << colour;
            used[b as usize] |= 1 << colour;
            // What does not change has no colour.
            used[GROUND as usize] = 0;
            places[index as usize] = place_of(colour, size);
        }
        counting_sort(nodes.len(), |i| places[i], order, ends);
        order
    }

    /// Whether any constraint of the last order changes a body.
    pub(super) fn holds(&self, body: u32) -> bool {
        self.used.get(body as usize).is_some_and(|&colours| colours != 0)
    }

    /// Where the last order has one of the nodes.
    pub(super) fn colour_of(&self, node: usize) -> Option<SolverColour> {
        self.places.get(node).map(|&place| match place.checked_sub(1) {
            None => SolverColour::Overflow,
            Some(place) => SolverColour::Group(place / 2),
        })
    }

    /// The last order, in the groups in which it may be solved. None of them is empty: most places of a small world are,
    /// and whoever goes through the groups does so many times in a tick.
    pub(crate) fn groups(&self) -> impl Iterator<Item = Group<'_>> {
        let starts = core::iter::once(0).chain(self.ends.iter().copied());
        let places = starts.zip(&self.ends).map(|(start, &end)| &self.order[start as usize..end as usize]);
        let filled = places.enumerate().filter(|(_, indices)| !indices.is_empty());
        filled.map(|(place, indices)| match place {
            0 => Group::Serial(indices),
            _ => Group::Coloured(indices),
        })
    }
}

/// The overflow comes first, then the large and the small constraints of each colour.
#[expect(clippy::cast_possible_truncation, reason = "at most COLOURS_MAX")]
fn place_of(colour: u32, size: Size) -> u8 {
    match colour as u8 {
        COLOURS_MAX => 0,
        colour => 2 * colour + if size == Size::Large { 1 } else { 2 },
    }
}

/// The top bits of a multiplicative hash (D. Knuth, The Art of Computer Programming 3, 6.4).
fn bucket_of(key: u64) -> u8 {
    (key.wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 56) as u8
}

/// The indices `0..count`, stably sorted by bucket, and where each bucket ends.
#[expect(clippy::cast_possible_truncation, reason = "constraints are counted in 32 bits")]
fn counting_sort(count: usize, bucket_of: impl Fn(usize) -> u8, sorted: &mut Vec<u32>, ends: &mut Vec<u32>) {
    ends.clear();
    ends.resize(BUCKETS, 0);
    for i in 0..count {
        ends[usize::from(bucket_of(i))] += 1;
    }
    let mut start = 0;
    for end in ends.iter_mut() {
        start += core::mem::replace(end, start);
    }
    sorted.clear();
    sorted.resize(count, 0);
    for i in 0..count {
        let place = &mut ends[usize::from(bucket_of(i))];
        sorted[*place as usize] = i as u32;
        *place += 1;
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
                    Node::new(key, [a + 1, if fixed { GROUND } else { b + 1 }], size)
                })
                .collect();
            let mut colouring = Colouring::default();
            let order = colouring.order(&nodes, bodies as usize + 1).to_vec();
            let mut seen = order.clone();
            seen.sort_unstable();
            assert!(seen.iter().copied().eq(0..400));
            let mut solved = Vec::new();
            for group in colouring.groups() {
                let indices = match group {
                    Group::Serial(indices) => {
                        assert!(solved.is_empty(), "the overflow comes first");
                        assert!(indices.iter().all(|&i| colouring.places[i as usize] == 0));
                        indices
                    }
                    Group::Coloured(indices) => {
                        let mut bodies = std::collections::BTreeSet::new();
                        for node in indices.iter().map(|&i| nodes[i as usize]) {
                            assert_eq!(node.size, nodes[indices[0] as usize].size);
                            for body in node.bodies.into_iter().filter(|&body| body != GROUND) {
                                assert!(bodies.insert(body), "body {body} twice in a colour");
                            }
                        }
                        indices
                    }
                };
                solved.extend_from_slice(indices);
            }
            assert_eq!(solved, order, "groups follow the order");
            assert!(colouring.places.contains(&0), "the hub overflows");
        }
    }
}
