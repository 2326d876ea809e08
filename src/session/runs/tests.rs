use super::*;

fn round_trip(inputs: &[u8], size: usize) -> usize {
    let mut bytes = Vec::new();
    encode(inputs, size, &mut bytes);
    let mut decoded = alloc::vec![9];
    let mut reader = Reader::new(&bytes);
    decode(&mut reader, inputs.len(), size, &mut decoded).unwrap();
    assert_eq!((&decoded[1..], reader.is_empty()), (inputs, true));
    bytes.len()
}

#[test]
fn inputs_survive_and_held_ones_take_few_bytes() {
    assert_eq!(round_trip(&[], 1), 0);
    assert_eq!(round_trip(&[7; 30], 1), 3);
    assert_eq!(round_trip(&[0; 64], 2), 2);
    assert_eq!(round_trip(&[1, 2, 1, 2, 1, 3, 1, 3], 2), 3 + 1 + 2 + 1);
    let mut noise = 1_u32;
    let noise: Vec<u8> = (0..500)
        .map(|_| {
            noise = noise.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            if noise >> 30 == 0 { noise.to_le_bytes()[2] } else { 0 }
        })
        .collect();
    for size in [1, 2, 5, 64] {
        for length in 0..noise.len() / size {
            assert!(round_trip(&noise[..length * size], size) <= length * size + 4);
        }
    }
}

#[test]
fn a_run_beyond_the_end_or_of_nothing_is_refused() {
    for bytes in [&[2 * 5 + 1][..], &[2 * 5, 1, 2, 3, 4, 5], &[0], &[1], &[2 * 4, 1, 2]] {
        assert_eq!(decode(&mut Reader::new(bytes), 4, 1, &mut Vec::new()), Err(Malformed), "{bytes:?}");
    }
}
