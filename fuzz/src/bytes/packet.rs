//! Sends packets to peers that wait, join, watch and play.
//!
//! Peers are expensive to create, so many inputs go to the same ones. When an input makes a peer panic, all inputs
//! since the peers were created are written to a folder. Given to the target in this order, they reproduce the panic,
//! unless it depends on random numbers of the peers.

use std::cell::RefCell;
use std::collections::VecDeque;
use std::path::PathBuf;
use std::rc::Rc;
use std::sync::Mutex;
use std::time::Duration;

use lockstep2d::net::{Event, Mode, NetOptions, PACKET_BYTES_MAX, Peer, Transport};
use lockstep2d::replay::{Limits, verify};
use lockstep2d::report::DesyncReport;

use crate::forge::mutate;
use crate::hostile::{Forger, Known, STRANGER};
use crate::memory::Memory;
use crate::source::Source;
use crate::wire;

/// Maximum number of inputs for the same peers.
const INPUTS_PER_STAGE: usize = 256;
/// Addresses of the peers: one waits for players, two play with each other, one wants to join, one wants to watch.
const WAITING: usize = 0;
const PLAYING: [usize; 2] = [1, 2];
const JOINING: usize = 3;
const WATCHING: usize = 4;
const PEERS: usize = 5;

/// Inputs since the peers were created.
static PAST: Mutex<Vec<Vec<u8>>> = Mutex::new(Vec::new());

thread_local! {
    static STAGE: RefCell<Option<Stage>> = const { RefCell::new(None) };
}

/// Packets on their way to a peer, and packets that it has sent.
#[derive(Default)]
struct Box {
    incoming: VecDeque<(u32, Vec<u8>)>,
    outgoing: Vec<(u32, Vec<u8>)>,
}

#[derive(Clone, Default)]
struct Post(Rc<RefCell<Box>>);

impl Transport<u32> for Post {
    fn send(&mut self, packet: &[u8], to: &u32) {
        self.0.borrow_mut().outgoing.push((*to, packet.to_vec()));
    }

    fn receive(&mut self) -> Option<(u32, Vec<u8>)> {
        self.0.borrow_mut().incoming.pop_front()
    }
}

/// The peers, and an eavesdropper that reads all their packets.
struct Stage {
    peers: Vec<(Peer<Memory, u32, Post>, Post)>,
    known: Known,
    now: Duration,
    inputs: usize,
    /// Whether a peer has received a packet with a correct checksum that no other peer has sent.
    forged: bool,
}

/// Sends a packet to a peer. Returns the effect on the peer as one word.
///
/// # Panics
/// When a peer panics, when it writes an invalid report or replay, or when it fails without having received a forged
/// packet.
pub fn run(bytes: &[u8]) -> &'static str {
    STAGE.with_borrow_mut(|place| {
        if place.as_ref().is_none_or(|stage| stage.inputs >= INPUTS_PER_STAGE) {
            if let Some(stage) = place.take() {
                stage.finish();
            }
            forget_inputs();
            *place = Some(Stage::new());
        }
        let Some(stage) = place else { return "nobody" };
        stage.inputs += 1;
        remember_input(bytes);
        let became = stage.play(bytes);
        if became == "stopped" {
            *place = None;
        }
        became
    })
}

impl Stage {
    fn new() -> Self {
        let options = NetOptions { mode: Mode::Rollback { window: 8 }, ..NetOptions::rollback() };
        let posts: Vec<Post> = (0..PEERS).map(|_| Post::default()).collect();
        let host = |at: usize| Peer::host(&(), options, posts[at].clone());
        let join = |at: usize, contact| Peer::join(&(), options, posts[at].clone(), contact, None);
        let watch = |at: usize, contact| Peer::watch(&(), options, posts[at].clone(), contact);
        let peers =
            [host(WAITING), host(PLAYING[0]), join(PLAYING[1], 1), join(JOINING, 0), watch(WATCHING, 1)];
        let peers: Result<Vec<_>, _> = peers.into_iter().collect();
        let peers = peers.expect("a valid setup").into_iter().zip(posts).collect();
        let mut stage =
            Stage { peers, known: Known::default(), now: Duration::ZERO, inputs: 0, forged: false };
        // Plays until the match has started.
        for turn in 0..40 {
            stage.now += Duration::from_millis(25);
            for at in PLAYING {
                stage.turn(at, turn).expect("no packets are forged yet");
                stage.deliver(at, |to| PLAYING.contains(&(to as usize)));
            }
        }
        let ticks = PLAYING.map(|at| stage.peers[at].0.tick());
        assert!(ticks.iter().all(|tick| *tick > 3), "the match is under way: {ticks:?}");
        for at in [WAITING, JOINING, WATCHING] {
            stage.turn(at, 0).expect("no packets are forged yet");
            stage.deliver(at, |_| false);
        }
        stage
    }

