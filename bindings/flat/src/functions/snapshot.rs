//! Snapshots for rollbacks, and worlds as bytes.

use lockstep2d::world::{Snapshot, World};

use crate::border::{In, Out};
use crate::describe::api;
use crate::numbers::RawHash;
use crate::table::{self, Bytes, with, with_two};

api! {
    /// Saves the state of a world into a new snapshot.
    fn ls2d_world_save(world: u32, snapshot: Out<'_, u32>) {
        let mut snapshot = snapshot;
        snapshot.check()?;
        let saved = with(world, |world: &mut World| Ok(world.save()))?;
        snapshot.set(table::add(saved)?)
    }

    /// Saves a world into an existing snapshot, whose memory is reused.
    fn ls2d_world_save_into(world: u32, snapshot: u32) {
        with_two(world, snapshot, |world: &mut World, snapshot: &mut Snapshot| {
            world.save_into(snapshot);
            Ok(())
        })
    }

    /// Restores a world to a saved state.
    fn ls2d_world_restore(world: u32, snapshot: u32) {
        with_two(world, snapshot, |world: &mut World, snapshot: &mut Snapshot| {
            world.restore(snapshot);
            Ok(())
        })
    }

    /// Hash of a saved state.
    fn ls2d_snapshot_hash(snapshot: u32, hash: Out<'_, RawHash>) {
        let mut hash = hash;
        with(snapshot, |snapshot: &mut Snapshot| hash.set(RawHash::of(snapshot.state_hash())))
    }

    /// Encodes a world as bytes.
    fn ls2d_world_encode(world: u32, bytes: Out<'_, u32>) {
        let mut bytes = bytes;
        bytes.check()?;
        let encoded = with(world, |world: &mut World| Ok(world.to_bytes()))?;
        bytes.set(table::add(Bytes(encoded))?)
    }

    /// Makes a world from encoded bytes. The bytes may come from an untrusted source.
    fn ls2d_world_decode(data: In<'_, u8>, size: usize, world: Out<'_, u32>) {
        let mut world = world;
        world.check()?;
        world.set(table::add(World::from_bytes(data.slice(size)?)?)?)
    }
}
