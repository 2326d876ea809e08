//! Peers play a match. An attacker reads all packets, and sends noise and truncated, repeated or changed packets.

use std::cell::RefCell;
use std::collections::VecDeque;
use std::rc::Rc;
use std::time::Duration;

use lockstep2d::peer::{
    LinkConditions, Network, Peer, PeerError, PeerEvent, PeerIdentity, PeerOptions, Port, Transport,
};
use lockstep2d::replay::{Limits, verify};
use lockstep2d::report::DesyncReport;
use lockstep2d::session::{Address, PeerId};

use crate::bytes::session::repair;
use crate::forge::mutate;
use crate::memory::Memory;
use crate::source::Source;

/// Length of a match, in turns of 10 ms.
const TURNS: u32 = 500;
/// Turn in which the third peer requests to join or to watch.
const NEWCOMER: u32 = 150;
/// Port of the attacker.
const STRANGER: u32 = 9;
/// Number of packets that the attacker remembers.
const PACKETS: usize = 64;

/// The last [`PACKETS`] packets that the peers sent, each with the port number of its sender.
type Heard = Rc<RefCell<VecDeque<(u32, Vec<u8>)>>>;

struct Tapped {
    port: Port,
    number: u32,
    heard: Heard,
}

impl Transport for Tapped {
    fn send(&mut self, packet: &[u8], to: &Address) {
        let mut heard = self.heard.borrow_mut();
        if heard.len() == PACKETS {
            heard.pop_front();
        }
        heard.push_back((self.number, packet.to_vec()));
        self.port.send(packet, to);
    }

    fn receive(&mut self) -> Option<(Address, Vec<u8>)> {
        self.port.receive()
    }
}

/// Statistics of a match.
#[derive(Clone, Copy, Debug, Default)]
pub struct Seen {
    /// Last tick that both the host and the second peer have confirmed, or 0 if one of them has stopped.
    pub ticks: u64,
    /// Number of packets that the attacker sent.
    pub packets: u64,
    /// Whether a peer has stopped. Forged packets can cause that.
    pub stopped: bool,
    /// Whether a peer has detected a desync. Forged packets can cause that.
    pub diverged: bool,
    /// Whether a third peer has joined or watched and has played a tick. False if the host or the second peer has
    /// stopped.
    pub late: bool,
}

struct Match {
    network: Network,
    heard: Heard,
    /// `None` for a peer that has stopped or not yet started.
    peers: [Option<Peer<Memory, Tapped>>; 3],
    /// Whether the attacker can make correct checksums.
    forges: bool,
    seen: Seen,
}

/// Plays a match of 5 s (a hundred ticks), disturbed as the bytes describe.
///
/// # Panics
/// When a peer's report or replay is invalid. Also when a peer stops or the states differ, although the attacker cannot
/// make correct checksums.
pub fn run(bytes: &[u8]) -> Seen {
    let mut source = Source::new(bytes);
    let options = source.pick(&[PeerOptions::lockstep(), PeerOptions::rollback()]);
    let newcomer = source.below(3);
    let mut game = Match {
        network: Network::new(LinkConditions::default(), 1),
        heard: Heard::default(),
        peers: [None, None, None],
        forges: !source.one_in(4),
        seen: Seen::default(),
    };
    let contact = Network::address(0);
    let me = |number: u64| PeerIdentity::new([number, number, 5, number]);
    game.peers[0] = Peer::host(&(), options, me(1), game.port(0)).ok();
    game.peers[1] = Peer::join(&(), options, me(2), game.port(1), contact).ok();
    let mut pause = source.below(12);
    for turn in 0..TURNS {
        if turn == NEWCOMER && newcomer > 0 {
            let port = game.port(2);
            game.peers[2] = match newcomer {
                1 => Peer::join(&(), options, me(3), port, contact).ok(),
                _ => Peer::watch(&(), options, me(3), port, Network::address(1)).ok(),
            };
        }
        game.turn(turn);
        pause = match pause {
            0 if !source.is_empty() => {
                game.perturb(&mut source);
                source.pick(&[0, 0, 3, 10, 60])
            }
            _ => pause.max(1) - 1,
        };
    }
    game.finish()
}

impl Match {
    fn port(&self, number: u32) -> Tapped {
        Tapped { port: self.network.port(number), number, heard: self.heard.clone() }
    }

    fn turn(&mut self, turn: u32) {
        let now = Duration::from_millis(10) * turn;
        self.network.set_time(now);
        self.each(|peer| {
            peer.update(now)?;
            while peer.is_due() {
                let inputs = vec![(turn >> 4) as u8; peer.seats().len()];
                peer.advance(&inputs)?;
            }
            Ok(())
        });
        for peer in self.peers.iter_mut().flatten() {
            while let Some(event) = peer.next_event() {
                let PeerEvent::Desync(desync) = event else { continue };
                assert!(self.forges, "without forged packets the states must be equal");
                self.seen.diverged = true;
                if let Ok(bytes) = peer.report(&desync) {
                    let report = DesyncReport::from_bytes(&bytes, &Limits::default());
                    assert!(report.is_ok(), "a peer's own report must be valid: {report:?}");
                }
            }
        }
    }

    /// Calls `act` for each peer. A peer that returns an error is removed.
    fn each(&mut self, mut act: impl FnMut(&mut Peer<Memory, Tapped>) -> Result<(), PeerError>) {
        for peer in &mut self.peers {
            if let Some(Err(error)) = peer.as_mut().map(&mut act) {
                assert!(self.forges, "a peer stopped without forged packets: {error}");
                (*peer, self.seen.stopped) = (None, true);
            }
        }
    }

    fn perturb(&mut self, source: &mut Source<'_>) {
        let to = source.pick(&[0, 1, 2]);
        let from = source.pick(&[0, 1, 2, STRANGER]);
        let heard = self.heard.borrow();
        let (sender, heard) = heard.get(source.below(heard.len())).cloned().unwrap_or_default();
        let mut packet = match source.below(8) {
            0 => (0..source.below(60)).map(|_| source.byte()).collect(),
            1 => heard[..source.below(heard.len() + 1)].to_vec(),
            2 => heard.clone(),
            _ => {
                let mut changed = heard.clone();
                for _ in 0..=source.below(3) {
                    mutate(source, &mut changed);
                }
                changed
            }
        };
        // An attacker that cannot forge checksums sends an unchanged packet only from the port of its original sender.
        let from = if !self.forges && packet == heard { sender } else { from };
        if self.forges {
            repair(0, PeerId(to + 1), &mut packet);
        }
        self.network.port(from).send(&packet, &Network::address(to));
        self.seen.packets += 1;
    }

    fn finish(self) -> Seen {
        let Match { peers, forges, mut seen, .. } = self;
        if let [Some(host), Some(player), third] = &peers {
            seen.ticks = host.confirmed().min(player.confirmed());
            seen.late = third.as_ref().is_some_and(|third| third.tick() > 0);
            let hash = |peer: &Peer<Memory, Tapped>| Some(peer.history().get(seen.ticks)?.hash);
            let equal = hash(host).zip(hash(player)).is_none_or(|(host, player)| host == player);
            assert!(forges || equal, "the states of the peers must be equal");
        }
        for mut peer in peers.into_iter().flatten() {
            let begun = peer.take_replay();
            let Ok(end) = peer.finish() else { continue };
            let replay = [begun, end.replay].concat();
            let verdict = verify::<Memory>(&replay, &Limits::default());
            assert!(replay.is_empty() || verdict.is_match(), "a peer's own replay must be valid: {verdict}");
        }
        seen
    }
}
