// The page of `pellicle live --html`: the simulation runs in a worker of the page.
import { fromBase64 } from "../data.js";
import { run } from "./main.js";
import { WorkerWire } from "./worker-wire.js";

async function unpack(element) {
    const stream = new Blob([fromBase64(element.textContent)]).stream().pipeThrough(new DecompressionStream("deflate"));
    return new Uint8Array(await new Response(stream).arrayBuffer());
}

// { core, scene, files, paused }: data that the program wrote into the page (src/service/live/page.c), and the module from the build of
// the page
async function readPage() {
    const { scene, files, paused } = JSON.parse(document.getElementById("scene").textContent);
    const meshes = await Promise.all([...document.querySelectorAll(".mesh")].map(unpack));
    const core = await unpack(document.getElementById("core"));
    return { core, scene, paused, files: Object.fromEntries(files.map((name, i) => [name, meshes[i]])) };
}

run((received, changed) => new WorkerWire(readPage(), received, changed));
