//! [`View`]: the visible part of the world.

use lockstep2d::body::BodyId;
use lockstep2d::draw::fit;
use lockstep2d::math::Aabb;
use lockstep2d::world::World;
use lockstep2d_render::Camera;

/// Zoom factor of one notch of the wheel or one key press.
const ZOOM: f32 = 1.2;

#[derive(Debug, Default)]
pub(super) struct View {
    camera: Option<Camera>,
    /// Size of the window, in pixels.
    size: [f32; 2],
    pub(super) followed: Option<BodyId>,
}

impl View {
    /// Returns the camera. At first it shows the whole world.
    pub(super) fn camera(&mut self, world: &World, size: [f32; 2]) -> Camera {
        if self.size != size {
            self.resize(size);
        }
        let mut camera = self.camera.unwrap_or_else(|| Camera::new(fit(world), [0.0; 2], size));
        if let Some(body) = self.followed.and_then(|id| world.body(id)) {
            camera.centre = body.centre_of_mass();
        }
        *self.camera.insert(camera)
    }

    /// Shows the whole world again, and follows no body.
    pub(super) fn reset(&mut self) {
        (self.camera, self.followed) = (None, None);
    }

    pub(super) fn pan(&mut self, by: [f32; 2]) {
        self.followed = None;
        self.camera.iter_mut().for_each(|camera| camera.pan(by));
    }

    pub(super) fn zoom(&mut self, notches: f32, about: [f32; 2]) {
        self.camera.iter_mut().for_each(|camera| camera.zoom(ZOOM.powf(notches), about));
    }

    /// Adopts a new size of the window. Keeps the centre and the scale.
    fn resize(&mut self, size: [f32; 2]) {
        self.size = size;
        let fresh = Camera::new(Aabb::default(), [0.0; 2], size);
        self.camera.iter_mut().for_each(|camera| (camera.middle, camera.half) = (fresh.middle, fresh.half));
    }
}
