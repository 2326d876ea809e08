use super::*;

#[test]
fn bytes_and_runs_are_swapped() {
    let found = byte_swaps(&[1, 2, 3, 4, 5, 6], &[1, 9, 8, 4, 5, 7]);
    let expected: [(Range<usize>, &[u8]); 4] = [(1..2, &[9]), (2..3, &[8]), (1..3, &[9, 8]), (5..6, &[7])];
    assert_eq!(found, expected.map(|(range, bytes)| (range, bytes.to_vec())));
    assert!(byte_swaps(&[1], &[1, 2]).is_empty());
}
