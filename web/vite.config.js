import { defineConfig } from "vite";

// two pages, built one after the other: PELLICLE_PAGE is report or live
const name = process.env.PELLICLE_PAGE ?? "report";
const input = name === "report" ? "index.html" : `${name}.html`;

// puts the script and the style into the page, so that it is one file
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

export default defineConfig({
    base: "./",
    plugins: [inline()],
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
