//! The input type that GGRS carries: the game's input, and in lockstep a state hash.

use core::fmt::Debug;
use core::hash::Hash;
use core::marker::PhantomData;

use serde::{Deserialize, Serialize, de::DeserializeOwned};

use crate::hash::StateHash;
use crate::lockstep::Game;

/// A game that can be played over a network: its inputs are small and plain, as GGRS requires.
pub trait NetGame: Game<Input: Copy + Send + Sync> + Send + 'static {}

impl<G: Game<Input: Copy + Send + Sync> + Send + 'static> NetGame for G {}

/// Address of a peer: a socket address, or whatever the transport uses.
pub trait Address: Clone + Ord + Hash + Debug + Serialize + DeserializeOwned + Send + Sync + 'static {}

impl<A> Address for A where
    A: Clone + Ord + Hash + Debug + Serialize + DeserializeOwned + Send + Sync + 'static
{
}

/// A checksum report: the state hash that a peer had after a tick.
///
/// Without prediction GGRS never requests a save, and so never compares checksums. In lockstep every input carries the
/// hash of a recent tick instead; as all peers receive all inputs, all of them can find the diverged peer. With
/// prediction the inputs carry no hash: it would change in each tick, and no prediction of an input would be right.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct ChecksumReport {
    /// Number of ticks played; 0 if there is no hash.
    pub tick: u64,
    /// Hash after these ticks.
    pub hash: StateHash,
}

/// A player's input for one tick, as sent by GGRS.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Wire<I> {
    /// The input of the game.
    pub input: I,
    /// In lockstep, the sender's hash of a recent tick.
    pub checksum: ChecksumReport,
}

/// The types of a GGRS session that plays `G` between peers with addresses `A`.
///
/// GGRS keeps no states, because [`Driver`](super::Driver) does: its cells hold checksums only.
pub struct GgrsConfig<G, A>(PhantomData<fn() -> (G, A)>);

impl<G: NetGame, A: Address> ggrs::Config for GgrsConfig<G, A> {
    type Input = Wire<G::Input>;
    type InputPredictor = ggrs::PredictRepeatLast;
    type State = ();
    type Address = A;
}
