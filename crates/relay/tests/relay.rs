//! The relay over real sockets: datagrams, rooms, limits, members that connect again.
#![expect(clippy::unwrap_used, reason = "a failed unwrap in a helper fails the test")]

use std::io::{ErrorKind, Read, Write};
use std::net::{SocketAddr, TcpListener, TcpStream};
use std::thread;
use std::time::Duration;

use lockstep2d::peer::Transport;
use lockstep2d::session::Address;
use lockstep2d_relay::{Limits, Relay, RelayError, Server};
use tungstenite::{Message, WebSocket};

/// Longest wait for an expected event.
const PATIENCE: Duration = Duration::from_secs(20);
const STEP: Duration = Duration::from_millis(2);

/// A relay in a thread that ends on drop.
struct Running {
    address: SocketAddr,
    stop: Option<tokio::sync::oneshot::Sender<()>>,
    thread: Option<thread::JoinHandle<()>>,
}

impl Running {
    fn start(limits: Limits) -> Self {
        Self::start_at("127.0.0.1:0".parse().unwrap(), limits)
    }

    fn start_at(address: SocketAddr, limits: Limits) -> Self {
        let (stop, stopped) = tokio::sync::oneshot::channel();
        let (sender, receiver) = std::sync::mpsc::channel();
        let thread = thread::spawn(move || {
            let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().unwrap();
            runtime.block_on(async move {
                let server = Server::bind(address, limits).await.unwrap();
                sender.send(server.address().unwrap()).unwrap();
                tokio::select! {
                    () = server.run() => {}
                    _ = stopped => {}
                }
            });
        });
        Running { address: receiver.recv().unwrap(), stop: Some(stop), thread: Some(thread) }
    }

    fn enter(&self, code: &str, secret: u8) -> Relay {
        Relay::connect(&format!("ws://{}", self.address), code, [secret; 16]).unwrap()
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        drop(self.stop.take());
        self.thread.take().map(thread::JoinHandle::join);
    }
}

fn until<T>(what: &str, mut attempt: impl FnMut() -> Option<T>) -> T {
    for _ in 0..PATIENCE.as_millis() / STEP.as_millis() {
        if let Some(found) = attempt() {
            return found;
        }
        thread::sleep(STEP);
    }
    panic!("{what}: not within {PATIENCE:?}");
}

fn receive(relay: &mut Relay) -> (Address, Vec<u8>) {
    until("a datagram", || relay.receive())
}

/// Updates a member until its list of the other members is `others`.
fn until_others(relay: &mut Relay, others: &[Address]) {
    until("the members", || {
        assert_eq!(relay.receive(), None);
        (relay.others() == others).then_some(())
    });
}

#[test]
fn datagrams_reach_the_member_they_are_for_and_name_their_sender() {
    let server = Running::start(Limits::default());
    let (mut a, mut b) = (server.enter("abcd", 1), server.enter("ABCD", 2));
    let mut c = server.enter("abcd", 3);
    let mut stranger = server.enter("other", 4);
    until_others(&mut a, &[*b.own(), *c.own()]);
    assert_eq!(c.others(), [*a.own(), *b.own()]);
    let contacts = [(); 3].map(|()| c.next_contact());
    assert_eq!(contacts, [Some(*b.own()), Some(*a.own()), Some(*b.own())], "the first contact was `a`");
    assert!(stranger.others().is_empty() && stranger.next_contact().is_none());

    let to = *b.own();
    a.send(b"to b", &to);
    c.send(b"also", &to);
    let mut found = [receive(&mut b), receive(&mut b)];
    found.sort_by_key(|(_, bytes)| bytes.clone());
    assert_eq!(found, [(*c.own(), b"also".to_vec()), (*a.own(), b"to b".to_vec())]);
    // Datagrams from another room and datagrams to an address without a member are dropped.
    stranger.send(b"from outside", &to);
    a.send(b"nowhere", &Address::new(&[1, 2, 3]).unwrap());
    a.send(b"last", &to);
    assert_eq!(receive(&mut b), (*a.own(), b"last".to_vec()));
    assert_eq!((b.receive(), c.receive()), (None, None));

    let left = *c.own();
    drop(c);
    until_others(&mut a, &[to]);
    a.send(b"gone", &left);
}

#[test]
fn a_member_that_connects_again_has_its_address() {
    let server = Running::start(Limits::default());
    let mut a = server.enter("room", 1);
    let old = server.enter("room", 2);
    let address = *old.own();
    // The old connection stays open, as after a change of networks.
    let mut new = server.enter("room", 2);
    assert_eq!(*new.own(), address);
    until_others(&mut a, std::slice::from_ref(&address));
    a.send(b"hello", &address);
    assert_eq!(receive(&mut new), (*a.own(), b"hello".to_vec()));
    // The old connection ends, and does not replace the new one in turn.
    let mut old = old;
    until("the end", || {
        assert_eq!(old.receive(), None);
        old.is_closed().then_some(())
    });
    assert!(new.is_open());
}

