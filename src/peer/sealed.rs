//! [`Sealed`]: a transport that encrypts and authenticates packets with the key of a match.
//!
//! A packet has a sender (8 bytes), a counter (8 bytes), the ciphertext and a tag (16 bytes). The cipher is
//! XChaCha20-Poly1305. Its nonce consists of the sender, eight zero bytes and the counter. A packet of 1200 bytes
//! becomes 1232 and fits with headers into 1280, the smallest maximum packet size of IPv6.
//!
//! **A nonce must never be used twice with one key.** Within one [`Sealed`], the counter prevents this. Between several
//! [`Sealed`], such as before and after a restart, the sender number prevents it: `Sealed::new` draws the sender from
//! 2^64 numbers. Two of `n` senders are equal with a probability of about `n^2 / 2^65`: for 10 000 senders, 3 in 10^12.

use alloc::vec::Vec;
use core::fmt;

use chacha20poly1305::aead::{AeadInPlace, KeyInit};
use chacha20poly1305::{Key, Tag, XChaCha20Poly1305, XNonce};

use super::transport::Transport;
use crate::session::Address;

/// Bytes that sealing adds to a packet.
pub const SEALED_OVERHEAD: usize = HEADER + TAG;
const HEADER: usize = 16;
const TAG: usize = 16;
const WINDOW_WORDS: usize = 32;
/// Length of a replay window. A packet is dropped if its counter is at least this number below the newest counter of
/// its sender.
const WINDOW: u64 = 2048;
/// Maximum number of senders with a replay window. For a further sender, the window of the sender that has been silent
/// longest is removed.
const SENDERS_MAX: usize = 1024;
/// Maximum number of packets that one call of [`Transport::receive`] rejects, so that forged packets cannot keep a peer
/// from its other work.
const REJECTED_MAX: usize = 1024;

/// A transport whose packets can be read and written only with the key of the match.
///
/// Drops packets that were forged, changed or truncated, that arrive a second time, or that come back to their sender.
/// The addresses and sizes of packets are visible. A member of the match can pose as another member. Old packets are
/// accepted again after a restart, and from senders whose replay window was removed. Old packets do no harm to a
/// session, because its status records have versions.
///
/// ```
/// use lockstep2d::peer::{LinkConditions, Network, Sealed, Transport};
///
/// let network = Network::new(LinkConditions::default(), 1);
/// // The lobby gives all members of a match the same random key.
/// let key = [7; 32];
/// let mut alice = Sealed::new(network.port(1), key);
/// let mut bob = Sealed::new(network.port(2), key);
/// alice.send(b"hello", &Network::address(2));
/// assert_eq!(bob.receive(), Some((Network::address(1), b"hello".to_vec())));
/// ```
pub struct Sealed<T> {
    inner: T,
    cipher: XChaCha20Poly1305,
    sender: u64,
    sent: u64,
    windows: Vec<Window>,
    /// Number of packets received: the clock of [`Window::heard`].
    received: u64,
}

/// Replay window of a sender.
#[derive(Clone, Debug)]
struct Window {
    sender: u64,
    /// Counter of the newest packet, plus 1.
    next: u64,
    /// Bit for each of the last [`WINDOW`] counters, at the counter modulo `WINDOW`.
    seen: [u64; WINDOW_WORDS],
    heard: u64,
}

impl<T: fmt::Debug> fmt::Debug for Sealed<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Sealed").field("inner", &self.inner).finish_non_exhaustive()
    }
}

impl Window {
    const fn new(sender: u64) -> Self {
        Window { sender, next: 0, seen: [0; WINDOW_WORDS], heard: 0 }
    }

    fn bit(counter: u64) -> (usize, u64) {
        let place = counter % WINDOW;
        (usize::try_from(place / 64).unwrap_or(0), 1 << (place % 64))
    }

    /// Whether the packet with this counter has not arrived yet. Packets older than the window count as arrived.
    fn is_new(&self, counter: u64) -> bool {
        if counter >= self.next {
            // `next` would overflow after the largest `u64`, which `Sealed` never sends.
            return counter < u64::MAX;
        }
        let (word, bit) = Window::bit(counter);
        self.next - counter <= WINDOW && self.seen.get(word).is_some_and(|seen| seen & bit == 0)
    }

