// Requests of a match or a replay to a game.
import { call, copy, read, scratch, sizeOf, u32 } from "./library.js";

const REQUESTS = ["save", "load", "advance", "checksum", "forget"];

/** The next request, or undefined. `inputBytes` is the number of bytes of the inputs of a tick. */
export function nextRequest(name, handle, inputBytes) {
    const size = sizeOf("request");
    const at = scratch(8 + size + inputBytes);
    if (!call(name, handle, at + 8, at + 8 + size, inputBytes, at)) {
        return undefined;
    }
    const { kind, ...rest } = read("request", at + 8);
    return { ...rest, kind: REQUESTS[kind], inputs: copy(at + 8 + size, u32(at)) };
}
