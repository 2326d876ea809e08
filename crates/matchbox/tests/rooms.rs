//! Rooms of a signalling server on this machine, and a match over real data channels.

use std::net::{Ipv4Addr, SocketAddr};
use std::thread;
use std::time::{Duration, Instant};

use lockstep2d::hash::StateHash;
use lockstep2d::lockstep::{Game, RulesId, SetupError};
use lockstep2d::peer::{Peer, PeerIdentity, PeerOptions, Sealed, Transport};
use lockstep2d::replay::{Limits, Verdict, verify};
use lockstep2d::session::{Address, Status};
use lockstep2d_matchbox::Matchbox;
use lockstep2d_matchbox::matchbox_socket::{RtcIceServerConfig, WebRtcSocket};
use matchbox_signaling::SignalingServer;

/// Longest wait for an expected event.
const PATIENCE: Duration = Duration::from_secs(30);
const STEP: Duration = Duration::from_millis(2);

struct Server {
    runtime: Option<tokio::runtime::Runtime>,
    address: SocketAddr,
}

impl Server {
    fn start() -> Self {
        let runtime = tokio::runtime::Runtime::new().expect("threads");
        let _guard = runtime.enter();
        let mut server = SignalingServer::full_mesh_builder((Ipv4Addr::LOCALHOST, 0)).build();
        let address = server.bind().expect("a free port");
        runtime.spawn(server.serve());
        Server { runtime: Some(runtime), address }
    }

    fn enter(&self, room: &str) -> Matchbox {
        let ice_server = RtcIceServerConfig { urls: vec![], ..Default::default() };
        let builder = WebRtcSocket::builder(format!("ws://{}/{room}", self.address)).ice_server(ice_server);
        Matchbox::with_builder(builder.reconnect_attempts(Some(1)))
    }

    fn kill(mut self) {
        self.stop();
    }

    fn stop(&mut self) {
        if let Some(runtime) = self.runtime.take() {
            runtime.shutdown_background();
        }
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        self.stop();
    }
}

fn until<T>(what: &str, mut attempt: impl FnMut() -> Option<T>) -> T {
    let start = Instant::now();
    while start.elapsed() < PATIENCE {
        if let Some(found) = attempt() {
            return found;
        }
        thread::sleep(STEP);
    }
    panic!("{what}: not within {PATIENCE:?}");
}

fn others(member: &mut Matchbox, count: usize) -> Vec<Address> {
    until("the members", || {
        member.update();
        (member.others().len() == count).then(|| member.others().to_vec())
    })
}

#[test]
fn packets_reach_the_member_they_are_for_and_name_their_sender() {
    let server = Server::start();
    let mut members = [server.enter("a"), server.enter("a"), server.enter("a")];
    let mut stranger = server.enter("b");
    let addresses = members.each_mut().map(|member| until("an address", || member.own()));
    for (member, own) in members.iter_mut().zip(&addresses) {
        let mut expected: Vec<Address> = addresses.iter().filter(|other| *other != own).copied().collect();
        expected.sort_unstable_by_key(|address| address.bytes().to_vec());
        assert_eq!(others(member, 2), expected);
    }

    // Packets may be lost, so they are sent until one arrives.
    let [a, b, c] = &mut members;
    let found = until("a packet", || {
        a.send(b"to b", &addresses[1]);
        b.receive()
    });
    assert_eq!(found, (addresses[0], b"to b".to_vec()));
    assert_eq!(c.receive(), None, "a packet for b");
    // Packets from another room and packets to an address without a member are dropped.
    stranger.send(b"from outside", &addresses[2]);
    a.send(b"nowhere", &Address::nowhere());
    a.send(b"nowhere", &Address::new(&[1, 2, 3]).expect("a short address"));
    let found = until("a packet", || {
        a.send(b"to c", &addresses[2]);
        c.receive()
    });
    assert_eq!(found, (addresses[0], b"to c".to_vec()));
    assert!(stranger.others().is_empty() && stranger.receive().is_none());
}

