//! [`MatchDriver`]: a participant of a match.

use core::fmt;

use lockstep2d::lockstep::Game;
use lockstep2d::peer::{Peer, PeerDesync, PeerError, Transport};
use lockstep2d::session::{Address, PeerId, Session, Status};

use super::FrameTime;
use crate::error::LockstepError;
use crate::game::LockstepGame;
use crate::inputs::Inputs;
use crate::observed::Observed;

/// A [`Transport`] of any type: [`Udp`](lockstep2d::peer::Udp), or your own.
pub struct AnyTransport(Box<dyn Transport + Send + Sync>);

impl AnyTransport {
    /// Hides the type of a transport.
    pub fn new(transport: impl Transport + Send + Sync + 'static) -> Self {
        AnyTransport(Box::new(transport))
    }
}

impl fmt::Debug for AnyTransport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("AnyTransport").finish_non_exhaustive()
    }
}

impl Transport for AnyTransport {
    fn send(&mut self, packet: &[u8], to: &Address) {
        self.0.send(packet, to);
    }

    fn receive(&mut self) -> Option<(Address, Vec<u8>)> {
        self.0.receive()
    }
}

/// Largest number of ticks that a peer plays in a frame, for example to catch up.
const TICKS_PER_FRAME: u32 = 64;

pub(crate) struct MatchDriver<G: LockstepGame> {
    peer: Peer<Observed<G>, AnyTransport>,
    /// Estimated time since the last tick, in ticks, 0 to 1. The exact time is unknown, because the session lengthens
    /// and shortens its ticks.
    phase: f32,
    /// Id of this peer in the session in which the last error occurred. `None` if there was no session or no error.
    failed_as: Option<PeerId>,
}

impl<G: LockstepGame> MatchDriver<G> {
    pub(crate) fn new(peer: Peer<Observed<G>, AnyTransport>) -> Self {
        MatchDriver { peer, phase: 0.0, failed_as: None }
    }

    pub(crate) fn run(
        &mut self,
        time: FrameTime,
        is_paused: bool,
        inputs: &mut Inputs<G>,
    ) -> Result<(), LockstepError> {
        let result = self.play(time, is_paused, inputs);
        if result.is_err() {
            self.give_up();
        }
        result
    }

    /// Exchanges packets after an error, so that the others learn that this peer leaves. Returns whether the peer has
    /// joined again, after [`Peer::ask`].
    ///
    /// # Errors
    /// The contact has refused the new request, or this peer has joined again and cannot continue. In the second case
    /// it leaves again. Errors that were returned before are not returned again.
    pub(crate) fn run_failed(&mut self, time: FrameTime) -> Result<bool, LockstepError> {
        let updated = self.peer.update(time.real_elapsed);
        self.synchronise();
        let has_joined = self.id().is_some_and(|id| Some(id) != self.failed_as);
        match updated {
            Ok(()) => Ok(has_joined),
            // For example, the state that begins the new session is not a state of this game.
            Err(error) if has_joined => {
                self.give_up();
                Err(error.into())
            }
            Err(error @ (PeerError::Refused { .. } | PeerError::Parameters(_))) => Err(error.into()),
            // An error that stops the peer occurs again in each update.
            Err(_) => Ok(false),
        }
    }

    /// Leaves the session after an error. The others would wait for a peer that exchanges packets and plays no more.
    fn give_up(&mut self) {
        self.peer.leave();
        self.failed_as = self.id();
    }

    /// Id of this peer in its session.
    fn id(&self) -> Option<PeerId> {
        self.peer.session().map(Session::id)
    }

    fn play(
        &mut self,
        time: FrameTime,
        is_paused: bool,
        inputs: &mut Inputs<G>,
    ) -> Result<(), LockstepError> {
        let first = self.peer.tick();
        self.peer.update(time.real_elapsed)?;
        // `Lockstep::pause` pauses only a session that exists at that time. A session that began later is paused here.
        if let Some(session) = self.peer.session_mut().filter(|_| is_paused) {
            session.pause(true);
        }
        self.synchronise();
        for _ in 0..TICKS_PER_FRAME {
            if is_paused || !self.peer.is_due() {
                break;
            }
            let own = self.peer.session().map_or(0, |session| session.seats().count_ones());
            // `advance` returns whether it has issued the inputs. A peer without a seat plays ticks without issuing
            // inputs. Inputs that were not issued are kept for the next tick.
            if self.peer.advance(&inputs.next(own as usize))? {
                inputs.used();
            }
            self.synchronise();
        }
        let played = self.peer.tick().saturating_sub(first);
        let rate = self.peer.game().tick_rate() as f32;
        let passed = self.phase + time.real_delta.as_secs_f32() * rate - played as f32;
        self.phase = passed.clamp(0.0, 1.0);
        Ok(())
    }

    /// Sets the tick of the log, because a received state does not contain its tick.
    fn synchronise(&self) {
        self.peer.game().log().set_tick(self.peer.tick());
    }

    pub(crate) fn peer(&self) -> &Peer<Observed<G>, AnyTransport> {
        &self.peer
    }

    pub(crate) fn peer_mut(&mut self) -> &mut Peer<Observed<G>, AnyTransport> {
        &mut self.peer
    }

    pub(crate) fn report(&mut self, desync: &PeerDesync) -> Result<Vec<u8>, LockstepError> {
        self.without_events(|peer| peer.report(desync))
    }

    pub(crate) fn replay_so_far(&mut self) -> Result<Vec<u8>, LockstepError> {
        self.without_events(|peer| peer.replay_so_far())
    }

    /// Makes a file while the log is suspended: to make it, the peer plays ticks again whose events are already in the
    /// log.
    fn without_events(
        &mut self,
        make: impl FnOnce(&mut Peer<Observed<G>, AnyTransport>) -> Result<Vec<u8>, PeerError>,
    ) -> Result<Vec<u8>, LockstepError> {
        self.peer.game().log().suspend();
        let file = make(&mut self.peer);
        self.peer.game().log().resume();
        Ok(file?)
    }

    pub(crate) fn finish(self) -> Result<Vec<u8>, LockstepError> {
        Ok(self.peer.finish()?.replay)
    }

    /// Whether the match has ended for this peer, and all of its final ticks were played.
    pub(crate) fn has_ended(&self) -> bool {
        self.peer.session().is_some_and(|session| {
            let ended = matches!(session.status(), Status::Finished { .. } | Status::Left | Status::Closed);
            ended && session.confirmed() == session.final_tick()
        })
    }

    pub(crate) fn fraction(&self) -> f32 {
        self.phase
    }
}
