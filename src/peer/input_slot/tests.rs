use super::*;

#[test]
fn inputs_survive_in_their_slots() {
    let mut slots = Vec::new();
    let fixed = InputSlot::of::<u32>(None).unwrap();
    fixed.put(&7_u32, &mut slots).unwrap();
    assert_eq!((fixed.bytes(), fixed.take::<u32>(&slots)), (4, 7));
    let list = InputSlot::of::<Vec<u8>>(Some(12)).unwrap();
    let mut slots = Vec::new();
    list.put(&alloc::vec![1_u8, 2], &mut slots).unwrap();
    assert_eq!((slots.len(), list.take::<Vec<u8>>(&slots)), (14, alloc::vec![1, 2]));
    assert_eq!(
        list.put(&alloc::vec![0_u8; 5], &mut slots),
        Err(PeerError::InputLength { bytes: 13, possible: 12 })
    );
    assert_eq!(list.take::<Vec<u8>>(&[255; 14]), Vec::<u8>::new(), "not an input");
    assert_eq!(InputSlot::of::<()>(None).unwrap().bytes(), 1);
}

#[test]
fn an_own_input_that_its_type_refuses_is_an_error() {
    #[derive(Clone, Copy, Default, serde::Serialize, serde::Deserialize)]
    #[serde(try_from = "u16", into = "u16")]
    struct Degrees(u16);
    impl From<Degrees> for u16 {
        fn from(degrees: Degrees) -> u16 {
            degrees.0
        }
    }
    impl TryFrom<u16> for Degrees {
        type Error = &'static str;
        fn try_from(degrees: u16) -> Result<Self, &'static str> {
            (degrees < 360).then_some(Degrees(degrees)).ok_or("more than a turn")
        }
    }
    let (slot, mut slots) = (InputSlot::of::<Degrees>(None).unwrap(), Vec::new());
    let refused = Err(PeerError::Record(RecordError::Inputs(InputError::NotCanonical)));
    assert_eq!(slot.put(&Degrees(360), &mut slots), refused);
    assert_eq!((slot.put(&Degrees(359), &mut slots), slots.len()), (Ok(()), 2));
}
