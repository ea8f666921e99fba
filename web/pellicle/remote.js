// Simulations in a worker, so that a page stays responsive while a step takes longer than a picture.
const isNode = Boolean(globalThis.process?.versions?.node);

async function startWorker() {
    const url = new URL("./worker.js", import.meta.url);
    if (!isNode) return new Worker(url, { type: "module" });
    const { Worker: NodeWorker } = await import(/* @vite-ignore */ "node:worker_threads");
    return new NodeWorker(url);
}

const methods = ["step", "advance", "positions", "triangles", "field", "summary", "pick", "tips", "apply", "parameters", "set", "grab", "grasp", "press", "move", "release", "pin", "unpin", "cut", "inflate", "mark", "undo", "reset", "scene", "surfaceRevision"];

// { simulation(scene, options), close() }. A simulation has the methods of pellicle.js, which return promises here, and in addition
// get(property), and advance({ count, positions, fields }): steps, with copies of arrays at their end. Calls are executed in their order.
export async function remote(worker = null) {
    worker ??= await startWorker();
    const waiting = new Map();
    let count = 0;
    const receive = ({ id, result, error }) => {
        const { done, failed } = waiting.get(id);
        waiting.delete(id);
        if (error) failed(Object.assign(new Error(error.message), error));
        else done(result);
    };
    const fail = (error) => {
        for (const { failed } of waiting.values()) failed(error instanceof Error ? error : new Error(error.message ?? "the worker failed"));
        waiting.clear();
    };
    if (isNode) worker.on("message", receive).on("error", fail);
    else Object.assign(worker, { onmessage: ({ data }) => receive(data), onerror: fail });
    const call = (handle, name, values) =>
        new Promise((done, failed) => {
            waiting.set(++count, { done, failed });
            worker.postMessage({ id: count, handle, name, values });
        });
    let handles = 0;
    return {
        async simulation(scene, options = {}) {
            const handle = ++handles;
            await call(handle, "create", [scene, options]);
            return {
                ...Object.fromEntries(methods.map((name) => [name, (...values) => call(handle, name, values)])),
                get: (property) => call(handle, "get", [property]),
                dispose: () => call(handle, "dispose", []),
            };
        },
        close: () => worker.terminate(),
    };
}
