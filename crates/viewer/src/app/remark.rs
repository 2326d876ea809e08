//! [`Remark`]: a line of text about what is shown, below its name.

use lockstep2d_render::Colour;

use super::theme;
use crate::source::Source;

#[derive(Clone, Debug)]
pub(super) struct Remark {
    pub(super) text: String,
    kind: Kind,
}

#[derive(Clone, Copy, Debug)]
enum Kind {
    Plain,
    /// The replay matches.
    Good,
    /// An error, or the verdict on a replay that does not match.
    Bad,
}

impl Remark {
    pub(super) fn plain(text: impl Into<String>) -> Self {
        Remark { text: text.into(), kind: Kind::Plain }
    }

    pub(super) fn error(text: impl Into<String>) -> Self {
        Remark { text: text.into(), kind: Kind::Bad }
    }

    /// The status of a source.
    pub(super) fn status_of(source: &dyn Source) -> Self {
        let kind = match source.verdict() {
            None => Kind::Plain,
            Some(verdict) if verdict.is_match() => Kind::Good,
            Some(_) => Kind::Bad,
        };
        Remark { text: source.status(), kind }
    }

    pub(super) fn colour(&self) -> Colour {
        match self.kind {
            Kind::Plain => theme::INK,
            Kind::Good => theme::GOOD,
            Kind::Bad => theme::BAD,
        }
    }
}
