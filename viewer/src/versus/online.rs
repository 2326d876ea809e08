//! [`Online`]: a match over a network, with the keyboard as this player's pad.

use std::net::SocketAddr;
use std::time::Duration;

use lockstep2d::hash::StateHash;
use lockstep2d::lockstep::Game;
use lockstep2d::net::{Address, Divergence, Event as NetEvent, NetError, Options, Peer, Transport, Udp};
use lockstep2d::replay::{CHECKPOINT_INTERVAL, Limits, Recording, Rerun, Step};
use lockstep2d::world::World;
use lockstep2d_picture::{Camera, DrawList};
use lockstep2d_shove::online::{OnlineError, Way, describe, play_due};
use lockstep2d_shove::{Setup, Shove};

use super::decorate::{decorate, headline};
use super::keys::{Keys, Side};
use crate::event::Event;
use crate::source::{Source, SourceError};

/// One participant of a match: hosts it, joins it or watches it.
///
/// It goes by its own clock, which is that of all participants; one can neither pause it nor go back in it. What is seen
/// may be a guess of the last few ticks. The replay has only what is known from everybody.
pub struct Online<A: Address, T: Transport<A>> {
    peer: Peer<Shove, A, T>,
    now: Duration,
    keys: Keys,
    /// The replay up to where it has been taken from the peer.
    replay: Vec<u8>,
    diverged: Option<Divergence>,
    /// The last thing that the peer has told.
    told: Option<String>,
    /// Why it does not go on.
    ended: Option<NetError>,
}

impl Online<SocketAddr, Udp> {
    /// Takes part over UDP; packets come in at the address `bind`, or else at any free port.
    ///
    /// # Errors
    /// [`OnlineError`] when there is no such address, no socket, or the setup starts no game.
    pub fn udp(
        way: Way<&str>,
        bind: Option<&str>,
        setup: &Setup,
        options: Options,
    ) -> Result<Self, OnlineError> {
        Ok(Self::new(way.enter_udp(bind, setup, options)?))
    }
}

impl<A: Address, T: Transport<A>> Online<A, T> {
    /// Takes the part of a peer that has just been made.
    #[must_use]
    pub fn new(peer: Peer<Shove, A, T>) -> Self {
        let (keys, replay) = (Keys::new(Side::Both), Vec::new());
        Online { peer, now: Duration::ZERO, keys, replay, diverged: None, told: None, ended: None }
    }

    /// The peer.
    #[must_use]
    pub const fn peer(&self) -> &Peer<Shove, A, T> {
        &self.peer
    }

    /// The first divergence, if there was one.
    #[must_use]
    pub const fn diverged(&self) -> Option<&Divergence> {
        self.diverged.as_ref()
    }

    /// Leaves the match, which tells the others, and ends the replay; it is empty if this peer was not there from the
    /// first tick.
    ///
    /// # Errors
    /// [`NetError`] when the replay cannot be ended.
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

    /// A whole replay of what there is: the match goes on, and so it has to be recorded anew.
    fn replay_so_far(&self) -> Result<Vec<u8>, SourceError> {
        if self.replay.is_empty() {
            return Err(SourceError("this match has no replay here, or not yet".into()));
        }
        let mut rerun = Rerun::<Shove>::open(&self.replay, &Limits::default()).map_err(SourceError::of)?;
        let setup = *rerun.game().setup();
        let mut recording =
            Recording::<Shove>::start(&setup, CHECKPOINT_INTERVAL).map_err(SourceError::of)?;
        while rerun.step().map_err(SourceError::of)? == Step::Ticked {
            recording.step(rerun.inputs()).map_err(SourceError::of)?;
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
        is_here.then_some(()).ok_or_else(|| SourceError("a match goes by its own clock".into()))
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
