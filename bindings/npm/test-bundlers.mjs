// Opens built pages in a headless Chromium: node bindings/npm/test-bundlers.mjs RESULT FOLDER...
//
// In each page, `globalThis.result` has to be { page: RESULT, worker: RESULT }: the page and its worker compute it
// separately.
import assert from "node:assert/strict";
import { basename, resolve } from "node:path";
import { pathToFileURL } from "node:url";
import { Browser } from "../../crates/viewer/web/browser.mjs";
import { serve } from "./serve.mjs";

const [expected, ...folders] = process.argv.slice(2);
for (const folder of folders) {
    const server = await serve(pathToFileURL(`${resolve(folder)}/`));
    const browser = await Browser.open(`${server.address}/`, [800, 600]);
    try {
        const result = await browser.until("globalThis.result", (found) => found?.page && found.worker, `${folder}: both results`);
        assert.deepEqual(result, { page: expected, worker: expected });
        assert.deepEqual(browser.complaints, []);
    } finally {
        await browser.close();
        server.close();
    }
    console.log(`${basename(folder)}: the page and its worker have the expected hash`);
}
