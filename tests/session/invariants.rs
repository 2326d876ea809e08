//! Invariants of a match: one history, equal states, and a quorum that has the inputs of all ticks before the cut of a
//! view.

use lockstep2d::session::{Event, InputStatus, PeerId, Status, Tick, TickInputs, View};

use super::game::mix_inputs;
use super::sim::{MS, S, Sim, id};

impl Sim {
    /// Checks a peer after each of its steps.
    pub(super) fn check(&mut self, index: usize) {
        self.check_events(index);
        self.check_view(index);
        self.check_final(index);
        self.check_played(index);
        let peer = &mut self.peers[index];
        if let (Status::Finished { ticks }, None) = (peer.session.status(), peer.finished) {
            let hash = self.history.get(ticks as usize).copied().unwrap_or(0);
            peer.finished = Some((ticks, hash));
        }
    }

    fn check_events(&mut self, index: usize) {
        while let Some(event) = self.peers[index].session.next_event() {
            match event {
                Event::Desync { .. } if self.peers[index].game.is_broken() => {}
                Event::Desync { peer, .. } if self.is_broken(peer) => self.peers[index].desyncs += 1,
                Event::Pause { .. } | Event::TooFarBehind => self.peers[index].events.push(event),
                Event::Waiting { peer, heard } => self.peers[index].waiting.push((peer, heard)),
                Event::Desync { peer, tick, .. } => {
                    self.fail(format!("S1 {index} and {peer} differ at tick {tick}"))
                }
                Event::Conflict { peer, tick } if !self.expects_conflicts => {
                    self.fail(format!("S6 two inputs of {peer} for tick {tick}"));
                }
                Event::Status(Status::Leaving) => self.peers[index].was_leaving = true,
                Event::Status(Status::Left) => self.peers[index].left_at = self.now,
                Event::Status(Status::Dropped) => self.peers[index].lost_seats += 1,
                _ => {}
            }
        }
    }

    fn is_broken(&self, peer: PeerId) -> bool {
        (0..self.peers.len()).any(|index| id(index) == peer && self.peers[index].game.is_broken())
    }

    /// Checks that a peer that has left keeps answering until all others know of its departure and have its inputs, or
    /// until a timeout.
    pub(super) fn check_goodbye(&mut self, index: usize) {
        let leaver = &self.peers[index];
        let view = leaver.session.view();
        let left = leaver.was_leaving && view.voter(id(index)).is_none() && leaver.finished.is_none();
        // The wait ends 11 s after the peer has left. Later changes of the view do not extend it.
        if !left || self.now > leaver.left_at + 11 * S {
            return;
        }
        let ignorant = (0..self.peers.len()).find(|&other| {
            let peer = &self.peers[other];
            let lacks = peer.session.view().number < view.number || peer.session.complete_tick() < view.cut;
            peer.on && view.voter(id(other)).is_some() && lacks
        });
        if let Some(other) = ignorant {
            self.fail(format!("L4 {index} is gone before {other} knows that it left and has its inputs"));
        }
    }

    fn check_view(&mut self, index: usize) {
        let peer = &self.peers[index];
        let view = peer.session.view();
        if view.number == peer.seen_view {
            return;
        }
        let final_before = peer.seen_final;
        if view.cut < final_before {
            let what = format!("S2 cut {} below {final_before} final ticks of {index}", view.cut);
            return self.fail(what);
        }
        match self.views.get(&view.number) {
            Some(known) if known != view => {
                let what = format!("S3 two views {}: {known:?} and {view:?}", view.number);
                return self.fail(what);
            }
            Some(_) => {}
            None => {
                let view = view.clone();
                self.check_cut_is_held(&view);
                self.views.insert(view.number, view);
                if self.assassin > 0 && self.rng.percent(self.assassin) {
                    self.assassin = self.assassin.saturating_sub(8);
                    let at = self.now + self.rng.range(0, 250) * MS;
                    self.crash_at(index, at);
                }
            }
        }
        self.peers[index].seen_view = self.peers[index].session.view().number;
    }

    /// Checks that a quorum of the previous view has the inputs of all ticks before the cut.
    fn check_cut_is_held(&mut self, view: &View) {
        let Some(before) = view.number.checked_sub(1).and_then(|number| self.views.get(&number)) else {
            return;
        };
        let holds = |(_, voter): &(usize, &lockstep2d::session::Voter)| {
            let peer = (0..self.peers.len()).find(|&index| id(index) == voter.id);
            peer.is_some_and(|peer| self.peers[peer].session.complete_tick() >= view.cut)
        };
        let holders =
            before.voters.iter().enumerate().filter(holds).fold(0, |set, (index, _)| set | 1 << index);
        if !before.is_quorum(holders) {
            let what = format!("S7 view {}: ticks before {} not held by a quorum", view.number, view.cut);
            self.fail(what);
        }
    }

    /// Checks that the inputs of the final ticks give the states of the shared history, and appends new states to it.
    fn check_final(&mut self, index: usize) {
        let fin = self.peers[index].session.final_tick();
        let from = self.peers[index].seen_final;
        if fin < from {
            self.fail(format!("S1 final ticks of {index} fell from {from} to {fin}"));
        }
        for tick in from..fin {
            let Some(inputs) = self.peers[index].session.final_inputs(tick) else {
                return self.fail(format!("S1 {index} lacks inputs of final tick {tick}"));
            };
            self.check_issued(index, tick, &inputs);
            let Some(&before) = self.history.get(tick as usize) else {
                return self.fail(format!("S1 tick {tick} of {index} follows no known tick"));
            };
            let state = mix_inputs(before, &inputs);
            match self.history.get(tick as usize + 1) {
                None => self.history.push(state),
                Some(&known) if known == state => {}
                Some(_) => {
                    let number = self.peers[index].session.view().number;
                    return self.fail(format!("S1 two histories at tick {tick}, {index} in view {number}"));
                }
            }
        }
        self.peers[index].seen_final = fin;
    }

    /// Checks that the final input of each seat is the one that its owner issued for the tick.
    fn check_issued(&mut self, index: usize, tick: Tick, inputs: &TickInputs) {
        let view = self.peers[index].session.view();
        let wrong =
            view.spans.iter().enumerate().filter(|(_, span)| span.contains(tick)).find(|(number, span)| {
                let owner = (0..self.peers.len()).find(|&peer| id(peer) == span.owner).expect("a peer");
                let issued = self.peers[owner].issued.get(number);
                let issued = issued.and_then(|issued| issued.get((tick - span.from) as usize));
                let (input, status) = inputs.seat(span.seat).expect("a seat of the match");
                status != InputStatus::Confirmed || issued.is_none_or(|issued| issued != input)
            });
        if let Some((number, span)) = wrong {
            self.fail(format!("S8 input of span {number}, seat {}, tick {tick} was not issued", span.seat));
        }
    }

    /// Checks that the states of confirmed ticks are those of the shared history, and that the number of kept saves is
    /// bounded.
    fn check_played(&mut self, index: usize) {
        let peer = &self.peers[index];
        let confirmed = peer.session.confirmed();
        let wrong = (peer.seen_confirmed..=confirmed)
            .find(|&tick| peer.game.states.get(tick as usize) != self.history.get(tick as usize));
        let kept = peer.game.kept();
        self.peers[index].seen_confirmed = confirmed;
        let broken = self.peers[index].game.is_broken();
        if let Some(tick) = wrong.filter(|_| !broken) {
            self.fail(format!("S1 the game of {index} has another state before tick {tick}"));
        }
        if kept > 140 {
            self.fail(format!("memory: {kept} states"));
        }
    }
}
