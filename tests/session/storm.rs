//! Random matches. A seed determines peers, links and disturbances. All links heal after 20 s. Peers that still take
//! part, are connected and are a quorum of the newest view then have to play and to finish the match.

use lockstep2d::session::{Config, Role, Timing, View};

use super::game::mix;
use super::sim::{LinkConditions, MS, Rng, S, Sim, Us, id, key};

/// Kind of a match, given by the last digit of the seed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Class {
    ShortOutages,
    Partitions,
    OneWay,
    Crashes,
    Stalls,
    JoinsAndLeaves,
    Everything,
    EndInTheMiddle,
    Storm,
    StormWithEnd,
}

const CLASSES: [Class; 10] = [
    Class::ShortOutages,
    Class::Partitions,
    Class::OneWay,
    Class::Crashes,
    Class::Stalls,
    Class::JoinsAndLeaves,
    Class::Everything,
    Class::EndInTheMiddle,
    Class::Storm,
    Class::StormWithEnd,
];

/// Faults of the network or of a process, and actions of players.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Trouble {
    Halves,
    Quarters,
    DeafOrMute,
    Crash,
    Stall,
    Leave,
    Links,
    Join(usize),
    End,
    Kick,
    GoOn,
    Delay,
}

use Trouble::{Crash, DeafOrMute, Delay, GoOn, Halves, Kick, Leave, Links, Quarters, Stall};

impl Class {
    fn troubles(self) -> &'static [Trouble] {
        match self {
            Class::ShortOutages => &[Halves, Quarters, DeafOrMute, Stall, Delay],
            Class::Partitions => &[Halves, Quarters],
            Class::OneWay => &[DeafOrMute],
            Class::Crashes => &[Crash, Halves],
            Class::Stalls => &[Stall, Halves],
            Class::JoinsAndLeaves => &[Links, Leave, Halves, Kick, GoOn],
            Class::Everything | Class::EndInTheMiddle => {
                &[Halves, Quarters, DeafOrMute, Crash, Stall, Leave, Links, DeafOrMute, Halves, Delay, GoOn]
            }
            Class::Storm | Class::StormWithEnd => &[
                Halves, Quarters, DeafOrMute, Stall, Links, DeafOrMute, Halves, Quarters, DeafOrMute, Stall,
                Links, DeafOrMute, Halves, Halves, Crash, Quarters, DeafOrMute, Halves, Leave,
            ],
        }
    }

    pub(super) fn is_storm(self) -> bool {
        matches!(self, Class::Storm | Class::StormWithEnd)
    }

    pub(super) fn ends_early(self) -> bool {
        matches!(self, Class::EndInTheMiddle | Class::StormWithEnd)
    }
}

#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Figures {
    pub(crate) ticks: u64,
    pub(crate) views: u64,
    pub(crate) packets: u64,
    pub(crate) bytes: u64,
    pub(crate) finished: u64,
    pub(crate) lost_seats: u64,
    /// Time from the healing of the links until all peers are seated again.
    pub(crate) healed: Us,
    /// 1 if no quorum of the newest view is alive and connected after the links healed.
    pub(crate) no_quorum: u64,
}

pub(super) const HEAL: Us = 20 * S;
/// Largest time from `HEAL` until all peers are seated.
pub(super) const SEATED: Us = 12 * S;
/// Time in which all seated peers should advance.
const MOVED: Us = 3 * S;
/// Events from this time on happen after the match has been checked for healing.
const LATE: Us = 100 * S;

pub(super) struct Match {
    pub(super) sim: Sim,
    pub(super) rng: Rng,
    pub(super) class: Class,
    pub(super) players: usize,
    pub(super) total: usize,
}

/// Plays a match. Returns the first violation, and figures.
pub(crate) fn play(seed: u64, configure: impl Fn(&mut Config)) -> (Option<String>, Figures) {
    let mut game = Match::new(seed, configure);
    let mut figures = Figures::default();
    game.play(&mut figures);
    let sim = &game.sim;
    figures.ticks = sim.history.len() as u64;
    figures.views = sim.views.len() as u64 - 1;
    figures.packets = sim.sent;
    figures.bytes = sim.bytes;
    figures.finished = sim.peers.iter().filter(|peer| peer.finished.is_some()).count() as u64;
    figures.lost_seats = sim.peers.iter().map(|peer| u64::from(peer.lost_seats)).sum();
    (sim.failure.clone(), figures)
}

fn timing(storm: bool, rng: &mut Rng) -> Timing {
    if !storm {
        return Timing::DEFAULT;
    }
    let fast = rng.pick(&[1, 4, 15]);
    Timing {
        patience: rng.range(300, 700) * MS,
        promises: 500 * MS / (fast * fast),
        ballot: 1500 * MS / fast,
        ..Timing::DEFAULT
    }
}

