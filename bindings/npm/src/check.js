// Checks of arguments. A check that fails throws an error with the code VALUE and the name of the argument.
import { Lockstep2dError } from "./error.js";

const U32_MAX = 0xffffffff;

export function fail(message) {
    throw new Lockstep2dError("VALUE", message);
}

/** Throws if an argument is missing. Otherwise `write` would skip its field, and the library would read old memory or a
 * default. */
export const given = (value, what) => (value === undefined ? fail(`${what} is missing`) : value);

/** Formats a value for the text of an error. */
export function shown(value) {
    switch (typeof value) {
        case "string":
            return JSON.stringify(value);
        case "object":
            return value === null ? "null" : `an object ${value.constructor?.name ?? ""}`.trimEnd();
        case "function":
            return "a function";
        default:
            return String(value);
    }
}

export function integer(value, what, min, max) {
    if ((typeof value !== "bigint" && !Number.isInteger(value)) || value < min || value > max) {
        fail(`${what} is an integer from ${min} to ${max}, and not ${shown(value)}`);
    }
    if (typeof value === "number" && !Number.isSafeInteger(value)) {
        fail(`${what} is the number ${value}, which may be rounded: beyond 2^53 - 1 pass a BigInt`);
    }
    return value;
}

export const count = (value, what) => Number(integer(value, what, 0, U32_MAX));

export const long = (value, what) => BigInt(integer(value, what, 0, 0xffffffffffffffffn));

/** Converts a time in milliseconds to whole microseconds, rounded down. */
export function micros(milliseconds, what) {
    if (typeof milliseconds !== "number" || !(milliseconds >= 0 && milliseconds < Number.MAX_SAFE_INTEGER / 1000)) {
        fail(`${what} is a number of milliseconds from 0, and not ${shown(milliseconds)}`);
    }
    return BigInt(Math.floor(milliseconds * 1000));
}

export function object(value, what) {
    if (value === null || typeof value !== "object" || Array.isArray(value)) {
        fail(`${what} is an object, and not ${Array.isArray(value) ? "an array" : shown(value)}`);
    }
    return value;
}

/** Returns a copy of an array with `undefined` in place of holes, because `forEach` would skip holes. */
export function array(value, what) {
    return Array.isArray(value) ? Array.from(value) : fail(`${what} is an array, and not ${shown(value)}`);
}

export function byteArray(value, what) {
    return value instanceof Uint8Array ? value : fail(`${what} is a Uint8Array, and not ${shown(value)}`);
}

export function string(value, what) {
    return typeof value === "string" ? value : fail(`${what} is a text, and not ${shown(value)}`);
}

export function flag(value, what) {
    return value === undefined || typeof value === "boolean" ? value : fail(`${what} is true or false, and not ${shown(value)}`);
}

export function callable(value, what) {
    return typeof value === "function" ? value : fail(`${what} is a function, and not ${shown(value)}`);
}

export function instance(value, type, what) {
    return value instanceof type ? value : fail(`${what} is a ${type.name}, and not ${shown(value)}`);
}

/** Throws for an unknown option, because a misspelt option would otherwise be ignored. */
export function onlyKnown(options, known, what) {
    const unknown = Object.keys(object(options, what)).find((key) => !known.includes(key));
    if (unknown !== undefined) {
        fail(`${what} has no option ${unknown}; there are ${known.join(", ")}`);
    }
    return options;
}
