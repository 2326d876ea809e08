//! Checks that there is a display. Without one, the windowing library aborts the program.

use std::env;
use std::os::linux::net::SocketAddrExt;
use std::os::unix::net::{SocketAddr, UnixStream};
use std::path::PathBuf;

/// Checks that `DISPLAY` or `WAYLAND_DISPLAY` is set. If only `DISPLAY` is set and names a local X server, that server
/// must accept connections. The error is a message for the user.
pub(super) fn check() -> Result<(), String> {
    let set = |name: &str| env::var(name).ok().filter(|value| !value.is_empty());
    match (set("DISPLAY"), set("WAYLAND_DISPLAY")) {
        (None, None) => Err("no display: neither DISPLAY nor WAYLAND_DISPLAY is set; \
                             on a machine without a screen, `xvfb-run` gives a program a display"
            .to_owned()),
        (Some(display), None) if !answers(&display) => {
            Err(format!("no display: no X server accepts connections at DISPLAY={display}"))
        }
        _ => Ok(()),
    }
}

/// Whether an X server listens at `display`. Displays on other hosts are not contacted, and count as listening. A
/// `display` that has no colon or begins with a slash counts as not listening.
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
