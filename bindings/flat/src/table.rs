//! Table of objects.
//!
//! A handle consists of a slot and a generation, which counts the objects that the slot has had. A slot is not reused
//! after its last generation. A stale handle therefore never refers to another object.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use lockstep2d::world::{Command, Snapshot, World};

#[cfg(feature = "lockstep")]
use crate::functions::{HostRecorder, HostReplay, Match, SandboxRecorder, SandboxTimeline};
use crate::status::{Failure, Outcome, Status};

/// Number of bits of a handle that hold the slot. The generation starts at 1, so that no handle is 0.
const SLOT_BITS: u32 = 20;
const SLOTS_MAX: usize = 1 << SLOT_BITS;
const GENERATION_MAX: u32 = (1 << (32 - SLOT_BITS)) - 1;

macro_rules! kinds {
    ($($(#[$condition:meta])* $variant:ident($type:ty), $name:literal;)+) => {
        pub(crate) enum Object {
            $($(#[$condition])* $variant(Box<$type>),)+
        }

        impl Object {
            fn name(&self) -> &'static str {
                match self {
                    $($(#[$condition])* Object::$variant(_) => $name,)+
                }
            }
        }

        $($(#[$condition])* impl Kind for $type {
            const NAME: &'static str = $name;

            fn find(object: &mut Object) -> Option<&mut Self> {
                match object {
                    Object::$variant(found) => Some(found),
                    _ => None,
                }
            }

            fn wrap(self) -> Object {
                Object::$variant(Box::new(self))
            }
        })+
    };
}

pub(crate) trait Kind: Sized {
    const NAME: &'static str;

    fn find(object: &mut Object) -> Option<&mut Self>;
    fn wrap(self) -> Object;
}

pub(crate) struct Bytes(pub(crate) Vec<u8>);

/// A list of commands that a world executes later.
pub(crate) struct Commands(pub(crate) Vec<Command>);

kinds! {
    World(World), "a world";
    Snapshot(Snapshot), "a snapshot";
    Bytes(Bytes), "bytes";
    Commands(Commands), "a list of commands";
    #[cfg(feature = "lockstep")]
    SandboxRecorder(SandboxRecorder), "a recording";
    #[cfg(feature = "lockstep")]
    SandboxTimeline(SandboxTimeline), "a timeline";
    #[cfg(feature = "lockstep")]
    HostRecorder(HostRecorder), "a recorder";
    #[cfg(feature = "lockstep")]
    HostReplay(HostReplay), "a replay";
    #[cfg(feature = "lockstep")]
    Match(Match), "a match";
}

type Shared = Arc<Mutex<Object>>;

struct Slot {
    generation: u32,
    object: Option<Shared>,
}

struct Table {
    slots: Vec<Slot>,
    free: Vec<u32>,
}

static TABLE: Mutex<Table> = Mutex::new(Table { slots: Vec::new(), free: Vec::new() });

/// Locks the table. Code that runs while the table is locked must not panic.
fn table() -> MutexGuard<'static, Table> {
    TABLE.lock().unwrap_or_else(PoisonError::into_inner)
}

fn unknown(handle: u32) -> Failure {
    Failure::new(Status::Handle, format!("no object has the handle {handle}"))
}

fn parts(handle: u32) -> (usize, u32) {
    let slot = handle & ((1 << SLOT_BITS) - 1);
    (usize::try_from(slot).unwrap_or(usize::MAX), handle >> SLOT_BITS)
}

pub(crate) fn add<T: Kind>(value: T) -> Outcome<u32> {
    let object = Arc::new(Mutex::new(value.wrap()));
    let mut table = table();
    let index = match table.free.pop() {
        Some(index) => index,
        None if table.slots.len() < SLOTS_MAX => {
            table.slots.push(Slot { generation: 0, object: None });
            u32::try_from(table.slots.len() - 1).unwrap_or(u32::MAX)
        }
        None => return Err(Failure::new(Status::Exhausted, "there are too many objects")),
    };
    let slot = usize::try_from(index).ok().and_then(|index| table.slots.get_mut(index));
    let slot = slot.ok_or_else(|| unknown(index))?;
    slot.generation += 1;
    slot.object = Some(object);
    Ok(index | slot.generation << SLOT_BITS)
}

/// Adds the bytes that `take` removes from another object. Calls `take` only if there is a free handle, because the
/// bytes would otherwise be lost.
#[cfg(feature = "lockstep")]
pub(crate) fn add_taken(take: impl FnOnce() -> Outcome<Vec<u8>>) -> Outcome<u32> {
    let handle = add(Bytes(Vec::new()))?;
    let filled = take().and_then(|taken| {
        with(handle, |Bytes(bytes)| {
            *bytes = taken;
            Ok(handle)
        })
    });
    if filled.is_err() {
        free(handle)?;
    }
    filled
}

fn get(handle: u32) -> Outcome<Shared> {
    let (index, generation) = parts(handle);
    let table = table();
    let slot = table.slots.get(index).filter(|slot| slot.generation == generation);
    slot.and_then(|slot| slot.object.clone()).ok_or_else(|| unknown(handle))
}

fn lock(object: &Shared) -> Outcome<MutexGuard<'_, Object>> {
    object.lock().map_err(|_| Failure::new(Status::Broken, "an earlier error has left the object unusable"))
}

fn find<T: Kind>(object: &mut Object) -> Outcome<&mut T> {
    let name = object.name();
    T::find(object).ok_or_else(|| {
        Failure::new(Status::HandleKind, format!("expected {}, the handle is of {name}", T::NAME))
    })
}

/// Calls `body` with an object.
pub(crate) fn with<T: Kind, R>(handle: u32, body: impl FnOnce(&mut T) -> Outcome<R>) -> Outcome<R> {
    let object = get(handle)?;
    let mut object = lock(&object)?;
    body(find(&mut object)?)
}

pub(crate) fn with_two<A: Kind, B: Kind, R>(
    a: u32,
    b: u32,
    body: impl FnOnce(&mut A, &mut B) -> Outcome<R>,
) -> Outcome<R> {
    let (object_a, object_b) = (get(a)?, get(b)?);
    if a == b {
        return Err(Failure::new(
            Status::HandleKind,
            "two objects are expected, and both handles are the same",
        ));
    }
    // Both objects are locked in the order of their handles, so that two threads cannot wait for each other.
    let (mut first, mut second);
    let (lock_a, lock_b) = if a < b {
        first = lock(&object_a)?;
        second = lock(&object_b)?;
        (&mut first, &mut second)
    } else {
        first = lock(&object_b)?;
        second = lock(&object_a)?;
        (&mut second, &mut first)
    };
    body(find(lock_a)?, find(lock_b)?)
}

pub(crate) fn with_any<R>(handle: u32, body: impl FnOnce(&mut Object) -> Outcome<R>) -> Outcome<R> {
    let object = get(handle)?;
    let mut object = lock(&object)?;
    body(&mut object)
}

fn remove(handle: u32) -> Outcome<Shared> {
    let (index, generation) = parts(handle);
    let mut table = table();
    let slot = table.slots.get_mut(index).filter(|slot| slot.generation == generation);
    let object = slot.and_then(|slot| slot.object.take()).ok_or_else(|| unknown(handle))?;
    if generation < GENERATION_MAX {
        let index = u32::try_from(index).map_err(|_| unknown(handle))?;
        table.free.push(index);
    }
    Ok(object)
}

/// Frees an object. If a call on another thread still uses the object, that call frees the memory at its end.
pub(crate) fn free(handle: u32) -> Outcome {
    // The object is dropped here, after `remove` has unlocked the table.
    remove(handle).map(drop)
}

pub(crate) fn count() -> usize {
    table().slots.iter().filter(|slot| slot.object.is_some()).count()
}
