//! The list of the fields of a state.

use lockstep2d::hash::StateHash;
use lockstep2d::inspect::Field;
use serde_json::{Value as Json, json};

use super::{Arguments, shown};
use crate::console::Console;
use crate::context::CommandResult;
use crate::error::CommandError;
use crate::exit::Exit;

pub(super) struct State {
    pub(super) tick: Option<u64>,
    pub(super) hash: Option<StateHash>,
    pub(super) fields: Vec<Field>,
}

impl State {
    pub(super) fn print(self, arguments: &Arguments, console: &mut Console<'_>) -> CommandResult {
        let State { tick, hash, fields } = self;
        let fields: Vec<&Field> = fields.iter().filter(|field| is_wanted(field, arguments)).collect();
        if fields.is_empty() {
            return Err(nothing(arguments));
        }
        let hash = hash.map(|hash| hash.to_string());
        if arguments.json {
            let file = arguments.file.display().to_string();
            let fields: Vec<Json> = fields.into_iter().map(field_json).collect();
            let document = json!({"file": file, "tick": tick, "hash": hash, "fields": fields});
            console.json(&document)?;
            return Ok(Exit::Success);
        }
        let tick = tick.map_or(" that was saved".into(), |tick| format!(" after tick {tick}"));
        let hash = hash.map_or(String::new(), |hash| format!(": {hash}"));
        console.line(format_args!("state{tick}{hash}"))?;
        for field in fields {
            console.line(format_args!("{}", field_text(field)))?;
        }
        Ok(Exit::Success)
    }
}

fn is_wanted(field: &Field, arguments: &Arguments) -> bool {
    let is_body = |id: &str| {
        let name = field.subject().and_then(|subject| subject.rsplit('.').next());
        let found = name.and_then(|name| name.strip_prefix("body "));
        // The text is `body HANDLE NAME`. The name may be missing.
        let mut words = found.into_iter().flat_map(|found| found.split(' '));
        words.next().is_some_and(|handle| handle == id || handle.split('v').next() == Some(id))
            || words.next() == Some(id)
    };
    let path = arguments.path.as_deref().unwrap_or("");
    arguments.body.as_deref().is_none_or(is_body) && field.path().starts_with(path)
}

fn nothing(arguments: &Arguments) -> CommandError {
    let what = match (&arguments.body, &arguments.path) {
        (Some(id), _) => return CommandError::NoBody { id: id.clone() },
        (None, Some(path)) => format!("field whose path begins with {path:?} in this state"),
        (None, None) => "field in this state".into(),
    };
    CommandError::NothingThere { what }
}

/// A field on one line. It is escaped, because it may come from an untrusted file.
pub(super) fn field_text(field: &Field) -> String {
    let path = if field.path().is_empty() { "value" } else { field.path() };
    shown(&format!("{path}: {}", field.value))
}

/// Path and value of a field. Numbers, angles and booleans also have their bits, which are text because they may exceed
/// the range of JSON numbers.
pub(super) fn field_json(field: &Field) -> Json {
    let bits = field.value.bits().map(|bits| bits.to_string());
    json!({"path": field.path(), "text": field.value.to_string(), "bits": bits})
}
