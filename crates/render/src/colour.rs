//! [`Colour`]: sRGB colour with opacity.

/// Colour in sRGB with opacity, not premultiplied.
///
/// ```
/// use lockstep2d_render::Colour;
/// // A translucent shadow in a team's colour.
/// let team = Colour::hex(0xd62728);
/// let shadow = team.with_opacity(64);
/// assert_eq!((shadow.rgb, shadow.opacity), ([0xd6, 0x27, 0x28], 64));
/// assert!(team.with_opacity(0).is_none());
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Colour {
    /// Red, green and blue, from 0 to 255.
    pub rgb: [u8; 3],
    /// Opacity, from 0 (invisible) to 255.
    pub opacity: u8,
}

impl Colour {
    /// Fully transparent black.
    pub const NONE: Self = Colour { rgb: [0; 3], opacity: 0 };

    /// Opaque colour in the HTML notation `0xRRGGBB`.
    #[must_use]
    pub const fn hex(rgb: u32) -> Self {
        let [_, red, green, blue] = rgb.to_be_bytes();
        Colour { rgb: [red, green, blue], opacity: 255 }
    }

    /// The colour with another opacity.
    #[must_use]
    pub const fn with_opacity(self, opacity: u8) -> Self {
        Colour { opacity, ..self }
    }

    /// Whether the colour is fully transparent.
    #[must_use]
    pub const fn is_none(self) -> bool {
        self.opacity == 0
    }
}
