//! The command-line tools as a library: a game gets them for its own rules in one line of `main`.
