//! [`Relay`]: a member of a room, as a transport.
#![expect(clippy::disallowed_types, reason = "a connection is observed in real time")]

use core::fmt;
use core::time::Duration;
use std::io;
use std::net::{TcpStream, ToSocketAddrs};
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::sync::{Arc, Weak};
use std::thread;
use std::time::Instant;

use lockstep2d::peer::Transport;
use lockstep2d::session::Address;
use tungstenite::protocol::WebSocketConfig;
use tungstenite::{Message, WebSocket, client::client_with_config};

use crate::frame::{ADDRESS_BYTES, Members, SECRET_BYTES, frame, of_text, unframe};
use crate::silence::{Due, Silence};

/// Timeout of an attempt to connect to an address, and of each read or write during the handshake.
const CONNECT_MAX: Duration = Duration::from_secs(5);
/// First pause before connecting again. The pause doubles after each failure.
const PAUSE_MIN: Duration = Duration::from_millis(250);
/// Longest pause before connecting again.
const PAUSE_MAX: Duration = Duration::from_secs(8);
/// Largest frame from the relay in bytes.
const FRAME_MAX: usize = 64 * 1024;
/// Code with which the relay closes a connection when the same member has opened a newer one.
const REPLACED: u16 = 4003;
/// Maximum number of bytes that wait to be sent. Further datagrams are dropped.
const WRITE_MAX: usize = 512 * 1024;

/// Reason why a relay cannot be used.
#[derive(Debug)]
pub enum RelayError {
    /// The URL does not begin with `ws://`, has no host, or has a path.
    Url {
        /// The URL.
        url: String,
    },
    /// The host is unknown, the port is invalid, or the relay cannot be reached or has refused the connection.
    Refused {
        /// Message of the system or of the relay.
        why: String,
    },
}

impl fmt::Display for RelayError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            RelayError::Url { url } => write!(f, "expected ws://HOST:PORT, not {url}"),
            RelayError::Refused { why } => write!(f, "the relay cannot be used: {why}"),
        }
    }
}

impl core::error::Error for RelayError {}

type Socket = WebSocket<TcpStream>;

#[derive(Clone)]
struct Target {
    /// URL with the code of the room.
    url: String,
    /// Host and port.
    host: String,
    secret: [u8; SECRET_BYTES],
}

enum State {
    Open {
        socket: Box<Socket>,
        silence: Silence,
    },
    /// A background thread is connecting. It ends when `wanted` is dropped.
    Connecting {
        receiver: Receiver<(Socket, Members)>,
        #[expect(dead_code, reason = "the thread looks whether it still exists")]
        wanted: Arc<()>,
    },
    /// A newer connection of this member has replaced this one.
    Closed,
}

/// A member of a room of a relay. A lost connection is opened again in the background. Datagrams are lost in the
/// meantime.
///
/// [`Transport::receive`] checks the connection: after 5 s without a frame it sends a ping, and if nothing arrives
/// within another 10 s, the connection counts as lost. A program that was suspended therefore keeps its connection.
///
/// ```no_run
/// use lockstep2d::peer::{Peer, PeerIdentity, PeerOptions};
/// use lockstep2d_relay::Relay;
/// # use lockstep2d::lockstep::Game;
/// # fn enter<MyGame: Game>(setup: &MyGame::Setup) -> Result<Peer<MyGame, Relay>, Box<dyn std::error::Error>> {
///
/// let mut relay = Relay::connect("ws://127.0.0.1:7010", "ABCD", rand_bytes())?;
/// // If another member is in the room, this peer joins the match through it; the first member opens the match.
/// let (options, me) = (PeerOptions::lockstep(), PeerIdentity::random());
/// let peer = match relay.others().first().cloned() {
///     None => Peer::<MyGame, _>::host(setup, options, me, relay)?,
///     Some(contact) => Peer::<MyGame, _>::join(setup, options, me, relay, contact)?,
/// };
/// // While `Peer::status` is `None` for two seconds, `peer.transport_mut().next_contact()` is another contact to ask.
/// # Ok(peer)
/// # }
/// # fn rand_bytes() -> [u8; 16] { [7; 16] }
/// ```
pub struct Relay {
    target: Target,
    state: State,
    own: Address,
    others: Vec<Address>,
    /// Number of calls of [`Relay::next_contact`].
    turn: usize,
}

