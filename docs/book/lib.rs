//! Compiles and runs the code of the chapters, and checks the links of all documents (`tests/links.rs`). The chapter
//! `first-game.md` is not in this list, because its game consists of several files: `.ci/book` extracts, builds and
//! plays it.

macro_rules! chapters {
    ($($name:ident $file:literal)*) => {
        $(
            #[cfg(doctest)]
            #[doc = include_str!($file)]
            mod $name {}
        )*
    };
}

chapters! {
    rules "rules.md"
    recipes "recipes.md"
    drawing "drawing.md"
    sensors "sensors.md"
    characters "characters.md"
}
