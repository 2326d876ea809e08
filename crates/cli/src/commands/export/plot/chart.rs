//! [`Chart`]: draws curves as an SVG document.

use std::fmt::Write;

use super::axis::{Axis, Unit};
use super::curve::Curve;
use crate::files::is_misleading;

/// Default width in pixels.
pub(super) const WIDTH: u32 = 960;
/// Default height of a panel with its title, in pixels.
const PANEL: u32 = 150;
/// Space above the panels in pixels.
const TOP: u32 = 30;
/// Space below the panels in pixels, for the time axis.
const BOTTOM: u32 = 42;
/// Space left of the curves in pixels, for labels.
const LEFT: f64 = 72.0;
/// Space right of the curves in pixels.
const RIGHT: f64 = 16.0;
/// Space above the curves of a panel in pixels, for its title.
const TITLE: f64 = 22.0;
/// Space below the curves of a panel in pixels.
const GAP: f64 = 14.0;
/// Maximum number of steps of the vertical axis.
const STEPS_UP: i64 = 4;
/// Maximum number of steps of the time axis.
const STEPS_ALONG: i64 = 10;

/// Panels of curves over a range of ticks, one below the other.
pub(super) struct Chart {
    pub(super) title: String,
    pub(super) panels: Vec<Panel>,
    pub(super) first: u64,
    pub(super) last: u64,
    /// Ticks per second.
    pub(super) rate: u32,
    pub(super) width: u32,
    pub(super) height: Option<u32>,
}

/// Curves with a common unit and axis.
pub(super) struct Panel {
    pub(super) title: &'static str,
    pub(super) unit: Unit,
    pub(super) curves: Vec<Curve>,
}

/// Rectangle of a panel's curves, in pixels.
struct Area {
    left: f64,
    right: f64,
    top: f64,
    bottom: f64,
}

impl Chart {
    pub(super) fn svg(&self) -> String {
        let count = self.panels.len().max(1) as u32;
        let width = self.width;
        let height = self.height.unwrap_or(TOP + count * PANEL + BOTTOM);
        let panel = f64::from(height.saturating_sub(TOP + BOTTOM)) / f64::from(count);
        let mut text = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"lockstep2d-plot\" width=\"{width}\" height=\"{height}\" \
             viewBox=\"0 0 {width} {height}\" font-family=\"ui-monospace,monospace\" font-size=\"12\" fill=\"#222\">\n\
             <rect width=\"{width}\" height=\"{height}\" fill=\"#fff\"/>\n<text x=\"8\" y=\"20\">{}</text>\n",
            escaped(&self.title)
        );
        for (at, curves) in (0u32..).zip(&self.panels) {
            let top = f64::from(TOP) + panel * f64::from(at);
            let (left, right) = (LEFT, (f64::from(width) - RIGHT).max(LEFT + 1.0));
            let area =
                Area { left, right, top: top + TITLE, bottom: (top + panel - GAP).max(top + TITLE + 1.0) };
            self.add_panel(&mut text, curves, &area);
            if at + 1 == count {
                self.add_time(&mut text, &area);
            }
        }
        text.push_str("</svg>\n");
        text
    }

    fn add_panel(&self, text: &mut String, panel: &Panel, area: &Area) {
        let low = panel.curves.iter().map(Curve::lowest).fold(0.0, f64::min);
        let high = panel.curves.iter().map(|curve| curve.highest().1).fold(0.0, f64::max);
        let (size, unit) = panel.unit.fitting(high.max(-low));
        let around = if panel.unit == Unit::Count { Axis::around_counts } else { Axis::around };
        let axis = around(low / size, high / size, STEPS_UP);
        let across = |value: f64| {
            area.bottom - (value - axis.low()) / (axis.high() - axis.low()) * (area.bottom - area.top)
        };
        let Area { left, right, top, bottom } = *area;
        push(
            text,
            format_args!(
                "<g>\n<rect x=\"{left}\" y=\"{top:.2}\" width=\"{:.2}\" height=\"{:.2}\" fill=\"#fafaf7\"/>\n",
                right - left,
                bottom - top
            ),
        );
        for (value, label) in axis.numbers() {
            let y = across(value);
            let colour = if value == 0.0 { "#999" } else { "#ddd" };
            push(
                text,
                format_args!(
                    "<path d=\"M{left} {y:.2}H{right}\" stroke=\"{colour}\"/>\
                     <text x=\"{:.2}\" y=\"{:.2}\" text-anchor=\"end\" font-size=\"11\">{label}</text>\n",
                    left - 6.0,
                    y + 4.0
                ),
            );
        }
        self.add_title(text, panel, area, (size, unit));
        for curve in &panel.curves {
            let points: Vec<String> = curve
                .points()
                .iter()
                .map(|&(tick, value)| format!("{:.2},{:.2}", self.along(tick, area), across(value / size)))
                .collect();
            push(
                text,
                format_args!(
                    "<polyline class=\"{}\" points=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"1.5\" \
                     stroke-linejoin=\"round\" stroke-linecap=\"round\"/>\n",
                    curve.name,
                    points.join(" "),
                    curve.colour
                ),
            );
        }
        text.push_str("</g>\n");
    }

    fn add_title(&self, text: &mut String, panel: &Panel, area: &Area, (size, unit): (f64, &str)) {
        let in_unit = if unit.is_empty() { String::new() } else { format!(" in {unit}") };
        push(
            text,
            format_args!(
                "<text x=\"{}\" y=\"{:.2}\"><tspan font-weight=\"bold\">{}</tspan>{in_unit}",
                area.left,
                area.top - 6.0,
                panel.title
            ),
        );
        for curve in &panel.curves {
            let (tick, value) = curve.highest();
            let digits = if panel.unit == Unit::Count { 0 } else { 3 };
            push(
                text,
                format_args!(
                    "<tspan dx=\"14\" fill=\"{}\">{}{}at most {:.digits$} at tick {tick}</tspan>",
                    curve.colour,
                    if panel.curves.len() > 1 { curve.name } else { "" },
                    if panel.curves.len() > 1 { " " } else { "" },
                    value / size
                ),
            );
        }
        text.push_str("</text>\n");
    }

    fn add_time(&self, text: &mut String, area: &Area) {
        let rate = f64::from(self.rate);
        let axis = Axis::around(self.first as f64 / rate, self.last as f64 / rate, STEPS_ALONG);
        let span = (self.last - self.first).max(1) as f64 / rate;
        for (seconds, label) in axis.numbers() {
            let x = area.left + (seconds - self.first as f64 / rate) / span * (area.right - area.left);
            if !(area.left - 0.01..=area.right + 0.01).contains(&x) {
                continue;
            }
            push(
                text,
                format_args!(
                    "<path d=\"M{x:.2} {:.2}v5\" stroke=\"#999\"/>\
                     <text x=\"{x:.2}\" y=\"{:.2}\" text-anchor=\"middle\" font-size=\"11\">{label}</text>\n",
                    area.bottom,
                    area.bottom + 18.0
                ),
            );
        }
        let middle = (area.left + area.right) / 2.0;
        push(
            text,
            format_args!(
                "<text x=\"{middle:.2}\" y=\"{:.2}\" text-anchor=\"middle\">time in s</text>\n",
                area.bottom + 36.0
            ),
        );
    }

    fn along(&self, tick: u64, area: &Area) -> f64 {
        let share = (tick - self.first) as f64 / (self.last - self.first).max(1) as f64;
        area.left + share * (area.right - area.left)
    }
}

