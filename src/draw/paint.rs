//! [`Paint`]: the appearance of styles.

use super::primitive::{ContactProximity, Hue, Style};

/// Appearance of a style on a light background.
///
/// ```
/// use lockstep2d::draw::{Fill, Paint, Style};
/// // The colours of the pictures, for a custom renderer.
/// let Paint { fill, stroke, .. } = Style::Dynamic.paint();
/// let Some(Fill { opacity, .. }) = fill else { panic!("bodies are filled") };
/// assert!(opacity < 100 && stroke != Style::Asleep.paint().stroke);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Paint {
    /// Name in a legend. Styles with the same meaning share a name.
    pub name: &'static str,
    /// Colour of lines, marks and text, as `0xRRGGBB`.
    pub stroke: u32,
    /// Fill of the enclosed area.
    pub fill: Option<Fill>,
    /// Width of lines and size of marks in hundredths of a pixel. The SVG reduces the width for small bodies.
    pub width: u16,
}

/// A colour and its opacity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fill {
    /// Colour as `0xRRGGBB`.
    pub colour: u32,
    /// Opacity in percent.
    pub opacity: u8,
}

/// Background colour, as `0xRRGGBB`.
pub const PAPER: u32 = 0xfafaf7;

/// Colour of the text of a legend, as `0xRRGGBB`.
const INK: u32 = 0x222222;

/// Colours by [`Hue::index`], from P. Tol's qualitative schemes, which are distinguishable with most colour vision
/// deficiencies. Neighbouring colours differ strongly.
const HUES: [u32; Hue::COUNT as usize] = [
    0x4477aa, 0xee6677, 0x228833, 0xccbb44, 0x66ccee, 0xaa3377, 0xee7733, 0x009988, 0x332288, 0x999933,
    0xcc3311, 0x882255,
];

impl Style {
    /// The appearance of this style.
    #[must_use]
    pub const fn paint(self) -> Paint {
        match self {
            Style::Sensor => shape("sensor", 0x9a7d0a, 0xf7dc6f, 25),
            Style::Fixed => shape("fixed", 0x6d6d68, 0xdddcd6, 100),
            Style::Kinematic => shape("kinematic", 0x00796b, 0xb2dfdb, 75),
            Style::Dynamic => shape("dynamic", 0x1f5f9e, 0xc5ddf2, 75),
            Style::Asleep => shape("asleep", 0x7d8794, 0xe2e5e9, 75),
            Style::Island(hue) => shape("islands, a colour each", hue_of(hue), hue_of(hue), 35),
            Style::BroadPhase => mark("broad phase", 0xc08a3e, 60),
            Style::FatBox => mark("fat box", 0xb9b9b0, 70),
            Style::JointArm => mark("joint", 0x8e24aa, 120),
            Style::Velocity => mark("velocity", 0x2e7d32, 180),
            Style::CentreOfMass => mark("centre of mass", 0x1a237e, 380),
            Style::JointAnchor => mark("anchor", 0x8e24aa, 700),
            Style::JointGap => mark("joint error", 0xff4081, 300),
            Style::JointError => mark("joint error", 0x6a1b9a, 100),
            Style::ContactNormal(ContactProximity::Speculative) => mark("about to touch", 0xe69500, 130),
            Style::ContactPoint(ContactProximity::Speculative) => mark("about to touch", 0xe69500, 500),
            Style::ContactNormal(ContactProximity::Touching) => mark("touching", 0xc62828, 130),
            Style::ContactPoint(ContactProximity::Touching) => mark("touching", 0xc62828, 500),
            Style::ContactForce => mark("force", 0xd500f9, 200),
            Style::ContactFriction => mark("friction", 0x00b8d4, 200),
            Style::SolverGroup(hue) => mark("solver groups, a colour each", hue_of(hue), 700),
            Style::SolverOverflow => mark("no solver group", 0x000000, 900),
            Style::Id => mark("body", 0x263238, 100),
        }
    }

    pub(super) const fn legend_colour(self) -> u32 {
        match self {
            Style::Island(_) | Style::SolverGroup(_) => INK,
            _ => self.paint().stroke,
        }
    }
}

const fn hue_of(hue: Hue) -> u32 {
    HUES[hue.index() as usize]
}

const fn shape(name: &'static str, stroke: u32, colour: u32, opacity: u8) -> Paint {
    Paint { name, stroke, fill: Some(Fill { colour, opacity }), width: 120 }
}

const fn mark(name: &'static str, stroke: u32, width: u16) -> Paint {
    Paint { name, stroke, fill: None, width }
}