impl fmt::Debug for Relay {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Relay").field("url", &self.target.url).field("own", &self.own).finish_non_exhaustive()
    }
}

impl Relay {
    /// Enters a room, and creates it if needed. `url` is `ws://HOST:PORT`. `code` has 1 to 32 letters, digits and `-`.
    /// `secret` has 16 random bytes, which determine the address. Blocks until the relay has answered. Each attempt to
    /// connect, read or write takes at most 5 s.
    ///
    /// # Errors
    /// [`RelayError`] when the URL is invalid, or the relay cannot be reached or refuses the connection.
    pub fn connect(url: &str, code: &str, secret: [u8; SECRET_BYTES]) -> Result<Self, RelayError> {
        let host = url.strip_prefix("ws://").map(|host| host.trim_end_matches('/'));
        let wrong = || RelayError::Url { url: url.to_owned() };
        let host = host.filter(|host| !host.is_empty() && !host.contains('/')).ok_or_else(wrong)?.to_owned();
        let target = Target { url: format!("ws://{host}/{code}"), host, secret };
        let (socket, members) = open(&target, || true).map_err(|why| RelayError::Refused { why })?;
        let own = Address::nowhere();
        let mut relay = Relay { target, state: State::open(socket), own, others: Vec::new(), turn: 0 };
        relay.set_members(&members);
        Ok(relay)
    }

    /// This peer's own address.
    #[must_use]
    pub const fn own(&self) -> &Address {
        &self.own
    }

    /// Addresses of the other members, in order of arrival.
    #[must_use]
    pub fn others(&self) -> &[Address] {
        &self.others
    }

    /// Another member, for `Peer::ask`, if the contact does not answer. The first contact is the first of
    /// [`others`](Relay::others); successive calls return the members after it in turn. `None` if nobody else is in the
    /// room.
    pub fn next_contact(&mut self) -> Option<Address> {
        self.turn = self.turn.wrapping_add(1);
        self.others.get(self.turn.checked_rem(self.others.len())?).copied()
    }

    /// Whether there is a connection to the relay at the moment.
    #[must_use]
    pub const fn is_open(&self) -> bool {
        matches!(self.state, State::Open { .. })
    }

    /// Whether a newer connection with this secret has replaced this one. This connection is then not opened again.
    #[must_use]
    pub const fn is_closed(&self) -> bool {
        matches!(self.state, State::Closed)
    }

    fn set_members(&mut self, members: &Members) {
        let address = |text: &String| of_text(text).and_then(|member| Address::new(&member));
        self.own = address(&members.you).unwrap_or_else(Address::nowhere);
        self.others = members.others.iter().filter_map(address).collect();
    }

    fn take_members(&mut self, text: &str) {
        if let Ok(members) = serde_json::from_str(text) {
            self.set_members(&members);
        }
    }

    /// Starts a thread that tries to connect again, until an attempt succeeds or this value is dropped. If the thread
    /// went on after the drop, it could replace the connection of a new [`Relay`] with the same secret.
    fn reconnect(&mut self) {
        let (sender, receiver) = channel();
        let target = self.target.clone();
        let wanted = Arc::new(());
        let still_wanted = Arc::downgrade(&wanted);
        thread::spawn(move || {
            let is_wanted = || Weak::strong_count(&still_wanted) > 0;
            let mut pause = PAUSE_MIN;
            loop {
                thread::sleep(pause);
                if !is_wanted() {
                    return;
                }
                if let Ok(opened) = open(&target, is_wanted) {
                    // This fails if the [`Relay`] was dropped, because the receiver is then gone.
                    let _ = sender.send(opened);
                    return;
                }
                pause = (pause * 2).min(PAUSE_MAX);
            }
        });
        self.state = State::Connecting { receiver, wanted };
    }

    /// The connection, if there is one. If the background thread has opened a new connection, takes it.
    fn connection(&mut self) -> Option<(&mut Socket, &mut Silence)> {
        if let State::Connecting { receiver, .. } = &self.state {
            match receiver.try_recv() {
                Ok((socket, members)) => {
                    self.state = State::open(socket);
                    self.set_members(&members);
                }
                Err(TryRecvError::Empty) => {}
                Err(TryRecvError::Disconnected) => self.reconnect(),
            }
        }
        match &mut self.state {
            State::Open { socket, silence } => Some((socket, silence)),
            State::Connecting { .. } | State::Closed => None,
        }
    }

