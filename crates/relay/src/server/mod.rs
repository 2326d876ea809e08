//! [`Server`]: the relay.

mod connection;
mod limits;
mod meter;
mod metered;
mod queue;
mod rooms;

use std::io;
use std::net::SocketAddr;
use std::sync::Arc;

use tokio::net::TcpListener;
use tokio::sync::Semaphore;

pub use limits::Limits;

struct Shared {
    limits: Limits,
    rooms: rooms::Rooms,
}

/// A relay: rooms whose members send each other datagrams over WebSockets.
///
/// ```no_run
/// # async fn run() -> std::io::Result<()> {
/// use lockstep2d_relay::{Limits, Server};
/// let server = Server::bind("127.0.0.1:7010", Limits::default()).await?;
/// println!("ws://{}", server.address()?);
/// server.run().await;
/// # Ok(()) }
/// ```
#[derive(Debug)]
pub struct Server {
    listener: TcpListener,
    limits: Limits,
}

impl Server {
    /// Listens on an address; port 0 lets the system choose one.
    ///
    /// # Errors
    /// Errors of the operating system.
    pub async fn bind(address: impl tokio::net::ToSocketAddrs, limits: Limits) -> io::Result<Self> {
        Ok(Server { listener: TcpListener::bind(address).await?, limits })
    }

    /// The local address.
    ///
    /// # Errors
    /// Errors of the operating system.
    pub fn address(&self) -> io::Result<SocketAddr> {
        self.listener.local_addr()
    }

    /// Accepts connections until the future is dropped. Connections that are open by that time continue until they end
    /// or the runtime is dropped.
    pub async fn run(self) {
        let places = Arc::new(Semaphore::new(self.limits.connections.min(Semaphore::MAX_PERMITS)));
        let shared = Arc::new(Shared { limits: self.limits, rooms: rooms::Rooms::default() });
        loop {
            // At the limit of connections, further ones wait in the backlog of the system.
            let Ok(place) = Arc::clone(&places).acquire_owned().await else { return };
            let Ok((stream, _)) = self.listener.accept().await else {
                // The error may be temporary, such as too many open files.
                tokio::time::sleep(core::time::Duration::from_millis(50)).await;
                continue;
            };
            let shared = Arc::clone(&shared);
            tokio::spawn(async move {
                // An error affects only this member.
                let _ = connection::serve(&shared, stream).await;
                drop(place);
            });
        }
    }
}
