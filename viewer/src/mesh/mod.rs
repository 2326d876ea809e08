//! [`Mesh`]: a draw list as triangles, for a graphics card.
//!
//! Everything is drawn in order by one kind of triangle, so that text, outlines and areas can lie on top of each other.
//! What a pixel is covered by is computed where it is drawn, from a [`Vertex::sample`]: for shapes
//!
//! ```text
//! coverage = clamp(reach - |distance|, 0, 1)
//! ```
//!
//! with the distance from the middle of a line in pixels of the screen and a reach of half its width and half a pixel
//! more: edges are smooth over one pixel, and a line takes two triangles a segment. For text it is what the glyph has
//! there, in the [`Atlas`].

mod atlas;
mod build;
mod strip;
#[cfg(test)]
mod tests;

pub use atlas::Atlas;

/// A corner of a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Vertex {
    /// Where it is, in the units of the list.
    pub position: [f32; 2],
    /// `[distance, reach, 0]` for shapes; `[u, v, 1]` for text, where u and v are fractions of the atlas.
    pub sample: [f32; 3],
    /// Red, green, blue and opacity, not premultiplied.
    pub colour: [u8; 4],
}

/// As much of a mesh as 16-bit indices reach.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Chunk {
    /// Corners.
    pub vertices: Vec<Vertex>,
    /// Triangles: three corners each.
    pub indices: Vec<u16>,
}

impl Chunk {
    /// Most corners of a chunk.
    pub const VERTICES: usize = 1 << 15;
    /// Most indices of a chunk: an area without a border, the hungriest of all shapes, has 4.5 for a corner.
    pub const INDICES: usize = 5 * Chunk::VERTICES;
}

/// The screen that a mesh is for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Screen {
    /// Its width and height in the units of the list.
    pub size: [f32; 2],
    /// How large a pixel is in these units: 0.5 where a screen has twice as many as one reckons with.
    pub pixel: f32,
}

/// A draw list as triangles, in the order in which to draw them.
///
/// It keeps its memory from frame to frame.
#[derive(Clone, Debug, Default)]
pub struct Mesh {
    chunks: Vec<Chunk>,
    /// How many of them are in use.
    used: usize,
    strip: strip::Strip,
}

impl Mesh {
    /// What to draw.
    #[must_use]
    pub fn chunks(&self) -> &[Chunk] {
        &self.chunks[..self.used]
    }

    fn clear(&mut self) {
        for chunk in &mut self.chunks {
            chunk.vertices.clear();
            chunk.indices.clear();
        }
        self.used = 0;
    }

    /// A chunk with room for so many corners, at most [`Chunk::VERTICES`], and how many it has already.
    fn room(&mut self, vertices: usize) -> (&mut Chunk, u16) {
        let full = |chunk: &Chunk| chunk.vertices.len() + vertices > Chunk::VERTICES;
        if self.used == 0 || full(&self.chunks[self.used - 1]) {
            if self.used == self.chunks.len() {
                self.chunks.push(Chunk::default());
            }
            self.used += 1;
        }
        let chunk = &mut self.chunks[self.used - 1];
        // Below 2^15, or there would be no room.
        let first = chunk.vertices.len() as u16;
        (chunk, first)
    }
}
