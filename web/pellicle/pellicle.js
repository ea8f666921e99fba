// Pellicle in JavaScript: `load` loads the module next to this file, in browsers and in Node.js.
import { instantiate } from "./module.js";

export { PellicleError } from "./module.js";

async function readBytes(source) {
    if (source instanceof ArrayBuffer || ArrayBuffer.isView(source)) return source;
    const url = new URL(source, import.meta.url);
    if (url.protocol === "file:" && globalThis.process?.versions?.node) {
        const { readFile } = await import(/* @vite-ignore */ "node:fs/promises");
        return readFile(url);
    }
    const response = await fetch(url);
    if (!response.ok) throw new Error(`${url}: ${response.status} ${response.statusText}`);
    return response.arrayBuffer();
}

// source: bytes of core.wasm or its URL; default: the file next to this one
export async function load(source = new URL("./core.wasm", import.meta.url)) {
    return instantiate(await readBytes(source));
}
