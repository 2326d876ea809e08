// A static file server for the tests in a browser.
import { readFileSync } from "node:fs";
import { createServer } from "node:http";
import { extname } from "node:path";

const TYPES = {
    ".html": "text/html",
    ".js": "text/javascript",
    ".mjs": "text/javascript",
    ".wasm": "application/wasm",
};

/** Serves the folder of a URL that ends with a slash. `/blank.html` is an empty page. */
export async function serve(root) {
    const server = createServer((request, response) => {
        const { pathname } = new URL(request.url, "http://localhost");
        const path = pathname.endsWith("/") ? `${pathname}index.html` : pathname;
        if (path === "/blank.html") {
            response.writeHead(200, { "content-type": "text/html" }).end("<!doctype html>");
            return;
        }
        try {
            const bytes = readFileSync(new URL(`.${path}`, root));
            response.writeHead(200, { "content-type": TYPES[extname(path)] ?? "application/octet-stream" }).end(bytes);
        } catch {
            response.writeHead(404).end();
        }
    });
    await new Promise((done) => server.listen(0, "127.0.0.1", done));
    return { address: `http://127.0.0.1:${server.address().port}`, close: () => server.close() };
}
