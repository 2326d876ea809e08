// The wasm module: loading, memory, structs, handles.
import { array, byteArray, count as u32Of, fail, flag, integer, long, onlyKnown, shown, string } from "./check.js";
import { Lockstep2dError } from "./error.js";
import { Angle, Fx, bitsOf, rawOf, vectorOf } from "./fx.js";
import { API_VERSION, STATUS, STRUCTS } from "./layout.js";

export const NO_ID = 0xffffffffffffffffn;
const NAMES = Object.fromEntries(Object.entries(STATUS).map(([name, code]) => [code, name]));
// A small wasm module with two SIMD instructions (`i8x16.splat`, `i8x16.popcnt`). It is valid only where SIMD is
// supported.
const SIMD = [0, 97, 115, 109, 1, 0, 0, 0, 1, 5, 1, 96, 0, 1, 123, 3, 2, 1, 0, 10, 10, 1, 8, 0, 65, 0, 253, 15, 253, 98, 11];
const DECODER = new TextDecoder();
const ENCODER = new TextEncoder();

let exports;
let view;
let bytes;
let starting;
let variant;

async function inlined(load) {
    const { default: text } = await load();
    const packed = Uint8Array.from(atob(text), (character) => character.charCodeAt(0));
    if (typeof DecompressionStream === "undefined") {
        const { gunzipSync } = await import(/* webpackIgnore: true */ /* @vite-ignore */ `node:${"zlib"}`).catch(() => {
            throw new Lockstep2dError("INIT", "there is no DecompressionStream here; pass the module as option `wasm`");
        });
        return gunzipSync(packed);
    }
    const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
    return new Response(stream).arrayBuffer();
}

async function start(modules, options) {
    try {
        await load(modules, onlyKnown(options, ["simd", "wasm"], "`init`"));
    } catch (error) {
        throw error instanceof Lockstep2dError ? error : new Lockstep2dError("INIT", `the wasm module cannot be loaded: ${error.message}`);
    }
}

async function load(modules, { simd, wasm }) {
    const chosen = flag(simd, "`simd`") ?? WebAssembly.validate(new Uint8Array(SIMD));
    let source = wasm ?? (await inlined(chosen ? modules.simd : modules.plain));
    if (typeof Response !== "undefined" && source instanceof Response) {
        source = await source.arrayBuffer();
    }
    const instance = source instanceof WebAssembly.Module ? await WebAssembly.instantiate(source) : (await WebAssembly.instantiate(source)).instance;
    if (instance.exports.ls2d_api_version() !== API_VERSION) {
        throw new Lockstep2dError("INIT", "the wasm module is of another version than the package");
    }
    exports = instance.exports;
    variant = wasm ? "given" : chosen ? "simd" : "plain";
}

/** Makes `init` for two inlined modules. Once `init` has succeeded, further calls of `init` change nothing. */
export const initializer = (modules) => (options = {}) => {
    starting ??= start(modules, options).catch((error) => {
        starting = undefined;
        throw error;
    });
    return starting;
};

export function loaded() {
    return variant;
}

export function library() {
    if (exports === undefined) {
        throw new Lockstep2dError("INIT", "call `await init()` before anything else");
    }
    return exports;
}

// Returns the memory of the module as bytes. When the memory grows, the old buffer is detached, so both views are made
// again.
function memory() {
    if (bytes === undefined || bytes.buffer !== exports.memory.buffer) {
        bytes = new Uint8Array(exports.memory.buffer);
        view = new DataView(exports.memory.buffer);
    }
    return bytes;
}

// Number of bytes at the start of the library's buffer that are reserved for `small`; `scratch` returns the bytes after
// them.
const SMALL = 64;
// Size in bytes of the buffer for the text of an error.
const TEXT_MAX = 1000;
// Whether options are being read, whose getters must not use the scratch memory.
let isReading = false;

function reserve(size) {
    const address = library().ls2d_scratch(size) >>> 0;
    if (address === 0) {
        throw new Lockstep2dError("MEMORY", `there is no memory for ${size} bytes`);
    }
    memory();
    return address;
}

/** Address of at least `size` bytes of scratch memory. The next call of `scratch` returns the same memory, so read
 * results before that call. The memory moves when it grows. */
export function scratch(size) {
    if (isReading) {
        fail("a getter of an argument calls the library: pass plain values");
    }
    return reserve(SMALL + size) + SMALL;
}

/** Address of 64 bytes that `scratch` never returns. Mathematics uses these bytes, because a getter of an argument may
 * compute while `scratch` is in use. */
export const small = () => reserve(SMALL);

/** Wraps a function that writes options into the scratch memory. While it runs, a getter of the options that would use
 * the scratch memory throws instead: it would overwrite the memory, or move it away from the function. */
