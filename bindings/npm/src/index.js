// lockstep2d: deterministic 2D physics for the web.
export * from "./common.js";
export { Recorder, Recording, Replay, ReplayDriver, Timeline, verifyReplay } from "./replay.js";
export { Match } from "./match.js";
export { MatchDriver } from "./driver.js";
export { Relay } from "./relay.js";
export { decodeNativeState, encodeNativeState, nativeOffer } from "./native.js";

import { initializer } from "./library.js";

export const init = initializer({ simd: () => import("../wasm/simd.js"), plain: () => import("../wasm/plain.js") });
