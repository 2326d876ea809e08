//! [`Online`]: a network match, with the local player at the keyboard.

use std::net::SocketAddr;
use std::time::Duration;

use lockstep2d::hash::StateHash;
use lockstep2d::lockstep::Game;
use lockstep2d::net::{Address, Divergence, Event as NetEvent, NetError, NetOptions, Peer, Transport, Udp};
use lockstep2d::replay::{CHECKPOINT_INTERVAL, Limits, RawReplay, Recording, Step};
use lockstep2d::world::World;
use lockstep2d_render::{Camera, DrawList};
use lockstep2d_shove::online::{OnlineError, Participation, describe, play_due};
use lockstep2d_shove::{Setup, Shove};

use super::decorate::{decorate, headline};
use super::keys::{Keys, Side};
use crate::event::Event;
use crate::source::{Source, SourceError};

/// Participant of a network match: its host, another player or a spectator.
///
/// The match runs by the clock that all participants share, so it can neither be paused nor sought. The last few
/// ticks shown may be predicted. The replay contains only ticks with confirmed inputs of all players.
pub struct Online<A: Address, T: Transport<A>> {
    peer: Peer<Shove, A, T>,
    now: Duration,
    keys: Keys,
    /// Part of the replay that has been taken from the peer so far.
    replay: Vec<u8>,
    diverged: Option<Divergence>,
    /// Text of the peer's last event.
    told: Option<String>,
    /// Error that ended the match.
    ended: Option<NetError>,
}

impl Online<SocketAddr, Udp> {
    /// Enters a match over UDP. The socket is bound to the address `bind`, or to any free port without it.
    ///
    /// # Errors
    /// [`OnlineError`] if an address cannot be resolved, the socket cannot be opened, or the setup is invalid.
    pub fn udp(
        participation: Participation<&str>,
        bind: Option<&str>,
        setup: &Setup,
        options: NetOptions,
    ) -> Result<Self, OnlineError> {
        Ok(Self::new(participation.enter_udp(bind, setup, options)?))
    }
}

impl<A: Address, T: Transport<A>> Online<A, T> {
    /// Wraps a new peer.
    #[must_use]
    pub fn new(peer: Peer<Shove, A, T>) -> Self {
        let (keys, replay) = (Keys::new(Side::Both), Vec::new());
        Online { peer, now: Duration::ZERO, keys, replay, diverged: None, told: None, ended: None }
    }

    /// Returns the peer.
    #[must_use]
    pub const fn peer(&self) -> &Peer<Shove, A, T> {
        &self.peer
    }

    /// Returns the first divergence, if there was one.
    #[must_use]
    pub const fn diverged(&self) -> Option<&Divergence> {
        self.diverged.as_ref()
    }

    /// Leaves the match, notifies the other peers, and returns the finished replay. It is empty if this peer was not
    /// in the match from the first tick.
    ///
    /// # Errors
    /// [`NetError`] if the replay cannot be finished.
    pub fn leave(self) -> Result<Vec<u8>, NetError> {
        let rest = self.peer.finish(u64::MAX)?;
        Ok([self.replay, rest].concat())
    }

    fn go_on(&mut self) -> Result<(), NetError> {
        self.peer.update(self.now)?;
        let pad = self.keys.pad();
        play_due(&mut self.peer, |_, _| pad)?;
        while let Some(event) = self.peer.next_event() {
            self.told = Some(describe(&event));
            if let NetEvent::Diverged(found) = event {
                self.diverged.get_or_insert(found);
            }
        }
        self.replay.extend(self.peer.take_replay());
        Ok(())
    }

    /// Returns a complete replay of the confirmed ticks so far. The match is still being recorded, so the ticks are
    /// played again into a second recording.
    fn replay_so_far(&self) -> Result<Vec<u8>, SourceError> {
        if self.replay.is_empty() {
            return Err(SourceError("this peer has no replay of the match, or not yet".into()));
        }
        let mut raw = RawReplay::<Shove>::open(&self.replay, &Limits::default()).map_err(SourceError::of)?;
        let setup = *raw.game().setup();
        let mut recording =
            Recording::<Shove>::start(&setup, CHECKPOINT_INTERVAL).map_err(SourceError::of)?;
        while raw.step().map_err(SourceError::of)? == Step::Ticked {
            recording.step(raw.inputs()).map_err(SourceError::of)?;
        }
        recording.finish().map_err(SourceError::of)
    }
}

impl<A: Address, T: Transport<A>> Source for Online<A, T> {
    fn name(&self) -> &str {
        "shove"
    }

    fn world(&mut self) -> &World {
        self.peer.game().world()
    }

    fn hash(&self) -> StateHash {
        self.peer.game().state_hash()
    }

    fn tick(&self) -> u64 {
        self.peer.tick()
    }

    fn ticks(&self) -> Option<u64> {
        None
    }

    fn tick_rate(&self) -> u32 {
        self.peer.game().tick_rate()
    }

    fn seek(&mut self, tick: u64) -> Result<(), SourceError> {
        let is_here = tick == self.tick();
        is_here
            .then_some(())
            .ok_or_else(|| SourceError("a network match runs by its own clock and cannot be sought".into()))
    }

    fn handle(&mut self, event: &Event) -> bool {
        self.keys.handle(event)
    }

    fn advance(&mut self, time: Duration) -> Result<bool, SourceError> {
        self.now += time;
        if self.ended.is_none()
            && let Err(error) = self.go_on()
        {
            let why = SourceError::of(&error);
            self.ended = Some(error);
            return Err(why);
        }
        Ok(true)
    }

    fn decorate(&mut self, list: &mut DrawList, camera: &Camera) {
        decorate(self.peer.game(), list, camera);
    }

    fn save_replay(&mut self) -> Option<Result<Vec<u8>, SourceError>> {
        Some(self.replay_so_far())
    }

    fn status(&self) -> String {
        let seat = match self.peer.seat() {
            _ if self.ended.is_some() => "out of the match".into(),
            Some(seat) => format!("seat {}", seat + 1),
            None => "no seat".into(),
        };
        let news = match (&self.ended, &self.diverged, &self.told) {
            (Some(error), ..) => error.to_string(),
            (None, Some(found), _) => describe(&NetEvent::Diverged(*found)),
            (None, None, told) => told.clone().unwrap_or_default(),
        };
        format!("{seat} · {} · {news}", headline(self.peer.game()))
    }
}
