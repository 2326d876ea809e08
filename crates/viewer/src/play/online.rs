//! [`Online`]: a network match, with the local player at the keyboard.

use std::time::Duration;

use lockstep2d::hash::StateHash;
use lockstep2d::lockstep::Game;
use lockstep2d::peer::{Peer, PeerDesync, PeerError, PeerEvent, Transport};
use lockstep2d::session::{Event as SessionEvent, Status};
use lockstep2d::world::World;
use lockstep2d_render::{Camera, DrawList};

use super::controls::Controls;
use super::presentation::Presentation;
use crate::event::{Event, Key};
use crate::source::{Source, SourceError};

/// Maximum number of ticks that are played in a frame when this peer catches up, so that the window stays responsive.
const TICKS_PER_FRAME: u32 = 64;
/// Longest time for which [`Source::close`] waits until this peer has left the match.
const LEAVE_TIME: Duration = Duration::from_secs(1);
/// Interval of updates while [`Source::close`] waits.
const LEAVE_STEP: Duration = Duration::from_millis(5);

/// Participant of a network match: host, player or spectator.
///
/// The match follows a clock that all peers share, so the user can neither pause it nor go to another tick. The latest
/// ticks on the screen may have predicted inputs. The replay contains only final ticks.
///
/// ```
/// use std::time::Duration;
/// use lockstep2d::lockstep::{Sandbox, SandboxSetup};
/// use lockstep2d::peer::{LinkConditions, Network, Peer, PeerIdentity, PeerOptions};
/// use lockstep2d_viewer::{App, Controls, Online};
///
/// // A network in memory; `Viewer::online` uses UDP.
/// let (network, setup) = (Network::new(LinkConditions::default(), 1), SandboxSetup::default());
/// // The sandbox has one seat.
/// let options = PeerOptions { start_with: 1, ..PeerOptions::lockstep() };
/// let peer = Peer::<Sandbox, _>::host(&setup, options, PeerIdentity::random(), network.port(0))?;
/// let mut app = App::default();
/// app.show(Box::new(Online::new("alone", peer, Controls::new())));
/// for _ in 0..60 {
///     app.advance(Duration::from_millis(16));
/// }
/// assert!(app.report().tick > 30, "{}", app.report());
/// app.close();
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Online<G: Game, T: Transport> {
    name: String,
    peer: Peer<G, T>,
    now: Duration,
    controls: Controls<G::Input>,
    presentation: Presentation<G>,
    desync: Option<PeerDesync>,
    /// Message about the latest event that has one, for the status line.
    told: Option<&'static str>,
    /// Whether play waits for another peer.
    waiting: bool,
    /// Whether this peer has to join again.
    too_far_behind: bool,
    /// Error that ended the match.
    ended: Option<PeerError>,
    /// Empty world, shown for a game without a world.
    nothing: World,
}

