//! Formats the results as tables.

use crate::compare::{Each, SceneResult, Summary};
use crate::measure::{EndState, Keeping};

fn optional(value: Option<f64>, digits: usize) -> String {
    value.map_or_else(|| "-".into(), |value| format!("{value:.digits$}"))
}

fn spread(quartiles: Option<[f64; 2]>) -> String {
    quartiles.map_or_else(|| "-".into(), |[low, high]| format!("{low:.2}-{high:.2}"))
}

pub fn times_head() -> String {
    format!(
        "{:14} {:>9} {:>9} {:>9} {:>9} {:>11} {:>10} {:>11}",
        "scene", "ours ms", "Box2D ms", "rapier ms", "vs Box2D", "quartiles", "vs rapier", "quartiles"
    )
}

pub fn times(result: &SceneResult) -> String {
    format!(
        "{:14} {:9.2} {:9.2} {:>9} {:9.2} {:>11} {:>10} {:>11}",
        result.scene,
        result.ms,
        result.box2d_ms,
        optional(result.rapier_ms, 2),
        result.vs_box2d,
        spread(Some(result.vs_box2d_quartiles)),
        optional(result.vs_rapier, 2),
        spread(result.vs_rapier_quartiles)
    )
}

pub fn summary(summary: &Summary) -> String {
    format!(
        "{:14} {:>39} {:>22}",
        "geometric mean",
        optional(summary.geomean_vs_box2d, 2),
        optional(summary.geomean_vs_rapier, 2)
    )
}

fn rows<T>(scene: &str, each: &Each<Option<T>>, row: impl Fn(&T) -> String) -> String {
    let engines = [("ours", &each.ours), ("Box2D", &each.box2d), ("rapier", &each.rapier)];
    let mut text = String::new();
    for (engine, value) in engines {
        if let Some(value) = value {
            text += &format!("{scene:14} {engine:6} {}\n", row(value));
        }
    }
    text
}

pub fn ends(results: &[SceneResult]) -> String {
    let mut text = format!(
        "{:14} {:6} {:>8} {:>8} {:>9} {:>9} {:>9} {:>9} {:>9} {:>7}\n",
        "end state",
        "",
        "top m",
        "bottom m",
        "depth mm",
        "mean m/s",
        "max m/s",
        "contacts",
        "gap mm",
        "awake"
    );
    let row = |end: &EndState| {
        format!(
            "{:8.2} {:8.2} {:9.1} {:9.3} {:9.2} {:9} {:>9} {:7}",
            end.top,
            end.bottom,
            end.deepest_mm,
            end.mean_speed,
            end.max_speed,
            end.contacts,
            optional(end.joint_gap_mm, 1),
            end.awake
        )
    };
    for result in results {
        text += &rows(&result.scene, &result.end, row);
    }
    text
}

pub fn keeping(results: &[SceneResult]) -> String {
    let mut text = format!(
        "{:14} {:6} {:>9} {:>11} {:>9} {:>11}\n",
        "whole world", "", "save ms", "restore ms", "hash ms", "bytes/body"
    );
    let row = |keeping: &Keeping| {
        format!(
            "{:9.3} {:11.3} {:>9} {:11.0}",
            keeping.save_ms,
            keeping.restore_ms,
            optional(keeping.hash_ms, 3),
            keeping.bytes_per_body
        )
    };
    for result in results {
        text += &rows(&result.scene, &result.keeping, row);
    }
    text
}
