//! A process that is started again gets packets that other peers still send to its predecessor at the same address.

use lockstep2d::session::{Endpoint, Identity, Role};

use super::net::{Net, address, config, identity};
use super::sim::{MS, S, id, key};

/// The clock of the second process is 2.5 s ahead of the clock of the first one, so that the echo of a packet to the
/// first process would look like a round trip of 2.5 s.
#[test]
fn a_restarted_process_ignores_packets_to_its_predecessor() {
    let mut net = Net::new(20 * MS, 0, 1000);
    net.host();
    net.join(Role::Player { seats: 1 }, 1);
    net.run(2 * S);
    net.join(Role::Player { seats: 1 }, 1);
    net.run(20 * S);
    net.assert_all_play();
    net.nodes[1].on = false;
    let again = Identity { key: key(1), ..identity(5) };
    let again = Endpoint::join(config(), again, Role::Player { seats: 1 }, address(1)).expect("valid");
    let again = net.add(again);
    (net.nodes[again].address, net.nodes[again].origin) = (2, 2500 * MS);
    let mut delay = 0;
    while net.now < 24 * S {
        net.run(net.now + 10 * MS);
        let session = net.nodes[again].endpoint.session();
        delay = delay.max(session.map_or(0, |session| session.delay()));
        for other in [0, 2] {
            let trip = session.and_then(|session| session.link(id(other))).map_or(0, |link| link.round_trip);
            assert!(trip < 80 * MS, "a round trip of {trip} us");
        }
    }
    net.assert_all_play();
    assert_eq!(net.nodes[again].endpoint.session().map(|session| session.seats()), Some(0b10));
    assert!(delay < 8, "{delay} ticks");
    for other in [0, 2] {
        let sessions = [(again, other, id(other)), (other, again, id(5))];
        for (of, to, peer) in sessions {
            let link =
                net.nodes[of].endpoint.session().and_then(|session| session.link(peer)).expect("known");
            assert!(link.loss_per_mille < 50, "{of} to {to}: {link:?}");
            assert!((30 * MS..80 * MS).contains(&link.round_trip), "{of} to {to}: {link:?}");
        }
    }
}
