//! lab main
mod game;
mod sim;
mod storm;
#[test]
fn short() {
    for seed in 0..200 {
        let (failure, _) = storm::play(seed, None);
        assert_eq!(failure, None, "seed {seed}");
    }
}
