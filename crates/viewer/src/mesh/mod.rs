//! [`Mesh`]: a draw list as triangles, for the GPU.
//!
//! All items share a vertex format and are drawn in list order. The fragment shader computes the coverage of a pixel
//! from [`Vertex::sample`]. For shapes, the coverage is
//!
//! ```text
//! coverage = clamp(reach - |distance|, 0, 1)
//! ```
//!
//! For a line, `distance` is the distance from the centre line in screen pixels, and `reach` is half the line width
//! plus half a pixel. This antialiases edges over one pixel. For text, the coverage is the opacity of the [`Atlas`].
//!
//! ```
//! use lockstep2d_viewer::mesh::{Atlas, Chunk, Mesh, Screen, Vertex};
//! use lockstep2d_viewer::{Colour, DrawList};
//!
//! // The texture is uploaded once.
//! let atlas = Atlas::default();
//! assert_eq!(atlas.pixels.len(), Atlas::WIDTH * Atlas::HEIGHT * 4);
//! // For each frame, every chunk gives a vertex buffer and an index buffer.
//! let mut list = DrawList::default();
//! list.rectangle([10.0, 10.0], [80.0, 8.0], Colour::hex(0x2ca02c));
//! list.text([10.0, 20.0], 1.0, Colour::hex(0x222222), "80");
//! let mut mesh = Mesh::default();
//! mesh.build(&list, &Screen { size: [800.0, 600.0], pixel: 1.0 });
//! let [chunk]: &[Chunk] = mesh.chunks() else { panic!("few triangles") };
//! let first: &Vertex = &chunk.vertices[usize::from(chunk.indices[0])];
//! assert_eq!(first.colour, [0x2c, 0xa0, 0x2c, 0xff]);
//! assert_eq!(chunk.indices.len() % 3, 0);
//! ```

mod atlas;
mod build;
mod strip;
#[cfg(test)]
mod tests;

pub use atlas::Atlas;

/// Vertex of a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Vertex {
    /// Position, in the units of the draw list.
    pub position: [f32; 2],
    /// `[distance, reach, 0]` for shapes; `[u, v, 1]` for text, where u and v are fractions of the atlas.
    pub sample: [f32; 3],
    /// Red, green, blue and opacity, not premultiplied.
    pub colour: [u8; 4],
}

/// Part of a mesh that 16-bit indices can address.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Chunk {
    /// Vertices.
    pub vertices: Vec<Vertex>,
    /// Triangles: three vertex indices each.
    pub indices: Vec<u16>,
}

impl Chunk {
    /// Maximum number of vertices of a chunk.
    pub const VERTICES: usize = 1 << 15;
    /// Maximum number of indices of a chunk. An area without a border has the most indices per vertex: fewer than 4.5.
    pub const INDICES: usize = 5 * Chunk::VERTICES;
}

/// The screen on which a mesh is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Screen {
    /// Width and height, in the units of the draw list.
    pub size: [f32; 2],
    /// Size of a screen pixel in these units, such as 0.5 for a scale factor of 2.
    pub pixel: f32,
}

/// Draw list as triangles, in drawing order. Memory is reused between frames.
#[derive(Clone, Debug, Default)]
pub struct Mesh {
    chunks: Vec<Chunk>,
    /// Number of chunks in use.
    used: usize,
    strip: strip::Strip,
}

impl Mesh {
    /// Chunks, in drawing order.
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

    /// Returns a chunk with room for `vertices` more vertices (at most [`Chunk::VERTICES`]), and its current number of
    /// vertices.
    fn room(&mut self, vertices: usize) -> (&mut Chunk, u16) {
        let full = |chunk: &Chunk| chunk.vertices.len() + vertices > Chunk::VERTICES;
        if self.used == 0 || full(&self.chunks[self.used - 1]) {
            if self.used == self.chunks.len() {
                self.chunks.push(Chunk::default());
            }
            self.used += 1;
        }
        let chunk = &mut self.chunks[self.used - 1];
        // The cast is exact: the number is at most 2^15, the capacity of a chunk.
        let first = chunk.vertices.len() as u16;
        (chunk, first)
    }
}
