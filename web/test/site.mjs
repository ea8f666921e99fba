// The pages of `make site` in Chromium: no page has a script error or asks another machine for anything, and none is wider than a phone.
// usage: node site.mjs FOLDER
import assert from "node:assert/strict";
import { readdirSync, readFileSync } from "node:fs";
import { createServer } from "node:http";
import { join, relative, resolve } from "node:path";
import { startBrowser } from "./browser.mjs";

const folder = resolve(process.argv[2] ?? "../build/site");
const pages = (at) =>
    readdirSync(at, { withFileTypes: true }).flatMap((entry) => {
        const path = join(at, entry.name);
        if (entry.isDirectory()) return ["c", "live", "assets"].includes(entry.name) ? [] : pages(path);
        return entry.name.endsWith(".html") ? [path] : [];
    });

const types = { html: "text/html", css: "text/css", js: "text/javascript", json: "application/json", svg: "image/svg+xml", png: "image/png", gif: "image/gif" };
const server = createServer((request, response) => {
    try {
        const path = decodeURIComponent(new URL(request.url, "http://localhost").pathname);
        const bytes = readFileSync(join(folder, path));
        response.writeHead(200, { "content-type": types[path.split(".").pop()] ?? "application/octet-stream" }).end(bytes);
    } catch {
        response.writeHead(404).end();
    }
});
await new Promise((done) => server.listen(0, "127.0.0.1", done));
const home = `http://127.0.0.1:${server.address().port}/`;

const browser = await startBrowser();
const found = [];
let count = 0;
try {
    for (const path of pages(folder)) {
        const name = relative(folder, path);
        const { errors, width } = await browser.read(home + name, { width: 390, height: 844 });
        found.push(...errors.map((error) => `${name}: ${error}`));
        if (width > 390) found.push(`${name}: ${width} pixels wide on a phone`);
        count++;
    }
} finally {
    await browser.close();
    server.close();
}
assert.ok(count > 20, `${count} pages in ${folder}`);
assert.deepEqual(found, []);
console.log(`${count} pages: no error, no request to another machine, none wider than a phone`);
