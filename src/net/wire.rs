//! What GGRS carries for this engine: inputs, and in lockstep a hash of the past beside them.

use core::fmt::Debug;
use core::hash::Hash;
use core::marker::PhantomData;

use serde::{Deserialize, Serialize, de::DeserializeOwned};

use crate::hash::StateHash;
use crate::lockstep::Game;

/// A game that can be played over a network: its inputs are small and plain, as GGRS wants them.
pub trait NetGame: Game<Input: Copy + Send + Sync> + Send + 'static {}

impl<G: Game<Input: Copy + Send + Sync> + Send + 'static> NetGame for G {}

/// How a peer is found: a socket address, or whatever the transport uses.
pub trait Address: Clone + Ord + Hash + Debug + Serialize + DeserializeOwned + Send + Sync + 'static {}

impl<A> Address for A where
    A: Clone + Ord + Hash + Debug + Serialize + DeserializeOwned + Send + Sync + 'static
{
}

/// The state hash that a peer had after some tick.
///
/// Without prediction GGRS never asks for a save, and so never compares checksums. In lockstep every input carries the
/// hash of a recent tick instead; as all peers see all inputs, all see who is alone. With prediction the inputs carry
/// none: it would be another one in each tick, and no prediction would ever be right.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Echo {
    /// How many ticks had been played; 0 if there is no hash.
    pub tick: u64,
    /// The hash after them.
    pub hash: StateHash,
}

/// A player's input of one tick, as GGRS sends it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Wire<I> {
    /// What the game gets.
    pub input: I,
    /// In lockstep, the sender's hash of a recent tick.
    pub echo: Echo,
}

/// The types of a GGRS session that plays `G` between peers with addresses `A`.
///
/// GGRS keeps no states ([`Driver`](super::Driver) does): its cells hold checksums only.
pub struct GgrsConfig<G, A>(PhantomData<fn() -> (G, A)>);

impl<G: NetGame, A: Address> ggrs::Config for GgrsConfig<G, A> {
    type Input = Wire<G::Input>;
    type InputPredictor = ggrs::PredictRepeatLast;
    type State = ();
    type Address = A;
}
