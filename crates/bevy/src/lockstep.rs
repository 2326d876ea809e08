//! [`Lockstep`]: the game and its driver, in one resource.

use core::sync::atomic::{AtomicU64, Ordering};

use bevy::prelude::Resource;
use lockstep2d::lockstep::Game;
use lockstep2d::peer::{Peer, PeerDesync, PeerEvent, PeerIdentity, PeerOptions, Transport};
use lockstep2d::replay::Limits;
use lockstep2d::session::Address;
use lockstep2d::world::World;

use crate::drivers::{
    AnyTransport, Driver, FrameTime, LocalDriver, MatchDriver, ReplayDriver, SyncTestDriver,
};
use crate::error::LockstepError;
use crate::game::LockstepGame;
use crate::inputs::Inputs;
use crate::observed::Observed;

/// Kind of the driver that plays the ticks of a [`Lockstep`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DriverKind {
    /// The driver of [`Lockstep::local`].
    Local,
    /// The driver of [`Lockstep::sync_test`].
    SyncTest,
    /// The driver of [`Lockstep::replay`].
    Replay,
    /// The driver of [`Lockstep::host`], [`Lockstep::join`] and [`Lockstep::watch`].
    Match,
}

/// A game and its driver. Insert it as a resource to start, replace it to restart, and remove it to stop.
///
/// The game can be changed only through [`Inputs`]: other changes would be missing on other machines and in the replay.
#[derive(Resource)]
pub struct Lockstep<G: LockstepGame> {
    /// Unique in the program, so that systems recognise a resource that was replaced within a frame.
    number: u64,
    driver: Driver<G>,
    is_paused: bool,
    /// Number of ticks to be played although the game is paused.
    single_steps: u32,
    failure: Option<LockstepError>,
}

type AnyPeer<G> = Peer<Observed<G>, AnyTransport>;

impl<G: LockstepGame> Lockstep<G> {
    fn new(driver: Driver<G>) -> Self {
        static COUNT: AtomicU64 = AtomicU64::new(0);
        let number = COUNT.fetch_add(1, Ordering::Relaxed);
        Lockstep { number, driver, is_paused: false, single_steps: 0, failure: None }
    }

    /// A game whose players are all at this machine, recorded for [`Lockstep::take_replay`].
    ///
    /// # Errors
    /// [`LockstepError::Record`] when the setup cannot start a game.
    pub fn local(setup: &G::Setup) -> Result<Self, LockstepError> {
        Ok(Self::new(Driver::Local(Box::new(LocalDriver::new(setup)?))))
    }

    /// A local game for tests. From tick `depth` on, the driver loads the state of `depth` ticks ago after every tick,
    /// plays these ticks again and compares the state hashes. It stops with [`LockstepError::SyncTest`] if they differ.
    ///
    /// # Errors
    /// [`LockstepError::Setup`] when the setup cannot start a game.
    pub fn sync_test(setup: &G::Setup, depth: u32) -> Result<Self, LockstepError> {
        Ok(Self::new(Driver::SyncTest(Box::new(SyncTestDriver::new(setup, depth)?))))
    }

    /// A replay, from its first tick.
    ///
    /// # Errors
    /// [`LockstepError::Replay`] with the verdict when no tick of the file can be played.
    pub fn replay(file: Vec<u8>, limits: &Limits) -> Result<Self, LockstepError> {
        Ok(Self::new(Driver::Replay(Box::new(ReplayDriver::new(file, limits)?))))
    }

    /// Opens a match; see [`Peer::host`].
    ///
    /// # Errors
    /// [`LockstepError::Match`] when the setup or the options cannot start a game.
    pub fn host(
        setup: &G::Setup,
        options: PeerOptions,
        me: PeerIdentity,
        transport: impl Transport + Send + Sync + 'static,
    ) -> Result<Self, LockstepError> {
        Ok(Self::of_peer(Peer::host(setup, options, me, AnyTransport::new(transport))?))
    }

    /// Joins a match, also after it has begun; see [`Peer::join`].
    ///
    /// # Errors
    /// As [`Lockstep::host`].
    pub fn join(
        setup: &G::Setup,
        options: PeerOptions,
        me: PeerIdentity,
        transport: impl Transport + Send + Sync + 'static,
        contact: Address,
    ) -> Result<Self, LockstepError> {
        Ok(Self::of_peer(Peer::join(setup, options, me, AnyTransport::new(transport), contact)?))
    }

