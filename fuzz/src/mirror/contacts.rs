//! Contacts, sleeping contacts, and contacts that have ended.

use serde::{Deserialize, Serialize};

use super::{Handle, IMPULSE_MAX, State, speed};
use crate::source::Source;

#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Point {
    feature: u16,
    normal: i32,
    tangent: i32,
}

type Vector = [i32; 2];

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
struct KeptManifold {
    normal: Vector,
    arm_a: Vector,
    arm_b: Vector,
    to_second: Vector,
    between: Vector,
    angles: [u32; 2],
    separations: [i32; 2],
}

impl KeptManifold {
    /// Normals to draw from. The world accepts the zero vector and unit vectors, and so refuses the last two.
    const NORMALS: [Vector; 6] = [
        [0, 0],
        [0, 1 << 30],
        [-(1 << 30), 0],
        [759_250_125, 759_250_125],
        [1 << 30, 1 << 30],
        [i32::MIN, 1],
    ];

    fn alter(&mut self, source: &mut Source<'_>) {
        if source.one_in(2) {
            self.normal = source.pick(&Self::NORMALS);
        }
        let KeptManifold { normal: _, arm_a, arm_b, to_second, between, angles, separations } = self;
        for vector in [arm_a, arm_b, to_second, between, separations] {
            let small = source.one_in(2);
            for number in vector {
                let word = source.word() as i32;
                *number = if small { number.wrapping_add(word >> 16) } else { word };
            }
        }
        for angle in angles {
            *angle = angle.wrapping_add(source.word() as u32 >> source.below(32));
        }
    }

    /// Sets the values that belong to points beyond `count` to zero.
    fn cut(&mut self, count: u8) {
        match count {
            0 => *self = KeptManifold::default(),
            1 => (self.to_second, self.separations[1]) = ([0; 2], 0),
            _ => {}
        }
    }
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Contact {
    pub(super) shapes: (u32, u32),
    touching: bool,
    passing: bool,
    count: u8,
    points: [Point; 2],
    kept: KeptManifold,
    rolling: i32,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Reported {
    shapes: (Handle, Handle),
    sensor: Option<Side>,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
enum Side {
    A,
    B,
    Both,
}

impl State {
    pub(super) fn alter_contact(&mut self, source: &mut Source<'_>) -> Option<()> {
        let rests = source.one_in(3);
        if source.one_in(6) {
            return self.alter_sleeping_contacts(source);
        }
        let (a, b) = (self.shapes.pick(source)? as u32, self.shapes.pick(source)? as u32);
        let contacts = if rests { &mut self.sleeping_contacts } else { &mut self.contacts };
        let at = source.below(contacts.len());
        match source.below(9) {
            0 => {
                let shapes = (a.min(b), a.max(b));
                let at = contacts.binary_search_by_key(&shapes, |contact| contact.shapes).err()?;
                let (touching, passing) = (source.one_in(2), source.one_in(4));
                let points = Default::default();
                let kept = KeptManifold::default();
                let contact = Contact { shapes, touching, passing, count: 0, points, kept, rolling: 0 };
                contacts.insert(at, contact);
            }
            _ if contacts.is_empty() => return None,
            1 => drop(contacts.remove(at)),
            2 => contacts[at].touching = !contacts[at].touching,
            3 => contacts[at].passing = !contacts[at].passing,
            4 => contacts[at].rolling = speed(source, IMPULSE_MAX),
            5 => {
                let contact = &mut contacts[at];
                contact.kept.alter(source);
                if !source.one_in(4) {
                    contact.kept.cut(contact.count);
                }
            }
            _ => {
                let contact = &mut contacts[at];
                contact.count = source.byte() % 3;
                contact.points = Default::default();
                for point in &mut contact.points[..contact.count.into()] {
                    let feature = if source.one_in(2) { source.word() as u16 } else { source.byte().into() };
                    let normal = source.within(0, IMPULSE_MAX) as i32;
                    *point = Point { feature, normal, tangent: speed(source, IMPULSE_MAX) };
                }
                contact.kept.cut(contact.count);
            }
        }
        Some(())
    }

    /// Moves an active contact to the sleeping contacts, or a sleeping contact to the active ones, so that it is in the
    /// wrong list.
    fn alter_sleeping_contacts(&mut self, source: &mut Source<'_>) -> Option<()> {
        let (from, to) = match source.one_in(2) {
            true => (&mut self.contacts, &mut self.sleeping_contacts),
            false => (&mut self.sleeping_contacts, &mut self.contacts),
        };
        let at = source.below(from.len());
        let moved = (!from.is_empty()).then(|| from.remove(at))?;
        let at = to.binary_search_by_key(&moved.shapes, |contact| contact.shapes).err()?;
        to.insert(at, moved);
        Some(())
    }

    pub(super) fn alter_removed(&mut self, source: &mut Source<'_>) {
        let a = self.shapes.pick(source).map_or((source.byte().into(), 0), |a| self.shapes.handle(a));
        let b = (source.below(300) as u32, source.within(0, u32::MAX.into()) as u32);
        let sensor = source.pick(&[None, Some(Side::A), Some(Side::B), Some(Side::Both)]);
        self.removed_contacts.push(Reported { shapes: (a, b), sensor });
    }
}