impl Match {
    fn new(seed: u64, configure: impl Fn(&mut Config)) -> Self {
        let mut rng = Rng(mix(seed, 77) | 1);
        (0..8).for_each(|_| _ = rng.next());
        let class = CLASSES[(seed % 10) as usize];
        let storm = class.is_storm();
        let players = rng.range(2, 8) as usize;
        let may_join = matches!(
            class,
            Class::ShortOutages | Class::JoinsAndLeaves | Class::Everything | Class::EndInTheMiddle
        );
        let joiners = if may_join || storm { rng.range(0, 3) as usize } else { 0 };
        let total = players + joiners;
        let mut sim = Sim::new(rng.next(), total);
        sim.late = if storm { rng.range(0, 15) } else { 0 };
        sim.assassin = if storm { rng.range(0, 25) } else { 0 };
        let base = rng.range(5, 120);
        let lossy = rng.pick(&[0, 2, 10, if storm { 40 } else { 25 }]);
        for from in 0..total {
            for to in 0..total {
                let latency = (base + rng.range(0, 60)) * MS;
                let jitter = latency / 4;
                sim.links[from][to] =
                    LinkConditions { exists: true, latency, jitter, loss: rng.range(0, lossy), cut_until: 0 };
            }
        }
        if rng.percent(30) && total > 2 {
            sparse(&mut sim, total, &mut rng);
        }
        let mut first = View::opened_by(id(0), key(0), 0, true);
        first.voters.clear();
        let mut seat = 0;
        for index in 0..players {
            // Some peers have two local players.
            let seats = if rng.percent(10) { 3 } else { 1 };
            first.found(id(index), key(index), 1, seats << seat);
            seat += if seats == 3 { 2 } else { 1 };
        }
        let mut config = Config::new(seed, (seat + joiners).min(64) as u8);
        let tick = rng.pick(&[50, 100, 100]);
        sim.look = tick * MS;
        config.tick_micros = tick as u32 * 1000;
        config.timing = timing(storm, &mut rng);
        configure(&mut config);
        config.guess = rng.pick(&[0, 0, 3, 8]);
        config.save_interval = rng.pick(&[1, 1, 4, 8]);
        config.check_interval = 8;
        for index in 0..total {
            let mut config = config.clone();
            config.delay_min = rng.range(0, 4) as u16;
            config.delay_max = config.delay_min + rng.pick(&[0, 6]);
            let spectates = index >= players && rng.percent(25);
            let role = if spectates { Role::Spectator } else { Role::Player { seats: 1 } };
            let skew = rng.range(970, 1030);
            sim.add(config, role, &first, skew);
        }
        let mut game = Match { sim, rng, class, players, total };
        for index in 0..players {
            let at = game.rng.range(0, 60) * MS;
            game.sim.start(index, at);
        }
        game
    }

    fn play(&mut self, figures: &mut Figures) {
        let mut events = self.plan();
        events.sort_unstable();
        let (before, after): (Vec<_>, Vec<_>) = events.into_iter().partition(|event| event.0 <= HEAL);
        for (at, trouble, duration, random) in before {
            if !self.run(at) {
                return;
            }
            self.cause(trouble, (at + duration).min(HEAL), random);
        }
        if !self.run(HEAL) {
            return;
        }
        self.heal(figures);
        self.check_healed(figures);
        let now = self.sim.now;
        let finals: Vec<u32> = self.sim.peers.iter().map(|peer| peer.session.confirmed()).collect();
        // After a crash, the other peers stop for `patience` and a change of the view.
        for wait in [MOVED, 3 * MOVED, 5 * MOVED] {
            if !self.run(now + wait) {
                return;
            }
            if self.stands_still(&finals).is_none() {
                break;
            }
        }
        if let Some(index) = self.stands_still(&finals) {
            let what = self.describe();
            self.sim.fail(format!("L2 {index} does not move from {}: {what}", finals[index]));
        }
        // The remaining events end the match.
        let shift = self.sim.now;
        for (at, trouble, _, random) in after {
            if !self.run(shift + at - LATE) {
                return;
            }
            self.cause(trouble, 0, random);
        }
        for _ in 0..30 {
            let now = self.sim.now;
            if !self.run(now + S) {
                return;
            }
            if self.sim.peers.iter().all(|peer| !peer.on) {
                break;
            }
        }
        self.check_finished();
    }

    pub(super) fn run(&mut self, until: Us) -> bool {
        self.sim.run(until);
        self.sim.failure.is_none()
    }

