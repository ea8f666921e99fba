// A page that simulates by itself, in Chromium: it draws a first picture without an error.
// usage: node opens.mjs FILE
import assert from "node:assert/strict";
import { resolve } from "node:path";
import { startBrowser } from "./browser.mjs";

const browser = await startBrowser();
try {
    const { errors, drawn } = await browser.play(resolve(process.argv[2]));
    assert.deepEqual(errors, []);
    console.log(`first picture after ${Math.round(drawn)} ms`);
} finally {
    await browser.close();
}
