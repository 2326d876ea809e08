//! A game remembers a key press, and passes it to `advance` until `advance` returns that an input was issued. Each
//! press then counts for exactly one tick.

use std::time::Duration;

use lockstep2d::peer::PeerOptions;
use lockstep2d::replay::{Limits, RawReplay};

use super::{Pushers, Table, modes};

const PRESS: u8 = 16;

/// The input delay jumps when the third peer gets a seat, and when the latencies of its links are measured. With
/// rollback, the delay is above 0 from the start.
#[test]
fn a_press_counts_for_one_tick() {
    for options in modes() {
        let mut table = Table::new(90, 0);
        table.host(PeerOptions { start_with: 2, ..options });
        table.join(options, 0);
        let mut presses = [0u32; 3];
        for step in 0..8000 {
            if step == 3000 {
                table.join(options, 0);
            }
            let now = table.network.time() + Duration::from_millis(1);
            table.network.set_time(now);
            for (at, presses) in presses.iter_mut().enumerate().take(table.peers.len()) {
                let peer = table.peer(at);
                peer.update(now).expect("valid");
                // Each update has a press, except in the last second, whose inputs may not be final at the end.
                let mut pressed = step < 7000;
                while peer.is_due() {
                    let inputs = vec![if pressed { PRESS } else { 0 }; peer.seats().len()];
                    if peer.advance(&inputs).expect("valid") {
                        *presses += u32::from(pressed);
                        pressed = false;
                    }
                }
                while peer.next_event().is_some() {}
            }
        }
        assert!(table.peer(2).session().expect("valid").delay() > 0);
        let replay = table.peers[0].take().expect("valid").finish().expect("valid").replay;
        let mut raw = RawReplay::<Pushers>::open(&replay, &Limits::default()).expect("valid");
        let mut counted = [0u32; 3];
        while raw.tick() < raw.ticks() {
            raw.step().expect("valid");
            for (counted, input) in counted.iter_mut().zip(raw.inputs()) {
                *counted += u32::from(*input == PRESS);
            }
        }
        assert_eq!(presses, counted);
        assert!(presses.iter().all(|presses| *presses > 100));
    }
}
