//! Peers play a match while an attacker, who reads all packets, sends arbitrary ones: noise, packets of the match
//! truncated, repeated or changed, and with correct checksums any packet, under its own address and those of others.

use std::cell::RefCell;
use std::rc::Rc;
use std::time::Duration;

use lockstep2d::net::{Event, LinkConditions, Mode, NetError, NetOptions, Network, Peer, Port, Transport};
use lockstep2d::replay::{Limits, verify};
use lockstep2d::report::DesyncReport;

use crate::forge::mutate;
use crate::hostile::{Forger, Known, STRANGER};
use crate::memory::Memory;
use crate::source::Source;
use crate::wire;

/// Number of turns in which the peers are updated.
const TURNS: u8 = 160;
/// Number of updates per peer and turn.
const ROUNDS: usize = 3;
/// Turn in which the third peer asks to join or to watch.
const NEWCOMER: u8 = 10;

/// A port whose outgoing packets are recorded.
struct Tapped {
    port: Port,
    address: u32,
    known: Rc<RefCell<Known>>,
}

impl Transport<u32> for Tapped {
    fn send(&mut self, packet: &[u8], to: &u32) {
        self.known.borrow_mut().receive(self.address, *to, packet);
        self.port.send(packet, to);
    }

    fn receive(&mut self) -> Option<(u32, Vec<u8>)> {
        self.port.receive()
    }
}

/// Statistics of a match.
#[derive(Clone, Copy, Debug, Default)]
pub struct Seen {
    /// Ticks with confirmed inputs of host and player.
    pub ticks: u64,
    /// Packets of the attacker.
    pub packets: u64,
    /// Whether a peer has stopped, which forged packets can cause.
    pub stopped: bool,
    /// Whether a peer has detected a divergence, which forged packets can cause, too.
    pub diverged: bool,
    /// Whether a peer has joined or watched the running match.
    pub late: bool,
}

/// A match and its attacker.
struct Match {
    options: NetOptions,
    network: Network,
    known: Rc<RefCell<Known>>,
    /// Peers by address; `None` for a peer that has stopped.
    peers: [Option<Peer<Memory, u32, Tapped>>; 3],
    /// Whether the attacker can make correct checksums.
    forges: bool,
    seen: Seen,
}

/// Plays a match of a few dozen ticks, disturbed as the bytes describe.
///
/// # Panics
/// When a peer panics, when its report or replay is invalid, or when packets without a correct checksum make the peers
/// stop or differ.
pub fn run(bytes: &[u8]) -> Seen {
    let mut source = Source::new(bytes);
    let options = match source.below(4) {
        0 => NetOptions::lockstep(),
        1 | 2 => NetOptions::rollback(),
        _ => NetOptions { mode: Mode::Rollback { window: 32 }, input_delay: 15, ..NetOptions::rollback() },
    };
    let newcomer = source.below(3);
    let mut game = Match {
        options,
        network: Network::new(LinkConditions::default(), 1),
        known: Rc::default(),
        peers: [None, None, None],
        forges: !source.one_in(4),
        seen: Seen::default(),
    };
    game.peers[0] = Peer::host(&(), options, game.port(0)).ok();
    game.peers[1] = Peer::join(&(), options, game.port(1), 0, None).ok();
    let mut pause = source.below(12);
    for turn in 0..TURNS {
        if turn == NEWCOMER && newcomer > 0 {
            let port = game.port(2);
            game.peers[2] = match newcomer {
                1 => Peer::join(&(), options, port, 0, None).ok(),
                _ => Peer::watch(&(), options, port, 1).ok(),
            };
        }
        game.turn(turn);
        pause = match pause {
            0 if !source.is_empty() => {
                game.perturb(&mut source);
                source.pick(&[0, 0, 1, 2, 30])
            }
            _ => pause.max(1) - 1,
        };
    }
    game.finish()
}

