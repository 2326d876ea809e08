use alloc::format;
use alloc::string::String;
use alloc::vec::Vec;
use core::fmt::Display;

use serde::{Serialize, Serializer};

use crate::body::{Arena, Body, Handle, label};
use crate::collision::Contact;
use crate::math::{Fx, Rng};
use crate::world::config::Config;
use crate::world::state::{Reported, State};

/// Serializes a state for human readers. Objects are named by their handles, contacts by the handles of their shapes.
pub(super) struct StateView<'a>(pub(super) &'a State);

impl Serialize for StateView<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        // Destructures without `..`, so that a new field causes a compile error until it is in the view.
        let State {
            config,
            tick,
            faults,
            bodies,
            shapes,
            joints,
            islands,
            contacts,
            sleeping_contacts,
            pairs_left_out,
            edited_contacts,
            rng,
        } = self.0;
        let contact = |contact| (self.name(contact), contact);
        Sections {
            settings: config,
            tick: *tick,
            faults: *faults,
            bodies: Entries(|| {
                bodies
                    .iter()
                    .map(|(id, body)| (format!("body {}", label(id, body.name())), BodyView::of(body)))
            }),
            shapes: Entries(|| shapes.iter().map(|(id, shape)| (format!("shape {id}"), shape))),
            joints: Entries(|| joints.iter().map(|(id, joint)| (format!("joint {id}"), joint))),
            contacts: Entries(|| contacts.iter().map(contact)),
            sleeping_contacts: Entries(|| sleeping_contacts.iter().map(contact)),
            pairs_left_out: *pairs_left_out,
            edited_contacts,
            islands: Entries(|| islands.iter().map(|(id, island)| (format!("island {id}"), island))),
            random: rng,
            vacant: VacantSlots {
                bodies: Vacant::of(bodies),
                shapes: Vacant::of(shapes),
                joints: Vacant::of(joints),
                islands: Vacant::of(islands),
            },
        }
        .serialize(serializer)
    }
}

impl StateView<'_> {
    fn name(&self, contact: &Contact) -> String {
        let (a, b) = contact.shapes;
        let shapes = &self.0.shapes;
        format!("shapes {} and {}", shapes.handle_at(a), shapes.handle_at(b))
    }
}

#[derive(Serialize)]
struct Sections<'a, B, S, J, C, R, I> {
    settings: &'a Config,
    tick: u64,
    faults: u64,
    bodies: B,
    shapes: S,
    joints: J,
    contacts: C,
    sleeping_contacts: R,
    pairs_left_out: bool,
    edited_contacts: &'a [Reported],
    islands: I,
    random: &'a Rng,
    vacant: VacantSlots,
}

/// A function that returns key-value pairs, which are serialized as a map in the order of the iterator.
struct Entries<F>(F);

impl<F, I, V> Serialize for Entries<F>
where
    F: Fn() -> I,
    I: Iterator<Item = (String, V)>,
    V: Serialize,
{
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map((self.0)())
    }
}

/// A body, and its angular velocity in rad/s (`Body::spin` is scaled).
#[derive(Serialize)]
struct BodyView<'a> {
    #[serde(flatten)]
    body: &'a Body,
    angular_velocity: Fx,
}

impl<'a> BodyView<'a> {
    fn of(body: &'a Body) -> Self {
        BodyView { body, angular_velocity: body.angular_velocity() }
    }
}

#[derive(Serialize)]
struct VacantSlots {
    bodies: Vacant,
    shapes: Vacant,
    joints: Vacant,
    islands: Vacant,
}

#[derive(Serialize)]
struct Vacant {
    /// Handles of the free slots. Added values get them from the end of the list.
    free: Vec<String>,
    /// Number of slots that cannot be used again, because they have no generation numbers left.
    used_up: u32,
}

impl Vacant {
    fn of<T, H: Handle + Display>(arena: &Arena<T, H>) -> Self {
        let free = arena.free_handles().map(|handle| format!("{handle}")).collect();
        Vacant { free, used_up: arena.retired() }
    }
}