    /// Sends a ping, or connects again, if nothing has arrived for some time.
    fn check_silence(&mut self) {
        let Some((socket, silence)) = self.connection() else { return };
        match silence.due(Instant::now()) {
            Due::Nothing => {}
            Due::Ping => {
                // An error is ignored here, because the next read also returns it.
                let _ = socket.send(Message::Ping(tungstenite::Bytes::new()));
            }
            Due::Reconnect => self.reconnect(),
        }
    }
}

impl State {
    fn open(socket: Socket) -> Self {
        State::Open { socket: Box::new(socket), silence: Silence::new(Instant::now()) }
    }
}

/// Opens a connection, unless it is no longer wanted. Returns the socket and the members of the room.
fn open(target: &Target, is_wanted: impl Fn() -> bool) -> Result<(Socket, Members), String> {
    let stream = connect(&target.host).map_err(|error| error.to_string())?;
    let config = WebSocketConfig::default()
        .max_message_size(Some(FRAME_MAX))
        .max_frame_size(Some(FRAME_MAX))
        .write_buffer_size(0)
        .max_write_buffer_size(WRITE_MAX);
    let opened = client_with_config(&target.url, stream, Some(config));
    let (mut socket, _) = opened.map_err(|error| error.to_string())?;
    // When the relay receives the secret, it closes an older connection of the same member, so this is the last moment
    // to give up.
    if !is_wanted() {
        return Err("no longer wanted".to_owned());
    }
    socket.send(Message::binary(target.secret.to_vec())).map_err(|error| error.to_string())?;
    loop {
        match socket.read().map_err(|error| error.to_string())? {
            Message::Text(text) => {
                let members = serde_json::from_str(&text).map_err(|error| error.to_string())?;
                let stream = socket.get_ref();
                stream.set_nonblocking(true).map_err(|error| error.to_string())?;
                return Ok((socket, members));
            }
            Message::Close(frame) => {
                return Err(frame.map_or_else(|| "closed".to_owned(), |frame| frame.reason.to_string()));
            }
            _ => {}
        }
    }
}

fn connect(host: &str) -> io::Result<TcpStream> {
    let mut last = io::Error::new(io::ErrorKind::NotFound, "the host has no address");
    for address in host.to_socket_addrs()? {
        match TcpStream::connect_timeout(&address, CONNECT_MAX) {
            Ok(stream) => {
                stream.set_nodelay(true)?;
                stream.set_read_timeout(Some(CONNECT_MAX))?;
                stream.set_write_timeout(Some(CONNECT_MAX))?;
                return Ok(stream);
            }
            Err(error) => last = error,
        }
    }
    Err(last)
}

/// Whether the connection can still be read after this error.
fn is_passing(error: &tungstenite::Error) -> bool {
    let tungstenite::Error::Io(error) = error else { return false };
    matches!(error.kind(), io::ErrorKind::WouldBlock | io::ErrorKind::Interrupted)
}

impl Transport for Relay {
    fn send(&mut self, packet: &[u8], to: &Address) {
        let Ok(to) = <[u8; ADDRESS_BYTES]>::try_from(to.bytes()) else { return };
        let Some((socket, _)) = self.connection() else { return };
        // An error is ignored here: `receive` detects it after reading the frames that have arrived. One of these
        // frames may be a close frame, sent because a newer connection has replaced this one.
        let _ = socket.send(Message::binary(frame(to, packet)));
    }

    fn receive(&mut self) -> Option<(Address, Vec<u8>)> {
        loop {
            let (socket, silence) = self.connection()?;
            let message = socket.read();
            if message.is_ok() {
                silence.heard(Instant::now());
            }
            match message {
                Ok(Message::Binary(bytes)) => {
                    if let Some((from, datagram)) = unframe(&bytes)
                        && let Some(from) = Address::new(&from)
                    {
                        return Some((from, datagram.to_vec()));
                    }
                }
                Ok(Message::Text(text)) => self.take_members(&text),
                Ok(Message::Close(Some(frame))) if u16::from(frame.code) == REPLACED => {
                    self.state = State::Closed;
                }
                // A ping needs no action here: the next read or write answers it.
                Ok(_) => {}
                Err(error) if is_passing(&error) => {
                    self.check_silence();
                    return None;
                }
                Err(_) => self.reconnect(),
            }
        }
    }
}
