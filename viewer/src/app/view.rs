//! [`View`]: which part of the world is seen.

use lockstep2d::body::BodyId;
use lockstep2d::draw::fit;
use lockstep2d::math::Aabb;
use lockstep2d::world::World;
use lockstep2d_picture::Camera;

/// How much a notch of the wheel, or a press of a key, enlarges.
const ZOOM: f32 = 1.2;

/// The camera, and whom it follows.
#[derive(Debug, Default)]
pub(super) struct View {
    camera: Option<Camera>,
    /// Of the area in which the world is seen, in pixels.
    size: [f32; 2],
    pub(super) followed: Option<BodyId>,
}

impl View {
    /// The camera as of now: at first it shows all that there is.
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

    /// Shows all that there is again.
    pub(super) fn reset(&mut self) {
        (self.camera, self.followed) = (None, None);
    }

    pub(super) fn pan(&mut self, by: [f32; 2]) {
        self.followed = None;
        self.camera.iter_mut().for_each(|camera| camera.pan(by));
    }

    /// Makes everything larger, or smaller, about a point of the screen.
    pub(super) fn zoom(&mut self, notches: f32, about: [f32; 2]) {
        self.camera.iter_mut().for_each(|camera| camera.zoom(ZOOM.powf(notches), about));
    }

    /// What is in the middle stays there, as large as it is.
    fn resize(&mut self, size: [f32; 2]) {
        self.size = size;
        let fresh = Camera::new(Aabb::default(), [0.0; 2], size);
        self.camera.iter_mut().for_each(|camera| (camera.middle, camera.half) = (fresh.middle, fresh.half));
    }
}
