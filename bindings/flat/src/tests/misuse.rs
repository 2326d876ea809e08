//! Wrong handles, pointers and names, a panic in the library, and the last error.

use lockstep2d::body::{BodyDef, Geometry, ShapeDef};
use lockstep2d::fx;
#[cfg(feature = "lockstep")]
use lockstep2d::session::Config;

use super::{done, hash_of};
use crate::status::{Failure, Outcome};
use crate::table::{self, Bytes};
use crate::*;

#[test]
fn a_stale_handle_never_means_another_object() {
    let mut stale = Vec::new();
    for _ in 0..10_000 {
        let mut handle = 0;
        done(ls2d_bytes_new(In::all(b"x"), 1, Out::of(&mut handle)));
        done(ls2d_free(handle));
        stale.push(handle);
    }
    let mut sorted = stale.clone();
    sorted.sort_unstable();
    sorted.dedup();
    assert_eq!(sorted.len(), stale.len(), "no handle is used twice");
    assert!(stale.iter().all(|&handle| ls2d_free(handle) == Status::Handle as i32));
}

#[test]
fn a_panic_becomes_a_code_and_leaves_the_object_unusable() {
    let mut handle = 0;
    done(ls2d_bytes_new(In::all(b"x"), 1, Out::of(&mut handle)));
    let fails = |_: &mut Bytes| -> Outcome { std::panic::resume_unwind(Box::new("planted")) };
    assert_eq!(border::guard(|| table::with(handle, fails)), Status::Internal as i32);
    let mut size = 0;
    assert_eq!(ls2d_bytes_size(handle, Out::of(&mut size)), Status::Broken as i32);
    done(ls2d_free(handle));
}

#[test]
fn the_last_error_says_why() {
    assert_eq!(ls2d_world_step(77), Status::Handle as i32);
    let (mut text, mut length) = ([0; 64], 0);
    done(ls2d_last_error(Out::all(&mut text), 64, Out::of(&mut length)));
    assert_eq!(&text[..length], b"no object has the handle 77");
    done(ls2d_last_error(Out::all(&mut text), 2, Out::of(&mut length)));
    assert_eq!(length, 27, "the length of the whole text");
    // A call with nothing to return is not a failure, and keeps the text of the last failure.
    assert_eq!(border::guard(|| Err(Failure::none())), Status::None as i32);
    done(ls2d_last_error(Out::all(&mut text), 64, Out::of(&mut length)));
    assert_eq!(&text[..length], b"no object has the handle 77");
}

/// A misaligned pointer to memory for one item.
fn odd<T: border::Plain>(memory: &mut [u64; 2]) -> Out<'_, T> {
    Out::to(memory.as_mut_ptr().cast::<u8>().wrapping_add(1).cast())
}

fn body(world: u32) -> RawBody {
    let mut id = RawBody(0);
    let def = RawBodyDef::of(&BodyDef::dynamic());
    done(ls2d_spawn(world, In::of(&def), In::null(), 0, Out::of(&mut id)));
    id
}

#[test]
fn an_edit_whose_result_cannot_be_written_changes_nothing() {
    let (mut world, mut list, mut memory) = (0, 0, [0; 2]);
    done(ls2d_world_new(In::null(), Out::of(&mut world)));
    done(ls2d_commands_new(Out::of(&mut list)));
    let (a, b) = (body(world), body(world));
    let def = RawBodyDef::of(&BodyDef::fixed());
    done(ls2d_spawn(list, In::of(&def), In::null(), 0, Out::null()));
    let shape = RawShapeDef::of(&ShapeDef::new(Geometry::circle(fx!(1)).unwrap()));
    let joint = RawJointDef { body_a: a, body_b: b, ..RawJointDef::of_kind(WELD).unwrap() };
    let before = hash_of(world);
    let results = [
        ls2d_spawn(world, In::of(&def), In::null(), 0, odd(&mut memory)),
        ls2d_add_shape(world, a, In::of(&shape), odd(&mut memory)),
        ls2d_add_joint(world, In::of(&joint), odd(&mut memory)),
        ls2d_world_execute(world, list, odd(&mut memory)),
    ];
    assert_eq!(results, [Status::Misaligned as i32; 4]);
    assert_eq!(hash_of(world), before);
    done(ls2d_free(list));
    done(ls2d_free(world));
}

#[cfg(feature = "lockstep")]
#[test]
fn a_tick_whose_result_cannot_be_written_is_not_recorded() {
    let hash = RawHash { low: 0, high: 0 };
    let mut memory = [0; 2];
    let files = [false, true].map(|fails| {
        let (mut recorder, mut bytes) = (0, 0);
        let out = Out::of(&mut recorder);
        done(ls2d_recorder_new(In::all(b"r"), 1, 1, 1, 60, 1, In::null(), 0, In::of(&hash), 9, out));
        if fails {
            let status = ls2d_recorder_record(recorder, In::all(&[7]), 1, 0, odd(&mut memory));
            assert_eq!(status, Status::Misaligned as i32);
        }
        done(ls2d_recorder_record(recorder, In::all(&[7]), 1, 0, Out::null()));
        done(ls2d_recorder_finish(recorder, In::of(&hash), Out::of(&mut bytes)));
        done(ls2d_free(recorder));
        super::take(bytes)
    });
    assert!(files[0] == files[1]);
}

