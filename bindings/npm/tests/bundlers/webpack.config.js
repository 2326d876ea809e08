import { fileURLToPath } from "node:url";

// The TypeScript is compiled by tsc before.
export default {
    mode: "production",
    entry: "./build/page.js",
    output: { path: fileURLToPath(new URL("dist-webpack", import.meta.url)), publicPath: "auto" },
    performance: false,
};
