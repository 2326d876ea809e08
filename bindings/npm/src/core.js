// lockstep2d/core: without replays and matches.
export * from "./common.js";

import { initializer } from "./library.js";

export const init = initializer({ simd: () => import("../wasm/core-simd.js"), plain: () => import("../wasm/core-plain.js") });