#[cfg(feature = "lockstep")]
#[test]
fn inputs_whose_result_cannot_be_written_are_not_issued() {
    let (mut game, mut due, mut issued, mut memory) = (0, 0, 0, [0; 2]);
    let config = Config { start_with: 1, ..Config::new(0, 1) };
    let config = RawMatchConfig { own_seats: 1, ..RawMatchConfig::of(&config) };
    done(ls2d_match_host(In::of(&config), In::null(), 0, Out::of(&mut game)));
    let mut request = RawRequest { kind: 0, tick: 0, absent: 0, guessed: 0 };
    let (mut inputs, mut size) = ([0], 0);
    let mut next =
        || ls2d_match_next_request(game, Out::of(&mut request), Out::all(&mut inputs), 1, Out::of(&mut size));
    let now = (0..1000).map(|step| step * 1000).find(|&now| {
        done(ls2d_match_update(game, now));
        while next() == Status::Ok as i32 {}
        done(ls2d_match_is_due(game, now, Out::of(&mut due)));
        due == 1
    });
    let now = now.unwrap();
    let status = ls2d_match_advance(game, now, In::all(&[7]), 1, odd(&mut memory));
    assert_eq!((status, next()), (Status::Misaligned as i32, Status::None as i32));
    done(ls2d_match_advance(game, now, In::all(&[7]), 1, Out::of(&mut issued)));
    assert_eq!((issued, next()), (1, Status::Ok as i32));
    done(ls2d_free(game));
}

/// The first event and a request that does not fit stay in the match until they are fetched.
#[cfg(feature = "lockstep")]
#[test]
fn nothing_of_a_discarded_match_is_delivered() {
    let (mut game, mut due, mut size) = (0, 0, 0);
    let config = Config { start_with: 1, ..Config::new(0, 1) };
    let config = RawMatchConfig { own_seats: 1, ..RawMatchConfig::of(&config) };
    done(ls2d_match_host(In::of(&config), In::null(), 0, Out::of(&mut game)));
    let mut event = RawMatchEvent::new(EVENT_STATUS);
    let mut next_event = || ls2d_match_next_event(game, Out::of(&mut event));
    let mut request = RawRequest { kind: 0, tick: 0, absent: 0, guessed: 0 };
    let mut next_request =
        || ls2d_match_next_request(game, Out::of(&mut request), Out::null(), 0, Out::of(&mut size));
    let now = (0..1000).map(|step| step * 1000).find(|&now| {
        done(ls2d_match_update(game, now));
        while next_request() == Status::Ok as i32 {}
        done(ls2d_match_is_due(game, now, Out::of(&mut due)));
        due == 1
    });
    let now = now.unwrap();
    done(ls2d_match_advance(game, now, In::all(&[7]), 1, Out::null()));
    // The match has begun, and its player leaves it: these are several events.
    done(ls2d_match_leave(game));
    done(ls2d_match_update(game, now + 1000));
    let kept = std::iter::repeat_with(&mut next_request).find(|status| *status != Status::Ok as i32);
    assert_eq!((kept, next_event()), (Some(Status::Buffer as i32), Status::Ok as i32));
    done(ls2d_match_ask(game, In::all(&[2]), 1));
    assert_eq!((next_request(), next_event()), (Status::None as i32, Status::None as i32));
    done(ls2d_free(game));
}

#[test]
fn a_name_with_a_zero_is_refused() {
    let mut world = 0;
    done(ls2d_world_new(In::null(), Out::of(&mut world)));
    let id = body(world);
    let set = |name: &[u8]| ls2d_set_name(world, id, In::all(name), name.len());
    done(set(b"ab"));
    for wrong in [&b"ab\0cd"[..], b"ab\0", b"\0", b"\0ab"] {
        assert_eq!(set(wrong), Status::Name as i32, "{wrong:?}");
    }
    let mut name = [1; 16];
    done(ls2d_body_name(world, id, Out::of(&mut name)));
    assert_eq!(&name, b"ab\0\0\0\0\0\0\0\0\0\0\0\0\0\0");
    done(set(b""));
    let def = |name| RawBodyDef { name, ..RawBodyDef::of(&BodyDef::fixed()) };
    let spawn = |name| ls2d_spawn(world, In::of(&def(name)), In::null(), 0, Out::null());
    for name in [*b"ab\0\0\0\0\0\0\0\0\0\0\0\0\0\0", *b"0123456789abcdef", [0; 16]] {
        done(spawn(name));
    }
    for wrong in [*b"ab\0cd\0\0\0\0\0\0\0\0\0\0\0", *b"\0ab\0\0\0\0\0\0\0\0\0\0\0\0\0"] {
        assert_eq!(spawn(wrong), Status::Name as i32, "{wrong:?}");
    }
    done(ls2d_free(world));
}
