import { readFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { deflateSync } from "node:zlib";
import { defineConfig } from "vite";

// Three pages, built one after the other: PELLICLE_PAGE is report, live or play. play is the live page with the simulation inside
// instead of a connection to the program; it needs the package of `make wasm`.
const name = process.env.PELLICLE_PAGE ?? "report";
const input = { report: "index.html", live: "live.html", play: "live.html" }[name];
const core = join(dirname(fileURLToPath(import.meta.url)), "../build/wasm/pellicle");

// puts script and style into the page, so the page is one file
function inline() {
    return {
        name: "inline",
        enforce: "post",
        generateBundle(_, bundle) {
            const page = Object.values(bundle).find((part) => part.fileName.endsWith(".html"));
            for (const part of Object.values(bundle)) {
                if (part === page) continue;
                const file = part.fileName.replace(/[.]/g, "[.]");
                if (part.type === "chunk") {
                    const code = part.code.replace(/<(?=\/script|!--)/g, "\\x3c");
                    page.source = page.source
                        .replace(new RegExp(`\\s*<script[^>]*src="[^"]*${file}"[^>]*></script>`), "")
                        .replace("</body>", () => `<script type="module">${code}</script>\n</body>`);
                } else {
                    page.source = page.source.replace(
                        new RegExp(`<link[^>]*href="[^"]*${file}"[^>]*>`),
                        () => `<style>${part.source}</style>`,
                    );
                }
                delete bundle[part.fileName];
            }
            page.fileName = `${name}.html`;
        },
    };
}

// the page with the simulation inside: its own script, the module, and the place where the program inserts scene and meshes
function play() {
    return {
        name: "play",
        transformIndexHtml: {
            order: "pre",
            handler(html) {
                const bytes = deflateSync(readFileSync(join(core, "core.wasm")), { level: 9 }).toString("base64");
                return html
                    .replace("/src/live/served.js", "/src/live/play.js")
                    .replace("</body>", () => `<!--pellicle scene, format 1-->\n<script type="text/plain" id="core">${bytes}</script>\n</body>`);
            },
        },
    };
}

export default defineConfig({
    base: "./",
    plugins: [...(name === "play" ? [play()] : []), inline()],
    resolve: { alias: { pellicle: core } },
    worker: { format: "iife" },
    build: {
        target: ["chrome110", "firefox115", "safari16.4"],
        outDir: "../build/web",
        emptyOutDir: false,
        rollupOptions: { input },
        modulePreload: false,
        chunkSizeWarningLimit: 1000,
        reportCompressedSize: false,
    },
});
