import { play } from "./play.js";

const hash = await play();
self.postMessage(hash);
