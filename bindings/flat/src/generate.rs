//! Writes the C header, and the layout of the structs for other languages.

use std::fmt::Write as _;

use crate::describe::{Alias, Constant, Function, Struct};
use crate::functions::{API_VERSION, FUNCTIONS};
use crate::records::{CONSTANTS, STRUCTS};
use crate::status::STATUSES;

const OPENING: &str = "\
/* The flat API of lockstep2d: a deterministic fixed-point 2D physics and lockstep engine.
 *
 * Written by the tests of lockstep2d-flat; do not edit it.
 *
 * Most functions return a status: LS2D_OK, LS2D_NONE if there is nothing to return, or an error, whose text
 * ls2d_last_error copies. Objects are referred to by handles, numbers that are never 0. A wrong or stale handle is an
 * error, never undefined behaviour. ls2d_free frees objects of all kinds.
 *
 * A pointer has to be null or to point to as many items as the function reads or writes. Nothing else may use that
 * memory during the call. Functions that fill a buffer take its capacity in items. If the buffer is too short, such a
 * function returns LS2D_BUFFER, and writes the number of items needed if it has a pointer for this number. There are
 * two exceptions: ls2d_last_error cuts the text, and ls2d_match_next_packet writes the size of the packet only if the
 * buffer for the address is long enough.
 *
 * Structs with an ls2d_*_init function, except ls2d_rng, begin with their size. The init function sets the size and the
 * defaults.
 *
 * Numbers are integers: ls2d_fx has 32 fraction bits, so that a length of LS2D_FX(1) is one metre. ls2d_angle is in
 * units of 2^-32 turn. Several threads may use different objects at the same time. */
#ifndef LOCKSTEP2D_H
#define LOCKSTEP2D_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern \"C\" {
#endif

/* Result of a function: one of the LS2D_ codes below. */
typedef int32_t ls2d_status;
/* Handle of an object. */
typedef uint32_t ls2d_handle;

/* LS2D_FX converts a whole number to ls2d_fx. LS2D_FX_RATIO is the quotient of two whole numbers, rounded towards zero.
 * The quotient has to be less than 2^31, and the denominator at most 2^31; the macro uses its arguments several times.
 * With `| 0`, a float does not compile; without it, the conversion to int64_t would truncate the float silently. The
 * arguments are converted before the division, because a division by an unsigned number would be unsigned. */
#define LS2D_WHOLE(whole) ((int64_t)((whole) | 0))
#define LS2D_FX(whole) ((ls2d_fx)(LS2D_WHOLE(whole) * 4294967296))
#define LS2D_QUOTIENT(n, d) ((ls2d_fx)(LS2D_FX((n) / (d)) + LS2D_FX((n) % (d)) / (d)))
#define LS2D_FX_RATIO(numerator, denominator) LS2D_QUOTIENT(LS2D_WHOLE(numerator), LS2D_WHOLE(denominator))
/* An angle of whole degrees, rounded towards zero. */
#define LS2D_DEGREES(whole) ((ls2d_angle)LS2D_FX_RATIO(whole, 360))
/* An ls2d_body, ls2d_shape or ls2d_joint that refers to nothing. */
#define LS2D_NO_ID UINT64_MAX
";

const CLOSING: &str = "
#ifdef __cplusplus
}
#endif

#endif
";

fn comment(text: &mut String, indent: &str, docs: &[&str]) {
    let lines: Vec<_> = docs.iter().map(|line| line.trim()).collect();
    let between = format!("\n{indent} * ");
    // Writing to a string cannot fail.
    let _ = writeln!(text, "{indent}/* {} */", lines.join(&between));
}

fn constant(text: &mut String, name: &str, value: i64, docs: &[&str]) {
    comment(text, "", docs);
    let _ = writeln!(text, "#define {name} {value}");
}

fn record(text: &mut String, record: &Struct) {
    text.push('\n');
    comment(text, "", record.docs);
    let _ = writeln!(text, "typedef struct {} {{", record.name);
    for field in record.fields {
        comment(text, "    ", field.docs);
        let count = field.count.map(|count| format!("[{count}]")).unwrap_or_default();
        let _ = writeln!(text, "    {} {}{count};", field.kind, field.name);
    }
    let _ = writeln!(text, "}} {};", record.name);
}

fn function(text: &mut String, function: &Function) {
    text.push('\n');
    comment(text, "", function.docs);
    let parameters: Vec<String> = function
        .parameters
        .iter()
        .map(|parameter| {
            let [before, base, after] = parameter.kind;
            format!("{before}{base}{}{}", if after.is_empty() { " " } else { after }, parameter.name)
        })
        .collect();
    let parameters = if parameters.is_empty() { "void".into() } else { parameters.join(", ") };
    let _ = writeln!(text, "{} {}({parameters});", function.returns, function.name);
}

fn aliases() -> impl Iterator<Item = &'static Alias> {
    crate::numbers::ALIASES.iter()
}

fn constants() -> impl Iterator<Item = &'static Constant> {
    CONSTANTS.iter().copied().flatten()
}

fn structs() -> impl Iterator<Item = &'static Struct> {
    STRUCTS.iter().copied().flatten()
}

/// The text of `include/lockstep2d.h`.
#[must_use]
pub fn header() -> String {
    let mut text = String::from(OPENING);
    let _ = writeln!(text, "/* Version of this header, to be compared with ls2d_api_version(). */");
    let _ = writeln!(text, "#define LS2D_API_VERSION {API_VERSION}\n");
    for &(value, name, docs) in STATUSES {
        constant(&mut text, name, value.into(), docs);
    }
    text.push('\n');
    for alias in aliases() {
        comment(&mut text, "", alias.docs);
        let _ = writeln!(text, "typedef {} {};", alias.of, alias.name);
    }
    text.push('\n');
    for each in constants() {
        constant(&mut text, each.name, each.value, each.docs);
    }
    structs().for_each(|each| record(&mut text, each));
    for (subject, functions) in FUNCTIONS {
        let _ = writeln!(text, "\n/* ---- {subject} ---- */");
        functions.iter().for_each(|each| function(&mut text, each));
    }
    text.push_str(CLOSING);
    text
}

/// The text of `layout.js`: all constants, and the size and the fields of every struct.
#[must_use]
pub fn layout() -> String {
    let mut text = String::from(
        "// Layout of the structs and constants of the flat API.\n\
         // Written by the tests of lockstep2d-flat; do not edit it.\n\n",
    );
    let _ = writeln!(text, "export const API_VERSION = {API_VERSION};\n\nexport const STATUS = {{");
    for (value, name, _) in STATUSES {
        let _ = writeln!(text, "    {}: {value},", name.trim_start_matches("LS2D_"));
    }
    text.push_str("};\n\nexport const C = {\n");
    for each in constants() {
        let _ = writeln!(text, "    {}: {},", each.name.trim_start_matches("LS2D_"), each.value);
    }
    text.push_str("};\n\nexport const STRUCTS = {\n");
    for each in structs() {
        let _ = writeln!(
            text,
            "    {}: {{ bytes: {}, fields: {{",
            each.name.trim_start_matches("ls2d_"),
            each.bytes
        );
        for field in each.fields {
            let count = field.count.map(|count| format!(", {count}")).unwrap_or_default();
            let kind = field.kind.trim_start_matches("ls2d_");
            let _ = writeln!(text, "        {}: [{}, \"{kind}\"{count}],", field.name, field.offset);
        }
        text.push_str("    } },\n");
    }
    text.push_str("};\n");
    text
}