    /// Watches a match; see [`Peer::watch`].
    ///
    /// # Errors
    /// As [`Lockstep::host`].
    pub fn watch(
        setup: &G::Setup,
        options: PeerOptions,
        me: PeerIdentity,
        transport: impl Transport + Send + Sync + 'static,
        contact: Address,
    ) -> Result<Self, LockstepError> {
        Ok(Self::of_peer(Peer::watch(setup, options, me, AnyTransport::new(transport), contact)?))
    }

    fn of_peer(peer: AnyPeer<G>) -> Self {
        Self::new(Driver::Match(Box::new(MatchDriver::new(peer))))
    }

    /// The game. In a match, its state may depend on guessed inputs.
    #[must_use]
    pub fn game(&self) -> &G {
        self.driver.game().game()
    }

    /// The physics world of the game, if it has one.
    #[must_use]
    pub fn world(&self) -> Option<&World> {
        self.driver.game().world()
    }

    /// Number of ticks played.
    #[must_use]
    pub fn tick(&self) -> u64 {
        self.driver.tick()
    }

    /// Number of ticks that no rollback can change.
    #[must_use]
    pub fn confirmed(&self) -> u64 {
        self.driver.confirmed()
    }

    /// Kind of the driver of this game.
    #[must_use]
    pub const fn kind(&self) -> DriverKind {
        match &self.driver {
            Driver::Local(_) => DriverKind::Local,
            Driver::SyncTest(_) => DriverKind::SyncTest,
            Driver::Replay(_) => DriverKind::Replay,
            Driver::Match(_) => DriverKind::Match,
        }
    }

    /// Stops the ticks. In a match, the other peers receive a [`MatchEvent`](crate::MatchEvent) and decide whether they
    /// stop, too. Peers that do not stop wait for this peer until it resumes, even for longer than
    /// [`PeerOptions::patience`].
    pub fn pause(&mut self) {
        self.set_paused(true);
    }

    /// Continues after [`Lockstep::pause`].
    pub fn resume(&mut self) {
        self.set_paused(false);
    }

    fn set_paused(&mut self, is_paused: bool) {
        self.is_paused = is_paused;
        if let Some(session) = self.peer_mut().and_then(Peer::session_mut) {
            session.pause(is_paused);
        }
    }

    /// Whether [`Lockstep::pause`] stopped the ticks.
    #[must_use]
    pub const fn is_paused(&self) -> bool {
        self.is_paused
    }

    /// Plays one tick in the next frame although the game is paused. If it is not paused, this tick is played in
    /// addition to those that are due. Has no effect in a match or after a failure.
    pub fn step_once(&mut self) {
        self.single_steps = self.single_steps.saturating_add(1);
    }

    /// Why the driver has stopped. The plugin also sends it as [`LockstepFailed`](crate::LockstepFailed) and logs it. A
    /// peer then leaves its match, so that the others continue. [`Peer::ask`] lets it join again.
    #[must_use]
    pub const fn failure(&self) -> Option<&LockstepError> {
        self.failure.as_ref()
    }

    /// Goes to a tick of a replay, forwards or backwards, without events. A replay that has failed can go back.
    ///
    /// # Errors
    /// [`LockstepError::Seek`] when the replay does not have the tick, or cannot be played up to it.
    /// [`LockstepError::Unsupported`] for other drivers.
    pub fn seek(&mut self, tick: u64) -> Result<(), LockstepError> {
        let Driver::Replay(replay) = &mut self.driver else { return Err(LockstepError::Unsupported("seek")) };
        replay.seek(tick)?;
        self.failure = None;
        Ok(())
    }

    /// Goes back by a number of ticks of a replay, at most to its start.
    ///
    /// # Errors
    /// As [`Lockstep::seek`].
    pub fn back(&mut self, ticks: u64) -> Result<(), LockstepError> {
        self.seek(self.tick().saturating_sub(ticks))
    }

    /// Length of a replay in ticks.
    #[must_use]
    pub fn replay_ticks(&self) -> Option<u64> {
        match &self.driver {
            Driver::Replay(replay) => Some(replay.ticks()),
            _ => None,
        }
    }

    /// Takes the finished bytes of the replay, to be appended to its file. Each byte is returned once. Empty for
    /// drivers that do not record, and for a peer that joined after the first tick.
    pub fn take_replay(&mut self) -> Vec<u8> {
        match &mut self.driver {
            Driver::Local(local) => local.take_replay(),
            Driver::Match(network) => network.peer_mut().take_replay(),
            Driver::SyncTest(_) | Driver::Replay(_) => Vec::new(),
        }
    }

