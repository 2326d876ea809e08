use super::*;

/// Sends over a link of `rate` bytes per second, with a queue of 100 ms and a loss of `loss` percent. Returns the
/// bytes per second that arrive after the first ten seconds.
fn run(rate: u64, loss: u64) -> u64 {
    let (mut control, mut queued, mut arrived, mut random) = (Congestion::new(), 0_u64, 0, 1_u64);
    let mut lost = 0;
    for ms in 0..20_000_u64 {
        let passed = queued.min(rate / 1000);
        queued -= passed;
        arrived += if ms >= 10_000 { passed } else { 0 };
        control.measure(40_000 + queued * 1_000_000 / rate);
        while control.may_send(ms * 1000) {
            control.note_sent(1000, lost > 0);
            lost -= u32::from(lost > 0);
            random = random.wrapping_mul(0x5851_f42d_4c95_7f2d).wrapping_add(1);
            if (random >> 33) % 100 < loss || queued + 1000 > rate / 10 {
                lost += 1;
            } else {
                queued += 1000;
            }
        }
    }
    arrived / 10
}

#[test]
fn the_rate_is_that_of_the_link() {
    for rate in [500_000, 2_000_000, 10_000_000] {
        for loss in [0, 5] {
            let reached = run(rate, loss);
            assert!(reached > rate * 6 / 10 && reached <= rate, "{reached} of {rate}, {loss} % loss");
        }
    }
}
