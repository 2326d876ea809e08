use super::*;

fn all(bytes: &[u8]) -> Result<Vec<(u32, Vec<u8>)>, ReadError> {
    let mut runs = Runs::new(bytes, 100);
    let mut list = Vec::new();
    while let Some(run) = runs.next_run()? {
        list.push((run.ticks, run.encoded.to_vec()));
    }
    Ok(list)
}

#[test]
fn runs_come_back() {
    let written = [(1, b"ab".to_vec()), (300, b"".to_vec()), (2, b"ab".to_vec())];
    let mut bytes = Vec::new();
    for (ticks, encoded) in &written {
        Run::write(*ticks, encoded, &mut bytes);
    }
    assert_eq!(all(&bytes), Ok(written.to_vec()));
    assert_eq!(all(&[]), Ok(Vec::new()));
}

#[test]
fn only_the_shortest_form_is_read() {
    let malformed = |offset, flaw| Err(ReadError::Malformed { offset, flaw });
    assert_eq!(all(&[1, 1, 7, 0, 1, 8]), malformed(103, Flaw::EmptyRun));
    assert_eq!(all(&[1, 1, 7, 2, 1, 7]), malformed(103, Flaw::SplitRun));
    assert_eq!(all(&[1, 2, 7]), malformed(100, Flaw::BlockCut));
    assert_eq!(all(&[1]), malformed(101, Flaw::BlockCut));
    assert_eq!(all(&[1, 0xff, 0xff, 0xff, 0xff, 0x0f, 7]), malformed(100, Flaw::BlockCut));
    assert_eq!(all(&[0x81, 0x00, 1, 7]), malformed(100, Flaw::Number));
}
