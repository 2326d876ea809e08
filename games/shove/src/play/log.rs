//! [`Log`]: events of the match as lines of text or JSON.

use std::error::Error;
use std::io::Write;
use std::time::Duration;

use lockstep2d::lockstep::Game;
use lockstep2d::peer::{PeerEnd, PeerEvent};
use lockstep2d::session::{Event, PeerId, Status};
use lockstep2d_shove::Shove;
use lockstep2d_shove::online::{UdpPeer, describe};
use serde_json::{Value, json};

/// Writes a line for each event.
#[derive(Debug)]
pub(super) struct Log {
    json: bool,
    /// Number of played ticks, and the time when it last changed. `None` before the session has begun.
    tick: Option<(u64, Duration)>,
    /// Longest time without a tick, and the time at which this stall ended.
    stall: (Duration, Duration),
    delay: Option<u16>,
    desync: Option<u64>,
    /// Whether this peer has left or all have finished. No more ticks are played then.
    is_over: bool,
}

impl Log {
    pub(super) fn new(json: bool) -> Self {
        let stall = (Duration::ZERO, Duration::ZERO);
        Log { json, tick: None, stall, delay: None, desync: None, is_over: false }
    }

    /// Writes the address of this peer if the output is JSON.
    pub(super) fn say_bound(&self, peer: &mut UdpPeer) -> std::io::Result<()> {
        let address = peer.transport_mut().local_address()?.to_string();
        if self.json {
            print(&json!({ "event": "bound", "address": address }));
        }
        Ok(())
    }

    pub(super) fn say(&mut self, peer: &UdpPeer, now: Duration, event: &PeerEvent) {
        match event {
            PeerEvent::Desync(found) => {
                self.desync.get_or_insert(found.tick);
            }
            PeerEvent::Session(Event::Status(status)) => {
                self.is_over |= matches!(status, Status::Finished { .. } | Status::Left | Status::Closed);
            }
            _ => {}
        }
        if self.json {
            let (name, fields) = fields(peer, event);
            self.print(peer, now, name, fields);
        } else {
            eprintln!("{}: {}", name_of(peer), describe(peer, event));
        }
    }

    /// Tracks progress. If the output is JSON, writes the first tick and changes of the input delay.
    pub(super) fn watch(&mut self, peer: &UdpPeer, now: Duration) {
        let tick = peer.tick();
        match &mut self.tick {
            None if peer.status().is_some() => self.tick = Some((tick, now)),
            Some((last, _)) if tick == *last => {}
            Some((last, at)) => {
                let is_first = self.delay.is_none();
                if !is_first && now - *at > self.stall.0 && !self.is_over {
                    self.stall = (now - *at, now);
                }
                (*last, *at) = (tick, now);
                if is_first {
                    self.print(peer, now, "first-tick", json!({ "seats": peer.seats() }));
                }
                let delay = peer.session().map_or(0, |session| session.delay());
                if self.delay != Some(delay) {
                    self.delay = Some(delay);
                    self.print(peer, now, "delay", json!({ "ticks": delay }));
                }
            }
            None => {}
        }
    }

    /// Statistics of this peer, for the last line.
    pub(super) fn summary(&self, peer: &UdpPeer) -> Value {
        let statistics = peer.session().map(|session| session.statistics());
        let replayed = statistics.map(|statistics| (statistics.replayed, statistics.replayed_max));
        let id = peer.session().map(|session| session.id());
        let voters = peer.session().map_or(&[][..], |session| &session.view().voters);
        let links = voters.iter().filter(|voter| Some(voter.id) != id).map(|voter| {
            let round_trip = peer.link(voter.id).map(|link| link.round_trip / 1000);
            json!({ "seats": peer.seats_of(voter.id), "round_trip_ms": round_trip })
        });
        json!({
            "seats": peer.seats(),
            "stall_max_ms": millis(self.stall.0),
            "stall_until_ms": millis(self.stall.1),
            "delay": self.delay,
            "replayed": replayed.map(|replayed| replayed.0),
            "replayed_max": replayed.map(|replayed| replayed.1),
            "links": links.collect::<Vec<_>>(),
        })
    }

    pub(super) fn say_end(&self, mut summary: Value, end: &PeerEnd<Shove>) {
        let hash = end.game.state_hash();
        if self.json {
            summary["event"] = "end".into();
            summary["ticks"] = end.ticks.into();
            summary["hash"] = hash.to_string().into();
            summary["desync"] = self.desync.into();
            print(&summary);
        } else {
            print(&format_args!("{} ticks, state {hash}", end.ticks));
        }
    }

    fn print(&self, peer: &UdpPeer, now: Duration, name: &str, mut fields: Value) {
        if self.json {
            fields["event"] = name.into();
            fields["time_ms"] = millis(now).into();
            fields["tick"] = peer.tick().into();
            print(&fields);
        }
    }
}

pub(super) fn say_error(json: bool, error: &dyn Error) {
    if json {
        print(&json!({ "event": "error", "error": error.to_string() }));
    }
    eprintln!("error: {error}");
}

/// Prints a line. Errors are ignored, so that the match continues even if the reader of the output has gone.
fn print(line: &dyn std::fmt::Display) {
    let _ = writeln!(std::io::stdout().lock(), "{line}");
}

fn millis(time: Duration) -> u64 {
    u64::try_from(time.as_millis()).unwrap_or(u64::MAX)
}

fn name_of(peer: &UdpPeer) -> String {
    match peer.seats()[..] {
        [] => "no seat".to_owned(),
        [seat] => format!("seat {seat}"),
        ref seats => format!("seats {seats:?}"),
    }
}

fn fields(peer: &UdpPeer, event: &PeerEvent) -> (&'static str, Value) {
    let seats = |id: PeerId| peer.seats_of(id);
    match *event {
        PeerEvent::Joined { tick } => ("joined", json!({ "state": tick })),
        PeerEvent::Desync(found) => (
            "desync",
            json!({
                "after": found.tick,
                "seats": seats(found.peer),
                "ours": found.ours.to_string(),
                "theirs": found.theirs.to_string(),
            }),
        ),
        PeerEvent::Session(event) => match event {
            Event::Status(status) => ("status", json!({ "status": status_name(status) })),
            Event::View { number } => ("view", json!({ "number": number })),
            Event::Seated { seat, from, .. } => ("seated", json!({ "seat": seat, "from": from })),
            Event::Unseated { seat, from, .. } => ("unseated", json!({ "seat": seat, "from": from })),
            Event::Waiting { peer, heard } => ("waiting", json!({ "for": seats(peer), "heard": heard })),
            Event::Resumed => ("resumed", json!({})),
            Event::Pause { peer, paused } => ("pause", json!({ "of": seats(peer), "paused": paused })),
            Event::End { ticks } => ("end-decided", json!({ "ticks": ticks })),
            Event::Desync { tick, .. } => ("desync", json!({ "after": tick })),
            Event::Conflict { peer, tick } => ("conflict", json!({ "of": seats(peer), "at": tick })),
            Event::TooFarBehind => ("too-far-behind", json!({})),
        },
    }
}

const fn status_name(status: Status) -> &'static str {
    match status {
        Status::Joining => "joining",
        Status::Watching => "watching",
        Status::Waiting => "waiting",
        Status::Playing => "playing",
        Status::Paused => "paused",
        Status::Dropped => "dropped",
        Status::Kicked => "kicked",
        Status::Leaving => "leaving",
        Status::Left => "left",
        Status::Finished { .. } => "finished",
        Status::Closed => "closed",
    }
}
