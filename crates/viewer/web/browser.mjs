// Drives a headless Chromium over a pipe, without npm packages.
import { spawn } from "node:child_process";
import { mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";

const TIMEOUT = 120_000;

export class Browser {
    #process;
    #profile;
    #waiting = new Map();
    #last = 0;
    #session;
    #isDown = false;
    // Exceptions and error messages of the page.
    complaints = [];

    static async open(url, [width, height]) {
        const browser = new Browser();
        browser.#start();
        try {
            const { targetId } = await browser.#send("Target.createTarget", { url: "about:blank" });
            const { sessionId } = await browser.#send("Target.attachToTarget", { targetId, flatten: true });
            browser.#session = sessionId;
            await browser.send("Runtime.enable");
            await browser.send("Page.enable");
            await browser.send("Emulation.setDeviceMetricsOverride", { width, height, deviceScaleFactor: 1, mobile: false });
            await browser.send("Page.navigate", { url });
        } catch (error) {
            await browser.close();
            throw error;
        }
        return browser;
    }

    #start() {
        this.#profile = mkdtempSync(join(tmpdir(), "viewer-"));
        const flags = ["--headless=new", "--remote-debugging-pipe", `--user-data-dir=${this.#profile}`, "--no-first-run",
            // Test machines have no GPU, and in a container the user is often root.
            "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist", "--no-sandbox",
            "--disable-dev-shm-usage"];
        const program = process.env.CHROMIUM ?? "chromium";
        this.#process = spawn(program, flags, { stdio: ["ignore", "ignore", "ignore", "pipe", "pipe"] });
        let text = "";
        this.#process.stdio[4].setEncoding("utf8").on("data", (data) => {
            text += data;
            const messages = text.split("\0");
            text = messages.pop();
            messages.forEach((message) => this.#receive(JSON.parse(message)));
        });
        this.#process.on("exit", () => this.#fail(new Error(`${program} has ended`)));
        this.#process.on("error", (error) => this.#fail(error));
    }

    #fail(error) {
        this.#waiting.forEach(({ reject }) => reject(error));
    }

    #receive({ id, result, error, method, params }) {
        if (method === "Runtime.exceptionThrown") {
            this.complaints.push(params.exceptionDetails.exception?.description ?? params.exceptionDetails.text);
        } else if (method === "Runtime.consoleAPICalled" && params.type === "error") {
            this.complaints.push(params.args.map((argument) => argument.value ?? argument.description).join(" "));
        }
        const waiting = this.#waiting.get(id);
        this.#waiting.delete(id);
        if (error) {
            waiting?.reject(new Error(error.message));
        } else {
            waiting?.resolve(result);
        }
    }

    #send(method, params = {}, sessionId = undefined) {
        const id = ++this.#last;
        this.#process.stdio[3].write(`${JSON.stringify({ id, method, params, sessionId })}\0`);
        return new Promise((resolve, reject) => this.#waiting.set(id, { resolve, reject }));
    }

    send(method, params) {
        return this.#send(method, params, this.#session);
    }

    // Evaluates an expression in the page.
    async evaluate(expression) {
        const options = { expression, awaitPromise: true, returnByValue: true };
        const { result, exceptionDetails } = await this.send("Runtime.evaluate", options);
        if (exceptionDetails) {
            throw new Error(exceptionDetails.exception?.description ?? exceptionDetails.text);
        }
        return result.value;
    }

    // Evaluates an expression in the page repeatedly until `holds(value)` is true. Returns the value. Fails after
    // TIMEOUT.
    async until(expression, holds, what) {
        const end = Date.now() + TIMEOUT;
        let value;
        do {
            value = await this.evaluate(expression);
            if (holds(value)) {
                return value;
            }
            await new Promise((resolve) => setTimeout(resolve, 50));
        } while (Date.now() < end);
        throw new Error(`${what}: not reached within ${TIMEOUT / 1000} s, last value ${JSON.stringify(value)}`);
    }

    async press(key, code = key) {
        const codes = { Home: 36, End: 35, ArrowLeft: 37, ArrowRight: 39, PageDown: 34, PageUp: 33, " ": 32 };
        const event = { key, code, windowsVirtualKeyCode: codes[key] ?? key.toUpperCase().charCodeAt(0) };
        await this.send("Input.dispatchKeyEvent", { type: "rawKeyDown", ...event });
        await this.send("Input.dispatchKeyEvent", { type: "keyUp", ...event });
    }

    // Presses, moves or releases the mouse. An event for a move has to name the button that is down, because otherwise
    // Chromium does not capture the pointer.
    async mouse(type, x, y) {
        if (type !== "mouseMoved") {
            this.#isDown = type === "mousePressed";
        }
        const button = type !== "mouseMoved" || this.#isDown ? "left" : "none";
        const event = { type, x, y, button, buttons: Number(this.#isDown), clickCount: Number(type !== "mouseMoved") };
        await this.send("Input.dispatchMouseEvent", event);
    }

    async screenshot() {
        const { data } = await this.send("Page.captureScreenshot", { format: "png" });
        return Buffer.from(data, "base64");
    }

    async close() {
        this.#process.removeAllListeners("exit");
        const ended = new Promise((resolve) => this.#process.on("exit", resolve));
        this.#send("Browser.close").catch(() => {});
        await Promise.race([ended, new Promise((resolve) => setTimeout(resolve, 5000))]);
        this.#process.kill("SIGKILL");
        rmSync(this.#profile, { recursive: true, force: true, maxRetries: 5 });
    }
}