#[test]
fn a_member_that_leaves_is_gone_and_comes_back_with_another_address() {
    let server = Server::start();
    let (mut a, mut b) = (server.enter("room"), server.enter("room"));
    let first = others(&mut a, 1);
    others(&mut b, 1);
    drop(b);
    others(&mut a, 0);
    a.send(b"gone", &first[0]);
    let mut b = server.enter("room");
    let second = others(&mut a, 1);
    assert_ne!(first, second);
    let found = until("a packet", || {
        a.send(b"again", &second[0]);
        b.receive()
    });
    assert_eq!(found.1, b"again");
}

#[test]
fn a_room_without_a_server_is_closed() {
    let server = Server::start();
    let address = server.address;
    server.kill();
    let mut member = Matchbox::with_builder(
        WebRtcSocket::builder(format!("ws://{address}/room")).reconnect_attempts(Some(1)),
    );
    until("the end", || {
        member.send(b"lost", &Address::nowhere());
        assert_eq!(member.receive(), None);
        member.is_closed().then_some(())
    });
    assert!(member.others().is_empty());
}

/// A game in which players add their inputs to a sum.
struct Sum(u64);

impl Game for Sum {
    type Setup = ();
    type Input = u8;
    type Save = u64;

    const RULES: RulesId = RulesId { name: "sum", version: 1 };

    fn new((): &()) -> Result<Self, SetupError> {
        Ok(Sum(0))
    }

    fn players(&self) -> u32 {
        2
    }

    fn tick_rate(&self) -> u32 {
        60
    }

    fn step(&mut self, inputs: &[u8]) {
        for &input in inputs {
            self.0 = self.0.wrapping_mul(31).wrapping_add(input.into());
        }
    }

    fn state_hash(&self) -> StateHash {
        StateHash::of(&self.0)
    }

    fn save(&self) -> u64 {
        self.0
    }

    fn load(&mut self, save: &u64) {
        self.0 = *save;
    }

    fn work(&self, _: &[u8]) -> u64 {
        1
    }
}

/// Plays a match of two peers in one thread. Returns their replays.
fn play<T: Transport>(peers: [Peer<Sum, T>; 2], ticks: u64) -> Vec<Vec<u8>> {
    let start = Instant::now();
    let mut peers = peers;
    peers[0].end_at(ticks);
    while peers.iter().any(|peer| peer.status() != Some(Status::Closed)) {
        assert!(start.elapsed() < 2 * PATIENCE, "ticks {:?}", peers.each_ref().map(Peer::tick));
        for (number, peer) in (1..).zip(&mut peers) {
            peer.update(start.elapsed()).expect("a peer that can go on");
            while peer.is_due() {
                let input = u8::try_from(peer.tick() / 7 % 50).expect("below 50") * number;
                peer.advance(&[input]).expect("an input");
            }
        }
        thread::sleep(STEP);
    }
    let replay =
        |mut peer: Peer<Sum, T>| [peer.take_replay(), peer.finish().expect("a replay").replay].concat();
    peers.into_iter().map(replay).collect()
}

#[test]
fn a_match_over_data_channels_has_one_history() {
    let server = Server::start();
    for options in [PeerOptions::lockstep(), PeerOptions::rollback()] {
        let (host, mut guest) = (server.enter("match"), server.enter("match"));
        let contact = others(&mut guest, 1)[0];
        let key = [7; 32];
        let [host, guest] = [host, guest].map(|room| Sealed::new(room, key));
        let replays = play(
            [
                Peer::host(&(), options, PeerIdentity::random(), host).expect("a host"),
                Peer::join(&(), options, PeerIdentity::random(), guest, contact).expect("a guest"),
            ],
            240,
        );
        for replay in &replays {
            let verdict = verify::<Sum>(replay, &Limits::default());
            assert!(matches!(verdict, Verdict::Match { ticks: 240, .. }), "{verdict}");
        }
        let game = |replay: &[u8]| verify::<Sum>(replay, &Limits::default()).to_string();
        assert_eq!(game(&replays[0]), game(&replays[1]));
    }
}
