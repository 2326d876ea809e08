//! Wrong handles, a panic in the library, and the last error.

use super::done;
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
    assert_eq!(Failure::none().status, Status::None);
}
