//! The description of a snapshot of a world.

use lockstep2d::world::World;
use serde_json::json;

use super::Arguments;
use crate::console::Console;
use crate::context::CommandResult;
use crate::counts::Counts;
use crate::exit::Exit;
use crate::files::Shown;

pub(super) fn print(
    world: &World,
    bytes: usize,
    arguments: &Arguments,
    console: &mut Console<'_>,
) -> CommandResult {
    let (tick, hash, counts) = (world.tick(), world.state_hash(), Counts::of(world));
    let (rate, semantics) = (world.config().tick_rate, lockstep2d::SEMANTICS);
    if arguments.json {
        let document = json!({
            "file": arguments.file.display().to_string(),
            "kind": "snapshot",
            "semantics": semantics,
            "bytes": bytes,
            "tick": tick,
            "tick_rate": rate,
            "hash": hash.to_string(),
            "counts": counts,
        });
        console.json(&document)?;
        return Ok(Exit::Success);
    }
    console.line(format_args!("{}: snapshot of a world, {bytes} bytes", Shown(&arguments.file)))?;
    console.line(format_args!("engine semantics {semantics}"))?;
    console.line(format_args!("tick {tick}, {rate} ticks per second, state {hash}"))?;
    console.line(counts)?;
    Ok(Exit::Success)
}