#[test]
fn members_find_each_other_after_a_restart_of_the_relay() {
    let server = Running::start(Limits::default());
    let address = server.address;
    let (mut a, mut b) = (server.enter("room", 1), server.enter("room", 2));
    let gone = server.enter("room", 3);
    let to = *b.own();
    until_others(&mut a, &[to, *gone.own()]);
    drop((server, gone));
    until("the loss", || {
        let _ = (a.receive(), b.receive());
        (!a.is_open() && !b.is_open()).then_some(())
    });
    let _server = Running::start_at(address, Limits::default());
    let found = until("a datagram", || {
        a.send(b"again", &to);
        b.receive()
    });
    assert_eq!(found, (*a.own(), b"again".to_vec()));
    // The member that did not return is no longer listed.
    until("the members", || {
        // Reading updates the lists of members. The results do not matter: further copies of the datagram may arrive.
        let _ = (a.receive(), b.receive());
        (a.others() == [to] && b.others() == [*a.own()]).then_some(())
    });
}

/// The relay sends a close frame to a member that was replaced. The member must detect this frame, even if it first
/// sends datagrams on the closed connection.
#[test]
fn a_replaced_member_that_sends_does_not_replace_its_successor() {
    let server = Running::start(Limits::default());
    let mut old = server.enter("room", 1);
    let mut new = server.enter("room", 1);
    let to = *old.own();
    for _ in 0..2 {
        thread::sleep(Duration::from_millis(50));
        old.send(b"hello", &to);
    }
    // Waits for 1 s, because a member would connect again after 250 ms.
    for _ in 0..500 {
        let _ = (old.receive(), new.receive());
        thread::sleep(STEP);
    }
    assert!(old.is_closed());
    assert!(new.is_open());
}

/// If a dropped member connected again, its thread would replace the connection of a new member with the same secret.
#[test]
fn a_dropped_member_does_not_connect_again() {
    let server = Running::start(Limits::default());
    let address = server.address;
    let mut old = server.enter("room", 1);
    drop(server);
    until("the loss", || {
        assert_eq!(old.receive(), None);
        (!old.is_open()).then_some(())
    });
    drop(old);
    let server = Running::start_at(address, Limits::default());
    let mut new = server.enter("room", 1);
    // Waits for 1 s, because the dropped member would connect again after a pause of 250 or 500 ms.
    for _ in 0..500 {
        assert_eq!(new.receive(), None);
        assert!(new.is_open(), "the connection was replaced");
        thread::sleep(STEP);
    }
}

#[test]
fn a_member_that_does_not_read_loses_the_oldest_datagrams() {
    let queue_bytes = 64 * 1024;
    let limits = Limits {
        queue_bytes,
        datagrams_per_second: 1_000_000,
        bytes_per_second: u32::MAX,
        ..Limits::default()
    };
    let server = Running::start(limits);
    let (mut a, mut b) = (server.enter("room", 1), server.enter("room", 2));
    let to = *b.own();
    // Sends more than the buffers of the system and the queue can hold.
    let count = 20_000_u32;
    for number in 0..count {
        let mut datagram = vec![0; 1000];
        datagram[..4].copy_from_slice(&number.to_le_bytes());
        a.send(&datagram, &to);
        while a.receive().is_some() {}
        if number % 64 == 0 {
            thread::sleep(STEP);
        }
    }
    // The last datagram arrives, although `b` has read nothing so far.
    let mut numbers = Vec::new();
    until("the newest datagram", || {
        // The datagram is sent repeatedly, because it is also lost if the sender's buffer is full.
        a.send(&u32::MAX.to_le_bytes(), &to);
        while let Some((_, bytes)) = b.receive() {
            numbers.push(u32::from_le_bytes(*bytes.first_chunk().unwrap()));
        }
        numbers.contains(&u32::MAX).then_some(())
    });
    assert!(numbers.is_sorted());
    let arrived = numbers.iter().filter(|number| **number < count).count();
    assert!(arrived < 15_000, "{arrived} datagrams were kept");
}

/// A connection after the handshake.
fn open(address: SocketAddr, path: &str) -> WebSocket<TcpStream> {
    let stream = TcpStream::connect(address).unwrap();
    stream.set_read_timeout(Some(PATIENCE)).unwrap();
    tungstenite::client(format!("ws://{address}/{path}"), stream).unwrap().0
}

/// Sends frames on a new connection. Returns the close code, or `None` if the connection ended without one.
fn close_code(address: SocketAddr, path: &str, frames: &[Message]) -> Option<u16> {
    let mut socket = open(address, path);
    for frame in frames {
        if socket.send(frame.clone()).is_err() {
            break;
        }
    }
    loop {
        match socket.read() {
            Ok(Message::Close(frame)) => return frame.map(|frame| frame.code.into()),
            Ok(_) => {}
            Err(tungstenite::Error::Io(error)) => {
                assert_ne!(error.kind(), ErrorKind::WouldBlock, "the connection stays open");
                return None;
            }
            Err(_) => return None,
        }
    }
}

