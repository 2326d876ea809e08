//! A wall of boxes that do not sleep, with every second row shifted by half a box.

/// Columns of the wall.
const COLUMNS: usize = 20;

/// Half the width and height of a box.
pub const HALF: f32 = 0.5;
/// Half the width and height of the floor, whose top is at height 0.
pub const FLOOR: (f32, f32) = (60.0, 1.0);

/// Centre of a box in 64ths of a metre, which fixed point and floats represent exactly.
pub fn place(number: usize) -> (i16, i16) {
    let (row, column) = (number / COLUMNS, number % COLUMNS);
    let x = 66 * column + 32 * (row % 2);
    let y = 32 + 65 * row;
    let bits = |length: usize| i16::try_from(length).unwrap_or(i16::MAX);
    (bits(x) - 640, bits(y))
}

/// Centre of a box in metres.
pub fn metres(number: usize) -> (f32, f32) {
    let (x, y) = place(number);
    (f32::from(x) / 64.0, f32::from(y) / 64.0)
}
