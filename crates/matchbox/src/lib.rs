#![doc = include_str!("../README.md")]

use core::fmt;
use std::collections::VecDeque;

use lockstep2d::peer::Transport;
use lockstep2d::session::Address;
pub use matchbox_socket;
use matchbox_socket::{ChannelConfig, MessageLoopFuture, PeerId, WebRtcSocket, WebRtcSocketBuilder};
use uuid::Uuid;

/// Index of the data channel that carries the packets.
const CHANNEL: usize = 0;

/// A member of a room of a matchbox signalling server, with a WebRTC data channel to each other member.
///
/// The channels are unordered and unreliable, as UDP is. A member that connects again gets another address. The session
/// then recognises the member by its key.
pub struct Matchbox {
    socket: WebRtcSocket,
    received: VecDeque<(Address, Vec<u8>)>,
    others: Vec<Address>,
    is_closed: bool,
}

impl fmt::Debug for Matchbox {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Matchbox")
            .field("others", &self.others)
            .field("is_closed", &self.is_closed)
            .finish_non_exhaustive()
    }
}

impl Matchbox {
    /// Enters the room `ws://HOST:PORT/ROOM`, with the default ICE servers of matchbox. Returns at once, and connects
    /// in the background.
    #[must_use]
    pub fn connect(room_url: &str) -> Self {
        Self::with_builder(WebRtcSocket::builder(room_url))
    }

    /// Enters a room with custom settings, such as ICE servers. This function adds the data channel.
    ///
    /// ```no_run
    /// use lockstep2d_matchbox::Matchbox;
    /// use lockstep2d_matchbox::matchbox_socket::{RtcIceServerConfig, WebRtcSocket};
    ///
    /// // A local network needs no STUN server.
    /// let ice_server = RtcIceServerConfig { urls: vec![], ..Default::default() };
    /// let matchbox = Matchbox::with_builder(WebRtcSocket::builder("ws://127.0.0.1:3536/room").ice_server(ice_server));
    /// ```
    #[must_use]
    pub fn with_builder(builder: WebRtcSocketBuilder) -> Self {
        let (socket, message_loop) = builder.add_channel(ChannelConfig::unreliable()).build();
        spawn(message_loop);
        Matchbox { socket, received: VecDeque::new(), others: Vec::new(), is_closed: false }
    }

    /// Updates [`Matchbox::others`]. [`Transport::receive`] also does this, whenever it has returned all packets that
    /// had arrived.
    pub fn update(&mut self) {
        match self.socket.try_update_peers() {
            Ok(changes) if changes.is_empty() => {}
            Ok(_) => {
                self.others = self.socket.connected_peers().map(address_of).collect();
                // The socket returns peers in any order.
                self.others.sort_unstable_by(|a, b| a.bytes().cmp(b.bytes()));
            }
            Err(_) => {
                self.is_closed = true;
                self.others.clear();
            }
        }
    }

    /// This peer's own address, once the signalling server has assigned it.
    pub fn own(&mut self) -> Option<Address> {
        self.socket.id().map(address_of)
    }

    /// Addresses of the other members to which a channel is open, in ascending order.
    #[must_use]
    pub fn others(&self) -> &[Address] {
        &self.others
    }

    /// Whether the connection to the signalling server has failed or ended. To return to the room, create another
    /// [`Matchbox`].
    #[must_use]
    pub const fn is_closed(&self) -> bool {
        self.is_closed
    }
}

impl Transport for Matchbox {
    fn send(&mut self, packet: &[u8], to: &Address) {
        let Some(peer) = peer_of(to) else { return };
        let Ok(channel) = self.socket.get_channel_mut(CHANNEL) else { return };
        // An error means that the room is lost, which `update` also detects.
        let _lost = channel.try_send(packet.to_vec().into(), peer);
    }

    fn receive(&mut self) -> Option<(Address, Vec<u8>)> {
        if self.received.is_empty() {
            self.update();
            let channel = self.socket.get_channel_mut(CHANNEL).ok()?;
            let packets = channel.receive().into_iter();
            self.received.extend(packets.map(|(peer, packet)| (address_of(peer), packet.to_vec())));
        }
        self.received.pop_front()
    }
}

/// The address of a peer is its id, which the signalling server assigned: 16 bytes.
fn address_of(peer: PeerId) -> Address {
    Address::new(peer.0.as_bytes()).unwrap_or_else(Address::nowhere)
}

fn peer_of(address: &Address) -> Option<PeerId> {
    Uuid::from_slice(address.bytes()).ok().map(PeerId)
}

/// Runs the connections until the socket is dropped.
#[cfg(not(target_arch = "wasm32"))]
fn spawn(message_loop: MessageLoopFuture) {
    std::thread::spawn(move || _ = pollster::block_on(message_loop));
}

#[cfg(target_arch = "wasm32")]
fn spawn(message_loop: MessageLoopFuture) {
    wasm_bindgen_futures::spawn_local(async { _ = message_loop.await });
}