impl Match {
    fn port(&self, address: u32) -> Tapped {
        Tapped { port: self.network.port(address), address, known: self.known.clone() }
    }

    fn turn(&mut self, turn: u8) {
        let now = Duration::from_millis(50) * u32::from(turn);
        self.network.set_time(now);
        for _ in 0..ROUNDS {
            self.each(|peer| peer.update(now));
        }
        let mut input = turn.wrapping_mul(7);
        self.each(|peer| {
            input ^= 1;
            if peer.is_due() { peer.advance(input).map(drop) } else { Ok(()) }
        });
        for peer in self.peers.iter_mut().flatten() {
            while let Some(event) = peer.next_event() {
                let ordinary =
                    matches!(event, Event::Joined { .. } | Event::Interrupted { .. } | Event::Resumed { .. });
                assert!(ordinary || self.forges, "without forged packets there must be no {event:?}");
                if let Event::Diverged(divergence) = event
                    && !self.seen.diverged
                {
                    self.seen.diverged = true;
                    let report = DesyncReport::from_bytes(&peer.report(&divergence), &Limits::default());
                    assert!(report.is_ok(), "a peer's own report must be valid: {report:?}");
                }
            }
        }
    }

    /// Calls `act` for each peer; a peer that returns an error is removed.
    fn each(&mut self, mut act: impl FnMut(&mut Peer<Memory, u32, Tapped>) -> Result<(), NetError>) {
        for peer in &mut self.peers {
            if let Some(Err(error)) = peer.as_mut().map(&mut act) {
                assert!(self.forges, "a peer stopped without forged packets: {error}");
                (*peer, self.seen.stopped) = (None, true);
            }
        }
    }

    /// Sends a packet of the attacker to a peer.
    fn perturb(&mut self, source: &mut Source<'_>) {
        let present: Vec<_> = (0..3).filter(|at| self.peers[*at as usize].is_some()).collect();
        if present.is_empty() {
            return;
        }
        let to = source.pick(&present);
        let from = source.pick(&[0, 1, 2, STRANGER]);
        let known = self.known.borrow();
        let heard = known.packets.get(source.below(known.packets.len())).cloned();
        let (sender, _, heard) = heard.unwrap_or_default();
        let mut packet = match source.below(if self.forges { 12 } else { 4 }) {
            0 => (0..source.below(60)).map(|_| source.byte()).collect(),
            1 => heard[..source.below(heard.len() + 1)].to_vec(),
            2 => heard,
            3 => {
                let mut changed = heard;
                for _ in 0..=source.below(3) {
                    mutate(source, &mut changed);
                }
                changed
            }
            _ => Forger { source, known: &known, from, to }.packet().write(),
        };
        drop(known);
        // A genuine packet from another address would be a forgery.
        let from = if !self.forges && wire::is_right(&packet) { sender } else { from };
        if self.forges {
            wire::repair(&mut packet);
        }
        self.network.port(from).send(&packet, &to);
        self.seen.packets += 1;
    }

    fn finish(self) -> Seen {
        let Match { peers, forges, mut seen, options, .. } = self;
        if let [Some(host), Some(player), third] = &peers {
            seen.ticks = host.confirmed().min(player.confirmed());
            seen.late = third.as_ref().is_some_and(|third| third.seat().is_some() || third.tick() > 0);
            let hash = |peer: &Peer<Memory, u32, Tapped>| Some(peer.history().get(seen.ticks)?.hash);
            assert!(forges || hash(host) == hash(player), "the states of the peers must be equal");
        }
        for peer in peers.into_iter().flatten() {
            let Ok(replay) = peer.finish(u64::MAX) else { continue };
            let verdict = verify::<Memory>(&replay, &Limits::default());
            // A late joiner has no replay.
            assert!(
                replay.is_empty() || verdict.is_match(),
                "a peer's own replay must match, {options:?}: {verdict}"
            );
        }
        seen
    }
}
