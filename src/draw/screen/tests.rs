use super::*;
use alloc::string::ToString;

fn screen(half: Fx) -> Screen {
    let corner = Vec2::new(half, half);
    Screen::new(Aabb::new(-corner, corner), (1000, 500))
}

#[test]
fn hundredths_print_without_zeros_at_the_end() {
    let cases = [(0, "0"), (-5, "-0.05"), (150, "1.5"), (-1234, "-12.34"), (200, "2"), (1001, "10.01")];
    for (hundredths, text) in cases {
        assert_eq!(Pixel(hundredths).to_string(), text);
    }
}

#[test]
fn the_window_is_in_the_middle_and_upright() {
    let screen = screen(fx!(5));
    assert_eq!(screen.place(Vec2::ZERO), (Pixel(50_000), Pixel(25_000)));
    assert_eq!(screen.place(Vec2::new(fx!(1), fx!(5))), (Pixel(55_000), Pixel(0)));
    assert_eq!(screen.length(fx!(0.5)), Pixel(2500));
    assert!(
        screen.seen.contains_point(Vec2::new(fx!(10), fx!(-5))),
        "the window should have the aspect ratio of the picture"
    );
}

#[test]
fn the_widest_and_the_narrowest_window_have_a_scale() {
    let all = screen(Fx::MAX);
    assert_eq!(all.place(Vec2::new(Fx::MAX, Fx::MAX)).1, Pixel(0));
    let point = screen(Fx::ZERO);
    assert_eq!(point.length(WINDOW_MIN), Pixel(50_000));
}

#[test]
fn lines_end_a_little_outside() {
    let screen = screen(fx!(5));
    let across = |y: Fx| (Vec2::new(fx!(-1000000000), y), Vec2::new(fx!(1000000000), y));
    let (west, east) = across(fx!(-1));
    let (from, to) = screen.clipped(west, east).unwrap();
    assert_eq!((from.y, to.y), (fx!(-1), fx!(-1)));
    assert_eq!((from.x.min(to.x), from.x.max(to.x)), (screen.seen.lower.x, screen.seen.upper.x));
    let (west, east) = across(fx!(6));
    assert_eq!(screen.clipped(west, east), None);
    let inside = (Vec2::new(fx!(1), fx!(2)), Vec2::new(fx!(3), fx!(4)));
    assert_eq!(screen.clipped(inside.0, inside.1), Some(inside));
}
