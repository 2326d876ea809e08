//! The web page: reads its address (`?server=ws://HOST:PORT#ROOM`), and shows the state of the match in its element
//! `status`.

use bevy::prelude::*;
use lockstep2d::peer::PeerIdentity;

use crate::Arguments;

/// Name under which the storage of the tab keeps the key of the player's identity.
const IDENTITY: &str = "identity";

pub fn arguments() -> Arguments {
    let location = web_sys::window().map(|window| window.location());
    let part = |part: Option<String>| part.filter(|text| text.len() > 1).map(|text| text[1..].to_string());
    let search = part(location.as_ref().and_then(|location| location.search().ok()));
    let server = search.as_deref().and_then(|search| search.strip_prefix("server=")).map(String::from);
    let room = part(location.and_then(|location| location.hash().ok()));
    let [id, key, secret, more] = random_numbers();
    let me = PeerIdentity::new([id, kept_key(key), secret, more]);
    Arguments {
        server: server.unwrap_or_else(|| "ws://127.0.0.1:3536".into()),
        room,
        me,
        new_room: format!("{:x}", me.id.0),
    }
}

/// Random numbers from the browser.
fn random_numbers() -> [u64; 4] {
    let mut bytes = [0; 32];
    let crypto = web_sys::window().and_then(|window| window.crypto().ok());
    let filled = crypto.map(|crypto| crypto.get_random_values_with_u8_array(&mut bytes));
    assert!(matches!(filled, Some(Ok(_))), "the browser has no random numbers");
    let (numbers, _) = bytes.as_chunks::<8>();
    core::array::from_fn(|index| u64::from_le_bytes(numbers[index]))
}

/// The key of this tab, by which a reloaded page gets its seat back. A new tab stores `new`.
fn kept_key(new: u64) -> u64 {
    let Some(storage) = web_sys::window().and_then(|window| window.session_storage().ok().flatten()) else {
        return new;
    };
    let kept = storage.get_item(IDENTITY).ok().flatten().and_then(|text| text.parse().ok());
    let key = kept.unwrap_or(new);
    // If the key cannot be stored, a reloaded page counts as another player.
    let _ = storage.set_item(IDENTITY, &key.to_string());
    key
}

pub fn show(text: &str, _: &mut Query<&mut Window>) {
    let document = web_sys::window().and_then(|window| window.document());
    if let Some(status) = document.and_then(|document| document.get_element_by_id("status")) {
        status.set_text_content(Some(text));
    }
}

pub fn enter(room: &str) {
    let location = web_sys::window().map(|window| window.location());
    let _ = location.map(|location| location.set_hash(room));
}
