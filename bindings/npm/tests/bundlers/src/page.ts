// Steps one world on the page and an equal one in a worker. Bundlers only remove the types; tsc checks them.
import { play } from "./play.js";

declare global {
    var result: { page?: string; worker?: string };
}
globalThis.result = {};
globalThis.result.page = await play();
const worker = new Worker(new URL("./worker.ts", import.meta.url), { type: "module" });
worker.onmessage = ({ data }: MessageEvent<string>) => (globalThis.result.worker = data);
export {};
