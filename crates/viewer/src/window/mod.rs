//! The window: passes miniquad's events to the viewer, and shows the viewer's picture.

#[cfg_attr(target_arch = "wasm32", path = "page.rs")]
mod host;
mod keys;
#[cfg(not(target_arch = "wasm32"))]
mod performance;
mod renderer;
mod stage;

use std::cell::RefCell;
use std::fmt;
use std::path::PathBuf;
use std::rc::Rc;

use miniquad::conf::{Conf, LinuxBackend, Platform};

use crate::app::App;
use crate::script::Script;
use host::Host;
use stage::Stage;

pub(crate) struct Options {
    pub(crate) title: String,
    pub(crate) size: [u16; 2],
    pub(crate) script: Option<Script>,
    /// File to which the recording is saved.
    pub(crate) output: Option<PathBuf>,
}

#[derive(Debug)]
pub(crate) enum WindowError {
    /// The graphics driver refuses the shader.
    Graphics(miniquad::ShaderError),
    #[cfg(not(target_arch = "wasm32"))]
    File { path: String, error: std::io::Error },
}

impl fmt::Display for WindowError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            WindowError::Graphics(error) => write!(f, "cannot draw with this graphics driver: {error}"),
            #[cfg(not(target_arch = "wasm32"))]
            WindowError::File { path, error } => write!(f, "{path}: {error}"),
        }
    }
}

impl std::error::Error for WindowError {}

/// Result of running the window. It is shared with the event handler.
type Outcome = Rc<RefCell<Result<(), WindowError>>>;

/// Shows the viewer in a window until it is closed. In a browser, returns at once.
pub(crate) fn show(app: App, options: Options) -> Result<(), WindowError> {
    let [width, height] = options.size.map(i32::from);
    let conf = Conf {
        window_title: options.title,
        window_width: width,
        window_height: height,
        high_dpi: true,
        icon: None,
        platform: Platform {
            linux_wm_class: "lockstep2d",
            linux_backend: LinuxBackend::X11WithWaylandFallback,
            ..Platform::default()
        },
        ..Conf::default()
    };
    let outcome = Outcome::new(RefCell::new(Ok(())));
    let host = Host::new(options.output);
    let shared = Rc::clone(&outcome);
    miniquad::start(conf, move || Stage::start(app, options.script, host, shared));
    outcome.replace(Ok(()))
}
