//! Graph colouring: no two constraints of a colour change the same body, so their order does not matter. The solver
//! therefore gives the same bits with scalar code, with SIMD, and on several threads.
//!
//! The constraints of a colour are divided among the threads by their bodies, so that a body is seldom passed from one
//! processor to another.
//!
//! Constraints are coloured greedily, in the order of a hash of their shapes or of their joint. In sorted order, the
//! solver would always sweep in the same direction: a pyramid would sway by 0.1 to 0.4 m, instead of 0.006 m.

use alloc::vec::Vec;

use super::body_list::GROUND;

/// Maximum number of colours. More colours would be nearly empty. Constraints that fit no colour form the overflow: for
/// example most contacts of a drum (one body) that is filled with hundreds of boxes.
const COLOURS_MAX: u8 = 24;

const BUCKETS: usize = 256;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Node {
    /// The highest bits of a hash of the key. Constraints are coloured in the order of their buckets.
    bucket: u8,
    size: Size,
    /// Whether the constraint gets more iterations (`COLD_ROUNDS`).
    cold: bool,
    /// The bodies that the constraint changes. [`GROUND`] replaces other bodies.
    bodies: [u32; 2],
}

impl Node {
    /// `key` identifies the shapes or the joint of the constraint.
    pub(super) fn new(key: u64, bodies: [u32; 2], size: Size) -> Self {
        Node { bucket: bucket_of(key), size, cold: false, bodies }
    }
}

/// The amount of work in a constraint. Contacts with one point are small, other constraints are large.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Size {
    Large,
    Small,
}

/// Position of a contact in the order in which the solver solves contacts.
///
/// ```
/// # use lockstep2d::{body::{BodyDef, Polygon, ShapeDef}, fx, world::World};
/// use lockstep2d::world::SolverColour;
/// # let mut world = World::default();
/// # let square = ShapeDef::new(Polygon::square(fx!(0.5))?);
/// # world.spawn(&BodyDef::fixed().position((fx!(0), fx!(-0.5))), &[square])?;
/// # world.spawn(&BodyDef::dynamic().position((fx!(0), fx!(0.5))), &[square])?;
/// # world.step();
/// // Contacts without a colour are slow to solve. They show that a body has very many contacts.
/// let colours: Vec<_> = world.contacts().map(|contact| contact.solver_colour()).collect();
/// assert!(matches!(colours[..], [Some(SolverColour::Group(_))]));
/// # Ok::<(), lockstep2d::body::WorldError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SolverColour {
    /// The colour, counted from 0. The contact shares no moving body with other contacts of this colour.
    Group(u8),
    /// Other contacts of the two bodies use all colours. The contact is solved alone, before the contacts that have a
    /// colour.
    Overflow,
}

/// The constraints of one colour that belong to one thread.
#[derive(Clone, Copy, Debug)]
pub(super) struct Group<'a> {
    /// Indices of the constraints. The first `large` ones are large, the others are small.
    pub(super) indices: &'a [u32],
    pub(super) large: usize,
}

impl<'a> Group<'a> {
    pub(super) fn of_singles(indices: &'a [u32]) -> Self {
        Group { indices, large: 0 }
    }

    /// Splits the group into batches of up to `N` constraints of one size. The last batch of large constraints is
    /// filled up with small ones, if `mixes` holds for all constraints of the filled batch.
    pub(super) fn batches<const N: usize>(
        self,
        mixes: impl Fn(u32) -> bool,
    ) -> impl Iterator<Item = &'a [u32]> {
        let Group { mut indices, mut large } = self;
        core::iter::from_fn(move || {
            let full = indices.get(..N.min(indices.len())).filter(|full| !full.is_empty())?;
            let is_uniform = large == 0 || large >= full.len() || !full.iter().all(|&index| mixes(index));
            let (batch, rest) =
                indices.split_at(if large > 0 && is_uniform { large.min(N) } else { full.len() });
            large = large.saturating_sub(batch.len());
            indices = rest;
            Some(batch)
        })
    }
}