export const writer = (convert) => (...given) => {
    const before = isReading;
    isReading = true;
    try {
        return convert(...given);
    } finally {
        isReading = before;
    }
};

export function lastText() {
    const at = reserve(SMALL + 8 + TEXT_MAX) + SMALL;
    exports.ls2d_last_error(at + 8, TEXT_MAX, at);
    return DECODER.decode(memory().slice(at + 8, at + 8 + Math.min(view.getUint32(at, true), TEXT_MAX)));
}

export function failure(status) {
    // The library names options in snake case, JavaScript in camel case.
    const message = lastText().replace(/`[a-z]+(_[a-z]+)+`/g, camel);
    return new Lockstep2dError(NAMES[status] ?? `STATUS_${status}`, message);
}

/** Calls a function, and returns its status. */
export function statusOf(name, ...given) {
    const called = library()[name];
    if (called === undefined) {
        throw new Lockstep2dError("INIT", "`init` of `lockstep2d/core` was called first: it loads a module without replays and matches");
    }
    for (const value of given) {
        // WebAssembly would convert other values to integers without an error.
        if (typeof value !== "bigint" && !(Number.isInteger(value) && value >= 0 && value <= 0xffffffff)) {
            fail(`an argument of ${name.replace("ls2d_", "")} is an integer from 0 to 4294967295, and not ${shown(value)}`);
        }
    }
    const status = called(...given);
    memory();
    return status;
}

/** Calls a function. Returns true for the status OK, false for NONE (nothing to return), and throws other statuses as
 * errors. */
export function call(name, ...given) {
    const status = statusOf(name, ...given);
    if (status > STATUS.NONE) {
        throw failure(status);
    }
    return status === STATUS.OK;
}

export const struct = (name) => STRUCTS[name];
export const sizeOf = (name) => STRUCTS[name].bytes;
export const u32 = (at) => view.getUint32(at, true);
export const u64 = (at) => view.getBigUint64(at, true);
export const fxAt = (at) => new Fx(view.getBigInt64(at, true));
export const idAt = (at) => view.getUint32(at + 4, true) * 4294967296 + view.getUint32(at, true);
export const hashAt = (at) => u64(at + 8).toString(16).padStart(16, "0") + u64(at).toString(16).padStart(16, "0");
export const f64s = (at, count) => new Float64Array(exports.memory.buffer, at, count);

export function writeHash(at, text, what = "a hash") {
    if (typeof text !== "string" || !/^[0-9a-f]{32}$/.test(text)) {
        fail(`${what} is 32 hexadecimal digits, and not ${shown(text)}`);
    }
    view.setBigUint64(at + 8, BigInt(`0x${text.slice(0, 16)}`), true);
    view.setBigUint64(at, BigInt(`0x${text.slice(16)}`), true);
}

/** Calls `attempt`, and returns false if the body or joint is not in the world. */
export function found(attempt) {
    try {
        return attempt();
    } catch (error) {
        if (error.code === "STALE_BODY" || error.code === "STALE_JOINT") {
            return false;
        }
        throw error;
    }
}

export function id(value, what = "a body") {
    if (Number.isSafeInteger(value) && value >= 0) {
        return BigInt(value);
    }
    return fail(`${what} is a number that the world has returned, and not ${shown(value)}`);
}

const WRITE = {
    fx: (at, value, what) => view.setBigInt64(at, rawOf(value, what), true),
    angle: (at, value, what) => view.setUint32(at, bitsOf(value, what), true),
    vec2: (at, value, what) => {
        const [x, y] = vectorOf(value, what);
        view.setBigInt64(at, x, true);
        view.setBigInt64(at + 8, y, true);
    },
    uint32_t: (at, value, what) => view.setUint32(at, u32Of(value, what), true),
    int32_t: (at, value, what) => view.setInt32(at, Number(integer(value, what, -(2 ** 31), 2 ** 31 - 1)), true),
    uint64_t: (at, value, what) => view.setBigUint64(at, long(value, what), true),
    body: (at, value, what) => view.setBigUint64(at, id(value, what), true),
    shape: (at, value, what) => view.setBigUint64(at, id(value, what), true),
    hash: writeHash,
};
const READ = {
    fx: fxAt,
    angle: (at) => new Angle(u32(at)),
    vec2: (at) => ({ x: fxAt(at), y: fxAt(at + 8) }),
    uint32_t: u32,
    int32_t: (at) => view.getInt32(at, true),
    uint64_t: u64,
    body: idAt,
    shape: idAt,
    joint: idAt,
    hash: hashAt,
};
const STRIDE = { fx: 8, vec2: 16, uint64_t: 8, body: 8, shape: 8, uint8_t: 1 };

const camel = (name) => name.replace(/_(\w)/g, (_, letter) => letter.toUpperCase());

