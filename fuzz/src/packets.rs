//! Two peers play a match while a third party sends them what it likes: noise, packets of the match cut, repeated or
//! changed, with and without a right checksum, in its own name and in that of the other.

use std::collections::VecDeque;
use std::time::Duration;

use lockstep2d::hash::StateHash;
use lockstep2d::lockstep::{Game, RulesId, SetupError};
use lockstep2d::net::{Event, Network, Options, Peer, Port, Transport, Weather};

use crate::source::Source;

/// A game that is next to nothing, but remembers everything.
#[derive(Clone)]
struct Memory {
    sum: u64,
}

impl Game for Memory {
    type Setup = ();
    type Input = u8;
    type Save = u64;

    const RULES: RulesId = RulesId { name: "memory", version: 1 };

    fn new((): &()) -> Result<Self, SetupError> {
        Ok(Memory { sum: 1 })
    }

    fn players(&self) -> u32 {
        3
    }

    fn tick_rate(&self) -> u32 {
        60
    }

    fn step(&mut self, inputs: &[u8]) {
        for input in inputs {
            self.sum = self.sum.wrapping_mul(31).wrapping_add(u64::from(*input));
        }
    }

    fn state_hash(&self) -> StateHash {
        StateHash::of(&self.sum)
    }

    fn save(&self) -> u64 {
        self.sum
    }

    fn load(&mut self, save: &u64) {
        self.sum = *save;
    }

    fn work(&self, _: &[u8]) -> u64 {
        1
    }

    fn absent() -> u8 {
        255
    }
}

/// A port that remembers what has passed.
struct Tapped {
    port: Port,
    heard: VecDeque<Vec<u8>>,
}

impl Transport<u32> for Tapped {
    fn send(&mut self, packet: &[u8], to: &u32) {
        self.port.send(packet, to);
    }

    fn receive(&mut self) -> Option<(u32, Vec<u8>)> {
        let (from, bytes) = self.port.receive()?;
        if from != STRANGER {
            if self.heard.len() == 64 {
                self.heard.pop_front();
            }
            self.heard.push_back(bytes.clone());
        }
        Some((from, bytes))
    }
}

/// The address of nobody.
const STRANGER: u32 = 9;
const CHECKSUM_BYTES: usize = 8;

/// What has happened.
#[derive(Clone, Copy, Debug, Default)]
pub struct Seen {
    /// Ticks that both have played with everybody's inputs.
    pub ticks: u64,
    /// Packets of the third party.
    pub packets: u64,
    /// Whether somebody has stopped: packets with right checksums can do that.
    pub stopped: bool,
}

/// A match of a few dozen ticks, disturbed as the bytes say.
///
/// # Panics
/// When a peer does, or when packets that nobody can mistake for genuine ones make the peers stop or differ.
pub fn run(bytes: &[u8]) -> Seen {
    let mut source = Source::new(bytes);
    let options = if source.one_in(2) { Options::lockstep() } else { Options::rollback() };
    // Whether the third party can make a packet look right.
    let forges = source.one_in(2);
    let network = Network::new(Weather::default(), 1);
    let port = |address| Tapped { port: network.port(address), heard: VecDeque::new() };
    let mut peers = [
        Peer::<Memory, u32, _>::host(&(), options, port(0)).expect("a setup"),
        Peer::join(&(), options, port(1), 0, None).expect("a setup"),
    ];
    let mut seen = Seen::default();
    let mut now = Duration::ZERO;
    for turn in 0..120u8 {
        now += Duration::from_millis(17);
        network.set_time(now);
        for at in [0, 1] {
            for _ in 0..4 {
                if peers.iter_mut().any(|peer| peer.update(now).is_err()) {
                    seen.stopped = true;
                }
            }
            let input = turn.wrapping_mul(7) ^ at as u8;
            if peers[at].is_due() && peers[at].advance(input).is_err() {
                seen.stopped = true;
            }
        }
        if seen.stopped {
            assert!(forges, "noise has stopped a match");
            return seen;
        }
        // The match has to be under way, or the two would only wait for each other.
        if peers[1].seat().is_some() && !source.is_empty() {
            disturb(&mut source, &mut peers, &network, forges);
            seen.packets += 1;
        }
    }
    seen.ticks = peers[0].confirmed().min(peers[1].confirmed());
    if !forges {
        let hash = |peer: &Peer<Memory, u32, Tapped>| peer.history().get(seen.ticks).map(|moment| moment.hash);
        assert_eq!(hash(&peers[0]), hash(&peers[1]), "the peers differ");
        for peer in &mut peers {
            while let Some(event) = peer.next_event() {
                let calm = matches!(event, Event::Joined { .. } | Event::Interrupted { .. } | Event::Resumed { .. });
                assert!(calm, "noise has made {event:?}");
            }
        }
    }
    for peer in peers {
        let _ = peer.finish(u64::MAX);
    }
    seen
}

/// Sends somebody something.
fn disturb(source: &mut Source<'_>, peers: &mut [Peer<Memory, u32, Tapped>; 2], network: &Network, forges: bool) {
    let to = source.below(2);
    let heard = &peers[to].transport_mut().heard;
    let known = heard.get(source.below(heard.len().max(1))).cloned().unwrap_or_default();
    let mut packet = match source.below(4) {
        0 => (0..source.below(60)).map(|_| source.byte()).collect(),
        1 => known[..source.below(known.len() + 1)].to_vec(),
        2 => known,
        _ => {
            let mut changed = known;
            for _ in 0..=source.below(3) {
                if !changed.is_empty() {
                    let at = source.below(changed.len());
                    changed[at] = source.byte();
                }
            }
            changed
        }
    };
    if forges && packet.len() >= CHECKSUM_BYTES {
        let hash = StateHash::of_bytes(&packet[CHECKSUM_BYTES..]).0.to_le_bytes();
        packet[..CHECKSUM_BYTES].copy_from_slice(&hash[..CHECKSUM_BYTES]);
    }
    let from = if source.one_in(2) { STRANGER } else { 1 - to as u32 };
    network.port(from).send(&packet, &(to as u32));
}