/// Sorts constraints into colours.
#[derive(Clone, Debug, Default)]
pub(super) struct Colouring {
    nodes: Vec<Node>,
    /// The constraints for which `order` was computed. In a world at rest the constraints seldom change, and `order` is
    /// reused.
    ordered: Vec<Node>,
    /// For each body, a bit set of the colours of its constraints.
    used: Vec<u32>,
    hashed: Vec<u32>,
    /// For each constraint, its place in the order: see [`place_of`].
    places: Vec<u8>,
    order: Vec<u32>,
    /// For each rank (see [`Ranks`]), the end of its constraints in `order`.
    ends: Vec<u32>,
    colour_count: u8,
    ranks: Ranks,
}

impl Colouring {
    pub(super) fn begin(&mut self) {
        self.nodes.clear();
    }

    /// Adds a constraint. Its index is the number of constraints added before.
    #[inline]
    pub(super) fn add(&mut self, node: Node) {
        self.nodes.push(node);
    }

    /// Marks each constraint as cold if `is_cold` holds for its bodies.
    pub(super) fn set_cold(&mut self, is_cold: impl Fn([u32; 2]) -> bool) {
        self.nodes.iter_mut().for_each(|node| node.cold = is_cold(node.bodies));
    }

    /// Sorts the constraints into colours, each of which is divided among `parts` threads. `body_count` is above the
    /// largest index of a body.
    pub(super) fn sort(&mut self, body_count: usize, parts: usize) {
        let Colouring { nodes, ordered, used, hashed, places, order, ends, colour_count, ranks } = self;
        let new_ranks = Ranks { parts: parts.max(1), body_count };
        if ordered == nodes && *ranks == new_ranks {
            return;
        }
        *ranks = new_ranks;
        ordered.clone_from(nodes);
        used.clear();
        used.resize(body_count, 0);
        *colour_count = 0;
        counting_sort(nodes.len(), BUCKETS, |i| nodes[i].bucket.into(), hashed, ends);
        places.clear();
        places.resize(nodes.len(), 0);
        for &index in hashed.iter() {
            let Node { bodies: [a, b], size, cold, .. } = nodes[index as usize];
            let taken = used[a as usize] | used[b as usize];
            let colour = taken.trailing_ones().min(COLOURS_MAX.into());
            used[a as usize] |= 1 << colour;
            used[b as usize] |= 1 << colour;
            // Constraints never change the ground. Two constraints with the ground may therefore have the same colour.
            used[GROUND as usize] = 0;
            let place = place_of(colour, size);
            *colour_count = (*colour_count).max(place.div_ceil(2));
            places[index as usize] = place + if cold { PLACES } else { 0 };
        }
        let rank_of = |i: usize| ranks.rank_of(places[i], ranks.part_of(&nodes[i]));
        counting_sort(nodes.len(), ranks.count(), rank_of, order, ends);
    }

    /// Whether a constraint in the last [`Self::sort`] changes the body.
    pub(super) fn holds(&self, body: u32) -> bool {
        self.used.get(body as usize).is_some_and(|&colours| colours != 0)
    }

    pub(super) fn colour_of(&self, node: usize) -> Option<SolverColour> {
        self.places.get(node).map(|&place| match (place % PLACES).checked_sub(1) {
            None => SolverColour::Overflow,
            Some(place) => SolverColour::Group(place / 2),
        })
    }

    /// All constraints in the order of their [`Ranks`].
    pub(super) fn order(&self) -> &[u32] {
        &self.order
    }

    /// The constraints that fit no colour: the cold ones if `cold` is true, otherwise the warm ones.
    pub(super) fn overflow(&self, cold: bool) -> &[u32] {
        let place = if cold { PLACES } else { 0 };
        &self.order[self.start(place, 0)..self.end(place, 0)]
    }

