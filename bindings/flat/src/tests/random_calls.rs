//! Random calls cause no internal error, and repeating a sequence of calls gives equal codes and worlds.

use lockstep2d::math::Rng;

use crate::fuzzing::run;

#[test]
fn every_sequence_of_calls_returns_codes() {
    let seeds = std::env::var("SEEDS").ok().and_then(|seeds| seeds.parse().ok()).unwrap_or(200);
    let (mut worlds, mut good) = (0, [0; 2]);
    for seed in 0..seeds {
        let mut rng = Rng::new(seed);
        let bytes: Vec<u8> = (0..20_000).map(|_| rng.next_u32().to_le_bytes()[0]).collect();
        let (codes, hashes) = run(&bytes);
        worlds += hashes.len();
        codes.iter().for_each(|&code| good[usize::from(code <= 1)] += 1);
        if seed % 10 == 0 {
            assert!((codes, hashes) == run(&bytes), "seed {seed}: the same calls give other results");
        }
    }
    println!("{worlds} worlds, {} calls that failed, {} that did not", good[0], good[1]);
    assert!(worlds > 100 && good[0] > 10_000 && good[1] > 10_000, "{worlds} worlds, {good:?} calls");
}