fn push(text: &mut String, arguments: std::fmt::Arguments<'_>) {
    text.write_fmt(arguments).expect("a String takes any text");
}

/// Escapes text for XML. [Misleading](is_misleading) characters, U+FFFE and U+FFFF become U+FFFD.
fn escaped(raw: &str) -> String {
    let mut text = String::new();
    for character in raw.chars() {
        match character {
            '<' => text.push_str("&lt;"),
            '>' => text.push_str("&gt;"),
            '&' => text.push_str("&amp;"),
            '\u{fffe}' | '\u{ffff}' => text.push('\u{fffd}'),
            other if is_misleading(other) => text.push('\u{fffd}'),
            other => text.push(other),
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curves_are_where_their_values_are() {
        let mut curve = Curve::new("value", "#000", 0, 4);
        [0.0, 5.0, 10.0, -10.0, 2.5].iter().zip(0..).for_each(|(value, tick)| curve.add(tick, *value));
        let panel = Panel { title: "a < b", unit: Unit::Count, curves: vec![curve] };
        let chart = Chart {
            title: "<&>".into(),
            panels: vec![panel],
            first: 0,
            last: 4,
            rate: 4,
            width: 488,
            height: Some(TOP + BOTTOM + 136),
        };
        let svg = chart.svg();
        // x goes from 72 at tick 0 to 472 at tick 4. y goes from 52 at value 10 to 152 at value -10.
        assert!(
            svg.contains("points=\"72.00,102.00 172.00,77.00 272.00,52.00 372.00,152.00 472.00,89.50\""),
            "{svg}"
        );
        assert!(svg.contains("at most 10 at tick 2") && svg.contains("&lt;&amp;&gt;"), "{svg}");
        for label in [">-10<", ">-5<", ">0<", ">5<", ">10<", ">0.0<", ">0.5<", ">1.0<"] {
            assert!(svg.contains(label), "{label} in {svg}");
        }
    }
}
