//! Matches: sessions whose inputs, states and packets are bytes. The caller transports packets and fulfils requests.

use std::collections::VecDeque;

use lockstep2d::session::{
    Address, Config, Endpoint, Event, Identity, JoinEvent, Key, PeerId, Request, Role, Session, TickInputs,
};

use crate::border::{In, Out};
use crate::describe::api;
use crate::numbers::RawHash;
use crate::records::{
    EVENT_BAD_STATE, EVENT_STATE, MATCH_CONNECTING, REQUEST_ADVANCE, REQUEST_CHECKSUM, REQUEST_FORGET,
    REQUEST_LOAD, REQUEST_SAVE, RawMatchConfig, RawMatchEvent, RawRequest, match_status,
};
use crate::status::{Failure, Outcome, Status, value};
use crate::table::{self, with};

/// A participant of a match.
pub(crate) struct Match {
    endpoint: Endpoint,
    /// Packet that did not fit into the caller's buffer.
    packet: Option<(Address, Vec<u8>)>,
    /// Request whose inputs did not fit into the caller's buffer.
    request: Option<Request>,
    events: VecDeque<Happened>,
}

/// An event, with the downloaded state if there is one.
struct Happened {
    event: RawMatchEvent,
    state: Option<Vec<u8>>,
}

impl Match {
    fn new(endpoint: Endpoint) -> Self {
        Match { endpoint, packet: None, request: None, events: VecDeque::new() }
    }

    fn session(&mut self) -> Outcome<&mut Session> {
        let waits = || Failure::new(Status::NotInMatch, "this peer does not take part in the match yet");
        self.endpoint.session_mut().ok_or_else(waits)
    }

    /// The next event, which stays in the queue until it is popped.
    fn next_event(&mut self) -> Option<&mut Happened> {
        while let Some(event) = self.endpoint.next_event() {
            self.events.push_back(match event {
                JoinEvent::Refused { reason, .. } => plain(RawMatchEvent::refused(reason)),
                JoinEvent::State { tick, bytes } => {
                    let event = RawMatchEvent { tick, ..RawMatchEvent::new(EVENT_STATE) };
                    Happened { event, state: Some(bytes) }
                }
                JoinEvent::BadState => plain(RawMatchEvent::new(EVENT_BAD_STATE)),
            });
        }
        if let Some(session) = self.endpoint.session_mut() {
            let events: Vec<Event> = std::iter::from_fn(|| session.next_event()).collect();
            self.events.extend(events.into_iter().map(|event| plain(RawMatchEvent::of(event))));
        }
        self.events.front_mut()
    }

    fn next_request(&mut self) -> Option<Request> {
        self.request.take().or_else(|| self.endpoint.session_mut()?.next_request())
    }

    fn next_packet(&mut self) -> Option<(Address, Vec<u8>)> {
        self.packet.take().or_else(|| self.endpoint.next_packet())
    }
}

fn plain(event: RawMatchEvent) -> Happened {
    Happened { event, state: None }
}

fn address(bytes: &In<'_, u8>, size: usize) -> Outcome<Address> {
    let bytes = bytes.slice(size)?;
    Address::new(bytes).ok_or_else(|| value("the length of an address", bytes.len()))
}

fn identity(config: &RawMatchConfig, offer: &[u8]) -> Identity {
    let RawMatchConfig { peer, key, secret, .. } = *config;
    Identity { id: PeerId(peer), key: Key(key), offer: offer.to_vec(), secret }
}

fn own_seats(config: &RawMatchConfig) -> u8 {
    u8::try_from(config.own_seats).unwrap_or(u8::MAX)
}

/// Calls a function of the session.
fn tell(handle: u32, act: impl FnOnce(&mut Session)) -> Outcome {
    with(handle, |game: &mut Match| game.session().map(act))
}

fn describe(request: &Request) -> (RawRequest, Option<&TickInputs>) {
    let raw = |kind, tick| RawRequest { kind, tick, absent: 0, guessed: 0 };
    match request {
        Request::Save { tick } => (raw(REQUEST_SAVE, *tick), None),
        Request::Load { tick } => (raw(REQUEST_LOAD, *tick), None),
        Request::Checksum { tick } => (raw(REQUEST_CHECKSUM, *tick), None),
        Request::Forget { tick } => (raw(REQUEST_FORGET, *tick), None),
        Request::Advance { tick, inputs } => {
            let bits = RawRequest {
                absent: inputs.absent(),
                guessed: inputs.guessed(),
                ..raw(REQUEST_ADVANCE, *tick)
            };
            (bits, Some(inputs))
        }
    }
}

