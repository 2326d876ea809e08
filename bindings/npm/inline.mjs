// Writes each wasm module as a JavaScript module with its compressed bytes, which every bundler can handle.
import { readFileSync, writeFileSync } from "node:fs";
import { gzipSync } from "node:zlib";

const folder = new URL("./wasm/", import.meta.url);
for (const name of ["simd", "plain"]) {
    const bytes = readFileSync(new URL(`${name}.wasm`, folder));
    const packed = gzipSync(bytes, { level: 9 });
    const text = `// ${name}.wasm, compressed by gzip. Written by build; do not edit it.\nexport default "${packed.toString("base64")}";\n`;
    writeFileSync(new URL(`${name}.js`, folder), text);
    console.log(`${name}: ${bytes.length} bytes, ${packed.length} compressed`);
}
