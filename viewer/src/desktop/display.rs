//! Whether there is anywhere to put a window: the windowing library ends the program where there is not.

use std::env;
use std::os::linux::net::SocketAddrExt;
use std::os::unix::net::{SocketAddr, UnixStream};
use std::path::PathBuf;

/// Looks for a display.
///
/// # Errors
/// What is missing, for people.
pub(super) fn check() -> Result<(), String> {
    let set = |name: &str| env::var(name).ok().filter(|value| !value.is_empty());
    match (set("DISPLAY"), set("WAYLAND_DISPLAY")) {
        (None, None) => Err("no display: neither DISPLAY nor WAYLAND_DISPLAY is set".to_owned()),
        (Some(display), None) if !answers(&display) => {
            Err(format!("no display: nothing answers at DISPLAY={display}"))
        }
        _ => Ok(()),
    }
}

/// Whether an X server listens there. Those of other machines are taken at their word.
fn answers(display: &str) -> bool {
    let Some(number) = display.strip_prefix(':').or_else(|| display.strip_prefix("unix:")) else {
        return !display.starts_with('/') && display.contains(':');
    };
    let number = number.split('.').next().unwrap_or_default();
    let socket = PathBuf::from(format!("/tmp/.X11-unix/X{number}"));
    let listens = |address: std::io::Result<SocketAddr>| {
        address.and_then(|address| UnixStream::connect_addr(&address)).is_ok()
    };
    let name = socket.as_os_str().as_encoded_bytes();
    listens(SocketAddr::from_pathname(&socket)) || listens(SocketAddr::from_abstract_name(name))
}
