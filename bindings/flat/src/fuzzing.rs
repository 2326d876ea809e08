//! Calls random functions of the API with arguments drawn from input bytes. Many of these arguments are invalid.

use crate::border::{In, Out, Plain};
use crate::functions::DRAWN;
use crate::numbers::{RawAngle, RawBody, RawFx, RawHash, RawJoint, RawShape};
use crate::status::Status;

pub(crate) type DrawnCall = fn(&mut Caller<'_>);

/// Number of items in a buffer, unless the items are bytes.
const ITEMS: usize = 64;
/// Number of bytes in a buffer of bytes.
const BYTES: usize = 4096;

/// A `Caller` remembers at most this many handles of objects, and as many ids of bodies, shapes and joints.
const REMEMBERED: usize = 12;

/// Names of parameters that are handles. A `Caller` passes a handle from an output mostly to parameters that have the
/// name of this output. The output `copy` counts as `world`, and the outputs `rules` and `name` count as `bytes`.
const HANDLES: [&str; 11] = [
    "world",
    "target",
    "handle",
    "commands",
    "snapshot",
    "bytes",
    "recording",
    "recorder",
    "replay",
    "timeline",
    "copy",
];

#[derive(Debug)]
struct Buffer {
    item: usize,
    /// The kind of object, if the parameter is a handle.
    handle: Option<&'static str>,
    is_output: bool,
    words: Box<[u64]>,
}

/// A simulated user of the API, with the results of its earlier calls.
#[derive(Debug)]
pub struct Caller<'a> {
    input: std::slice::Iter<'a, u8>,
    handles: Vec<(&'static str, u32)>,
    ids: Vec<u64>,
    /// The last output for each item size.
    known: Vec<(usize, Box<[u64]>)>,
    buffers: Vec<Buffer>,
    /// Number of items in the buffer of the last pointer argument.
    items: usize,
    codes: Vec<i32>,
}

/// Calls functions until the input is used up. Returns the status codes of the calls, and the lower halves of the
/// hashes that the worlds have at the end.
///
/// # Panics
/// If a call returns the code of an internal error.
#[must_use]
pub fn run(input: &[u8]) -> (Vec<i32>, Vec<u64>) {
    let calls: Vec<_> = DRAWN.iter().copied().flatten().collect();
    let (handles, ids, known, buffers, codes) = Default::default();
    let mut caller = Caller { input: input.iter(), handles, ids, known, buffers, items: 0, codes };
    let mut made = caller.begin();
    while !caller.input.as_slice().is_empty() {
        let call = calls.get(caller.below(calls.len())).copied();
        call.into_iter().for_each(|call| call(&mut caller));
        made.extend(caller.harvest());
    }
    let hashes = made.iter().filter_map(|&handle| hash(handle)).collect();
    for handle in made {
        let _ = crate::ls2d_free(handle);
    }
    (caller.codes, hashes)
}

fn hash(world: u32) -> Option<u64> {
    let mut hash = RawHash { low: 0, high: 0 };
    (crate::ls2d_world_hash(world, Out::of(&mut hash)) == 0).then_some(hash.low)
}

/// The kind of object that a parameter refers to; `None` if the parameter is not a handle.
fn family(name: &str) -> Option<&'static str> {
    let name = match name {
        "copy" => "world",
        "rules" | "name" => "bytes",
        _ => name,
    };
    HANDLES.into_iter().find(|&handle| handle == name)
}

