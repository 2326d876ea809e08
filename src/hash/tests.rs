use alloc::vec::Vec;

use super::*;

#[test]
fn it_is_shown_in_32_digits() {
    assert_eq!(alloc::format!("{}", StateHash(0xab)), "000000000000000000000000000000ab");
}

/// The expected values come from the reference implementation in C, xxHash 0.8.
#[test]
fn digests_of_all_lengths_are_those_of_the_reference() {
    let byte = |i: u32| u8::try_from((i * i + 7 * i + 13 * (i >> 8)) & 0xff).expect("masked");
    let bytes: Vec<u8> = (0..4096).map(byte).collect();
    // The lengths include those at which the algorithm changes. They end at many positions within the stripes and
    // blocks of XXH3.
    let lengths = (0..600).chain((600..4096).step_by(61));
    let all = StateHash::of_digests(lengths.map(|length| StateHash::of_bytes(&bytes[..length])));
    assert_eq!(all, StateHash(0x895a_7f64_9a6f_6e88_c604_0708_9b0a_5435));
    let known = [
        (0, 0x99aa_06d3_0147_98d8_6001_c324_468d_497f),
        (240, 0x7900_2818_6011_dfbd_c75f_5f21_7aea_b9c9),
        (241, 0x644d_48e8_ee0b_f9bb_2d68_73b1_28d3_f478),
        (4095, 0x92af_cdf9_4a3a_b5bc_921c_22ab_aeaa_06c5),
    ];
    for (length, digest) in known {
        assert_eq!(StateHash::of_bytes(&bytes[..length]), StateHash(digest), "{length} bytes");
    }
}
