//! Time limits and times at the ends of their ranges.

use lockstep2d::session::{Config, Role, Timing};

use super::net::{Net, address};
use super::sim::{MS, S};

#[test]
fn a_time_limit_above_a_day_is_refused() {
    type Change = fn(&mut Timing);
    let fields: [(&str, Change); 7] = [
        ("timing.heard", |timing| timing.heard = u64::MAX),
        ("timing.fresh", |timing| timing.fresh = u64::MAX),
        ("timing.promises", |timing| timing.promises = u64::MAX),
        ("timing.ballot", |timing| timing.ballot = u64::MAX),
        ("timing.linger", |timing| timing.linger = u64::MAX),
        ("timing.linger_max", |timing| timing.linger_max = u64::MAX),
        ("timing.step_max", |timing| timing.step_max = u64::MAX),
    ];
    for (field, change) in fields {
        let mut config = Config::new(0, 2);
        change(&mut config.timing);
        assert_eq!(config.validate().map_err(|error| (error.field, error.max)), Err((field, 86_400 * S)));
    }
    let timing = Timing { patience: u64::MAX, ..Timing::DEFAULT };
    assert_eq!(Config { timing, ..Config::new(0, 2) }.validate(), Ok(()));
}

/// A host, a player and a guest that joins get the largest time with every call.
#[test]
fn the_largest_time_overflows_nothing() {
    let mut net = Net::new(10 * MS, 0, 50_000);
    net.host();
    net.join(Role::Player { seats: 1 }, 1);
    net.run(3 * S);
    net.join(Role::Spectator, 1);
    net.now = u64::MAX;
    for _ in 0..50 {
        for index in 0..3 {
            net.step(index);
            while let Some((to, bytes)) = net.nodes[index].endpoint.next_packet() {
                let receiver = &mut net.nodes[usize::from(to.bytes()[3]) - 1].endpoint;
                receiver.receive(u64::MAX, address(index as u8 + 1), &bytes);
            }
        }
    }
    assert!(net.nodes[0].tick > 60);
}
