//! The replay of a match that has not ended.

use lockstep2d::lockstep::Game;
use lockstep2d::peer::PeerOptions;
use lockstep2d::replay::{Limits, Verdict, verify};

use super::{Pushers, Table, modes};

/// The game is often ahead of the last final tick, also in lockstep. The replay must have all ticks up to the last
/// final one and no more, although `Table::play` takes the finished bytes of the replay after every update.
#[test]
fn a_replay_so_far_ends_at_the_last_final_tick() {
    for options in modes() {
        let options = PeerOptions { start_with: 2, ..options };
        let mut table = Table::new(30, 0);
        table.host(options);
        table.join(options, 0);
        assert_eq!(table.peer(1).replay_so_far(), Ok(vec![]), "the initial state has not arrived");
        let mut later = vec![];
        for _ in 0..40 {
            table.play(77);
            for at in 0..2 {
                let peer = table.peer(at);
                let (tick, hash, confirmed) = (peer.tick(), peer.game().state_hash(), peer.confirmed());
                let file = peer.replay_so_far().expect("valid");
                assert_eq!((peer.tick(), peer.game().state_hash()), (tick, hash));
                if confirmed > 0 {
                    let verdict = verify::<Pushers>(&file, &Limits::default());
                    let Verdict::Match { ticks, .. } = verdict else { panic!("{verdict}") };
                    assert_eq!(ticks, confirmed);
                    later.push(tick - confirmed);
                }
            }
        }
        assert!(later.iter().any(|&ticks| ticks > 0), "{later:?}");
        let replays = table.end();
        assert_eq!(replays[0], replays[1]);
        assert!(verify::<Pushers>(&replays[0], &Limits::default()).is_match());
    }
}
