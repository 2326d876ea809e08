// Runs a WebAssembly program in node: `node wasi.mjs FILE [ARGUMENT...]`.
import { readFile } from "node:fs/promises";
import { argv, exit } from "node:process";
import { WASI } from "node:wasi";

const [file, ...words] = argv.slice(2);
const wasi = new WASI({ version: "preview1", args: [file, ...words], returnOnExit: true });
const module = await WebAssembly.compile(await readFile(file));
const instance = await WebAssembly.instantiate(module, { wasi_snapshot_preview1: wasi.wasiImport });
exit(wasi.start(instance));