impl<G: Game + 'static, T: Transport> Online<G, T> {
    /// Shows the match of a peer. `controls` apply to all seats of the peer.
    #[must_use]
    pub fn new(name: impl Into<String>, peer: Peer<G, T>, controls: Controls<G::Input>) -> Self {
        Online {
            name: name.into(),
            peer,
            now: Duration::ZERO,
            controls,
            presentation: Presentation::default(),
            desync: None,
            told: None,
            waiting: false,
            too_far_behind: false,
            ended: None,
            nothing: World::default(),
        }
    }

    pub(crate) fn presented(self, presentation: Presentation<G>) -> Self {
        Online { presentation, ..self }
    }

    /// The peer.
    #[must_use]
    pub const fn peer(&self) -> &Peer<G, T> {
        &self.peer
    }

    /// The first desync, if one was found.
    #[must_use]
    pub const fn desync(&self) -> Option<&PeerDesync> {
        self.desync.as_ref()
    }

    fn go_on(&mut self) -> Result<(), PeerError> {
        self.peer.update(self.now)?;
        for _ in 0..TICKS_PER_FRAME {
            if !self.peer.is_due() {
                break;
            }
            let seats = self.peer.seats().len();
            let inputs: Vec<_> = (0..seats).map(|_| self.controls.input()).collect();
            if self.peer.advance(&inputs)? {
                // Forgets the keys that went down since the last tick, so that a short tap counts for one tick.
                let _played = self.controls.take();
            }
        }
        while let Some(event) = self.peer.next_event() {
            self.note(&event);
        }
        Ok(())
    }

    fn note(&mut self, event: &PeerEvent) {
        match event {
            PeerEvent::Desync(found) => {
                self.desync.get_or_insert(*found);
            }
            PeerEvent::Session(SessionEvent::Waiting { .. }) => self.waiting = true,
            PeerEvent::Session(SessionEvent::Resumed) => self.waiting = false,
            PeerEvent::Session(SessionEvent::Seated { .. }) => self.told = Some("somebody has joined"),
            PeerEvent::Session(SessionEvent::Unseated { .. }) => self.told = Some("somebody has left"),
            PeerEvent::Session(SessionEvent::TooFarBehind) => self.too_far_behind = true,
            PeerEvent::Joined { .. } => self.too_far_behind = false,
            _ => {}
        }
    }

    fn replay_so_far(&mut self) -> Result<Vec<u8>, SourceError> {
        let file = self.peer.replay_so_far().map_err(SourceError::of)?;
        if file.is_empty() || self.peer.confirmed() == 0 {
            return Err(SourceError("this peer has no replay of the match, or not yet".into()));
        }
        Ok(file)
    }

    fn news(&self) -> String {
        match (&self.ended, &self.desync, self.peer.status()) {
            (Some(error), ..) => return error.to_string(),
            (None, Some(PeerDesync { tick, ours, theirs, .. }), _) => {
                return format!("after tick {tick} the state is {ours} here and {theirs} elsewhere");
            }
            _ if self.too_far_behind => "too far behind the others: join the match again",
            (None, None, Some(Status::Playing)) if self.waiting => "waiting for somebody",
            (None, None, Some(Status::Playing)) => self.told.unwrap_or("playing"),
            (None, None, Some(Status::Waiting)) => "waiting for more players",
            (None, None, None | Some(Status::Joining)) => "joining",
            (None, None, Some(Status::Watching)) => "watching",
            (None, None, Some(Status::Paused)) => "paused: no majority of the players is heard",
            (None, None, Some(Status::Dropped)) => "dropped: the others went on; asking for the seat again",
            (None, None, Some(Status::Kicked)) => "removed by the others",
            (None, None, Some(Status::Finished { .. })) => "finished",
            (None, None, Some(_)) => "out of the match",
        }
        .to_owned()
    }
}

impl<G: Game + 'static, T: Transport> Source for Online<G, T> {
    fn name(&self) -> &str {
        &self.name
    }

    fn world(&mut self) -> &World {
        self.peer.game().world().unwrap_or(&self.nothing)
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

    /// Number of final ticks, which are those in the replay.
    fn recorded(&self) -> u64 {
        self.peer.confirmed()
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
        self.controls.handle(event)
    }

    fn keys(&self) -> Vec<Key> {
        self.controls.keys().collect()
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

    /// Leaves the match.
    fn close(&mut self) {
        self.peer.leave();
        for _ in 0..LEAVE_TIME.as_millis() / LEAVE_STEP.as_millis() {
            if matches!(self.peer.status(), None | Some(Status::Closed)) {
                break;
            }
            // A peer that leaves needs updates until the other peers know about it. After an error, `advance` no longer
            // updates the peer, so it is updated directly. Errors have been shown before.
            let _ = self.advance(LEAVE_STEP);
            if self.ended.is_some() {
                let _ = self.peer.update(self.now);
            }
            std::thread::sleep(LEAVE_STEP);
        }
    }

    fn decorate(&mut self, list: &mut DrawList, camera: &Camera) {
        self.presentation.draw(self.peer.game(), list, camera);
    }

    fn state(&self) -> Vec<(String, String)> {
        (self.presentation.state)(self.peer.game())
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
        let own = (self.presentation.status)(self.peer.game());
        let parts = [seat, own, self.news()];
        parts.into_iter().filter(|part| !part.is_empty()).collect::<Vec<_>>().join(" · ")
    }
}
