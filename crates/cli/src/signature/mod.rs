//! Ed25519 signatures of games, with which key owners vouch for a replay.
//!
//! A signature covers the [`GameDigest`]: one combination of engine semantics, rules, setup and inputs. FORMAT.md gives
//! the layout of the files. VERIFYING.md lists what a signature does not prove.
//!
//! A server checks the signatures of an upload:
//!
//! ```
//! use lockstep2d::lockstep::Sandbox;
//! use lockstep2d::replay::{Limits, Recording};
//! use lockstep2d_cli::signature::{AllowedKeys, GameDigest, SecretKey, Signatures};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! // The player signs the replay of a game.
//! let replay = Recording::<Sandbox>::start(&Default::default(), 60)?.finish()?;
//! let secret = SecretKey::generate()?;
//! let mut signatures = Signatures::default();
//! let digest = GameDigest::of_replay::<Sandbox>(&replay, &Limits::default());
//! signatures.add(secret.sign(&digest.map_err(|verdict| verdict.to_string())?))?;
//! let upload = (replay, signatures.to_string());
//!
//! // The server knows the public key of the player, and checks the signature.
//! let keys: AllowedKeys = format!("{} alice\n", secret.public_key()).parse()?;
//! let digest = GameDigest::of_replay::<Sandbox>(&upload.0, &Limits::default());
//! let check = keys.check(&upload.1.parse()?, &digest.map_err(|verdict| verdict.to_string())?);
//! assert_eq!((check.signed_by, check.forged), (vec!["alice".to_string()], vec![]));
//! # Ok(())
//! # }
//! ```
//!
//! The server still has to verify the replay: anyone can sign a replay that does not match.

mod allowed_keys;
mod hex;
mod key;
mod line_error;
mod signatures;

pub use crate::identity::GameDigest;
pub(crate) use allowed_keys::is_name;
pub use allowed_keys::{AllowedKeys, Check};
pub use key::{PublicKey, RandomError, SecretKey};
pub use line_error::{Flaw, LineError};
pub use signatures::{FILE_BYTES_MAX, SIGNATURES_MAX, Signature, Signatures, path_beside};
