//! The committed header and layout match the API. With `LOCKSTEP2D_WRITE=1`, these tests write both files.

use std::path::Path;

fn check(path: &str, text: &str) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(path);
    if std::env::var_os("LOCKSTEP2D_WRITE").is_some() {
        assert!(std::fs::write(&path, text).is_ok(), "{} cannot be written", path.display());
    }
    let found = std::fs::read_to_string(&path).unwrap_or_default();
    let name = path.display();
    assert!(
        found == text,
        "{name} is outdated: LOCKSTEP2D_WRITE=1 cargo test -p lockstep2d-flat --test generated"
    );
}

#[test]
fn the_header_is_that_of_the_api() {
    check("include/lockstep2d.h", &lockstep2d_flat::header());
}

#[test]
fn the_layout_is_that_of_the_api() {
    check("../npm/src/layout.js", &lockstep2d_flat::layout());
}

#[test]
fn every_function_is_in_the_header() {
    let header = lockstep2d_flat::header();
    for name in ["ls2d_world_step", "ls2d_spawn", "ls2d_cast_ray", "ls2d_match_host", "ls2d_rng_below"] {
        assert!(header.contains(&format!(" {name}(")), "{name}");
    }
}

/// In C, types and functions share one namespace.
#[test]
fn no_function_has_the_name_of_a_type() {
    let header = lockstep2d_flat::header();
    let types: Vec<&str> = header
        .lines()
        .filter_map(|line| line.strip_prefix("} "))
        .filter_map(|line| line.strip_suffix(';'))
        .collect();
    assert!(types.contains(&"ls2d_vec2"), "{types:?}");
    let taken = types.iter().find(|name| header.contains(&format!(" {name}(")));
    assert_eq!(taken, None);
}
