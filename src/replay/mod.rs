//! Replay files: recording, reading and verifying.
