// Checks of arguments. A wrong argument is an error with the code VALUE that names the argument.
import { Lockstep2dError } from "./error.js";

const U32_MAX = 0xffffffff;

export function fail(message) {
    throw new Lockstep2dError("VALUE", message);
}

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

/** Checks an integer from `min` to `max`, which is a number or a bigint, and returns it. */
export function integer(value, what, min, max) {
    if ((typeof value !== "bigint" && !Number.isSafeInteger(value)) || value < min || value > max) {
        fail(`${what} is an integer from ${min} to ${max}, and not ${shown(value)}`);
    }
    return value;
}

/** Checks an integer of 32 bits without sign, and returns it as a number. */
export const count = (value, what) => Number(integer(value, what, 0, U32_MAX));

/** Checks an integer of 64 bits without sign, and returns it as a bigint. */
export const long = (value, what) => BigInt(integer(value, what, 0, 0xffffffffffffffffn));

export function object(value, what) {
    if (value === null || typeof value !== "object" || Array.isArray(value)) {
        fail(`${what} is an object, and not ${Array.isArray(value) ? "an array" : shown(value)}`);
    }
    return value;
}

export function array(value, what) {
    return Array.isArray(value) ? value : fail(`${what} is an array, and not ${shown(value)}`);
}

export function byteArray(value, what) {
    return value instanceof Uint8Array ? value : fail(`${what} is a Uint8Array, and not ${shown(value)}`);
}

export function string(value, what) {
    return typeof value === "string" ? value : fail(`${what} is a text, and not ${shown(value)}`);
}

/** Checks a value that is a boolean or undefined, and returns it. */
export function flag(value, what) {
    return value === undefined || typeof value === "boolean" ? value : fail(`${what} is true or false, and not ${shown(value)}`);
}

/** Checks an instance of a class, and returns it. */
export function instance(value, type, what) {
    return value instanceof type ? value : fail(`${what} is a ${type.name}, and not ${shown(value)}`);
}

/** Checks the names of options, and returns the options. A misspelt option is an error, because it would otherwise be
 * ignored. */
export function onlyKnown(options, known, what) {
    const unknown = Object.keys(object(options, what)).find((key) => !known.includes(key));
    if (unknown !== undefined) {
        fail(`${what} has no option ${unknown}; there are ${known.join(", ")}`);
    }
    return options;
}
