// Starts Chromium without a display and opens pages in it.
import { mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { chromium } from "playwright-core";

const flags = [
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
];

// { open(file, { viewport, dark }), play(file, the same), visit(address, the same), close() }; open gives { page, errors,
// opened }, opened in milliseconds; read gives { errors, width } of any page; visit gives { page, errors } of the live page once it has drawn, play those of a page
// that simulates by itself with the milliseconds until it had `drawn`, or had said why it cannot
export async function startBrowser() {
    const profile = mkdtempSync(join(tmpdir(), "pellicle-browser-"));
    const context = await chromium.launchPersistentContext(profile, {
        executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
        args: flags,
        viewport: { width: 1280, height: 800 },
    });
    const newPage = async (allowed, viewport, dark) => {
        const page = await context.newPage();
        const errors = [];
        page.on("console", (message) => message.type() === "error" && errors.push(message.text()));
        page.on("pageerror", (error) => errors.push(String(error)));
        page.on("request", (request) => !allowed.test(request.url()) && errors.push(request.url()));
        await page.setViewportSize(viewport);
        await page.emulateMedia({ colorScheme: dark ? "dark" : "light" });
        return { page, errors };
    };
    return {
        async open(file, { viewport = { width: 1280, height: 800 }, dark = false } = {}) {
            const { page, errors } = await newPage(/^(file|data|blob):/, viewport, dark);
            const start = performance.now();
            await page.goto(`file://${file}`);
            await page.waitForFunction(() => globalThis.pellicle?.view.pictures > 0);
            const drawn = performance.now() - start;
            await page.waitForFunction(() => document.body.classList.contains("ready"));
            return { page, errors, drawn, opened: performance.now() - start };
        },
        async read(address, viewport) {
            const { page, errors } = await newPage(/^(http:\/\/127\.0\.0\.1:|data:|blob:)/, viewport, false);
            await page.goto(address);
            await page.waitForLoadState("networkidle");
            const width = await page.evaluate(() => document.documentElement.scrollWidth);
            await page.close();
            return { errors, width };
        },
        async play(file, { viewport = { width: 1280, height: 800 }, dark = false } = {}) {
            const { page, errors } = await newPage(/^(file|data|blob):/, viewport, dark);
            const start = performance.now();
            await page.goto(`file://${file}`);
            await page.waitForFunction(() => globalThis.pellicle?.frame || document.body.classList.contains("away"));
            return { page, errors, drawn: performance.now() - start };
        },
        // script: a file that the page runs first
        async visit(address, { viewport = { width: 1280, height: 800 }, dark = false, script } = {}) {
            const { page, errors } = await newPage(/^(http:\/\/127\.0\.0\.1:|ws:\/\/127\.0\.0\.1:|data:|blob:)/, viewport, dark);
            if (script) await page.addInitScript(script);
            await page.goto(address);
            await page.waitForFunction(() => globalThis.pellicle?.frame);
            return { page, errors };
        },
        // a page of this machine that does not say when it is ready
        async raw({ viewport = { width: 1280, height: 800 }, dark = false } = {}) {
            return newPage(/^(http:\/\/127\.0\.0\.1:|data:|blob:)/, viewport, dark);
        },
        async close() {
            await context.close();
            rmSync(profile, { recursive: true, force: true });
        },
    };
}
