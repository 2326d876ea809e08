use super::*;

const MS: Duration = Duration::from_millis(1);

/// Sends 1000 numbered packets, one per millisecond. Returns number and delay of the arrivals.
fn run(conditions: LinkConditions, seed: u64) -> Vec<(u32, u32)> {
    let network = Network::new(conditions, seed);
    let (mut a, mut b) = (network.port(1), network.port(2));
    let mut seen = Vec::new();
    for ms in 0..2000_u32 {
        network.set_time(MS * ms);
        if ms < 1000 {
            a.send(&ms.to_le_bytes(), &b.address());
        }
        while let Some((from, bytes)) = b.receive() {
            assert_eq!(from, a.address());
            let number = u32::from_le_bytes(bytes.try_into().unwrap());
            seen.push((number, ms - number));
        }
    }
    seen
}

#[test]
fn conditions_do_what_they_say() {
    let latency = LinkConditions::latency(30 * MS);
    assert!(run(latency, 1).into_iter().eq((0..1000).map(|number| (number, 30))));
    let seen = run(LinkConditions { jitter: 10 * MS, ..latency }, 1);
    assert!(seen.iter().all(|(_, delay)| (30..=40).contains(delay)) && seen.is_sorted());
    assert_eq!(seen.len(), 1000);
    let lost = 1000 - run(LinkConditions { loss: 10, ..latency }, 1).len();
    assert!((60..140).contains(&lost), "{lost}");
    let seen = run(LinkConditions { duplication: 10, ..latency }, 1);
    assert!((1060..1140).contains(&seen.len()), "{}", seen.len());
    let seen = run(LinkConditions { reordering: 10, ..latency }, 1);
    let late = seen.iter().filter(|(_, delay)| *delay == 50).count();
    assert!((60..140).contains(&late) && !seen.is_sorted(), "{late}");
}

#[test]
fn a_seed_gives_one_network() {
    let all = LinkConditions { latency: MS, jitter: 9 * MS, loss: 20, duplication: 20, reordering: 20 };
    assert_eq!(run(all, 5), run(all, 5));
    assert_ne!(run(all, 5), run(all, 6));
}

#[test]
fn links_are_cut_one_way_and_have_their_own_conditions() {
    let network = Network::new(LinkConditions::default(), 1);
    let (mut a, mut b) = (network.port(1), network.port(2));
    network.cut(1, 2);
    a.send(b"lost", &b.address());
    b.send(b"back", &a.address());
    assert_eq!((b.receive(), a.receive()), (None, Some((b.address(), b"back".to_vec()))));
    network.mend();
    network.set_link(1, 2, LinkConditions::latency(5 * MS));
    a.send(b"late", &b.address());
    assert_eq!(b.receive(), None);
    network.set_time(5 * MS);
    assert_eq!(b.receive(), Some((a.address(), b"late".to_vec())));
}
