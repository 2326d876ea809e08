//! Graph colouring: groups of constraints of which no two change the same body, so that the order inside a group cannot
//! matter. A scalar, a wide and a threaded solver then give the same bits.
//!
//! Constraints are coloured greedily in the order of a hash of their shapes or of their joint: in sorted order the
//! solver always sweeps the same way and a pyramid sways by 0.1 to 0.4 m, in hashed order by 0.006 m.

use alloc::vec::Vec;

use super::body_list::GROUND;

/// Largest number of colours. More colours would be nearly empty: constraints that fit no colour (a drum touched by
/// hundreds of boxes) are the overflow, a serial list before all colours, in its own order.
const COLOURS_MAX: u8 = 24;

const BUCKETS: usize = 256;

/// A constraint to be coloured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Node {
    /// The bucket in the order in which constraints are coloured.
    bucket: u8,
    /// Constraints of one colour and one size are solved together.
    size: Size,
    /// The bodies that the constraint changes: [`GROUND`] instead of a body that it does not change.
    bodies: [u32; 2],
}

impl Node {
    /// `key` identifies what the constraint joins.
    pub(super) fn new(key: u64, bodies: [u32; 2], size: Size) -> Self {
        Node { bucket: bucket_of(key), size, bodies }
    }
}

/// The amount of work in a constraint: contacts with one point are small.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Size {
    Large,
    Small,
}

/// Where a contact is in the order of the solver.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SolverColour {
    /// It is solved together with all other contacts of this colour, which are independent of it. Counted from 0.
    Group(u8),
    /// Its bodies have more contacts than there are colours: it is solved by itself, before all groups.
    Overflow,
}

/// Sorts constraints into colours, and keeps the last order.
#[derive(Clone, Debug, Default)]
pub(super) struct Colouring {
    /// The constraints to be sorted.
    nodes: Vec<Node>,
    /// The constraints that the present order belongs to. In most ticks of a resting world they are the same again.
    ordered: Vec<Node>,
    /// For each body, the colours of its constraints so far, one bit each.
    used: Vec<u32>,
    hashed: Vec<u32>,
    /// For each constraint, its place in the order: see [`place_of`].
    places: Vec<u8>,
    order: Vec<u32>,
    /// For each place, where its constraints end in the order.
    ends: Vec<u32>,
}

impl Colouring {
    /// Starts with no constraints.
    pub(super) fn begin(&mut self) {
        self.nodes.clear();
    }

    /// Adds a constraint. Its index is the number of constraints that were added before it.
    #[inline]
    pub(super) fn add(&mut self, node: Node) {
        self.nodes.push(node);
    }

    /// Sorts the constraints into colours.
    pub(super) fn sort(&mut self, body_slots: usize) {
        let Colouring { nodes, ordered, used, hashed, places, order, ends } = self;
        if ordered == nodes {
            return;
        }
        ordered.clone_from(nodes);
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
            // Bodies that do not change have no colours.
            used[GROUND as usize] = 0;
            places[index as usize] = place_of(colour, size);
        }
        counting_sort(nodes.len(), |i| places[i], order, ends);
    }

    /// Whether any constraint of the last order changes a body.
    pub(super) fn holds(&self, body: u32) -> bool {
        self.used.get(body as usize).is_some_and(|&colours| colours != 0)
    }

    /// Where a constraint is in the last order, by its index.
    pub(super) fn colour_of(&self, node: usize) -> Option<SolverColour> {
        self.places.get(node).map(|&place| match place.checked_sub(1) {
            None => SolverColour::Overflow,
            Some(place) => SolverColour::Group(place / 2),
        })
    }

    /// The constraints of the last order that fit no colour, to be solved one after the other.
    pub(super) fn overflow(&self) -> &[u32] {
        let end = self.ends.first().map_or(0, |&end| end as usize);
        &self.order[..end]
    }

    /// The other constraints, colour by colour and size by size. Empty groups are left out: in a small world most
    /// groups are empty, and every operation iterates over them.
    pub(super) fn colours(&self) -> impl Iterator<Item = &[u32]> {
        let groups = self.ends.windows(2).map(|ends| &self.order[ends[0] as usize..ends[1] as usize]);
        groups.filter(|indices| !indices.is_empty())
    }
}

/// The place in the order: the overflow comes first, then the large and the small constraints of each colour.
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
            nodes.iter().for_each(|&node| colouring.add(node));
            colouring.sort(bodies as usize + 1);
            let mut seen = colouring.order.clone();
            seen.sort_unstable();
            assert!(seen.iter().copied().eq(0..400));
            let mut solved = colouring.overflow().to_vec();
            assert!(solved.iter().all(|&i| colouring.places[i as usize] == 0));
            for indices in colouring.colours() {
                let mut bodies = std::collections::BTreeSet::new();
                for node in indices.iter().map(|&i| nodes[i as usize]) {
                    assert_eq!(node.size, nodes[indices[0] as usize].size);
                    for body in node.bodies.into_iter().filter(|&body| body != GROUND) {
                        assert!(bodies.insert(body), "body {body} twice in a colour");
                    }
                }
                solved.extend_from_slice(indices);
            }
            assert_eq!(solved, colouring.order, "the groups follow the order");
            assert!(colouring.places.contains(&0), "the hub has more constraints than there are colours");
        }
    }
}
