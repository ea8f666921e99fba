import { defineConfig } from "vite";

// puts the script and the style into the page, so that it is one file
function inline() {
    return {
        name: "inline",
        enforce: "post",
        generateBundle(_, bundle) {
            const page = Object.values(bundle).find((part) => part.fileName.endsWith(".html"));
            for (const part of Object.values(bundle)) {
                if (part === page) continue;
                const name = part.fileName.replace(/[.]/g, "[.]");
                if (part.type === "chunk") {
                    const code = part.code.replace(/<(?=\/script|!--)/g, "\\x3c");
                    page.source = page.source
                        .replace(new RegExp(`\\s*<script[^>]*src="[^"]*${name}"[^>]*></script>`), "")
                        .replace("</body>", () => `<script type="module">${code}</script>\n</body>`);
                } else {
                    page.source = page.source.replace(
                        new RegExp(`<link[^>]*href="[^"]*${name}"[^>]*>`),
                        () => `<style>${part.source}</style>`,
                    );
                }
                delete bundle[part.fileName];
            }
            page.fileName = "report.html";
        },
    };
}

export default defineConfig({
    base: "./",
    plugins: [inline()],
    build: {
        target: ["chrome110", "firefox115", "safari16.4"],
        outDir: "../build/web",
        emptyOutDir: true,
        modulePreload: false,
        chunkSizeWarningLimit: 1000,
        reportCompressedSize: false,
    },
});