    fn plan(&mut self) -> Vec<(Us, Trouble, Us, u64)> {
        let rng = &mut self.rng;
        let storm = self.class.is_storm();
        let kinds = self.class.troubles();
        let mut events = Vec::new();
        let count = if storm { rng.range(8, 40) } else { rng.range(1, 6) };
        for number in 0..count {
            let kind = rng.pick(kinds);
            let short = self.class == Class::ShortOutages;
            let duration = match (short, storm) {
                (true, _) => rng.range(100, 1600),
                (_, true) => rng.range(50, 1800),
                _ => rng.pick(&[300, 1500, 2500, 4000, 8000]) + rng.range(0, 900),
            };
            let last = !short && rng.percent(40);
            let second = if short {
                2 + 3 * number
            } else if last {
                17
            } else {
                rng.range(2, 14)
            };
            let duration = if last && rng.percent(60) { 3000 } else { duration };
            events.push((second * S + rng.range(0, 999) * MS, kind, duration * MS, rng.next()));
        }
        for joiner in self.players..self.total {
            events.push((rng.range(2, 14) * S, Trouble::Join(joiner), 0, 0));
        }
        let end = if self.class.ends_early() { rng.range(4, 18) * S + rng.range(0, 999) * MS } else { LATE };
        events.push((end, Trouble::End, 0, rng.next()));
        if rng.percent(30) {
            events.push((end + rng.range(0, 300) * MS, Trouble::End, 0, rng.next()));
        }
        events
    }

    fn cause(&mut self, trouble: Trouble, until: Us, random: u64) {
        let pick = (random % self.players as u64) as usize;
        match trouble {
            Halves => self.cut(until, |_, a, b| (random >> a ^ random >> b) & 1 == 1),
            Quarters => self.cut(until, |_, a, b| (random >> (2 * a) ^ random >> (2 * b)) & 3 != 0),
            DeafOrMute => {
                let mode = random / 64 % 4;
                self.cut(until, |rng, a, b| {
                    a == pick && mode != 1 || b == pick && mode != 0 || mode == 3 && rng.percent(30)
                });
            }
            Links => self.cut(until, |rng, _, _| rng.percent(15)),
            Crash => {
                if self.rng.percent(70) {
                    self.sim.peers[pick].on = false;
                }
            }
            Stall => self.sim.peers[pick].stopped_until = until,
            Leave => {
                if self.sim.peers[pick].on {
                    self.sim.peers[pick].leaves = true;
                    self.sim.peers[pick].session.leave();
                }
            }
            Trouble::Join(joiner) => {
                for other in (0..self.total).filter(|&other| other != joiner) {
                    self.sim.introduce(joiner, other);
                }
                let now = self.sim.now;
                self.sim.start(joiner, now);
            }
            Trouble::End => self.end(random),
            Kick => {
                if self.players > 2 && self.rng.percent(30) {
                    let by = self.tie_holder();
                    if by != pick {
                        self.sim.peers[pick].kicked = true;
                        self.sim.peers[by].session.kick(key(pick));
                    }
                }
            }
            GoOn => {
                let by = self.tie_holder();
                if by != pick {
                    self.sim.peers[by].session.go_on_without(id(pick));
                }
            }
            Delay => {
                let least = self.rng.range(0, 5) as u16;
                let guess = self.rng.pick(&[0, 2, 6]);
                self.sim.peers[pick].session.set_delay(least, least + 5);
                self.sim.peers[pick].session.set_guess(guess);
            }
        }
    }

    fn tie_holder(&self) -> usize {
        let holder = self.sim.newest_view().tie_holder;
        (0..self.total).find(|&index| id(index) == holder).unwrap_or(0)
    }

    fn cut(&mut self, until: Us, mut is_cut: impl FnMut(&mut Rng, usize, usize) -> bool) {
        for from in 0..self.total {
            for to in (0..self.total).filter(|&to| to != from) {
                if is_cut(&mut self.rng, from, to) {
                    let link = &mut self.sim.links[from][to];
                    link.cut_until = link.cut_until.max(until);
                }
            }
        }
    }

    fn end(&mut self, random: u64) {
        let able = |&index: &usize| {
            let peer = &self.sim.peers[index];
            peer.on && !peer.leaves && peer.session.seats() != 0
        };
        let able: Vec<usize> = (0..self.total).filter(able).collect();
        if let Some(&index) = able.get((random as usize) % able.len().max(1)) {
            let played = self.sim.peers[index].session.played();
            self.sim.peers[index].session.end_at(played + 10 + (random % 20) as u32);
        }
    }
}

/// Removes random links, but keeps all peers connected.
fn sparse(sim: &mut Sim, total: usize, rng: &mut Rng) {
    let mut set = |a: usize, b: usize, exists: bool| {
        sim.links[a][b].exists = exists;
        sim.links[b][a].exists = exists;
    };
    for a in 0..total {
        (0..a).for_each(|b| set(a, b, false));
    }
    for a in 1..total {
        set(a, rng.range(0, a as u64 - 1) as usize, true);
        for b in 0..a {
            if rng.percent(30) {
                set(a, b, true);
            }
        }
    }
}
