// Connects the page with the viewer: passes files to the viewer, and displays the reports that the viewer logs.
//
// ?file=URL opens a file, ?scene=NAME opens a scene.
"use strict";

const element = (id) => document.getElementById(id);

// Names of the verdicts. The page shows them with a capital letter.
const VERDICTS = /\b(match|claim mismatch|diverged|incomplete|malformed|limit exceeded|unverifiable)\b/;

function report([name, tick, ticks, hash, status]) {
    element("name").textContent = name;
    element("tick").textContent = ticks === "" ? `tick ${tick}` : `tick ${tick} of ${ticks}`;
    element("hash").textContent = hash;
    element("verdict").textContent = status.replace(VERDICTS, (verdict) => verdict.charAt(0).toUpperCase() + verdict.slice(1));
}

function save([name, digits]) {
    const bytes = Uint8Array.from(digits.match(/../g) ?? [], (pair) => parseInt(pair, 16));
    const link = document.createElement("a");
    link.href = URL.createObjectURL(new Blob([bytes]));
    link.download = name;
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 60_000);
}

const LINES = { "lockstep2d.report": report, "lockstep2d.save": save };

function fail(message) {
    element("verdict").textContent = message;
}

// Copies bytes into the viewer's memory, as miniquad does with a dropped file.
function give(bytes) {
    const start = wasm_exports.allocate_vec_u8(bytes.length);
    new Uint8Array(wasm_memory.buffer, start, bytes.length).set(bytes);
    return [start, bytes.length];
}

function show(name, bytes) {
    const file = [...give(new TextEncoder().encode(name)), ...give(bytes)];
    wasm_exports.on_files_dropped_start();
    wasm_exports.on_file_dropped(...file);
    wasm_exports.on_files_dropped_finish();
    element("glcanvas").focus();
}

// Shows files, or compares them with the shown file, as the viewer does while Shift is down. The page may not have the
// focus during a drop and then gets no key events, so a press of Shift is passed to the viewer for the time of each
// drop.
async function showFiles(files, compares) {
    const shift = into_sapp_keycode("ShiftLeft");
    for (const file of files) {
        const bytes = new Uint8Array(await file.arrayBuffer());
        if (compares) {
            wasm_exports.key_down(shift, 0, false);
        }
        show(file.name, bytes);
        if (compares) {
            wasm_exports.key_up(shift, 0);
        }
    }
}

async function showUrl(url) {
    const answer = await fetch(url);
    if (!answer.ok) {
        throw new Error(`${answer.status} ${answer.statusText}`);
    }
    show(url.split("/").pop(), new Uint8Array(await answer.arrayBuffer()));
}

// Replaces miniquad's drop handler, which assumes that a file name has as many bytes as characters.
window.addEventListener("drop", (event) => {
    event.preventDefault();
    event.stopImmediatePropagation();
    showFiles(Array.from(event.dataTransfer.files), event.shiftKey);
}, { capture: true });
element("file").addEventListener("change", (event) => showFiles(Array.from(event.target.files), false));

// During a drag, the canvas gets all mouse events, even if the pointer leaves it or the button is released outside.
element("glcanvas").addEventListener("pointerdown", (event) => event.target.setPointerCapture(event.pointerId));

// Opens the file or scene of the URL. This is done after the viewer's first report, because the viewer accepts no files
// earlier.
let started = false;
function start() {
    if (started) {
        return;
    }
    started = true;
    const wishes = new URLSearchParams(location.search);
    if (wishes.has("scene")) {
        show(`${wishes.get("scene")}.scene`, new Uint8Array(0));
    }
    if (wishes.has("file")) {
        showUrl(wishes.get("file")).catch((error) => fail(`${wishes.get("file")}: ${error.message}`));
    }
}

miniquad_add_plugin({
    name: "lockstep2d",
    version: 1,
    register_plugin(imports) {
        const info = imports.env.console_info;
        imports.env.console_info = (text) => {
            const [kind, ...fields] = UTF8ToString(text).split("\t");
            if (!(kind in LINES)) {
                return info(text);
            }
            LINES[kind](fields);
            // The viewer calls this function, and a call into the viewer is not possible from here. So the start is
            // postponed.
            setTimeout(start);
        };
        imports.env.console_error = (text) => fail(UTF8ToString(text));
        imports.env.console_log = (text) => fail(UTF8ToString(text));
    },
});

load("viewer.wasm");