    fn note(&mut self, counter: u64) {
        if counter >= self.next {
            if counter - self.next >= WINDOW {
                self.seen = [0; WINDOW_WORDS];
            } else {
                // The skipped counters have not arrived.
                for skipped in self.next..counter {
                    let (word, bit) = Window::bit(skipped);
                    self.seen.get_mut(word).into_iter().for_each(|seen| *seen &= !bit);
                }
            }
            self.next = counter.saturating_add(1);
        }
        let (word, bit) = Window::bit(counter);
        self.seen.get_mut(word).into_iter().for_each(|seen| *seen |= bit);
    }
}

fn nonce(sender: u64, counter: u64) -> XNonce {
    let mut nonce = [0; 24];
    for (to, from) in nonce.iter_mut().zip(sender.to_le_bytes().into_iter().chain([0; 8])) {
        *to = from;
    }
    for (to, from) in nonce.iter_mut().skip(16).zip(counter.to_le_bytes()) {
        *to = from;
    }
    nonce.into()
}

impl<T> Sealed<T> {
    /// Seals the packets of a transport. The key must be random, shared by all members, and new for each match.
    #[cfg(all(feature = "std", not(all(target_family = "wasm", target_os = "unknown"))))]
    pub fn new(inner: T, key: [u8; 32]) -> Self {
        let [sender] = super::options::random_numbers();
        Sealed::with_sender(inner, key, sender)
    }

    /// Like [`Sealed::new`] with a given sender number, which must be random and new for each call with this key.
    pub fn with_sender(inner: T, key: [u8; 32], sender: u64) -> Self {
        let cipher = XChaCha20Poly1305::new(&Key::from(key));
        Sealed { inner, cipher, sender, sent: 0, windows: Vec::new(), received: 0 }
    }

    /// The wrapped transport.
    pub const fn inner_mut(&mut self) -> &mut T {
        &mut self.inner
    }

    fn seal(&mut self, packet: &[u8]) -> Option<Vec<u8>> {
        let counter = self.sent;
        // After 2^64 - 1 packets nothing more is sent.
        self.sent = counter.checked_add(1)?;
        let mut bytes = Vec::with_capacity(packet.len() + SEALED_OVERHEAD);
        bytes.extend_from_slice(&self.sender.to_le_bytes());
        bytes.extend_from_slice(&counter.to_le_bytes());
        bytes.extend_from_slice(packet);
        let body = bytes.get_mut(HEADER..)?;
        let tag = self.cipher.encrypt_in_place_detached(&nonce(self.sender, counter), b"", body).ok()?;
        bytes.extend_from_slice(&tag);
        Some(bytes)
    }

    fn open(&mut self, bytes: &[u8]) -> Option<Vec<u8>> {
        let (sender, rest) = bytes.split_first_chunk::<8>()?;
        let (counter, rest) = rest.split_first_chunk::<8>()?;
        let (body, tag) = rest.split_last_chunk::<TAG>()?;
        let (sender, counter) = (u64::from_le_bytes(*sender), u64::from_le_bytes(*counter));
        let known = self.windows.iter().position(|window| window.sender == sender);
        let is_new = known.and_then(|at| self.windows.get(at)).is_none_or(|window| window.is_new(counter));
        if sender == self.sender || !is_new {
            return None;
        }
        let mut body = body.to_vec();
        let tag = Tag::from(*tag);
        self.cipher.decrypt_in_place_detached(&nonce(sender, counter), b"", &mut body, &tag).ok()?;
        // Only authentic packets get here, so forged packets cannot change the windows.
        self.received += 1;
        let at = known.unwrap_or_else(|| self.remember(sender));
        let window = self.windows.get_mut(at)?;
        window.heard = self.received;
        window.note(counter);
        Some(body)
    }

    fn remember(&mut self, sender: u64) -> usize {
        if self.windows.len() >= SENDERS_MAX {
            let silent = (0..).zip(&self.windows).min_by_key(|(_, window)| window.heard);
            if let Some((at, _)) = silent {
                self.windows.swap_remove(at);
            }
        }
        self.windows.push(Window::new(sender));
        self.windows.len() - 1
    }
}

impl<T: Transport> Transport for Sealed<T> {
    fn send(&mut self, packet: &[u8], to: &Address) {
        if let Some(sealed) = self.seal(packet) {
            self.inner.send(&sealed, to);
        }
    }

    fn receive(&mut self) -> Option<(Address, Vec<u8>)> {
        for _ in 0..REJECTED_MAX {
            let (from, bytes) = self.inner.receive()?;
            if let Some(packet) = self.open(&bytes) {
                return Some((from, packet));
            }
        }
        None
    }
}

#[cfg(all(test, feature = "std"))]
mod tests;