// For each struct, the list of its fields. A field has a name in JavaScript, an offset, a kind, and for an array the
// number of items.
const FIELDS = Object.fromEntries(
    Object.entries(STRUCTS).map(([name, { fields }]) => [name, Object.entries(fields).map(([field, rest]) => [camel(field), ...rest])]),
);

/** Names of the fields of a struct that callers may set as options. */
export const optionsOf = (name, without = []) =>
    Object.keys(STRUCTS[name].fields).filter((field) => !["size", "reserved", ...without].includes(field)).map(camel);

export const write = writer((name, at, values) => {
    for (const [field, offset, kind, count] of FIELDS[name]) {
        const value = values[field];
        if (value === undefined) {
            continue;
        }
        if (kind === "uint8_t") {
            const data = ENCODER.encode(string(value, field));
            if (data.length > count) {
                fail(`${field} has ${data.length} bytes, at most ${count} are possible`);
            }
            if (data.includes(0)) {
                fail(`${field} contains a zero character, and is ${shown(value)}`);
            }
            memory().fill(0, at + offset, at + offset + count);
            memory().set(data, at + offset);
        } else if (count === undefined) {
            WRITE[kind](at + offset, value, field);
        } else {
            const items = array(value, field);
            if (items.length > count) {
                fail(`${field} has ${items.length} items, at most ${count} are possible`);
            }
            items.forEach((item, index) => WRITE[kind](at + offset + index * STRIDE[kind], item, field));
        }
    }
});

export function read(name, at) {
    const result = {};
    for (const [field, offset, kind, count] of FIELDS[name]) {
        if (count === undefined && READ[kind] !== undefined) {
            result[field] = READ[kind](at + offset);
        }
    }
    return result;
}

export function fieldAt(name, at, field) {
    return at + STRUCTS[name].fields[field][0];
}

/** Reserves `reserved` bytes of scratch memory and copies `data` after them. Returns the address of the reserved
 * bytes. */
export function give(data, reserved = 64, what = "the argument") {
    byteArray(data, what);
    const at = scratch(reserved + data.length);
    memory().set(data, at + reserved);
    return at;
}

export const giveText = (text, reserved = 64) => {
    const data = ENCODER.encode(string(text, "a name"));
    return [give(data, reserved), data.length];
};

export const putBytes = (at, data) => memory().set(data, at);
export const putRaw = (at, raw) => view.setBigInt64(at, raw, true);

export const copy = (at, size) => memory().slice(at, at + size);

/** Reads and frees a bytes object. */
export function takeBytes(handle) {
    try {
        const at = scratch(16);
        call("ls2d_bytes_size", handle, at);
        const size = u32(at);
        const to = scratch(16 + size);
        call("ls2d_bytes_copy", handle, to + 16, size);
        return copy(to + 16, size);
    } finally {
        // Frees the object even if there is no memory for a copy.
        exports.ls2d_free(handle);
    }
}

export const text = (data) => DECODER.decode(data);

// Size in bytes of the buffer for the items of a list. It grows if a list does not fit. The size is in bytes, not in
// items: otherwise, after a long list of small items, lists of large items would reserve much memory, which is never
// given back.
let room = 4096;

/** Calls `ask`, which writes items of `size` bytes, repeatedly with a larger buffer until all items fit. Returns the
 * address and the number of the items. `prepare` writes other arguments to the `before` bytes in front of the items. */
export function list(size, before, ask, prepare = () => {}) {
    for (;;) {
        const capacity = Math.floor(room / size);
        const at = scratch(8 + before + capacity * size);
        prepare(at + 8);
        const status = ask(at + 8 + before, capacity, at, at + 8);
        memory();
        if (status !== STATUS.BUFFER) {
            if (status > STATUS.NONE) {
                throw failure(status);
            }
            return { at: at + 8 + before, count: status === STATUS.NONE ? 0 : u32(at) };
        }
        room = Math.max(u32(at) * size, 2 * room);
    }
}

const registry =
    typeof FinalizationRegistry === "undefined" ? undefined : new FinalizationRegistry((handle) => exports.ls2d_free(handle));

export class Handle {
    #handle;

    constructor(handle) {
        this.#handle = handle;
        registry?.register(this, handle, this);
    }

    get handle() {
        if (this.#handle === 0) {
            throw new Lockstep2dError("DISPOSED", `this ${this.constructor.name} was disposed`);
        }
        return this.#handle;
    }

    dispose() {
        if (this.#handle !== 0) {
            registry?.unregister(this);
            exports.ls2d_free(this.#handle);
            this.#handle = 0;
        }
    }
}

/** Lets `using` dispose of the objects of a class, if JavaScript has `Symbol.dispose`. */
export function disposable({ prototype }) {
    if (Symbol.dispose) {
        prototype[Symbol.dispose] = prototype.dispose;
    }
}
disposable(Handle);
