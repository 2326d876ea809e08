// Runs a WebAssembly program: `node wasi.mjs FILE [ARGUMENT...]`. This file does not use `node:wasi`, which in some
// versions of node writes to a stale buffer after the program's memory has grown.
import { readFileSync, writeSync } from "node:fs";
import process from "node:process";

const words = process.argv.slice(2).map((word) => Buffer.from(`${word}\0`));
const OK = 0, BAD_FILE = 8;
class Exit extends Error {}

let memory;
// Makes a new view for each access, because growing the memory detaches the old buffer.
const bytes = () => new Uint8Array(memory.buffer);
const set = (at, number) => new DataView(memory.buffer).setUint32(at, number, true);
const get = (at) => new DataView(memory.buffer).getUint32(at, true);

const wasi_snapshot_preview1 = {
    args_sizes_get(count, size) {
        set(count, words.length);
        set(size, words.reduce((sum, word) => sum + word.length, 0));
        return OK;
    },
    args_get(pointers, texts) {
        for (const word of words) {
            set(pointers, texts);
            bytes().set(word, texts);
            pointers += 4;
            texts += word.length;
        }
        return OK;
    },
    environ_sizes_get(count, size) {
        set(count, 0);
        set(size, 0);
        return OK;
    },
    environ_get: () => OK,
    fd_write(file, pieces, count, written) {
        if (file !== 1 && file !== 2) return BAD_FILE;
        let sum = 0;
        for (let i = 0; i < count; i++) {
            const start = get(pieces + 8 * i), length = get(pieces + 8 * i + 4);
            for (let done = 0; done < length; ) {
                done += writeSync(file, bytes(), start + done, length - done);
            }
            sum += length;
        }
        set(written, sum);
        return OK;
    },
    proc_exit(code) {
        process.exitCode = code;
        throw new Exit();
    },
};

const module = new WebAssembly.Module(readFileSync(process.argv[2]));
const program = new WebAssembly.Instance(module, { wasi_snapshot_preview1 }).exports;
memory = program.memory;
try {
    program._start();
} catch (error) {
    if (!(error instanceof Exit)) throw error;
}
