// Fixed-point numbers: 64-bit integers with 32 fraction bits, so that every browser computes the same bits.
import { integer, shown } from "./check.js";
import { Lockstep2dError } from "./error.js";

const ONE = 1n << 32n;
const MAX = (1n << 63n) - 1n;
const MIN = -(1n << 63n);
const NUMBER = /^([+-]?)(\d+)(?:\.(\d+))?$/;
// Name of the method whose result `console.log` prints in Node, Deno and Bun.
const INSPECT = Symbol.for("nodejs.util.inspect.custom");
// Cache of the numbers parsed from strings, because programs parse the same few strings repeatedly.
const CACHE = new Map();
const CACHE_MAX = 4096;

const saturate = (raw) => (raw > MAX ? MAX : raw < MIN ? MIN : raw);

function divide(numerator, denominator) {
    // Rounded to nearest, halves away from zero.
    const negative = numerator < 0n !== denominator < 0n;
    const [n, d] = [numerator < 0n ? -numerator : numerator, denominator < 0n ? -denominator : denominator];
    const quotient = (2n * n + d) / (2n * d);
    return negative ? -quotient : quotient;
}

function parse(text, what) {
    const known = CACHE.get(text);
    if (known !== undefined) {
        return known;
    }
    const parts = NUMBER.exec(text);
    if (parts === null) {
        throw new Lockstep2dError("TEXT", `${what} is "${text}", and not a decimal number such as "-1.25"`);
    }
    const [, sign, whole, fraction = ""] = parts;
    const scale = 10n ** BigInt(fraction.length);
    const digits = BigInt(whole + fraction) * ONE;
    // Rounded to nearest, halves to even.
    let raw = digits / scale;
    const rest = 2n * (digits % scale);
    if (rest > scale || (rest === scale && (raw & 1n) === 1n)) {
        raw += 1n;
    }
    raw = sign === "-" ? -raw : raw;
    if (raw > MAX || raw < MIN) {
        throw new Lockstep2dError("TEXT", `${what} is ${text}, beyond the range of numbers, ±2^31`);
    }
    if (CACHE.size >= CACHE_MAX) {
        CACHE.clear();
    }
    CACHE.set(text, raw);
    return raw;
}

/** The raw integer of an argument. A float is an error. */
export function rawOf(value, what = "a number") {
    if (value instanceof Fx) {
        return value.raw;
    }
    if (typeof value === "string") {
        return parse(value, what);
    }
    if (typeof value === "number") {
        if (Number.isInteger(value)) {
            return BigInt(integer(value, what, -(2 ** 31), 2 ** 31 - 1)) * ONE;
        }
        throw new Lockstep2dError(
            "FLOAT",
            `${what} is the float ${value}. Computations with floats differ between machines, therefore floats cannot ` +
                `enter the simulation: write an integer, a text such as "0.1", or fx("0.1").`,
        );
    }
    throw new Lockstep2dError("VALUE", `${what} is ${shown(value)}, and not an integer, a decimal text or an Fx`);
}

// Throws if an operator is applied to an `Fx` or an `Angle`: `a < b` would compare floats or texts, and `a + b` would
// concatenate texts.
function primitive(value, hint, what, methods) {
    if (hint === "string") {
        return value.toString();
    }
    throw new Lockstep2dError("FLOAT", `${what} has no operators: use ${methods}, or toNumber for drawing`);
}

export class Fx {
    constructor(raw) {
        if (typeof raw !== "bigint") {
            throw new Lockstep2dError("VALUE", `a number is made by fx("1.25") or Fx.fromRaw, and not of ${shown(raw)}`);
        }
        this.raw = raw;
        Object.freeze(this);
    }

    static fromRaw(raw) {
        return new Fx(BigInt.asIntN(64, BigInt(integer(raw, "a raw number", MIN, 2n ** 64n - 1n))));
    }

    add(other) {
        return new Fx(saturate(this.raw + rawOf(other)));
    }

    sub(other) {
        return new Fx(saturate(this.raw - rawOf(other)));
    }

    mul(other) {
        return new Fx(saturate((this.raw * rawOf(other) + (1n << 31n)) >> 32n));
    }

    div(other) {
        const by = rawOf(other);
        if (by === 0n) {
            throw new Lockstep2dError("NUMBER", "division by zero");
        }
        return new Fx(saturate(divide(this.raw << 32n, by)));
    }

    neg() {
        return new Fx(saturate(-this.raw));
    }

