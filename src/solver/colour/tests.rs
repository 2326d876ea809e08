use super::*;
use crate::math::Rng;

fn check_sizes(group: &Group<'_>, nodes: &[Node], cold: bool) {
    for (place, node) in group.indices.iter().map(|&i| nodes[i as usize]).enumerate() {
        let size = if place < group.large { Size::Large } else { Size::Small };
        assert_eq!((node.size, node.cold), (size, cold));
    }
}

fn check_bodies(indices: &[u32], nodes: &[Node]) {
    let mut bodies = std::collections::BTreeSet::new();
    for node in indices.iter().map(|&i| nodes[i as usize]) {
        for body in node.bodies.into_iter().filter(|&body| body != GROUND) {
            assert!(bodies.insert(body), "body {body} twice in a colour");
        }
    }
}

#[test]
fn a_batch_has_two_sizes_only_if_all_of_its_constraints_mix() {
    let indices: Vec<u32> = (0..21).collect();
    let lens = |large: usize, mixes: &dyn Fn(u32) -> bool| -> Vec<usize> {
        let batches: Vec<&[u32]> = Group { indices: &indices, large }.batches::<8>(mixes).collect();
        assert_eq!(batches.concat(), indices);
        batches.iter().map(|batch| batch.len()).collect()
    };
    assert_eq!(lens(10, &|_| true), [8, 8, 5]);
    assert_eq!(lens(10, &|_| false), [8, 2, 8, 3]);
    assert_eq!(lens(10, &|index| index != 9), [8, 2, 8, 3]);
    assert_eq!(lens(10, &|index| index != 15), [8, 2, 8, 3]);
    assert_eq!(lens(10, &|index| index != 16), [8, 8, 5]);
    assert_eq!(lens(8, &|_| true), [8, 8, 5]);
    assert_eq!(lens(0, &|_| false), [8, 8, 5]);
    assert_eq!(lens(21, &|_| false), [8, 8, 5]);
    assert_eq!(lens(19, &|_| true), [8, 8, 5]);
    assert_eq!(lens(19, &|_| false), [8, 8, 3, 2]);
}

#[test]
fn no_colour_holds_a_body_twice_and_nothing_is_lost() {
    let mut rng = Rng::new(11);
    for (bodies, parts) in [(2u32, 1), (10, 1), (300, 1), (2, 3), (10, 2), (300, 5)] {
        // Body 1 is a hub, so that some constraints are in the overflow.
        let nodes: Vec<Node> = (0..400)
            .map(|key| {
                let a = if key % 3 == 0 { 0 } else { rng.below(bodies) };
                let b = (a + 1 + rng.below(bodies - 1)) % bodies;
                let fixed = key % 7 == 0;
                let size = if key % 2 == 0 { Size::Large } else { Size::Small };
                Node::new(key, [a + 1, if fixed { GROUND } else { b + 1 }], size)
            })
            .collect();
        let mut colouring = Colouring::default();
        nodes.iter().for_each(|&node| colouring.add(node));
        colouring.set_cold(|[a, _]| a % 5 < 2);
        let nodes = colouring.nodes.clone();
        colouring.sort(bodies as usize + 1, parts);
        let mut seen = colouring.order.clone();
        seen.sort_unstable();
        assert!(seen.iter().copied().eq(0..400));
        let mut solved = colouring.overflow(false).to_vec();
        assert!(solved.iter().all(|&i| colouring.places[i as usize] == 0));
        for cold in [false, true] {
            let colours = (0..parts).map(|part| colouring.colours(cold, part).collect::<Vec<_>>());
            let colours: Vec<_> = colours.collect();
            if cold {
                solved.extend_from_slice(colouring.overflow(cold));
            }
            for colour in 0..colours[0].len() {
                let mut all = Vec::new();
                for part in &colours {
                    check_sizes(&part[colour], &nodes, cold);
                    all.extend_from_slice(part[colour].indices);
                }
                solved.extend_from_slice(&all);
                check_bodies(&all, &nodes);
            }
        }
        assert_eq!(solved, colouring.order, "the groups follow the order");
        assert!(
            colouring.places.iter().any(|place| place % PLACES == 0),
            "the hub has more constraints than there are colours"
        );
    }
}