#[test]
fn limits_close_connections() {
    let limits = Limits { members: 2, rooms: 1, datagrams_per_second: 100, ..Limits::default() };
    let server = Running::start(limits);
    let secret = |number: u8| Message::binary(vec![number; 16]);
    let code = |path: &str, frames: &[Message]| close_code(server.address, path, frames);
    assert_eq!(code("room", &[Message::binary(vec![0; 15])]), Some(4000));
    let flood: Vec<_> =
        std::iter::once(secret(1)).chain(std::iter::repeat_n(Message::binary(vec![0; 100]), 3000)).collect();
    assert_eq!(code("room", &flood), Some(4004));
    let large = [secret(1), Message::binary(vec![0; 5000])];
    assert_eq!(code("room", &large), None);

    let (_a, _b) = (server.enter("room", 1), server.enter("room", 2));
    assert_eq!(code("room", &[secret(3)]), Some(4001));
    assert_eq!(code("other", &[secret(3)]), Some(4002));
    let full = Relay::connect(&format!("ws://{}", server.address), "room", [3; 16]);
    assert!(full.unwrap_err().to_string().contains("the room is full"));
}

/// A fragment of a message counts before the message is complete, because its last fragment may never come.
#[test]
fn a_flood_of_fragments_closes_the_connection() {
    let limits = Limits { bytes_per_second: 10_000, datagrams_per_second: 100, ..Limits::default() };
    let server = Running::start(limits);
    let mut socket = open(server.address, "room");
    socket.send(Message::binary(vec![1; 16])).unwrap();
    let stream = socket.get_mut();
    stream.write_all(&[0x02, 0x80, 0, 0, 0, 0]).unwrap();
    // 20 MB are more than the buffers of the system hold.
    let fragments = [0x00, 0x80, 0, 0, 0, 0].repeat(20_000);
    let error = (0..160).find_map(|_| stream.write_all(&fragments).err()).map(|error| error.kind());
    assert!(matches!(error, Some(ErrorKind::ConnectionReset | ErrorKind::BrokenPipe)), "{error:?}");
}

#[test]
fn answers_to_pings_that_a_member_does_not_read_take_little_memory() {
    let server = Running::start(Limits {
        bytes_per_second: u32::MAX,
        datagrams_per_second: u32::MAX,
        idle: 3 * PATIENCE,
        ..Limits::default()
    });
    let mut socket = open(server.address, "room");
    socket.send(Message::binary(vec![1; 16])).unwrap();
    let stream = socket.get_mut();
    // 40 MB are several times what the buffers of the system hold.
    let ping = [&[0x89, 0x80 | 125, 0, 0, 0, 0][..], &[0; 125]].concat();
    let pings = ping.repeat(1000);
    (0..300).for_each(|_| stream.write_all(&pings).unwrap());
    stream.set_read_timeout(Some(Duration::from_secs(1))).unwrap();
    let (mut answers, mut bytes) = (0, vec![0; 1 << 16]);
    while let Ok(count) = stream.read(&mut bytes) {
        answers += count;
    }
    assert!(answers < 20_000_000, "{answers} bytes waited");
}

#[test]
fn a_close_frame_is_answered() {
    let server = Running::start(Limits::default());
    let mut socket = open(server.address, "room");
    socket.send(Message::binary(vec![1; 16])).unwrap();
    socket.close(None).unwrap();
    let end = std::iter::repeat_with(|| socket.read()).find_map(Result::err);
    assert!(matches!(end, Some(tungstenite::Error::ConnectionClosed)), "{end:?}");
}

#[test]
fn a_silent_member_is_disconnected_and_one_that_answers_pings_is_not() {
    let server = Running::start(Limits { idle: Duration::from_millis(300), ..Limits::default() });
    let mut a = server.enter("room", 1);
    // This member does not read, so it answers no ping.
    let silent = server.enter("room", 2);
    until_others(&mut a, std::slice::from_ref(silent.own()));
    until_others(&mut a, &[]);
    assert!(a.is_open());
}

#[test]
fn what_is_no_relay_is_an_error() {
    for url in ["http://127.0.0.1:1", "ws://", "ws://host/room", "host:1"] {
        assert!(matches!(Relay::connect(url, "room", [0; 16]), Err(RelayError::Url { .. })), "{url}");
    }
    let closed = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap();
    assert!(matches!(
        Relay::connect(&format!("ws://{closed}"), "room", [0; 16]),
        Err(RelayError::Refused { .. })
    ));
    let server = Running::start(Limits::default());
    let invalid = Relay::connect(&format!("ws://{}", server.address), "no%20code", [0; 16]);
    assert!(matches!(invalid, Err(RelayError::Refused { .. })));
}
