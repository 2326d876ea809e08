//! [`Colour`].

/// A colour with opacity, in sRGB, not premultiplied.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Colour {
    /// Red, green and blue.
    pub rgb: [u8; 3],
    /// From 0, invisible, to 255.
    pub opacity: u8,
}

impl Colour {
    /// Nothing to see.
    pub const NONE: Self = Colour { rgb: [0; 3], opacity: 0 };

    /// An opaque colour, written as in HTML: `0xRRGGBB`.
    #[must_use]
    pub const fn hex(rgb: u32) -> Self {
        let [_, red, green, blue] = rgb.to_be_bytes();
        Colour { rgb: [red, green, blue], opacity: 255 }
    }

    /// The same with another opacity.
    #[must_use]
    pub const fn with_opacity(self, opacity: u8) -> Self {
        Colour { opacity, ..self }
    }

    /// Whether there is nothing to see.
    #[must_use]
    pub const fn is_none(self) -> bool {
        self.opacity == 0
    }
}