    /// Ends the game and returns the rest of its replay: see [`Lockstep::take_replay`]. Leave or end a match first: see
    /// [`Peer::finish`].
    ///
    /// # Errors
    /// [`LockstepError`] when the replay cannot be finished.
    pub fn finish(self) -> Result<Vec<u8>, LockstepError> {
        match self.driver {
            Driver::Local(local) => local.finish(),
            Driver::Match(network) => network.finish(),
            Driver::SyncTest(_) | Driver::Replay(_) => Ok(Vec::new()),
        }
    }

    /// Indices of the players at this machine in the inputs of [`Game::step`], ascending and counted from 0. Empty in a
    /// replay, for a spectator, and before a peer is seated.
    #[must_use]
    pub fn seats(&self) -> Vec<u32> {
        match &self.driver {
            Driver::Local(_) | Driver::SyncTest(_) => (0..self.driver.game().players()).collect(),
            Driver::Replay(_) => Vec::new(),
            Driver::Match(network) => network.peer().seats(),
        }
    }

    /// The local peer of a match.
    #[must_use]
    pub fn peer(&self) -> Option<&AnyPeer<G>> {
        match &self.driver {
            Driver::Match(network) => Some(network.peer()),
            _ => None,
        }
    }

    /// The local peer of a match, to leave or end it or to kick a player. The plugin calls `update` and `advance`, so
    /// the game must not call them. Use [`Lockstep::report`] and [`Lockstep::replay_so_far`] for the files of the
    /// match.
    pub fn peer_mut(&mut self) -> Option<&mut AnyPeer<G>> {
        match &mut self.driver {
            Driver::Match(network) => Some(network.peer_mut()),
            _ => None,
        }
    }

    /// Report of a desync, as bytes for a file: see [`Peer::report`].
    ///
    /// # Errors
    /// [`LockstepError::Match`] when this peer no longer has the states for it, [`LockstepError::Unsupported`] for
    /// other drivers.
    pub fn report(&mut self, desync: &PeerDesync) -> Result<Vec<u8>, LockstepError> {
        match &mut self.driver {
            Driver::Match(network) => network.report(desync),
            _ => Err(LockstepError::Unsupported("report a desync")),
        }
    }

    /// A complete replay of the final ticks of a match so far: see [`Peer::replay_so_far`].
    ///
    /// # Errors
    /// [`LockstepError::Match`] when the replay cannot be finished, [`LockstepError::Unsupported`] for other drivers.
    pub fn replay_so_far(&mut self) -> Result<Vec<u8>, LockstepError> {
        match &mut self.driver {
            Driver::Match(network) => network.replay_so_far(),
            _ => Err(LockstepError::Unsupported("save a replay of a match that goes on")),
        }
    }

    pub(crate) fn run(&mut self, time: FrameTime, inputs: &mut Inputs<G>) -> Result<(), LockstepError> {
        let single_steps = core::mem::take(&mut self.single_steps);
        let has_failed = self.failure.is_some();
        // `Ok(true)` if ticks can be played. `Ok(false)` if an earlier error still stops the game.
        let result = match &mut self.driver {
            Driver::Match(network) if has_failed => network.run_failed(time),
            _ if has_failed => Ok(false),
            _ => {
                let stepped = self.run_singly(single_steps, inputs);
                stepped.and_then(|()| self.driver.run(time, self.is_paused, inputs)).map(|()| true)
            }
        };
        match &result {
            Ok(true) => self.failure = None,
            Ok(false) => {}
            Err(error) => self.failure = Some(error.clone()),
        }
        if self.failure.is_some() || self.seats().is_empty() {
            inputs.used();
        }
        result.map(drop)
    }

    fn run_singly(&mut self, ticks: u32, inputs: &mut Inputs<G>) -> Result<(), LockstepError> {
        for _ in 0..ticks {
            match &mut self.driver {
                Driver::Local(local) => local.step(inputs)?,
                Driver::SyncTest(test) => test.step(inputs)?,
                Driver::Replay(replay) => drop(replay.step()?),
                Driver::Match(_) => {}
            }
        }
        Ok(())
    }

    pub(crate) fn next_event(&mut self) -> Option<PeerEvent> {
        self.peer_mut().and_then(Peer::next_event)
    }

    /// Whether an error has stopped the game, or its match has ended. After an error, ticks are played again only if a
    /// replay seeks or a peer joins again.
    pub(crate) fn has_ended(&self) -> bool {
        self.failure.is_some() || matches!(&self.driver, Driver::Match(network) if network.has_ended())
    }

    pub(crate) const fn number(&self) -> u64 {
        self.number
    }

    pub(crate) fn observed(&self) -> &Observed<G> {
        self.driver.game()
    }

    pub(crate) fn fraction(&self) -> f32 {
        self.driver.fraction()
    }
}