    abs() {
        return this.raw < 0n ? this.neg() : this;
    }

    min(other) {
        const raw = rawOf(other);
        return raw < this.raw ? new Fx(raw) : this;
    }

    max(other) {
        const raw = rawOf(other);
        return raw > this.raw ? new Fx(raw) : this;
    }

    compare(other) {
        const raw = rawOf(other);
        return this.raw < raw ? -1 : this.raw > raw ? 1 : 0;
    }

    lt(other) {
        return this.compare(other) < 0;
    }

    gt(other) {
        return this.compare(other) > 0;
    }

    eq(other) {
        return this.compare(other) === 0;
    }

    floor() {
        return Number(this.raw >> 32n);
    }

    toNumber() {
        return Number(this.raw) / 4294967296;
    }

    toString() {
        const magnitude = this.raw < 0n ? -this.raw : this.raw;
        const digits = divide((magnitude & (ONE - 1n)) * 10n ** 10n, ONE);
        const whole = (magnitude >> 32n) + digits / 10n ** 10n;
        const fraction = (digits % 10n ** 10n).toString().padStart(10, "0").replace(/0+$/, "");
        return `${this.raw < 0n ? "-" : ""}${whole}${fraction === "" ? "" : `.${fraction}`}`;
    }

    toJSON() {
        return this.toString();
    }

    [INSPECT]() {
        return `Fx(${this})`;
    }

    [Symbol.toPrimitive](hint) {
        return primitive(this, hint, "an Fx", "add, sub, mul, div, lt, gt, eq");
    }
}

export function fx(value) {
    return value instanceof Fx ? value : new Fx(rawOf(value));
}

export class Angle {
    constructor(bits) {
        this.bits = Number(integer(bits, "bits of an angle", Number.MIN_SAFE_INTEGER, Number.MAX_SAFE_INTEGER)) >>> 0;
        Object.freeze(this);
    }

    add(other) {
        return new Angle(this.bits + bitsOf(other));
    }

    sub(other) {
        return new Angle(this.bits - bitsOf(other));
    }

    neg() {
        return new Angle(-this.bits);
    }

    toDegrees() {
        return new Fx(signed(this.bits) * 360n);
    }

    toRadians() {
        return new Fx((signed(this.bits) * 7244019458077122842n + (1n << 59n)) >> 60n);
    }

    toNumber() {
        return (Number(signed(this.bits)) / 4294967296) * 2 * Math.PI;
    }

    /** Degrees as decimal text, such as "45". */
    toString() {
        return this.toDegrees().toString();
    }

    toJSON() {
        return this.bits;
    }

    [Symbol.toPrimitive](hint) {
        return primitive(this, hint, "an Angle", "add, sub, neg, toDegrees");
    }

    [INSPECT]() {
        return `Angle(${this} degrees)`;
    }
}

/** An angle as a signed number of units of 2^-32 turn, above -1/2 turn and up to 1/2 turn. */
const signed = (bits) => (bits === 0x80000000 ? BigInt(bits) : BigInt.asIntN(32, BigInt(bits)));

const angleOf = (raw) => new Angle(Number(BigInt.asUintN(32, raw)));

export function degrees(value) {
    const raw = rawOf(value, "an angle");
    const rest = raw % 360n;
    return angleOf(raw / 360n + (rest >= 180n ? 1n : rest <= -180n ? -1n : 0n));
}

export function radians(value) {
    return angleOf((rawOf(value, "an angle") * 11743562013128004906n + (1n << 65n)) >> 66n);
}

export function turns(value) {
    return angleOf(rawOf(value, "an angle"));
}

export function bitsOf(value, what = "an angle") {
    if (value instanceof Angle) {
        return value.bits;
    }
    if (value === 0) {
        return 0;
    }
    throw new Lockstep2dError("VALUE", `${what} is degrees(45), radians("0.5"), turns("0.25") or 0, and not ${shown(value)}`);
}

/** The raw components of a vector, which is `[x, y]` or `{ x, y }`. */
export function vectorOf(value, what = "a vector") {
    if (Array.isArray(value) && value.length === 2) {
        return [rawOf(value[0], what), rawOf(value[1], what)];
    }
    if (value !== null && typeof value === "object" && "x" in value && "y" in value) {
        return [rawOf(value.x, what), rawOf(value.y, what)];
    }
    throw new Lockstep2dError("VALUE", `${what} is [x, y] or { x, y }, and not ${Array.isArray(value) ? `an array of ${value.length}` : shown(value)}`);
}
