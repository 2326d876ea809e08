//! Pictures of one tick.

use lockstep2d::draw::{self, View};
use lockstep2d::world::World;
use lockstep2d_render::{Colour, DrawList, Image, page, raster};

use super::format::Format;
use super::{Arguments, Output};
use crate::console::Console;
use crate::context::CommandResult;

/// Writes an SVG document for [`Format::Svg`], and a PNG file for any other format.
pub(super) fn write(
    world: &World,
    view: &View,
    format: Format,
    arguments: &Arguments,
    console: &mut Console<'_>,
) -> CommandResult {
    Output::write(arguments, console, |output| match format {
        Format::Svg => output.line(draw::svg(world, view).trim_end()),
        _ => {
            let (to, failed) = output.parts();
            image(&mut DrawList::default(), world, view).write_png(to).map_err(failed)
        }
    })
}

/// Draws a world. `list` is cleared and reused.
pub(super) fn image(list: &mut DrawList, world: &World, view: &View) -> Image {
    list.clear();
    page(list, world, view);
    raster(list, (view.width, view.height), Colour::hex(0xffffff))
}
