//! Whether the account is right. Of whole worlds the tests of `scenes` ask for `push_error`.

use std::vec::Vec;

use super::*;
use crate::fx;
use crate::lanes::Backend;
use crate::math::{Rng, Speed, narrow};
use crate::solver::{Solver, Task as ContactTask, Tuning};

/// Not a multiple of the lanes, so that the last group is not full.
const COUNT: usize = 21;

fn change(bodies: &mut [SolverBody], by: &[[Speed; 3]]) {
    for (body, &[x, y, turn]) in bodies.iter_mut().zip(by) {
        body.velocity.x += x;
        body.velocity.y += y;
        body.spin += turn;
    }
}

/// What contacts have changed in a sub-step is changed again in the next one, and nothing else is.
#[test]
fn what_contacts_have_changed_is_changed_again() {
    let mut rng = Rng::new(7);
    for backend in Backend::available() {
        let machine = Machine::new(backend).expect("available");
        let mut random = || -> Vec<[Speed; 3]> {
            (0..=COUNT)
                .map(|i| {
                    [0; 3].map(|_| if i == 0 { Speed::ZERO } else { narrow(rng.range(fx!(-30), fx!(30))) })
                })
                .collect()
        };
        let [start, warm, pushed, joints, pushed_again, outside] = [0; 6].map(|_| random());
        let mut bodies = Vec::from([SolverBody::default(); COUNT + 1]);
        change(&mut bodies, &start);
        let (mut pushes, mut faults) = (Pushes::default(), 0);
        pushes.begin((1..=COUNT).map(|index| (u32::try_from(index).expect("few"), index > 10)));
        let mut perform = |task, bodies: &mut Vec<SolverBody>| {
            pushes.perform(task, machine, SolverBody::cells(bodies), &mut faults);
        };
        let by_joints = |numbers: &[[Speed; 3]]| -> Vec<[Speed; 3]> {
            // Those in groups that nothing else changes are left alone.
            numbers.iter().enumerate().map(|(i, &by)| if i > 10 { by } else { [Speed::ZERO; 3] }).collect()
        };
        perform(Task::Measure, &mut bodies);
        perform(Task::Apply, &mut bodies);
        change(&mut bodies, &warm);
        change(&mut bodies, &pushed);
        perform(Task::Suspend, &mut bodies);
        change(&mut bodies, &by_joints(&joints));
        perform(Task::Resume, &mut bodies);
        change(&mut bodies, &pushed_again);
        perform(Task::Measure, &mut bodies);
        change(&mut bodies, &outside);
        let mut wanted = bodies.clone();
        [warm, pushed, pushed_again].iter().for_each(|by| change(&mut wanted, by));
        perform(Task::Apply, &mut bodies);
        let motions =
            |bodies: &[SolverBody]| -> Vec<_> { bodies.iter().map(|b| (b.velocity, b.spin)).collect() };
        assert_eq!(motions(&bodies), motions(&wanted), "{backend:?}");
        assert_eq!(faults, 0);
    }
}

/// A push that is too fast for a body is cut short, and counted.
#[test]
fn what_is_too_fast_is_a_fault() {
    let mut bodies = Vec::from([SolverBody::default(); 2]);
    let (mut pushes, mut faults) = (Pushes::default(), 0);
    pushes.begin([(1, false)].into_iter());
    let fast = [[Speed::ZERO; 3], [Speed::lit("300"), Speed::ZERO, Speed::ZERO]];
    let mut perform = |task, bodies: &mut Vec<SolverBody>| {
        pushes.perform(task, Machine::default(), SolverBody::cells(bodies), &mut faults);
    };
    perform(Task::Apply, &mut bodies);
    change(&mut bodies, &fast);
    perform(Task::Measure, &mut bodies);
    perform(Task::Apply, &mut bodies);
    assert_eq!(faults, 1);
    assert_eq!(bodies[1].velocity.x, crate::solver::limits::SPEED_MAX);
}

impl Solver {
    /// By how much what contacts have pushed in the last sub-step differs at most from what the impulses in their rows
    /// amount to, in units of a speed, and how much that is.
    pub(crate) fn push_error(&mut self, tuning: &Tuning) -> (i32, i32) {
        self.push(Task::Measure);
        self.list.bodies.fill(SolverBody::default());
        self.perform_serial(ContactTask::WarmStart, tuning);
        self.perform_coloured(ContactTask::WarmStart, tuning);
        let (mut error, mut largest) = (0, 0);
        for group in &self.pushes.groups {
            for (lane, &index) in group.at.iter().enumerate() {
                let body = &self.list.bodies[index as usize];
                let rows = [body.velocity.x, body.velocity.y, body.spin].map(Speed::to_bits);
                let Motion { x, y, turn } = &group.push;
                for (row, push) in rows.into_iter().zip([x.0[lane], y.0[lane], turn.0[lane]]) {
                    error = error.max((row - push).abs());
                    largest = largest.max(row.abs());
                }
            }
        }
        (error, largest)
    }
}
