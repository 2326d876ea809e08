//! Worlds and their settings.

use lockstep2d::math::Fx;
use lockstep2d::world::{Config, Section, World};

use crate::border::{In, Out};
use crate::describe::api;
use crate::numbers::{RawFx, RawHash};
use crate::records::RawConfig;
use crate::status::value;
use crate::table::{self, with};

api! {
    /// Sets the default settings of a world: 60 ticks per second, gravity of 10 m/s² downwards.
    fn ls2d_config_init(config: Out<'_, RawConfig>) {
        let mut config = config;
        config.set(RawConfig::of(&Config::default()))
    }

    /// Copies the settings `from` to `config`, adapted to small boxes. Raises the number of sub-steps (to at most 64
    /// per tick and 4000 per second) and the contact stiffness, so that a stack of 8 boxes of `size` metres sinks by
    /// less than 2.5 % of `size`. Reduces the speculative distance to a fiftieth of `size`, but not below 1 mm. Set
    /// gravity and the tick rate in `from` before this call.
    fn ls2d_config_for_smallest(config: Out<'_, RawConfig>, from: In<'_, RawConfig>, size: RawFx) {
        let mut config = config;
        let adapted = from.get()?.config()?.for_smallest(size.fx());
        config.set(RawConfig::of(&adapted))
    }

    /// Makes an empty world. A null `config` stands for the default settings.
    fn ls2d_world_new(config: In<'_, RawConfig>, world: Out<'_, u32>) {
        let mut world = world;
        world.check()?;
        let config = if config.is_null() { Config::default() } else { config.get()?.config()? };
        world.set(table::add(World::new(config)?)?)
    }

    /// Makes a copy of a world.
    fn ls2d_world_clone(world: u32, copy: Out<'_, u32>) {
        let mut copy = copy;
        copy.check()?;
        let cloned = with(world, |world: &mut World| Ok(world.clone()))?;
        copy.set(table::add(cloned)?)
    }

    /// Advances a world by one tick.
    fn ls2d_world_step(world: u32) {
        with(world, |world: &mut World| {
            world.step();
            Ok(())
        })
    }

    /// Advances a world by a number of ticks. Afterwards, the event functions return the events of the last tick.
    fn ls2d_world_steps(world: u32, ticks: u32) {
        with(world, |world: &mut World| {
            (0..ticks).for_each(|_| world.step());
            Ok(())
        })
    }

    /// Hash of the state of a world. Equal settings, edits and ticks in the same order give equal hashes on every
    /// machine.
    fn ls2d_world_hash(world: u32, hash: Out<'_, RawHash>) {
        let mut hash = hash;
        with(world, |world: &mut World| hash.set(RawHash::of(world.state_hash())))
    }

    /// Hash of one section of the state. `section` is 0 (settings, tick and fault count), 1 (bodies), 2 (shapes), 3
    /// (joints), 4 (contacts), 5 (islands), or 6 (random number generator).
    fn ls2d_world_digest(world: u32, section: u32, hash: Out<'_, RawHash>) {
        let mut hash = hash;
        let sections = [
            Section::World,
            Section::Bodies,
            Section::Shapes,
            Section::Joints,
            Section::Contacts,
            Section::Islands,
            Section::Random,
        ];
        let wanted = usize::try_from(section).ok().and_then(|section| sections.get(section));
        let wanted = wanted.ok_or_else(|| value("a section", section))?;
        with(world, |world: &mut World| {
            let digest = world.digest().sections.into_iter().find(|(section, _)| section == wanted);
            hash.set(RawHash::of(digest.map(|(_, digest)| digest).unwrap_or_default()))
        })
    }

    /// Number of ticks since the world was made.
    fn ls2d_world_tick(world: u32, tick: Out<'_, u64>) {
        let mut tick = tick;
        with(world, |world: &mut World| tick.set(world.tick()))
    }

    /// Number of faults since the world was made: results of the solver that were clamped to the range of their number
    /// format, and ticks with more pairs than `pair_limit`. Limiting a body to the largest speed does not count.
    fn ls2d_world_faults(world: u32, faults: Out<'_, u64>) {
        let mut faults = faults;
        with(world, |world: &mut World| faults.set(world.faults()))
    }

    /// The settings of a world.
    fn ls2d_world_config(world: u32, config: Out<'_, RawConfig>) {
        let mut config = config;
        with(world, |world: &mut World| config.set(RawConfig::of(world.config())))
    }

    /// Numbers of bodies, shapes, joints, awake bodies, and pairs of shapes with overlapping fat AABBs. Each pointer
    /// may be null.
    fn ls2d_world_counts(
        world: u32,
        bodies: Out<'_, usize>,
        shapes: Out<'_, usize>,
        joints: Out<'_, usize>,
        awake: Out<'_, usize>,
        pairs: Out<'_, usize>,
    ) {
        let outs = [bodies, shapes, joints, awake, pairs];
        with(world, |world: &mut World| {
            let counts = [
                world.body_count(),
                world.shape_count(),
                world.joint_count(),
                world.awake_body_count(),
                world.pair_count(),
            ];
            outs.into_iter().zip(counts).try_for_each(|(mut out, count)| out.set_if_wanted(count))
        })
    }

    /// Draws a number of 32 bits from the world's generator, which is part of the state.
    fn ls2d_world_random(world: u32, number: Out<'_, u32>) {
        let mut number = number;
        number.check()?;
        with(world, |world: &mut World| number.set(world.rng().next_u32()))
    }

    /// Draws a uniform number below `bound` from the world's generator.
    fn ls2d_world_random_below(world: u32, bound: u32, number: Out<'_, u32>) {
        let mut number = number;
        number.check()?;
        with(world, |world: &mut World| number.set(world.rng().below(bound)))
    }

    /// Draws a uniform number from `low` to below `high` from the world's generator.
    fn ls2d_world_random_range(world: u32, low: RawFx, high: RawFx, number: Out<'_, RawFx>) {
        let mut number = number;
        number.check()?;
        let (low, high): (Fx, Fx) = (low.fx(), high.fx());
        with(world, |world: &mut World| number.set(RawFx::of(world.rng().range(low, high))))
    }

    /// Rebuilds the caches of a world from its state. The hash of the world does not change. There are no events until
    /// the next tick.
    fn ls2d_world_clear_scratch(world: u32) {
        with(world, |world: &mut World| {
            world.clear_scratch();
            Ok(())
        })
    }
}