    /// The coloured constraints of a thread, colour by colour. Colours that are empty for all threads are left out,
    /// because every operation iterates over the colours.
    pub(super) fn colours(&self, cold: bool, part: usize) -> impl Iterator<Item = Group<'_>> {
        let first = if cold { PLACES } else { 0 };
        let places = (0..self.colour_count).map(move |colour| first + place_of(colour.into(), Size::Large));
        let is_used = |place: &u8| self.end(place + 1, self.ranks.parts - 1) > self.start(*place, 0);
        places.filter(is_used).map(move |place| {
            let (start, middle) = (self.start(place, part), self.end(place, part));
            Group { indices: &self.order[start..self.end(place + 1, part)], large: middle - start }
        })
    }

    /// Index in `order` of the first constraint that has this place and belongs to the thread `part`.
    fn start(&self, place: u8, part: usize) -> usize {
        let rank = self.ranks.rank_of(place, part);
        rank.checked_sub(1).and_then(|last| self.ends.get(last)).map_or(0, |&end| end as usize)
    }

    /// Index in `order` one past the last constraint that has this place and belongs to the thread `part`.
    fn end(&self, place: u8, part: usize) -> usize {
        self.ends.get(self.ranks.rank_of(place, part)).map_or(0, |&end| end as usize)
    }
}

/// The order of the constraints: the overflow, then colour by colour. A colour is ordered by thread (`part`), and each
/// thread's constraints by size, large ones first. Cold constraints follow in the same order.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Ranks {
    parts: usize,
    body_count: usize,
}

impl Ranks {
    fn count(self) -> usize {
        2 * (1 + 2 * usize::from(COLOURS_MAX) * self.parts)
    }

    /// The thread that solves a constraint. The bodies are divided evenly among the threads, by index. The constraint
    /// belongs to the thread of the first body if the difference of the two indices is even, and otherwise to that of
    /// the second body. If the first body always decided, the first thread would get most constraints of a mixed heap.
    fn part_of(self, node: &Node) -> usize {
        let body = match node.bodies {
            [GROUND, body] | [body, GROUND] => body,
            [a, b] if (a ^ b) & 1 == 0 => a,
            [_, b] => b,
        };
        body as usize * self.parts / self.body_count
    }

    /// The rank of the constraints that have this place and belong to the thread `part`. The overflow has one rank for
    /// all threads.
    fn rank_of(self, place: u8, part: usize) -> usize {
        let first = if place < PLACES { 0 } else { self.count() / 2 };
        first
            + match (place % PLACES).checked_sub(1).map(usize::from) {
                None => 0,
                Some(place) => 1 + 2 * (place / 2 * self.parts + part) + place % 2,
            }
    }
}

/// Number of places of warm constraints. The places of cold constraints follow.
const PLACES: u8 = 1 + 2 * COLOURS_MAX;

/// The place in the order of a single thread: 0 for the overflow, then one place for the large and one for the small
/// constraints of each colour.
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

/// Sorts the indices `0..count` by bucket, stably, and lists the end of each bucket.
#[expect(clippy::cast_possible_truncation, reason = "constraints are counted in 32 bits")]
fn counting_sort(
    count: usize,
    buckets: usize,
    bucket_of: impl Fn(usize) -> usize,
    sorted: &mut Vec<u32>,
    ends: &mut Vec<u32>,
) {
    ends.clear();
    ends.resize(buckets, 0);
    for i in 0..count {
        ends[bucket_of(i)] += 1;
    }
    let mut start = 0;
    for end in ends.iter_mut() {
        start += core::mem::replace(end, start);
    }
    sorted.clear();
    sorted.resize(count, 0);
    for i in 0..count {
        let place = &mut ends[bucket_of(i)];
        sorted[*place as usize] = i as u32;
        *place += 1;
    }
}

#[cfg(test)]
mod tests;
