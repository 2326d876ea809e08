//! Draws the screen, from back to front.

use lockstep2d::body::BodyId;
use lockstep2d::draw::{Form, Layers, Primitive, Style, Subject, primitives};
use lockstep2d::world::World;
use lockstep2d_render::{Brush, CELL_HEIGHT, Camera, Colour, DrawList, paint, width_of, world};

use super::compare::{Comparison, differing};
use super::layers::LayerList;
use super::timeline::Bar;
use super::{App, help, theme};

const LEFT: f32 = 12.0;
const TOP: f32 = 8.0;
/// Longest row of text, in characters.
const COLUMNS_MAX: usize = 120;

/// Highest place for the top of the layer list, as its y coordinate in pixels. Longer text above the list moves it
/// down.
const LAYERS_TOP: f32 = 136.0;

pub(super) fn draw(app: &mut App) {
    let (report, remarks) = (app.report(), app.remarks());
    let App { source, comparison, player, view, layers, inspector, hand, pointer, help, size, list, .. } =
        app;
    list.clear();
    list.rectangle([0.0; 2], *size, theme::GROUND);
    let mut lines = Vec::new();
    if let Some(source) = source {
        let shown = source.world();
        let camera = view.camera(shown, *size);
        world(list, shown, *layers, &camera, &Brush::suiting(shown, &camera));
        if let Some(id) = inspector.body {
            outline(list, shown, id, &camera, theme::SELECTED);
        }
        comparison.iter_mut().for_each(|comparison| draw_other(list, shown, comparison, *layers, &camera));
        let bodies = (shown.body_count(), shown.awake_body_count());
        let (contacts, joints, faults) = (shown.contacts().count(), shown.joint_count(), shown.faults());
        source.decorate(list, &camera);
        inspector.draw(list, source.as_mut(), *size);
        hand.draw(list, source.as_mut(), &camera, pointer.at);
        let marked =
            comparison.as_ref().and_then(|comparison| comparison.first.as_ref()).map(|first| first.tick);
        Bar::new(*size, source.as_ref()).draw(list, source.as_ref(), player.goal(), marked);
        let speed = if player.playing { player.speed() } else { "paused".into() };
        let tick = source
            .ticks()
            .map_or(format!("tick {}", report.tick), |end| format!("tick {} of {end}", report.tick));
        lines.push((theme::INK, format!("{} · {tick} · {} Hz · {speed}", report.name, source.tick_rate())));
        lines.extend(report.hash.map(|hash| (theme::INK, hash.to_string())));
        let form = source.playground().map(|_| format!(" · right button: {}", hand.form().name()));
        let counts =
            format!("{} bodies, {} awake · {contacts} contacts · {joints} joints", bodies.0, bodies.1);
        lines.push((theme::INK, format!("{counts} · {faults} faults{}", form.unwrap_or_default())));
    }
    if source.is_none() && remarks.is_empty() {
        lines.push((theme::INK, report.status));
    }
    lines.extend(remarks.into_iter().map(|remark| (remark.colour(), remark.text)));
    lines.push((theme::FAINT, "h: help".into()));
    let bottom = draw_lines(list, &lines, *size);
    let layer_list = LayerList { corner: [LEFT, LAYERS_TOP.max(bottom + CELL_HEIGHT / 2.0)] };
    let players = source.as_ref().map_or(Vec::new(), |source| source.keys());
    // The list is left out in a small window, and while people play, because it would cover their game.
    let fits = source.is_some() && layer_list.corner[1] + LayerList::size()[1] < size[1] - CELL_HEIGHT * 3.0;
    let is_in_the_way = player.playing && !players.is_empty() && !*help;
    app.layer_list = (fits && !is_in_the_way).then_some(layer_list);
    if let Some(layer_list) = app.layer_list {
        layer_list.draw(list, *layers);
    }
    if *help {
        let is_live = source.as_mut().is_some_and(|source| source.playground().is_some());
        help::draw(list, *size, is_live, &players);
    }
}

/// Draws lines of text. Returns the y coordinate of their lower edge.
fn draw_lines(list: &mut DrawList, lines: &[(Colour, String)], [width, _]: [f32; 2]) -> f32 {
    let columns = (((width - 2.0 * LEFT) / width_of("x", 1.0)) as usize).clamp(1, COLUMNS_MAX);
    let rows: Vec<_> = lines
        .iter()
        .flat_map(|(colour, line)| wrapped(line, columns).into_iter().map(move |row| (*colour, row)))
        .collect();
    let shown = rows.iter().map(|(_, row)| row.chars().count()).max().unwrap_or(0);
    let height = CELL_HEIGHT * rows.len() as f32;
    theme::panel(list, [LEFT, TOP], [width_of("x", 1.0) * shown as f32, height]);
    for (at, (colour, row)) in rows.into_iter().enumerate() {
        list.text([LEFT, TOP + at as f32 * CELL_HEIGHT], 1.0, colour, row);
    }
    TOP + height
}

fn wrapped(line: &str, columns: usize) -> Vec<String> {
    let characters: Vec<char> = line.chars().collect();
    characters.chunks(columns.max(1)).map(|row| row.iter().collect()).collect()
}

/// Draws the second world over the first, with a circle around each body that differs. The circle has a thicker line if
/// the body is that of the first difference between the replays.
fn draw_other(
    list: &mut DrawList,
    shown: &World,
    comparison: &mut Comparison,
    layers: Layers,
    camera: &Camera,
) {
    let first = comparison.first.as_ref().and_then(|first| first.body);
    let other = comparison.other.world();
    let tinted = Brush { tint: Some(theme::OTHER), ..Brush::suiting(other, camera) };
    let moving = |primitive: &Primitive| !matches!(primitive.style, Style::Fixed | Style::Sensor);
    let outlines = Layers { outlines: layers.outlines, ..Layers::NONE };
    for primitive in primitives(other, outlines).iter().filter(|primitive| moving(primitive)) {
        paint(list, primitive, camera, &tinted);
    }
    for id in differing(shown, other) {
        let width = if Some(id) == first { 3.0 } else { 1.0 };
        let Some(body) = shown.body(id).or(other.body(id)) else { continue };
        let place = camera.place(body.centre_of_mass());
        ring(list, place, 14.0, theme::BAD, width);
    }
}

/// Draws a body again in another colour.
fn outline(list: &mut DrawList, shown: &World, id: BodyId, camera: &Camera, colour: Colour) {
    let brush = Brush { tint: Some(colour), ..Brush::default() };
    let only = Layers { outlines: true, ..Layers::NONE };
    for primitive in primitives(shown, only).iter().filter(|found| found.subject == Subject::Body(id)) {
        paint(list, primitive, camera, &brush);
    }
    if let Some(body) = shown.body(id) {
        let form = Form::Point(body.centre_of_mass());
        paint(
            list,
            &Primitive { style: Style::CentreOfMass, subject: Subject::Body(id), form },
            camera,
            &brush,
        );
    }
}

fn ring(list: &mut DrawList, [x, y]: [f32; 2], radius: f32, colour: Colour, width: f32) {
    let points = (0..24).map(|i| {
        let (sin, cos) = (i as f32 * std::f32::consts::TAU / 24.0).sin_cos();
        [x + radius * cos, y + radius * sin]
    });
    list.polygon(points, Colour::NONE, colour, width);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_of_a_long_line_is_lost() {
        assert_eq!(wrapped("né·abc", 4), ["né·a", "bc"]);
        assert_eq!(wrapped("abcd", 4), ["abcd"]);
        assert_eq!(wrapped("abc", 0), ["a", "b", "c"]);
    }
}
