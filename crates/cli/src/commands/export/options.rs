//! Parsers of the options for layers and windows.

use lockstep2d::draw::Layers;
use lockstep2d::math::{Aabb, Fx, Vec2};

/// Parses names of fields of [`Layers`] separated by commas, `all` or `none`.
pub(super) fn layers(text: &str) -> Result<Layers, String> {
    match text {
        "all" => return Ok(Layers::ALL),
        "none" => return Ok(Layers::NONE),
        _ => {}
    }
    let mut layers = Layers::NONE;
    for name in text.split(',').map(str::trim) {
        let mut named = layers.named();
        match named.iter_mut().find(|(known, _)| *known == name) {
            Some((_, shown)) => **shown = true,
            None => {
                let known: Vec<_> = named.iter().map(|(known, _)| *known).collect();
                return Err(format!("there is no layer {name:?}; there are all, none, {}", known.join(", ")));
            }
        }
    }
    Ok(layers)
}

/// Parses the coordinates of two opposite corners, separated by commas.
pub(super) fn window(text: &str) -> Result<Aabb, String> {
    let numbers: Vec<Fx> = text
        .split(',')
        .map(|number| number.trim().parse().map_err(|_| format!("{number:?} is not a length in metres")))
        .collect::<Result<_, _>>()?;
    let &[x0, y0, x1, y1] = &numbers[..] else {
        return Err("a window is four numbers with commas between them".into());
    };
    if x0 == x1 || y0 == y1 {
        return Err("a window has two corners that differ in both coordinates".into());
    }
    let (a, b) = (Vec2::new(x0, y0), Vec2::new(x1, y1));
    Ok(Aabb::new(a.min(b), a.max(b)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use lockstep2d::fx;

    #[test]
    fn layers_have_the_names_of_their_fields() {
        let expected = Layers { outlines: true, contact_points: true, ..Layers::NONE };
        assert_eq!(layers("outlines, contact_points"), Ok(expected));
        assert_eq!((layers("all"), layers("none")), (Ok(Layers::ALL), Ok(Layers::NONE)));
        let error = layers("outlines,shadows").unwrap_err();
        assert!(error.contains("\"shadows\"") && error.contains("velocities"), "{error}");
    }

    #[test]
    fn a_window_is_any_two_opposite_corners() {
        let expected = Aabb::new(Vec2::new(fx!(-1.5), fx!(0)), Vec2::new(fx!(2), fx!(3.25)));
        for text in ["-1.5,0,2,3.25", "2,3.25,-1.5,0", "-1.5, 3.25, 2, 0"] {
            assert_eq!(window(text), Ok(expected), "{text}");
        }
        for text in [
            "",
            "1,2,3",
            "1,2,3,4,5",
            "1,2,3,x",
            "1,2,3,1e99",
            "1,2,3,99999999999999999999",
            "1,2,1,2",
            "1,2,1,5",
        ] {
            assert!(window(text).is_err(), "{text}");
        }
    }
}
