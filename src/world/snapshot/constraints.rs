//! Packed contacts and joints.
//!
//! Each contact has a head of 8 bytes: slot of shape A (30 bits), slot of shape B (29 bits), touching (1 bit), passing
//! (1 bit), number of points (2 bits), whether it has points or a rolling impulse (1 bit). For each contact with this
//! last bit, a second buffer has 80 bytes: normal and tangential impulse of both points and the rolling impulse (5 x
//! i32), feature ids of both points (2 x u16), the kept manifold (14 x i32).
//!
//! Each joint takes one byte of flags, then those of its six impulses that are not 0 (i32 each), then its count of
//! whole turns (i32 or i64). Bit `i` of the flags is set if impulse `i` is not 0. Bit 6 is set if the count takes 8
//! bytes.

use alloc::vec::Vec;

use super::packing::{Fields, Reader, Record, Writer, low_half, put_records};
use crate::body::{Arena, JointId};
use crate::collision::{Contact, KeptManifold, PointImpulse};
use crate::math::Speed;
use crate::solver::Joint;

const HEAD_BYTES: usize = 8;
const IMPULSES_BYTES: usize = 24 + 4 * KeptManifold::WORDS;
const JOINT_BYTES: usize = 1 + 6 * 4 + 8;
const MANY_TURNS: u8 = 1 << 6;
const JOINT_IMPULSES: u8 = 6;

pub(super) fn pack_contacts(contacts: &[Contact], heads: &mut Vec<u8>, impulses: &mut Vec<u8>) {
    let mut impulses = Writer::new(impulses, contacts.len() * IMPULSES_BYTES);
    put_records(heads, contacts.len(), contacts, |contact, record: &mut Record<'_, HEAD_BYTES>| {
        record.put(head(contact));
        if has_impulses(contact) {
            impulses.record(|record: &mut Record<'_, IMPULSES_BYTES>| {
                for point in &contact.points {
                    record.put(point.normal.to_bits());
                    record.put(point.tangent.to_bits());
                }
                record.put(contact.rolling.to_bits());
                contact.points.iter().for_each(|point| record.put(point.feature));
                contact.kept.to_words().into_iter().for_each(|word| record.put(word));
            });
        }
    });
}

fn has_impulses(contact: &Contact) -> bool {
    contact.count != 0 || contact.rolling != 0
}

/// Packs the head of a contact. Slots are below 2^21, so 29 bits are enough for each.
fn head(contact: &Contact) -> u64 {
    let (a, b) = contact.shapes;
    u64::from(a) << 34
        | u64::from(b) << 5
        | u64::from(contact.touching) << 4
        | u64::from(contact.passing) << 3
        | u64::from(contact.count.min(3)) << 1
        | u64::from(has_impulses(contact))
}

pub(super) fn unpack_contacts(contacts: &mut Vec<Contact>, heads: &[u8], impulses: &[u8]) {
    let (mut heads, mut impulses) = (Reader(heads), Reader(impulses));
    contacts.clear();
    contacts.reserve(heads.0.len() / HEAD_BYTES);
    while !heads.is_empty() {
        contacts.push(unpack_contact(heads.record(), &mut impulses));
    }
}

#[expect(clippy::cast_possible_truncation, reason = "masked to the bits that were packed")]
#[inline(always)]
fn unpack_contact(mut head: Fields<'_, HEAD_BYTES>, impulses: &mut Reader<'_>) -> Contact {
    let head: u64 = head.take();
    let bits = |shift: u32, count: u32| head >> shift & ((1 << count) - 1);
    let mut contact = Contact::new((bits(34, 30) as u32, bits(5, 29) as u32));
    contact.touching = bits(4, 1) != 0;
    contact.passing = bits(3, 1) != 0;
    contact.count = bits(1, 2) as u8;
    if bits(0, 1) != 0 {
        let mut impulses: Fields<'_, IMPULSES_BYTES> = impulses.record();
        for point in &mut contact.points {
            let (normal, tangent) = (Speed::from_bits(impulses.take()), Speed::from_bits(impulses.take()));
            *point = PointImpulse { feature: 0, normal, tangent };
        }
        contact.rolling = Speed::from_bits(impulses.take());
        contact.points.iter_mut().for_each(|point| point.feature = impulses.take());
        contact.kept = KeptManifold::from_words(core::array::from_fn(|_| impulses.take()));
    }
    contact
}

/// A copy of a joint with zero impulses and 0 turns. Ticks change both, so they are packed with every snapshot.
pub(super) fn lasting_joint(joint: &Joint) -> Joint {
    Joint::new(*joint.def)
}

pub(super) fn pack_joints(joints: &Arena<Joint, JointId>, bytes: &mut Vec<u8>) {
    let mut writer = Writer::new(bytes, joints.len() * JOINT_BYTES);
    for (_, joint) in joints.iter() {
        let mut there = 0;
        // Stores every impulse, but advances `count` only if the impulse is not 0, so that the next word overwrites an
        // impulse of 0. This avoids a branch that the processor would predict badly.
        let (mut words, mut count) = ([0i32; 8], 0);
        for (place, impulse) in (0..JOINT_IMPULSES).zip(joint.impulses.0) {
            let bits = impulse.to_bits();
            words[count] = bits;
            count += usize::from(bits != 0);
            there |= u8::from(bits != 0) << place;
        }
        let [low, high] = halves(joint.turns);
        words[count] = low;
        count += 1;
        if joint.turns != i64::from(low) {
            there |= MANY_TURNS;
            words[count] = high;
            count += 1;
        }
        writer.record(|record: &mut Record<'_, JOINT_BYTES>| {
            record.put(there);
            words.into_iter().for_each(|word| record.put(word));
            record.truncate(1 + count * size_of::<i32>());
        });
    }
}

fn halves(turns: i64) -> [i32; 2] {
    [low_half(turns), low_half(turns >> u32::BITS)]
}

pub(super) fn unpack_joints(joints: &mut Arena<Joint, JointId>, bytes: &[u8]) {
    let mut reader = Reader(bytes);
    for (_, joint) in joints.iter_mut() {
        let there: u8 = reader.record::<1>().take();
        let mut word = || -> i32 { reader.record::<4>().take() };
        for (place, impulse) in (0..JOINT_IMPULSES).zip(&mut joint.impulses.0) {
            let some = there >> place & 1 != 0;
            *impulse = if some { Speed::from_bits(word()) } else { Speed::ZERO };
        }
        let low = word();
        joint.turns = i64::from(low);
        if there & MANY_TURNS != 0 {
            joint.turns = i64::from(word()) << 32 | (joint.turns & 0xffff_ffff);
        }
    }
}