    fn turn(&mut self, at: usize, input: u8) -> Result<(), lockstep2d::net::NetError> {
        let (peer, _) = &mut self.peers[at];
        peer.update(self.now)?;
        if peer.is_due() {
            peer.advance(input)?;
        }
        Ok(())
    }

    /// Records the packets that a peer has sent, and delivers some of them.
    fn deliver(&mut self, from: usize, arrives: impl Fn(u32) -> bool) {
        let said = std::mem::take(&mut self.peers[from].1.0.borrow_mut().outgoing);
        for (to, packet) in said {
            self.known.receive(from as u32, to, &packet);
            if arrives(to)
                && let Some((_, post)) = self.peers.get(to as usize)
            {
                post.0.borrow_mut().incoming.push_back((from as u32, packet));
            }
        }
    }

    fn play(&mut self, bytes: &[u8]) -> &'static str {
        let Some((&mode, rest)) = bytes.split_first() else { return "nothing" };
        let at = usize::from(mode >> 4) % PEERS;
        let mut source = Source::new(rest);
        let packet = match mode & 3 {
            0 => rest.to_vec(),
            1 => {
                let mut packet = rest.to_vec();
                wire::repair(&mut packet);
                packet
            }
            way => self.forged(&mut source, at, way == 3),
        };
        let from = [0, 1, 2, STRANGER][usize::from(mode >> 2 & 3)];
        let heard = wire::is_right(&packet) && packet.len() <= PACKET_BYTES_MAX;
        self.peers[at].1.0.borrow_mut().incoming.push_back((from, packet));
        self.forged |= heard;
        self.now += Duration::from_micros(if heard { 500 } else { 50 });
        if let Err(error) = self.turn(at, mode) {
            assert!(self.forged, "a peer stopped without a forged packet: {error}");
            return "stopped";
        }
        // Peers that play keep receiving each other's packets.
        self.deliver(at, |to| PLAYING.contains(&at) && PLAYING.contains(&(to as usize)));
        let (peer, _) = &mut self.peers[at];
        let mut became = if heard { "heard" } else { "dropped" };
        while let Some(event) = peer.next_event() {
            if let Event::Diverged(divergence) = event {
                let report = DesyncReport::from_bytes(&peer.report(&divergence), &Limits::default());
                assert!(report.is_ok(), "a peer's own report must be valid: {report:?}");
                became = "diverged";
            }
        }
        became
    }

    /// A packet that an eavesdropper could send to a peer.
    fn forged(&self, source: &mut Source<'_>, to: usize, change: bool) -> Vec<u8> {
        let from = source.pick(&[0, 1, 2, STRANGER]);
        let mut packet = if source.one_in(3) {
            let heard = self.known.packets.get(source.below(self.known.packets.len()));
            heard.map(|(_, _, bytes)| bytes.clone()).unwrap_or_default()
        } else {
            Forger { source, known: &self.known, from, to: to as u32 }.packet().write()
        };
        if change {
            mutate(source, &mut packet);
            if !source.one_in(4) {
                wire::repair(&mut packet);
            }
        }
        packet
    }

    /// Checks the replays written by the peers.
    fn finish(self) {
        for (peer, _) in self.peers {
            let Ok(replay) = peer.finish(u64::MAX) else { continue };
            let verdict = verify::<Memory>(&replay, &Limits::default());
            assert!(replay.is_empty() || verdict.is_match(), "a peer's own replay must match: {verdict}");
        }
    }
}

fn remember_input(bytes: &[u8]) {
    if let Ok(mut past) = PAST.lock() {
        past.push(bytes.to_vec());
    }
}

fn forget_inputs() {
    if let Ok(mut past) = PAST.lock() {
        past.clear();
    }
}

/// Installs a panic hook that writes the inputs since the peers were created to a folder.
pub fn keep_inputs_of_a_panic() {
    let before = std::panic::take_hook();
    std::panic::set_hook(std::boxed::Box::new(move |panic| {
        if let Ok(folder) = write_inputs() {
            eprintln!("the inputs that led to this: {}/*", folder.display());
        }
        before(panic);
    }));
}

fn write_inputs() -> std::io::Result<PathBuf> {
    let folder = std::env::temp_dir().join(format!("lockstep2d-packets-{}", std::process::id()));
    std::fs::create_dir_all(&folder)?;
    let past = PAST.lock().map_err(|_| std::io::ErrorKind::Other)?;
    for (at, bytes) in past.iter().enumerate() {
        std::fs::write(folder.join(format!("{at:04}")), bytes)?;
    }
    Ok(folder)
}
