//! A call that fails because the table of objects is full loses no data: when an object has been freed, the repeated
//! call succeeds. The tests run in a process of their own, because they fill the table.
#![cfg(feature = "lockstep")]
#![expect(clippy::indexing_slicing, reason = "a test fails by a panic")]

use lockstep2d_flat::*;

const OK: i32 = Status::Ok as i32;
const EXHAUSTED: i32 = Status::Exhausted as i32;
const START: RawHash = RawHash { low: 1, high: 2 };

fn done(status: i32) {
    assert_eq!(status, OK);
}

fn take(bytes: u32) -> Vec<u8> {
    let mut size = 0;
    done(ls2d_bytes_size(bytes, Out::of(&mut size)));
    let mut copy = vec![0; size];
    done(ls2d_bytes_copy(bytes, Out::all(&mut copy), size));
    done(ls2d_free(bytes));
    copy
}

fn recorder() -> u32 {
    let mut recorder = 0;
    let out = Out::of(&mut recorder);
    done(ls2d_recorder_new(In::all(b"r"), 1, 1, 1, 60, 1, In::null(), 0, In::of(&START), 9, out));
    done(ls2d_recorder_record(recorder, In::all(&[7]), 1, 0, Out::null()));
    recorder
}

fn recording() -> u32 {
    let (mut recording, mut list) = (0, 0);
    done(ls2d_commands_new(Out::of(&mut list)));
    done(ls2d_recording_new(In::null(), list, 9, Out::of(&mut recording)));
    done(ls2d_recording_step(recording, list));
    done(ls2d_free(list));
    recording
}

/// A function that takes bytes out of an object.
type Take = Box<dyn Fn(Out<'_, u32>) -> i32>;

fn takes(recorder: u32, recording: u32) -> [Take; 5] {
    [
        Box::new(move |out| ls2d_recorder_take(recorder, out)),
        Box::new(move |out| ls2d_recorder_so_far(recorder, In::of(&START), out)),
        Box::new(move |out| ls2d_recorder_finish(recorder, In::of(&START), out)),
        Box::new(move |out| ls2d_recording_take(recording, out)),
        Box::new(move |out| ls2d_recording_finish(recording, out)),
    ]
}

/// Opens a match if `contact` is `None`; otherwise joins the match of the contact.
fn enter(peer: u32, contact: Option<u8>) -> u32 {
    let mut config = RawMatchConfig {
        size: 0,
        seats: 0,
        own_seats: 0,
        start_with: 0,
        input_bytes: 0,
        tick_micros: 0,
        guess: 0,
        delay_min: 0,
        delay_max: 0,
        save_interval: 0,
        check_interval: 0,
        history: 0,
        log_ticks: 0,
        seat_lead: 0,
        seat_within: 0,
        peer: 0,
        match_tag: 0,
        patience: 0,
        key: 0,
        secret: [0; 2],
    };
    done(ls2d_match_config_init(2, Out::of(&mut config)));
    (config.peer, config.key, config.secret) = (peer, peer.into(), [peer.into(); 2]);
    let mut handle = 0;
    let (config, out) = (In::of(&config), Out::of(&mut handle));
    done(match contact {
        None => ls2d_match_host(config, In::null(), 0, out),
        Some(contact) => ls2d_match_join(config, In::null(), 0, In::all(&[contact]), 1, out),
    });
    handle
}

/// Passes packets between two peers until the second has its first event.
fn first_event(peers: [u32; 2]) -> RawMatchEvent {
    let none = RawHash { low: 0, high: 0 };
    let mut event = RawMatchEvent {
        kind: 99,
        peer: 0,
        seat: 0,
        tick: 0,
        value: 0,
        reserved: 0,
        ours: none,
        theirs: none,
    };
    for now in (0..10_000_000).step_by(4000) {
        for (own, &peer) in peers.iter().enumerate() {
            done(ls2d_match_update(peer, now));
            let (mut to, mut packet, mut sizes) = ([0; 32], [0; 2048], [0; 2]);
            let [to_size, size] = &mut sizes;
            let (to_size, size) = (Out::of(to_size), Out::of(size));
            if ls2d_match_next_packet(peer, Out::all(&mut to), 32, to_size, Out::all(&mut packet), 2048, size)
                == OK
            {
                let from = [u8::try_from(own).unwrap_or_default()];
                let other = peers[1 - own];
                done(ls2d_match_receive(other, now, In::all(&from), 1, In::all(&packet), sizes[1]));
            }
        }
        let mut wants = 0;
        done(ls2d_match_wants_state(peers[0], Out::of(&mut wants)));
        if wants == 1 {
            done(ls2d_match_offer_state(peers[0], 0, In::all(b"state"), 5));
        }
        match ls2d_match_next_event(peers[1], Out::of(&mut event)) {
            OK => return event,
            EXHAUSTED => return RawMatchEvent { kind: 77, ..event },
            _ => {}
        }
    }
    event
}

/// Fills the table of objects. Returns some of the new handles.
fn fill() -> Vec<u32> {
    let (mut spare, mut handle) = (Vec::new(), 0);
    while ls2d_bytes_new(In::null(), 0, Out::of(&mut handle)) == OK {
        if spare.len() < 8 {
            spare.push(handle);
        }
    }
    spare
}

#[test]
fn a_full_table_loses_nothing() {
    let expected = takes(recorder(), recording()).map(|take_from| {
        let mut bytes = 0;
        done(take_from(Out::of(&mut bytes)));
        take(bytes)
    });
    let takes = takes(recorder(), recording());
    let peers = [enter(1, None), enter(2, Some(0))];
    let mut spare = fill();
    for (take_from, expected) in takes.iter().zip(expected) {
        let mut bytes = 0;
        assert_eq!(take_from(Out::of(&mut bytes)), EXHAUSTED);
        done(ls2d_free(spare.pop().unwrap_or_default()));
        done(take_from(Out::of(&mut bytes)));
        assert!(!expected.is_empty() && take(bytes) == expected);
        assert_eq!(ls2d_bytes_new(In::null(), 0, Out::of(&mut bytes)), OK);
    }
    assert_eq!(first_event(peers).kind, 77, "the state has no handle");
    done(ls2d_free(spare.pop().unwrap_or_default()));
    let event = first_event(peers);
    assert_eq!((event.kind, take(event.value)), (EVENT_STATE, b"state".to_vec()));
}
