//! [`Renderer`]: draws meshes on the screen and into pictures.

use crate::mesh::{Atlas, Chunk, Mesh, Screen, Vertex};
use miniquad::{
    BlendFactor, BlendState, BlendValue, BufferId, BufferLayout, BufferSource, BufferType, BufferUsage,
    Equation, PassAction, Pipeline, PipelineParams, RenderingBackend, ShaderError, ShaderMeta, ShaderSource,
    TextureId, UniformBlockLayout, UniformDesc, UniformType, UniformsSource, VertexAttribute, VertexFormat,
    window,
};

const VERTEX: &str = "#version 100
attribute vec2 position;
attribute vec3 source;
attribute vec4 colour;
uniform vec2 size;
varying highp vec3 at;
varying lowp vec4 paint;
void main() {
    gl_Position = vec4(position.x / size.x * 2.0 - 1.0, 1.0 - position.y / size.y * 2.0, 0.0, 1.0);
    at = source;
    paint = colour / 255.0;
}";

const FRAGMENT: &str = "#version 100
precision highp float;
varying highp vec3 at;
varying lowp vec4 paint;
uniform sampler2D atlas;
void main() {
    float shape = clamp(at.y - abs(at.x), 0.0, 1.0);
    float glyph = texture2D(atlas, at.xy).a;
    gl_FragColor = vec4(paint.rgb, paint.a * mix(shape, glyph, at.z));
}";

const BACKGROUND: PassAction =
    PassAction::Clear { color: Some((0.0, 0.0, 0.0, 1.0)), depth: None, stencil: None };

pub(super) struct Renderer {
    context: Box<dyn RenderingBackend>,
    pipeline: Pipeline,
    atlas: TextureId,
    /// A vertex and an index buffer for each chunk. With only one pair of buffers, each upload would wait until the GPU
    /// has read the previous chunk.
    buffers: Vec<[BufferId; 2]>,
}

/// An image: red, green, blue and opacity of each pixel, with the rows from top to bottom.
#[cfg(not(target_arch = "wasm32"))]
pub(super) struct Picture {
    pub(super) width: u32,
    pub(super) height: u32,
    pub(super) pixels: Vec<u8>,
}

impl Renderer {
    pub(super) fn new() -> Result<Self, ShaderError> {
        let mut context = window::new_rendering_backend();
        let uniforms = UniformBlockLayout { uniforms: vec![UniformDesc::new("size", UniformType::Float2)] };
        let meta = ShaderMeta { images: vec!["atlas".to_owned()], uniforms };
        let shader = context.new_shader(ShaderSource::Glsl { vertex: VERTEX, fragment: FRAGMENT }, meta)?;
        let attributes = [
            VertexAttribute::new("position", VertexFormat::Float2),
            VertexAttribute::new("source", VertexFormat::Float3),
            VertexAttribute::new("colour", VertexFormat::Byte4),
        ];
        let over = |from| {
            let rest = BlendFactor::OneMinusValue(BlendValue::SourceAlpha);
            Some(BlendState::new(Equation::Add, from, rest))
        };
        let blending = PipelineParams {
            color_blend: over(BlendFactor::Value(BlendValue::SourceAlpha)),
            // Keeps the canvas opaque. Otherwise a browser would blend it with the page behind it.
            alpha_blend: over(BlendFactor::One),
            ..PipelineParams::default()
        };
        let pipeline = context.new_pipeline(&[BufferLayout::default()], &attributes, shader, blending);
        let [width, height] = [Atlas::WIDTH, Atlas::HEIGHT].map(|side| side as u16);
        let atlas = context.new_texture_from_rgba8(width, height, &Atlas::default().pixels);
        Ok(Renderer { context, pipeline, atlas, buffers: Vec::new() })
    }

    pub(super) fn show(&mut self, mesh: &Mesh, screen: &Screen) {
        self.upload(mesh);
        self.context.begin_default_pass(BACKGROUND);
        self.draw(mesh, screen);
        self.context.commit_frame();
    }

    /// Draws a mesh into a picture, with the same shader as on the screen.
    #[cfg(not(target_arch = "wasm32"))]
    pub(super) fn picture(&mut self, mesh: &Mesh, screen: &Screen, [width, height]: [u32; 2]) -> Picture {
        self.upload(mesh);
        let texture =
            self.context.new_render_texture(miniquad::TextureParams { width, height, ..Default::default() });
        let pass = self.context.new_render_pass(texture, None);
        self.context.begin_pass(Some(pass), BACKGROUND);
        self.draw(mesh, screen);
        let row = width as usize * 4;
        let mut pixels = vec![0; row * height as usize];
        self.context.texture_read_pixels(texture, &mut pixels);
        self.context.delete_render_pass(pass);
        // OpenGL returns the rows from bottom to top.
        let rows: Vec<u8> = pixels.chunks_exact(row.max(1)).rev().flatten().copied().collect();
        Picture { width, height, pixels: rows }
    }

    fn upload(&mut self, mesh: &Mesh) {
        while self.buffers.len() < mesh.chunks().len() {
            let vertices = BufferSource::empty::<Vertex>(Chunk::VERTICES);
            let indices = BufferSource::empty::<u16>(Chunk::INDICES);
            self.buffers.push([
                self.context.new_buffer(BufferType::VertexBuffer, BufferUsage::Stream, vertices),
                self.context.new_buffer(BufferType::IndexBuffer, BufferUsage::Stream, indices),
            ]);
        }
        for (chunk, [vertices, indices]) in mesh.chunks().iter().zip(&self.buffers) {
            self.context.buffer_update(*vertices, BufferSource::slice(&chunk.vertices));
            self.context.buffer_update(*indices, BufferSource::slice(&chunk.indices));
        }
    }

    fn draw(&mut self, mesh: &Mesh, screen: &Screen) {
        self.context.apply_pipeline(&self.pipeline);
        for (chunk, [vertices, indices]) in mesh.chunks().iter().zip(&self.buffers) {
            self.context.apply_bindings_from_slice(&[*vertices], *indices, &[self.atlas]);
            self.context.apply_uniforms(UniformsSource::table(&screen.size));
            self.context.draw(0, chunk.indices.len() as i32, 1);
        }
        self.context.end_render_pass();
    }
}
