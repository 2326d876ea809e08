//! A peer with an error plays no more ticks, but can still leave and join again.

use std::cell::Cell;
use std::time::Duration;

use lockstep2d::hash::StateHash;
use lockstep2d::lockstep::{Game, RulesId, SetupError};
use lockstep2d::peer::{
    LinkConditions, Network, Peer, PeerError, PeerEvent, PeerIdentity, PeerOptions, Port, Transport,
};
use lockstep2d::session::{Address, Event};
use serde::{Deserialize, Serialize};

thread_local! {
    /// Whether inputs change when they are decoded.
    static BROKEN: Cell<bool> = const { Cell::new(false) };
}

#[derive(Clone, Debug, Default, PartialEq, Deserialize, Serialize)]
#[serde(from = "u8", into = "u8")]
struct Key(u8);

impl From<u8> for Key {
    fn from(byte: u8) -> Self {
        Key(byte + u8::from(BROKEN.get()))
    }
}

impl From<Key> for u8 {
    fn from(Key(byte): Key) -> Self {
        byte
    }
}

#[derive(Clone, Debug, Serialize, Deserialize)]
struct Ticks(u64);

impl Game for Ticks {
    type Setup = ();
    type Input = Key;
    type Save = Ticks;
    const RULES: RulesId = RulesId { name: "ticks", version: 1 };

    fn new(&(): &()) -> Result<Self, SetupError> {
        Ok(Ticks(0))
    }
    fn players(&self) -> u32 {
        2
    }
    fn tick_rate(&self) -> u32 {
        60
    }
    fn step(&mut self, _: &[Key]) {
        self.0 += 1;
    }
    fn state_hash(&self) -> StateHash {
        StateHash::of(self)
    }
    fn save(&self) -> Ticks {
        self.clone()
    }
    fn load(&mut self, save: &Ticks) {
        self.clone_from(save);
    }
    fn work(&self, _: &[Key]) -> u64 {
        1
    }
}

/// A port that counts the packets sent.
struct Counted {
    port: Port,
    sent: u32,
}

impl Transport for Counted {
    fn send(&mut self, packet: &[u8], to: &Address) {
        self.sent += 1;
        self.port.send(packet, to);
    }

    fn receive(&mut self) -> Option<(Address, Vec<u8>)> {
        self.port.receive()
    }
}

/// Plays the ticks that are due. The input changes in every tick, so the other peer guesses wrong inputs.
fn play(peer: &mut Peer<Ticks, Counted>) {
    while peer.is_due() {
        let key = u8::try_from(peer.tick() % 7).expect("less than 7");
        peer.advance(&vec![Key(key); peer.seats().len()]).expect("valid");
    }
}

#[test]
fn a_peer_with_an_error_plays_no_more_and_can_still_leave() {
    let network = Network::new(LinkConditions::latency(Duration::from_millis(80)), 1);
    let port = |number| Counted { port: network.port(number), sent: 0 };
    let (options, me) = (PeerOptions::rollback(), |number| PeerIdentity::new([number; 4]));
    let mut host = Peer::<Ticks, _>::host(&(), options, me(1), port(0)).expect("valid");
    let mut guest = Peer::<Ticks, _>::join(&(), options, me(2), port(1), Network::address(0)).expect("valid");
    let (mut now, mut error) = (Duration::ZERO, None);
    while error.is_none() && now < Duration::from_secs(3) {
        now += Duration::from_millis(10);
        network.set_time(now);
        host.update(now).expect("valid");
        play(&mut host);
        BROKEN.set(now > Duration::from_secs(2));
        error = guest.update(now).err();
        BROKEN.set(false);
        if error.is_none() {
            play(&mut guest);
        }
    }
    assert!(matches!(error, Some(PeerError::Record(_))), "{error:?}");
    let (tick, sent) = (guest.tick(), guest.transport_mut().sent);
    assert!(!guest.is_due(), "a peer with an error plays no more");
    assert_eq!(guest.advance(&vec![Key(0); guest.seats().len()]).err(), error);
    guest.leave();
    for _ in 0..200 {
        now += Duration::from_millis(10);
        network.set_time(now);
        assert_eq!(guest.update(now).err(), error, "the same error");
        host.update(now).expect("valid");
        play(&mut host);
    }
    assert_eq!(guest.tick(), tick);
    assert!(guest.transport_mut().sent > sent + 20, "{} packets", guest.transport_mut().sent - sent);
    let left = |event| matches!(event, PeerEvent::Session(Event::Unseated { .. }));
    assert!(std::iter::from_fn(|| host.next_event()).any(left));
    guest.ask(Network::address(0));
    assert_eq!(guest.update(now), Ok(()), "a peer that joins again has no error");
}
