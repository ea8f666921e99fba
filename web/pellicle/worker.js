// The worker of remote.js: runs simulations, in browsers and in Node.js. Messages: { id, name, values }; answers: { id, result } or { id, error }.
import { load } from "./pellicle.js";

const port = typeof globalThis.postMessage === "function" ? globalThis : (await import(/* @vite-ignore */ "node:worker_threads")).parentPort;
const listen = (received) => (port === globalThis ? (port.onmessage = ({ data }) => received(data)) : port.on("message", received));

const simulations = new Map();
let module = null;

// views of the module's memory are valid until the next call: copies are sent
const copied = (value) => (ArrayBuffer.isView(value) ? value.slice() : value);

async function act(handle, name, values) {
    if (name === "create") {
        module ??= load();
        simulations.set(handle, (await module).simulation(...values));
        return undefined;
    }
    const simulation = simulations.get(handle);
    if (name === "get") return copied(simulation[values[0]]);
    if (name === "dispose") simulations.delete(handle);
    if (name === "advance") {
        // steps and arrays in one message: { count, positions: [bodies], fields: [[field, body]] }
        const { count, positions = [], fields = [] } = values[0];
        simulation.step(count);
        return { time: simulation.time, positions: positions.map((body) => simulation.positions(body).slice()), fields: fields.map(([field, body]) => simulation.field(field, body).slice()) };
    }
    return copied(simulation[name](...values));
}

const buffersOf = (value) => {
    if (ArrayBuffer.isView(value)) return [value.buffer];
    return value && typeof value === "object" ? [...(value.positions ?? []), ...(value.fields ?? [])].filter(ArrayBuffer.isView).map(({ buffer }) => buffer) : [];
};

listen(async ({ id, handle, name, values }) => {
    try {
        const result = await act(handle, name, values);
        port.postMessage({ id, result }, buffersOf(result));
    } catch (error) {
        const { message, status, what, remedy, file, line, column } = error;
        port.postMessage({ id, error: { message, status, what, remedy, file, line, column } });
    }
});
