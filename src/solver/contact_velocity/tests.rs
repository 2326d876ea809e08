//! The warm start applies the velocity changes that contacts caused in the last sub-step. For whole worlds,
//! `world::tests` compares these changes with those that the accumulated impulses cause (`contact_velocity_error`).

use std::vec::Vec;

use super::*;
use crate::fx;
use crate::math::{Rng, Speed, Vec2, narrow};
use crate::simd::{Backend, Machine};
use crate::solver::settings::SolverSettings;
use crate::solver::{Solver, Tuning, contact};

/// Number of bodies. It is not a multiple of four or eight lanes, so that the last group is not full.
const COUNT: usize = 21;

fn with_context<T>(
    machine: Machine,
    bodies: &mut [SolverBody],
    faults: &mut Faults,
    run: impl FnOnce(&StepContext<'_>) -> T,
) -> T {
    let tuning = Tuning::new(&SolverSettings::default(), Vec2::ZERO, 60);
    run(&StepContext::new(machine, &tuning, bodies, faults))
}

fn change(bodies: &mut [SolverBody], by: &[[Speed; 3]]) {
    for (body, &[x, y, turn]) in bodies.iter_mut().zip(by) {
        body.velocity.x += x;
        body.velocity.y += y;
        body.spin += turn;
    }
}

fn change_cells(bodies: &[Cell<SolverBody>], by: &[[Speed; 3]]) {
    for (cell, by) in bodies.iter().zip(by) {
        let mut body = [cell.get()];
        change(&mut body, &[*by]);
        cell.set(body[0]);
    }
}

/// Only velocity changes by contacts are applied again.
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
        let (mut contact_velocities, mut faults) = (ContactVelocities::default(), 0);
        contact_velocities.begin(
            machine,
            (1..=COUNT)
                .map(|index| PushedBody { index: u32::try_from(index).expect("few"), shared: index > 10 }),
        );
        let by_joints = |numbers: &[[Speed; 3]]| -> Vec<[Speed; 3]> {
            // Joints change only the bodies that are marked as shared.
            numbers.iter().enumerate().map(|(i, &by)| if i > 10 { by } else { [Speed::ZERO; 3] }).collect()
        };
        let was_known = with_context(machine, &mut bodies, &mut faults, |context| {
            contact_velocities.measure(context);
            contact_velocities.apply(context)
        });
        assert!(!was_known, "there was no sub-step before");
        change(&mut bodies, &warm);
        change(&mut bodies, &pushed);
        with_context(machine, &mut bodies, &mut faults, |context| {
            contact_velocities.exempt(context, || change_cells(context.bodies, &by_joints(&joints)));
        });
        change(&mut bodies, &pushed_again);
        with_context(machine, &mut bodies, &mut faults, |context| contact_velocities.measure(context));
        change(&mut bodies, &outside);
        let mut wanted = bodies.clone();
        [warm, pushed, pushed_again].iter().for_each(|by| change(&mut wanted, by));
        assert!(with_context(machine, &mut bodies, &mut faults, |context| contact_velocities.apply(context)));
        let motions =
            |bodies: &[SolverBody]| -> Vec<_> { bodies.iter().map(|b| (b.velocity, b.spin)).collect() };
        assert_eq!(motions(&bodies), motions(&wanted), "{backend:?}");
        assert_eq!(faults, 0);
    }
}

#[test]
fn what_is_too_fast_is_a_fault() {
    let mut bodies = Vec::from([SolverBody::default(); 2]);
    let (mut contact_velocities, mut faults) = (ContactVelocities::default(), 0);
    let fast = [[Speed::ZERO; 3], [Speed::lit("300"), Speed::ZERO, Speed::ZERO]];
    let machine = Machine::default();
    contact_velocities.begin(machine, [PushedBody { index: 1, shared: false }].into_iter());
    with_context(machine, &mut bodies, &mut faults, |context| contact_velocities.apply(context));
    change(&mut bodies, &fast);
    with_context(machine, &mut bodies, &mut faults, |context| {
        contact_velocities.measure(context);
        contact_velocities.apply(context)
    });
    assert_eq!(faults, 1);
    assert_eq!(bodies[1].velocity.x, crate::solver::limits::SPEED_MAX);
}

impl Solver {
    /// Compares the velocity changes by contacts in the last sub-step with the changes that the accumulated impulses
    /// cause. Returns the largest difference and the largest change by impulses, in units of a speed.
    pub(crate) fn contact_velocity_error(&mut self, tuning: &Tuning) -> (i32, i32) {
        let Solver { list, contacts, contact_velocities, machine, faults, .. } = self;
        let context = &StepContext::new(*machine, tuning, &mut list.bodies, faults);
        contact_velocities.iter_mut().for_each(|velocities| velocities.measure(context));
        context.bodies.iter().for_each(|body| body.set(SolverBody::default()));
        for mut share in contacts.shares() {
            share.run_overflow(contact::WarmStart, context);
            share.run_coloured(contact::WarmStart, context);
        }
        let (mut error, mut largest) = (0, 0);
        let changes = self.contact_velocities.iter().flat_map(|velocities| {
            with_data!(&velocities.groups, groups => groups.iter().flat_map(Group::changes).collect::<Vec<_>>())
        });
        for (index, changes) in changes {
            let body = &self.list.bodies[index as usize];
            let rows = [body.velocity.x, body.velocity.y, body.spin].map(Speed::to_bits);
            for (row, change) in rows.into_iter().zip(changes) {
                error = error.max((row - change).abs());
                largest = largest.max(row.abs());
            }
        }
        (error, largest)
    }
}

impl<const N: usize> Group<N> {
    fn changes(&self) -> impl Iterator<Item = (u32, [i32; 3])> {
        let Group { at, change: VelocityW { x, y, turn }, .. } = self;
        at.iter().enumerate().map(|(lane, &index)| (index, [x.0[lane], y.0[lane], turn.0[lane]]))
    }
}