api! {
    /// Sets the defaults of a match: lockstep at 60 ticks per second, inputs of one byte, and a start as soon as two
    /// seats (or the only one) are taken. The caller sets `peer`, `key` and `secret` to random numbers.
    fn ls2d_match_config_init(seats: u32, config: Out<'_, RawMatchConfig>) {
        let mut config = config;
        let number = u8::try_from(seats).map_err(|_| value("the number of seats", seats))?;
        let defaults = Config { start_with: number.min(2), ..Config::new(0, number) };
        defaults.validate()?;
        config.set(RawMatchConfig::of(&defaults))
    }

    /// Opens a match. `offer` is data of at most 512 bytes that all peers have to agree on, such as rules and setup.
    fn ls2d_match_host(config: In<'_, RawMatchConfig>, offer: In<'_, u8>, offer_size: usize, handle: Out<'_, u32>) {
        let mut handle = handle;
        handle.check()?;
        let raw = config.get()?;
        let (config, identity) = (raw.config()?, identity(&raw, offer.slice(offer_size)?));
        let seats = 1_u64.checked_shl(raw.own_seats).map_or(u64::MAX, |above| above - 1);
        handle.set(table::add(Match::new(Endpoint::host(config, identity, seats)?))?)
    }

    /// Joins a match through the participant at the address `contact`, as a spectator if `own_seats` is 0.
    fn ls2d_match_join(
        config: In<'_, RawMatchConfig>,
        offer: In<'_, u8>,
        offer_size: usize,
        contact: In<'_, u8>,
        contact_size: usize,
        handle: Out<'_, u32>,
    ) {
        let mut handle = handle;
        handle.check()?;
        let raw = config.get()?;
        let (config, identity) = (raw.config()?, identity(&raw, offer.slice(offer_size)?));
        let contact = address(&contact, contact_size)?;
        let role = match own_seats(&raw) {
            0 => Role::Spectator,
            seats => Role::Player { seats },
        };
        handle.set(table::add(Match::new(Endpoint::join(config, identity, role, contact)?))?)
    }

    /// Requests to join a match through the participant at the address `contact`. Discards a match in progress, with
    /// its requests and events. Packets that were not fetched are still sent.
    fn ls2d_match_ask(handle: u32, contact: In<'_, u8>, contact_size: usize) {
        let contact = address(&contact, contact_size)?;
        with(handle, |game: &mut Match| {
            game.endpoint.ask(contact);
            game.request = None;
            game.events.clear();
            Ok(())
        })
    }

    /// Processes a packet that arrived from the address `from`. `now` is a time in microseconds that never decreases.
    fn ls2d_match_receive(
        handle: u32,
        now: u64,
        from: In<'_, u8>,
        from_size: usize,
        packet: In<'_, u8>,
        size: usize,
    ) {
        let from = address(&from, from_size)?;
        let packet = packet.slice(size)?;
        with(handle, |game: &mut Match| {
            game.endpoint.receive(now, from, packet);
            Ok(())
        })
    }

    /// Advances the match to the time `now`. Call it every few milliseconds and after packets have arrived.
    fn ls2d_match_update(handle: u32, now: u64) {
        with(handle, |game: &mut Match| {
            game.endpoint.update(now);
            Ok(())
        })
    }

    /// Writes 1 if `ls2d_match_advance` has to be called now, otherwise 0.
    fn ls2d_match_is_due(handle: u32, now: u64, due: Out<'_, u32>) {
        let mut due = due;
        with(handle, |game: &mut Match| {
            due.set(game.endpoint.session().is_some_and(|session| session.is_due(now)).into())
        })
    }

    /// Issues the inputs of this peer's seats, in order of the seats, and plays a tick if possible: the next requests
    /// then contain `LS2D_REQUEST_ADVANCE`. Writes 1 to `issued` if the inputs were issued; otherwise the same inputs
    /// may be passed again. Issued inputs count for one tick, so clear recorded key presses when the inputs were
    /// issued. While the input delay grows, `ls2d_match_is_due` remains 1, and each further call takes the inputs of
    /// one more tick before the next tick is played. For a peer without seats, `size` is 0.
    fn ls2d_match_advance(handle: u32, now: u64, inputs: In<'_, u8>, size: usize, issued: Out<'_, u32>) {
        let mut issued = issued;
        issued.check_if_wanted()?;
        with(handle, |game: &mut Match| {
            let done = game.session()?.advance(now, inputs.slice(size)?)?;
            game.endpoint.flush();
            issued.set_if_wanted(done.into())
        })
    }

    /// The next request. Fulfil requests in order before the next `ls2d_match_advance`. For `LS2D_REQUEST_ADVANCE`,
    /// writes the inputs of all seats to `inputs`. `LS2D_NONE` if there is no request.
    fn ls2d_match_next_request(
        handle: u32,
        request: Out<'_, RawRequest>,
        inputs: Out<'_, u8>,
        capacity: usize,
        size: Out<'_, usize>,
    ) {
        let (mut request, mut inputs, mut size) = (request, inputs, size);
        request.check()?;
        with(handle, |game: &mut Match| {
            let next = game.next_request().ok_or_else(Failure::none)?;
            let (raw, played) = describe(&next);
            let bytes = played.map(TickInputs::bytes).unwrap_or_default();
            let written = inputs.set_all(capacity, &mut size, bytes).and_then(|()| request.set(raw));
            if written.is_err() {
                game.request = Some(next);
            }
            written
        })
    }

    /// Passes the hash that `LS2D_REQUEST_CHECKSUM` requests.
    fn ls2d_match_report_hash(handle: u32, tick: u32, hash: In<'_, RawHash>) {
        let hash = hash.get()?.hash();
        tell(handle, |session| session.report_hash(tick, hash.0))
    }

    /// The next packet, of at most 1200 bytes, and its destination, an address of at most 32 bytes. `LS2D_NONE` if
    /// there is no packet.
    fn ls2d_match_next_packet(
        handle: u32,
        to: Out<'_, u8>,
        to_capacity: usize,
        to_size: Out<'_, usize>,
        packet: Out<'_, u8>,
        capacity: usize,
        size: Out<'_, usize>,
    ) {
        let (mut to, mut to_size, mut packet, mut size) = (to, to_size, packet, size);
        with(handle, |game: &mut Match| {
            let (address, bytes) = game.next_packet().ok_or_else(Failure::none)?;
            let written = to.set_all(to_capacity, &mut to_size, address.bytes());
            let written = written.and_then(|()| packet.set_all(capacity, &mut size, &bytes));
            if written.is_err() {
                game.packet = Some((address, bytes));
            }
            written
        })
    }

    /// The next event. `LS2D_NONE` if there is no event.
    fn ls2d_match_next_event(handle: u32, event: Out<'_, RawMatchEvent>) {
        let mut event = event;
        event.check()?;
        with(handle, |game: &mut Match| {
            let Happened { event: next, state } = game.next_event().ok_or_else(Failure::none)?;
            if let Some(state) = state {
                next.value = table::add_taken(|| Ok(std::mem::take(state)))?;
            }
            event.set(*next)?;
            game.events.pop_front();
            Ok(())
        })
    }

    /// Writes 1 if a joining peer waits for its initial state, otherwise 0.
    fn ls2d_match_wants_state(handle: u32, wants: Out<'_, u32>) {
        let mut wants = wants;
        with(handle, |game: &mut Match| wants.set(game.endpoint.wants_state().into()))
    }

    /// Offers the encoded state after `tick` final ticks to peers that join.
    fn ls2d_match_offer_state(handle: u32, tick: u32, state: In<'_, u8>, size: usize) {
        let state = state.slice(size)?.to_vec();
        with(handle, |game: &mut Match| {
            game.endpoint.offer_state(tick, state);
            Ok(())
        })
    }

    /// Status of the match: one of the `LS2D_MATCH_` constants.
    fn ls2d_match_status(handle: u32, status: Out<'_, u32>) {
        let mut status = status;
        with(handle, |game: &mut Match| {
            let session = game.endpoint.session();
            status.set(session.map_or(MATCH_CONNECTING, |session| match_status(session.status())))
        })
    }

    /// Numbers of ticks: `played` ticks were played, `last` ticks have final inputs, and `confirmed` ticks were played
    /// with final inputs. Each pointer may be null.
    fn ls2d_match_ticks(handle: u32, played: Out<'_, u32>, last: Out<'_, u32>, confirmed: Out<'_, u32>) {
        let (mut played, mut last, mut confirmed) = (played, last, confirmed);
        with(handle, |game: &mut Match| {
            let session = game.session()?;
            played.set_if_wanted(session.played())?;
            last.set_if_wanted(session.final_tick())?;
            confirmed.set_if_wanted(session.confirmed())
        })
    }

    /// Writes the bit mask of this peer's own seats.
    fn ls2d_match_seats(handle: u32, seats: Out<'_, u64>) {
        let mut seats = seats;
        with(handle, |game: &mut Match| seats.set(game.endpoint.session().map_or(0, Session::seats)))
    }

    /// The final inputs of all seats for a tick. `LS2D_NONE` if they are not final yet or no longer stored.
    fn ls2d_match_final_inputs(
        handle: u32,
        tick: u32,
        inputs: Out<'_, u8>,
        capacity: usize,
        size: Out<'_, usize>,
        absent: Out<'_, u64>,
    ) {
        let (mut inputs, mut size, mut absent) = (inputs, size, absent);
        with(handle, |game: &mut Match| {
            let known = game.session()?.final_inputs(tick).ok_or_else(Failure::none)?;
            absent.set_if_wanted(known.absent())?;
            inputs.set_all(capacity, &mut size, known.bytes())
        })
    }

    /// Delay of this peer's inputs in ticks. For the link to `peer`: smoothed round-trip time in microseconds, and loss
    /// in thousandths. Each pointer may be null. `LS2D_NONE` if there is no such peer.
    fn ls2d_match_link(
        handle: u32,
        peer: u32,
        delay: Out<'_, u32>,
        round_trip: Out<'_, u64>,
        loss: Out<'_, u32>,
    ) {
        let (mut delay, mut round_trip, mut loss) = (delay, round_trip, loss);
        with(handle, |game: &mut Match| {
            let session = game.session()?;
            delay.set_if_wanted(session.delay().into())?;
            let link = session.link(PeerId(peer)).ok_or_else(Failure::none)?;
            round_trip.set_if_wanted(link.round_trip)?;
            loss.set_if_wanted(link.loss_per_mille)
        })
    }

    /// Leaves the match. Call `ls2d_match_update` until the status is `LS2D_MATCH_CLOSED`, to inform the other peers.
    fn ls2d_match_leave(handle: u32) {
        tell(handle, |session| session.leave())
    }

    /// Requests an end of the match after `ticks` ticks. The request is sent two seconds before the end. Until a
    /// majority has decided on the end, other peers can get seats. The request of one peer with a vote (a player with a
    /// seat, or a dedicated server) suffices and cannot be withdrawn, so base it on the state of a confirmed tick
    /// (`ls2d_match_ticks`). Without a vote, the request has no effect until this peer gets a seat, and none if its tick
    /// has passed by then.
    fn ls2d_match_end_at(handle: u32, ticks: u32) {
        tell(handle, |session| session.end_at(ticks))
    }

    /// Tells the other peers that this peer requests a pause (1) or withdraws its request (0). The match plays on:
    /// during a pause, the program of each peer calls `ls2d_match_update` and does not call `ls2d_match_advance`.
    fn ls2d_match_pause(handle: u32, paused: u32) {
        tell(handle, |session| session.pause(paused != 0))
    }

    /// Votes for going on without a missing peer.
    fn ls2d_match_go_on_without(handle: u32, peer: u32) {
        tell(handle, |session| session.go_on_without(PeerId(peer)))
    }

    /// Votes for removing the player with this key. The vote counts only while this peer is a voter.
    fn ls2d_match_kick(handle: u32, key: u64) {
        tell(handle, |session| session.kick(Key(key)))
    }

    /// Sets the number of ticks that may be played with guessed inputs; 0 is lockstep.
    fn ls2d_match_set_guess(handle: u32, ticks: u32) {
        let ticks = u16::try_from(ticks).map_err(|_| value("the number of guessed ticks", ticks))?;
        tell(handle, |session| session.set_guess(ticks))
    }
}
