//! [`Online`]: a network match, with the local player at the keyboard.

use std::time::Duration;

use lockstep2d::hash::StateHash;
use lockstep2d::lockstep::Game;
use lockstep2d::peer::{Peer, PeerDesync, PeerError, PeerEvent, PeerIdentity, PeerOptions, Transport, Udp};
use lockstep2d::replay::{CHECKPOINT_INTERVAL, Limits, RawReplay, Recording, Step};
use lockstep2d::session::{Event as SessionEvent, PeerId, Status};
use lockstep2d::world::World;
use lockstep2d_render::{Camera, DrawList};
use lockstep2d_shove::online::{OnlineError, Participation, describe, play_due};
use lockstep2d_shove::{Setup, Shove};

use super::decorate::{decorate, headline};
use super::keys::{Keys, Side};
use crate::event::Event;
use crate::source::{Source, SourceError};

/// Longest time for which closing waits until the others know that this peer leaves, and time between two updates.
const LEAVE_TIME: Duration = Duration::from_secs(1);
const LEAVE_STEP: Duration = Duration::from_millis(5);

/// Participant of a network match: its host, another player or a spectator.
///
/// The match runs by the clock that all participants share, so it can neither be paused nor sought. The last few
/// ticks shown may be played with guessed inputs. The replay contains only final ticks.
pub struct Online<T: Transport> {
    peer: Peer<Shove, T>,
    now: Duration,
    keys: Keys,
    /// Part of the replay that has been taken from the peer so far.
    replay: Vec<u8>,
    desync: Option<PeerDesync>,
    /// Text of the peer's last event.
    told: Option<String>,
    /// Whom play waits for, and whether that peer is heard.
    waiting: Option<(PeerId, bool)>,
    /// Error that ended the match.
    ended: Option<PeerError>,
}

impl Online<Udp> {
    /// Enters a match over UDP. The socket is bound to the address `bind`, or to any free port without it.
    ///
    /// # Errors
    /// [`OnlineError`] if an address cannot be resolved, the socket cannot be opened, or the setup is invalid.
    pub fn udp(
        participation: Participation<&str>,
        bind: Option<&str>,
        setup: &Setup,
        options: PeerOptions,
    ) -> Result<Self, OnlineError> {
        Ok(Self::new(participation.enter_udp(bind, setup, options, PeerIdentity::random())?))
    }
}

impl<T: Transport> Online<T> {
    /// Wraps a new peer.
    #[must_use]
    pub fn new(peer: Peer<Shove, T>) -> Self {
        let (keys, replay) = (Keys::new(Side::Both), Vec::new());
        Online {
            peer,
            now: Duration::ZERO,
            keys,
            replay,
            desync: None,
            told: None,
            waiting: None,
            ended: None,
        }
    }

    /// Returns the peer.
    #[must_use]
    pub const fn peer(&self) -> &Peer<Shove, T> {
        &self.peer
    }

    /// Returns the first desync, if there was one.
    #[must_use]
    pub const fn desync(&self) -> Option<&PeerDesync> {
        self.desync.as_ref()
    }

    /// Leaves the match: the others go on at once. Call [`advance`](Source::advance) until
    /// [`has_left`](Online::has_left).
    pub fn leave(&mut self) {
        self.peer.leave();
    }

    /// Whether the match has ended for this peer and nobody needs it any more.
    #[must_use]
    pub fn has_left(&self) -> bool {
        self.ended.is_some() || matches!(self.peer.status(), None | Some(Status::Closed))
    }

    /// Returns the finished replay. It is empty if this peer was not in the match from the first tick.
    ///
    /// # Errors
    /// [`PeerError`] if the replay cannot be finished.
    pub fn finish(self) -> Result<Vec<u8>, PeerError> {
        let end = self.peer.finish()?;
        Ok([self.replay, end.replay].concat())
    }

    fn go_on(&mut self) -> Result<(), PeerError> {
        self.peer.update(self.now)?;
        let pad = self.keys.pad();
        play_due(&mut self.peer, |_, _| pad)?;
        while let Some(event) = self.peer.next_event() {
            self.told = Some(describe(&self.peer, &event));
            match event {
                PeerEvent::Desync(found) => {
                    self.desync.get_or_insert(found);
                }
                PeerEvent::Session(SessionEvent::Waiting { peer, heard }) => {
                    self.waiting = Some((peer, heard))
                }
                PeerEvent::Session(SessionEvent::Resumed) => self.waiting = None,
                _ => {}
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

impl<T: Transport> Source for Online<T> {
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

    fn close(&mut self) {
        self.leave();
        for _ in 0..LEAVE_TIME.as_millis() / LEAVE_STEP.as_millis() {
            let left = matches!(self.peer.status(), Some(Status::Left | Status::Finished { .. }));
            if left || self.has_left() || self.advance(LEAVE_STEP).is_err() {
                break;
            }
            std::thread::sleep(LEAVE_STEP);
        }
    }

    fn decorate(&mut self, list: &mut DrawList, camera: &Camera) {
        decorate(self.peer.game(), list, camera);
    }

    fn save_replay(&mut self) -> Option<Result<Vec<u8>, SourceError>> {
        Some(self.replay_so_far())
    }

    fn status(&self) -> String {
        let seat = match self.peer.seats()[..] {
            _ if self.ended.is_some() => "out of the match".into(),
            [] => "no seat".into(),
            [seat, ..] => format!("seat {}", seat + 1),
        };
        let news = match (&self.ended, &self.desync, self.waiting) {
            (Some(error), ..) => error.to_string(),
            (None, Some(found), _) => describe(&self.peer, &PeerEvent::Desync(*found)),
            (None, None, Some((peer, heard))) => {
                describe(&self.peer, &PeerEvent::Session(SessionEvent::Waiting { peer, heard }))
            }
            (None, None, None) => self.told.clone().unwrap_or_default(),
        };
        format!("{seat} · {} · {news}", headline(self.peer.game()))
    }
}
