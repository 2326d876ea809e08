//! After the links of a match have healed, all living peers play and finish the match.

use super::sim::{MS, S, Sim, id};
use super::storm::{Class, Figures, HEAL, Match, SEATED};

impl Match {
    /// Ends the disturbances, and measures the time until all peers have their seats.
    pub(super) fn heal(&mut self, figures: &mut Figures) {
        if self.class.is_storm() {
            self.sim.late = 0;
            self.sim.assassin = 0;
            for link in self.sim.links.iter_mut().flatten() {
                link.loss = link.loss.min(15);
            }
        }
        let mut at = HEAL;
        let settling = |game: &Self| {
            game.all_seated() == Some(false) || game.all_seated().is_none() && game.sim.now < HEAL + S
        };
        while at < HEAL + SEATED && !self.class.ends_early() && settling(self) {
            at += 50 * MS;
            if !self.run(at) {
                return;
            }
        }
        figures.healed = at - HEAL;
    }

    /// Peers that run, do not leave and were not kicked.
    pub(super) fn alive(&self) -> Vec<usize> {
        let alive = |&index: &usize| {
            let peer = &self.sim.peers[index];
            peer.on && !peer.leaves && !peer.kicked
        };
        (0..self.total).filter(alive).collect()
    }

    /// Whether all living peers have seats in the newest view. `None` if some of them cannot reach each other, or if
    /// they are no quorum.
    pub(super) fn all_seated(&self) -> Option<bool> {
        let alive = self.alive();
        let first = *alive.first()?;
        // Views that only crashed peers have installed do not count. The newest view of the living peers does.
        let views = alive.iter().map(|&index| self.sim.peers[index].session.view());
        let view = views.max_by_key(|view| view.number)?;
        let reach = self.sim.reach(first);
        if alive.iter().any(|&index| reach >> index & 1 == 0) {
            return None;
        }
        if !view.is_quorum(Sim::voters_among(view, alive.iter().copied())) {
            return None;
        }
        Some(alive.iter().all(|&index| {
            let peer = &self.sim.peers[index];
            let current = peer.session.view().number == view.number;
            current && (peer.spectator || view.voter(id(index)).is_some())
        }))
    }

    pub(super) fn check_healed(&mut self, figures: &mut Figures) {
        let lost: u32 = self.sim.peers.iter().map(|peer| peer.lost_seats).sum();
        if self.class == Class::ShortOutages && lost > 0 {
            self.sim.fail(format!("S5 {lost} seats lost in short outages"));
        }
        match self.all_seated() {
            None => figures.no_quorum = 1,
            Some(true) => {}
            Some(false) if self.class.ends_early() => {}
            Some(false) => {
                let what = self.describe();
                self.sim.fail(format!("L1 not all are seated: {what}"));
            }
        }
    }

    pub(super) fn describe(&self) -> String {
        let line = |index: usize| {
            let peer = &self.sim.peers[index];
            let view = peer.session.view();
            format!(
                "{index}: on {} {:?} view {} complete {} final {} played {}",
                peer.on,
                peer.session.status(),
                view.number,
                peer.session.complete_tick(),
                peer.session.final_tick(),
                peer.session.played()
            )
        };
        (0..self.total).map(line).collect::<Vec<_>>().join(" | ")
    }

    /// A living peer that has confirmed fewer than two ticks since `before`, although all living peers have their
    /// seats.
    pub(super) fn stands_still(&self, before: &[u32]) -> Option<usize> {
        if self.class.ends_early() || self.all_seated() != Some(true) {
            return None;
        }
        self.alive().into_iter().find(|&index| self.sim.peers[index].session.confirmed() < before[index] + 2)
    }

    pub(super) fn check_finished(&mut self) {
        let ends: Vec<_> = self.sim.peers.iter().filter_map(|peer| peer.finished).collect();
        if ends.windows(2).any(|pair| pair[0] != pair[1]) {
            self.sim.fail(format!("S4 ends differ: {ends:?}"));
        }
        let able = |&index: &usize| self.sim.peers[index].on || self.sim.peers[index].finished.is_some();
        let able = (0..self.total).filter(able);
        let views = able.clone().map(|index| self.sim.peers[index].session.view());
        let Some(view) = views.max_by_key(|view| view.number).cloned() else { return };
        let quorum = view.is_quorum(Sim::voters_among(&view, able));
        if view.end.is_none() || !quorum {
            return;
        }
        for index in self.alive() {
            let peer = &self.sim.peers[index];
            let reached = Sim::voters_among(
                &view,
                (0..self.total).filter(|&other| self.sim.reach(index) >> other & 1 == 1),
            );
            let should = view.voter(id(index)).is_some() && view.is_quorum(reached);
            if should && peer.finished.is_none() {
                let what = self.describe();
                self.sim.fail(format!("L3 {index} has not finished: {what}"));
                return;
            }
        }
    }
}
