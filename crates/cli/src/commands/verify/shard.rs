//! [`Shard`]: one of several parts of the files, to split a verification between processes or machines.

use std::fmt;
use std::path::Path;
use std::str::FromStr;

/// One of `count` parts of the files, numbered from 1.
///
/// The part to which a file belongs depends only on a hash of the file's path (relative to the folder that is an argument
/// of the command), not on the other files. So if several processes list a changing folder at different times, exactly one of them
/// takes each file that all of them find. The parts differ in size: with about 1000 files per part, the standard
/// deviation is about 30 files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Shard {
    index: u32,
    count: u32,
}

impl Shard {
    pub(super) const WHOLE: Shard = Shard { index: 1, count: 1 };

    pub(super) fn takes(self, below: &Path) -> bool {
        part(below, self.count) == u64::from(self.index) - 1
    }
}

/// Number of the part of a path, from 0: the first eight bytes of the path's BLAKE3 hash, as a little-endian number,
/// modulo `count`. The hashed text has `/` between the components of the path on every system.
fn part(below: &Path, count: u32) -> u64 {
    let mut hasher = blake3::Hasher::new();
    for (position, component) in below.components().enumerate() {
        if position > 0 {
            hasher.update(b"/");
        }
        hasher.update(component.as_os_str().as_encoded_bytes());
    }
    let [a, b, c, d, e, f, g, h, ..] = *hasher.finalize().as_bytes();
    u64::from_le_bytes([a, b, c, d, e, f, g, h]) % u64::from(count)
}

impl FromStr for Shard {
    type Err = &'static str;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let numbers = text.split_once('/').and_then(|(index, count)| {
            let digits = |text: &str| text.bytes().all(|byte| byte.is_ascii_digit());
            let number = |text: &str| text.parse().ok().filter(|_| digits(text));
            Some(Shard { index: number(index)?, count: number(count)? })
        });
        let shard =
            numbers.ok_or("expected the number of the part, a slash and the number of parts, such as 2/5")?;
        if (1..=shard.count).contains(&shard.index) {
            Ok(shard)
        } else {
            Err("parts are numbered from 1 to the number of parts")
        }
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.index, self.count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_path_is_in_one_part_and_parts_are_alike() {
        for count in (1..=20).chain([97, 256, 1000]) {
            let shards = (1..=count).map(|index| Shard { index, count });
            let mut files = vec![0u32; 1000];
            for number in 0..2000 {
                let path = format!("{}/match {number}.replay", number % 13);
                let takers: Vec<Shard> =
                    shards.clone().filter(|shard| shard.takes(Path::new(&path))).collect();
                assert_eq!(takers.len(), 1, "{path} of {count}");
                files[takers[0].index as usize - 1] += 1;
            }
            // Each part has the expected number of files, within ten standard deviations.
            let (fair, spread) = (2000 / count, 10 * (2000 / count).isqrt().max(1));
            let parts = &files[..count as usize];
            assert!(parts.iter().all(|files| files.abs_diff(fair) <= spread), "{count}: {parts:?}");
        }
    }

    #[test]
    fn the_rule_is_the_one_that_is_documented() {
        assert_eq!(part(Path::new("a/b.replay"), u32::MAX), part(Path::new("a//b.replay"), u32::MAX));
        // `printf a/b.replay | b3sum` prints this hash.
        let hash = blake3::hash(b"a/b.replay");
        let first = hash.to_hex().as_str()[..16].to_string();
        let number = u64::from_str_radix(&first, 16).unwrap().swap_bytes();
        assert_eq!(part(Path::new("a/b.replay"), 1000), number % 1000);
    }

    #[test]
    fn parts_are_numbered_from_one() {
        assert_eq!("2/5".parse(), Ok(Shard { index: 2, count: 5 }));
        assert_eq!("1/1".parse(), Ok(Shard::WHOLE));
        for wrong in
            ["0/5", "6/5", "1/0", "0/0", "5", "/5", "5/", "+1/5", "1/5/6", "1 / 5", "-1/5", "1/99999999999"]
        {
            assert!(wrong.parse::<Shard>().is_err(), "{wrong}");
        }
        assert_eq!(Shard { index: 2, count: 5 }.to_string(), "2/5");
    }
}
