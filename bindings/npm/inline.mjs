// Writes each wasm module as a JavaScript module with its compressed bytes.
//
// `zopfli` (a Debian package) writes about 5 % fewer bytes than zlib. It takes a minute.
import { execFileSync } from "node:child_process";
import { readFileSync, writeFileSync } from "node:fs";
import { fileURLToPath } from "node:url";
import { gzipSync } from "node:zlib";

const folder = new URL("./wasm/", import.meta.url);

function compress(file, bytes) {
    if (process.env.QUICK) {
        return gzipSync(bytes, { level: 9 });
    }
    try {
        return execFileSync("zopfli", ["-c", fileURLToPath(file)], { maxBuffer: 1 << 26 });
    } catch (error) {
        if (error.code !== "ENOENT") {
            throw error;
        }
        return gzipSync(bytes, { level: 9 });
    }
}

for (const name of process.argv.slice(2)) {
    const file = new URL(`${name}.wasm`, folder);
    const bytes = readFileSync(file);
    const packed = compress(file, bytes);
    const text = `// ${name}.wasm, compressed by gzip. Written by build; do not edit it.\nexport default "${packed.toString("base64")}";\n`;
    writeFileSync(new URL(`${name}.js`, folder), text);
    console.log(`${name}: ${bytes.length} bytes, ${packed.length} compressed`);
}
