// lockstep2d/core: without replays and matches, for smaller pages.
export * from "./common.js";

import { initializer } from "./library.js";

export const init = initializer({ simd: () => import("../wasm/core-simd.js"), plain: () => import("../wasm/core-plain.js") });
