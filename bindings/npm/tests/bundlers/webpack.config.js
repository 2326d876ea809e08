import { fileURLToPath } from "node:url";

// tsc compiles the TypeScript before webpack runs.
export default {
    mode: "production",
    entry: "./build/page.js",
    output: { path: fileURLToPath(new URL("dist-webpack", import.meta.url)), publicPath: "auto" },
    performance: false,
};
