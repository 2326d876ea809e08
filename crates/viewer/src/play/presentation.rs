//! [`Presentation`]: the parts of a game that are shown besides its world.

use std::collections::BTreeSet;
use std::rc::Rc;

use lockstep2d::inspect::{Field, fields};
use lockstep2d::lockstep::Game;
use lockstep2d_render::{Camera, DrawList};

use crate::canvas::Canvas;

/// Names and values of fields.
pub(crate) type Fields = Vec<(String, String)>;

pub(crate) type Draw<G> = dyn Fn(&G, &mut Canvas<'_>);

pub(crate) struct Presentation<G: Game> {
    pub(crate) draw: Rc<Draw<G>>,
    /// Returns a line of text, such as the score. It may be empty.
    pub(crate) status: Rc<dyn Fn(&G) -> String>,
    /// Returns the state of the game's own rules.
    pub(crate) state: Rc<dyn Fn(&G) -> Fields>,
}

impl<G: Game> Clone for Presentation<G> {
    fn clone(&self) -> Self {
        let Presentation { draw, status, state } = self;
        Presentation { draw: Rc::clone(draw), status: Rc::clone(status), state: Rc::clone(state) }
    }
}

impl<G: Game + 'static> Default for Presentation<G> {
    /// Draws nothing and shows no status. The state consists of all fields of a save, except those of the world.
    fn default() -> Self {
        Presentation {
            draw: Rc::new(|_, _| {}),
            status: Rc::new(|_| String::new()),
            state: Rc::new(own_state::<G>),
        }
    }
}

impl<G: Game> Presentation<G> {
    pub(crate) fn draw(&self, game: &G, list: &mut DrawList, camera: &Camera) {
        (self.draw)(game, &mut Canvas::new(list, camera));
    }
}

pub(crate) fn listed(fields: &[Field]) -> Fields {
    fields.iter().map(|field| (field.path().to_owned(), field.value.to_string())).collect()
}

fn own_state<G: Game>(game: &G) -> Fields {
    let all = fields(&game.save()).unwrap_or_default();
    let world = game.world().and_then(|world| fields(&world.save()).ok()).unwrap_or_default();
    let Some(first) = world.first().map(Field::path) else { return listed(&all) };
    // The path of this field in the save of the game is the path of the world, followed by the path of the field in the
    // world.
    let inside = all.iter().find_map(|field| field.path().strip_suffix(first)).map(str::to_owned);
    let of_world: BTreeSet<&str> = world.iter().map(Field::path).collect();
    let is_own = |field: &&Field| match inside.as_deref() {
        None => true,
        Some("") => !of_world.contains(field.path()),
        Some(prefix) => !field.path().starts_with(prefix),
    };
    listed(&all.iter().filter(is_own).cloned().collect::<Vec<_>>())
}
