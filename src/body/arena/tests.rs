use super::*;

#[test]
fn a_handle_never_resolves_to_a_successor() {
    let mut arena: Arena<u32, BodyId> = Arena::default();
    let first = arena.insert(1);
    let second = arena.insert(2);
    assert_eq!(arena.remove(first), Some(1));
    assert_eq!(arena.remove(first), None);
    let third = arena.insert(3);
    assert_eq!(third.index(), first.index(), "the freed slot should be reused");
    assert_eq!(arena.get(first), None);
    assert_eq!(arena.get(second), Some(&2));
    assert_eq!(arena.get(third), Some(&3));
    assert!(arena.is_consistent());
}

#[test]
fn a_slot_whose_generations_are_used_up_is_retired() {
    let mut arena: Arena<u32, BodyId> = Arena::default();
    let _ = arena.insert(1);
    arena.slots[0].generation = u32::MAX;
    let last = arena.handle_at(0);
    assert_eq!(arena.remove(last), Some(1));
    assert_eq!(arena.get(last), None);
    assert_eq!(arena.insert(2).index(), 1, "a retired slot should not be reused");
    assert!(arena.is_consistent());
}
