//! SipHash-2-4 (Aumasson and Bernstein), a keyed hash for handshake cookies and probe tokens.

#[cfg(test)]
mod tests;

#[derive(Clone, Copy)]
pub(super) struct Secret(pub(super) [u64; 2]);

impl core::fmt::Debug for Secret {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str("Secret")
    }
}

fn round(v: &mut [u64; 4]) {
    let [a, b, c, d] = v;
    *a = a.wrapping_add(*b);
    *b = b.rotate_left(13) ^ *a;
    *a = a.rotate_left(32);
    *c = c.wrapping_add(*d);
    *d = d.rotate_left(16) ^ *c;
    *a = a.wrapping_add(*d);
    *d = d.rotate_left(21) ^ *a;
    *c = c.wrapping_add(*b);
    *b = b.rotate_left(17) ^ *c;
    *c = c.rotate_left(32);
}

impl Secret {
    pub(super) fn hash(self, bytes: &[u8]) -> u64 {
        let [k0, k1] = self.0;
        let mut v = [
            k0 ^ 0x736f_6d65_7073_6575,
            k1 ^ 0x646f_7261_6e64_6f6d,
            k0 ^ 0x6c79_6765_6e65_7261,
            k1 ^ 0x7465_6462_7974_6573,
        ];
        let [length, ..] = bytes.len().to_le_bytes();
        let (words, rest) = bytes.as_chunks::<8>();
        let mut last = [0, 0, 0, 0, 0, 0, 0, length];
        last.iter_mut().zip(rest).for_each(|(place, &byte)| *place = byte);
        for word in words.iter().chain([&last]) {
            let word = u64::from_le_bytes(*word);
            v[3] ^= word;
            round(&mut v);
            round(&mut v);
            v[0] ^= word;
        }
        v[2] ^= 0xff;
        (0..4).for_each(|_| round(&mut v));
        v.into_iter().fold(0, |hash, word| hash ^ word)
    }
}
