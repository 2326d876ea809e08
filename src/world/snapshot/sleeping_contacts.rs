//! Sleeping contacts. After a change of the list, the next snapshot packs it, and all further snapshots share this
//! packed form until the list changes again.

use alloc::boxed::Box;
use alloc::sync::Arc;
use alloc::vec::Vec;
use core::ops::{Deref, DerefMut};

use once_cell::race::OnceBox;
use serde::{Deserialize, Serialize};

use super::constraints::{pack_contacts, unpack_contacts};
use crate::collision::Contact;
use crate::hash::StateHash;

/// Contacts without an active body, sorted by pair, and their cached packed form. Mutable access drops the packed form.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(transparent)]
pub(crate) struct SleepingContacts {
    contacts: Vec<Contact>,
    #[serde(skip)]
    packed: OnceBox<Arc<PackedContacts>>,
}

#[derive(Debug, Default, PartialEq)]
pub(super) struct PackedContacts {
    heads: Vec<u8>,
    impulses: Vec<u8>,
    pub(super) digest: StateHash,
}

impl PackedContacts {
    fn of(contacts: &[Contact]) -> Self {
        let (mut heads, mut impulses) = (Vec::new(), Vec::new());
        pack_contacts(contacts, &mut heads, &mut impulses);
        let digest = StateHash::of_digests([&heads, &impulses].map(|bytes| StateHash::of_bytes(bytes)));
        PackedContacts { heads, impulses, digest }
    }
}

impl SleepingContacts {
    pub(super) fn share(&self) -> Arc<PackedContacts> {
        let pack = || PackedContacts::of(&self.contacts);
        let packed = self.packed.get_or_init(|| Box::new(Arc::new(pack())));
        debug_assert_eq!(**packed, pack(), "sleeping contacts have changed since they were packed");
        packed.clone()
    }

    pub(super) fn restore(&mut self, packed: &Arc<PackedContacts>) {
        if !self.packed.get().is_some_and(|known| Arc::ptr_eq(known, packed)) {
            unpack_contacts(&mut self.contacts, &packed.heads, &packed.impulses);
            self.packed = OnceBox::with_value(Box::new(packed.clone()));
        }
    }
}

impl PartialEq for SleepingContacts {
    fn eq(&self, other: &Self) -> bool {
        self.contacts == other.contacts
    }
}

impl Deref for SleepingContacts {
    type Target = Vec<Contact>;

    fn deref(&self) -> &Vec<Contact> {
        &self.contacts
    }
}

impl DerefMut for SleepingContacts {
    fn deref_mut(&mut self) -> &mut Vec<Contact> {
        self.packed = OnceBox::new();
        &mut self.contacts
    }
}