impl Caller<'_> {
    fn begin(&mut self) -> Vec<u32> {
        let [mut world, mut commands] = [0; 2];
        let _ = crate::ls2d_world_new(In::null(), Out::of(&mut world));
        let _ = crate::ls2d_commands_new(Out::of(&mut commands));
        self.handles.extend([("world", world), ("commands", commands)]);
        vec![world, commands]
    }

    fn byte(&mut self) -> u8 {
        self.input.next().copied().unwrap_or(0)
    }

    fn word(&mut self) -> u64 {
        (0..8).fold(0, |word, _| word << 8 | u64::from(self.byte()))
    }

    fn below(&mut self, bound: usize) -> usize {
        (usize::from(self.byte()) << 8 | usize::from(self.byte())) % bound.max(1)
    }

    /// Draws a handle, mostly of the kind that the parameter `name` expects.
    fn handle(&mut self, name: &str) -> u32 {
        let index = usize::from(self.byte());
        let any = self.byte() < 16;
        let suits = |of: &str| any || of == name || name == "target" && matches!(of, "world" | "commands");
        let known: Vec<u32> =
            self.handles.iter().filter(|(of, _)| suits(of)).map(|&(_, handle)| handle).collect();
        known.get(index % known.len().max(1)).copied().unwrap_or(0)
    }

    /// Draws a number with 32 fraction bits: a multiple of 1/16 from about -8 to 8, or rarely an extreme or any value.
    fn number(&mut self) -> u64 {
        match self.byte() {
            0 => self.word(),
            1 => i64::MAX.cast_unsigned(),
            2 => i64::MIN.cast_unsigned(),
            byte => (i64::from(byte) - 128).cast_unsigned() << 28,
        }
    }

    fn id(&mut self) -> u64 {
        let (wrong, index) = (self.byte() < 16, usize::from(self.byte()));
        let known = self.ids.get(index % self.ids.len().max(1)).copied().filter(|_| !wrong);
        known.unwrap_or_else(|| self.word())
    }

    /// Draws memory for a parameter that points to items of `item` bytes. The memory is filled with zeros or with an
    /// earlier output; if the parameter is an input, up to three words are then changed. Returns the address and an
    /// offset to add to it: 1 byte to make the pointer misaligned, otherwise 0. `None` stands for a null pointer.
    fn buffer(&mut self, name: &str, item: usize, is_output: bool) -> Option<(*mut u64, usize)> {
        self.items = if item == 1 { BYTES } else { ITEMS };
        let kind = self.byte();
        if kind == 0 {
            return None;
        }
        let known = self.known.iter().find(|(size, _)| *size == item).map(|(_, words)| words.clone());
        let mut words = known.unwrap_or_else(|| vec![0; (self.items * item).div_ceil(8) + 1].into());
        if !is_output {
            for _ in 0..self.byte() % 4 {
                // Changes only words of the first two items (or of the first 64 bytes, if the items are small), because
                // most calls read no more.
                let (place, value) = (self.below((item / 4).max(8)), self.number());
                if let Some(word) = words.get_mut(place) {
                    *word = value;
                }
            }
        }
        self.buffers.push(Buffer { item, handle: family(name), is_output, words });
        let address = self.buffers.last_mut().map(|buffer| buffer.words.as_mut_ptr());
        address.map(|address| (address, usize::from(kind == 1)))
    }

    /// Remembers the values that the call has written. Returns the handles among them.
    fn harvest(&mut self) -> Vec<u32> {
        let mut made = Vec::new();
        for Buffer { item, handle, is_output, words } in std::mem::take(&mut self.buffers) {
            let first = words.first().copied().unwrap_or(0);
            if let Some(name) = handle.filter(|_| is_output && item == 4) {
                let handle = u32::try_from(first & u64::from(u32::MAX)).unwrap_or(0);
                if handle != 0 {
                    self.handles.push((name, handle));
                    made.push(handle);
                }
            } else if is_output && item == 8 && first < 1 << 53 {
                self.ids.push(first);
            }
            if is_output && handle.is_none() {
                self.known.retain(|(size, _)| *size != item);
                self.known.push((item, words));
            }
        }
        let forgotten = self.handles.len().saturating_sub(REMEMBERED);
        self.handles.drain(..forgotten);
        let forgotten = self.ids.len().saturating_sub(REMEMBERED);
        self.ids.drain(..forgotten);
        made
    }
}

pub(crate) trait Drawn {
    fn draw(caller: &mut Caller<'_>, name: &'static str) -> Self;
}

impl Drawn for u32 {
    fn draw(caller: &mut Caller<'_>, name: &str) -> Self {
        let byte = caller.byte();
        if HANDLES.contains(&name) && byte >= 16 {
            return caller.handle(name);
        }
        match byte {
            // Few ticks per call, because every tick takes time.
            _ if name == "ticks" => u32::from(byte % 8),
            0..16 => u32::try_from(caller.word() >> 32).unwrap_or(0),
            _ => u32::from(byte % 16),
        }
    }
}

impl Drawn for usize {
    fn draw(caller: &mut Caller<'_>, _: &str) -> Self {
        let items = caller.items;
        if caller.byte() < 128 { items.min(8) } else { caller.below(items + 1) }
    }
}

macro_rules! drawn {
    ($($type:ty: $caller:ident => $value:expr;)+) => {
        $(impl Drawn for $type {
            fn draw($caller: &mut Caller<'_>, _: &str) -> Self {
                $value
            }
        })+
    };
}

drawn! {
    u64: caller => caller.number() >> 16;
    i64: caller => caller.number().cast_signed();
    RawFx: caller => RawFx(caller.number().cast_signed());
    RawAngle: caller => RawAngle(u32::from(caller.byte()) << 24);
    RawBody: caller => RawBody(caller.id());
    RawShape: caller => RawShape(caller.id());
    RawJoint: caller => RawJoint(caller.id());
}

impl<T: Plain> Drawn for In<'_, T> {
    fn draw(caller: &mut Caller<'_>, name: &str) -> Self {
        let memory = caller.buffer(name, size_of::<T>(), false);
        memory.map_or(In::null(), |(address, offset)| In::to(address.cast::<T>().wrapping_byte_add(offset)))
    }
}

impl<T: Plain> Drawn for Out<'_, T> {
    fn draw(caller: &mut Caller<'_>, name: &str) -> Self {
        let memory = caller.buffer(name, size_of::<T>(), true);
        memory.map_or(Out::null(), |(address, offset)| Out::to(address.cast::<T>().wrapping_byte_add(offset)))
    }
}

pub(crate) trait Returned {
    /// The status code; `None` for a function that returns a value.
    fn code(self) -> Option<i32>;

    /// Records a status code. Panics if the call has failed with an internal error.
    fn check(self, caller: &mut Caller<'_>, name: &str)
    where
        Self: Sized,
    {
        let Some(code) = self.code() else { return };
        let failed = code == Status::Internal as i32 || code == Status::Broken as i32;
        assert!(!failed, "{name} has failed: {}", crate::status::last_text());
        caller.codes.push(code);
    }
}

impl Returned for i32 {
    fn code(self) -> Option<i32> {
        Some(self)
    }
}

macro_rules! values {
    ($($type:ty),+) => {
        $(impl Returned for $type {
            fn code(self) -> Option<i32> {
                None
            }
        })+
    };
}

values! { u32, usize, RawFx, RawAngle }
