//! The [`Game`] trait. Recording, verification, rollback and the tools are generic over it.

mod game;
mod history;
mod input_log;
mod sandbox;

pub(crate) use game::world_of;
pub use game::{Game, RulesId, SetupError, StartError};
pub use history::{History, Past};
pub(crate) use input_log::decode_inputs;
pub use input_log::{EncodedInputs, InputError, InputLog};
pub use sandbox::{Sandbox, SandboxSave, SandboxSetup};
