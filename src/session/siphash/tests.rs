use super::*;

/// Test vectors of the paper and of its reference implementation.
#[test]
fn it_is_siphash_2_4() {
    let secret = Secret([0x0706_0504_0302_0100, 0x0f0e_0d0c_0b0a_0908]);
    let bytes: alloc::vec::Vec<u8> = (0..15).collect();
    assert_eq!(secret.hash(&bytes), 0xa129_ca61_49be_45e5);
    assert_eq!(secret.hash(&[]), 0x726f_db47_dd0e_0e31);
}
