// Classes for the calls of src/wasm/calls.h. Views are in the memory of the module and are valid until the next call.
import makeCore from "./core.mjs";

export class PellicleError extends Error {
    constructor(details) {
        super(details.message);
        this.name = "PellicleError";
        Object.assign(this, details);
    }
}

const outOfMemory = () =>
    new PellicleError({ message: "out of memory", status: "out of memory", what: "out of memory", remedy: "", file: "", line: 0, column: 0 });

// checks that a path is inside the folder of the scene
function checkName(name) {
    if (name === "" || name.startsWith("/") || name.split("/").includes(".."))
        throw new TypeError(`the file '${name}' is not inside the folder of the scene. use a relative path without ..`);
    return name;
}

/* ---- memory ---- */

// bytes; the memory of a module grows and never shrinks
const LARGE = 128 << 20;

class Memory {
    // make: async, a new module
    constructor(core, make) {
        this.core = core;
        this.make = make;
        this.decoder = new TextDecoder();
        this.folders = 0;
        this.open = 0; // handles
        this.renewal = null;
    }

    // replaces a module that has grown large by a new one, once nothing of it is open
    shrink() {
        if (this.open > 0 || this.renewal || this.core.HEAPU8.length <= LARGE) return;
        this.renewal = this.make()
            .then((core) => {
                if (this.open === 0) this.core = core;
            })
            .catch(() => {}) // no memory for a second one: the old one goes on
            .finally(() => {
                this.renewal = null;
            });
    }

    // calls use(address) with a copy of the text
    withText(text, use) {
        const size = this.core.lengthBytesUTF8(text);
        const at = this.core._malloc(size + 1);
        if (at === 0) throw outOfMemory();
        this.core.stringToUTF8(text, at, size + 1);
        try {
            return use(at, size);
        } finally {
            this.core._free(at);
        }
    }

    // calls use(address of an array of addresses) with copies of the texts
    withTexts(texts, use, addresses = []) {
        if (texts.length > 0) return this.withText(texts[0], (at) => this.withTexts(texts.slice(1), use, [...addresses, at]));
        const list = this.core._malloc(4 * addresses.length + 4);
        if (list === 0) throw outOfMemory();
        this.core.HEAPU32.set(addresses, list / 4);
        try {
            return use(list);
        } finally {
            this.core._free(list);
        }
    }

    // the bytes of a pel_wasm_text
    bytes(address) {
        const [at, size] = this.core.HEAPU32.subarray(address / 4, address / 4 + 2);
        if (at === 0) throw outOfMemory();
        return this.core.HEAPU8.subarray(at, at + size);
    }

    text(address) {
        return this.decoder.decode(this.bytes(address));
    }

    view(Kind, address, length) {
        if (address === 0 && length > 0) throw outOfMemory();
        return new Kind(this.core.HEAPU8.buffer, address, length);
    }

    // a new folder with files in it: name -> text or bytes
    makeFolder(files) {
        const folder = `/${++this.folders}`;
        this.core.FS.mkdir(folder);
        for (const [name, content] of Object.entries(files)) {
            const parts = checkName(name).split("/");
            for (let depth = 1; depth < parts.length; depth++) {
                const path = `${folder}/${parts.slice(0, depth).join("/")}`;
                if (!this.core.FS.analyzePath(path).exists) this.core.FS.mkdir(path);
            }
            this.core.FS.writeFile(`${folder}/${name}`, content instanceof ArrayBuffer ? new Uint8Array(content) : content);
        }
        return folder;
    }

    removeFolder(path) {
        const { FS } = this.core;
        for (const name of FS.readdir(path).filter((name) => name !== "." && name !== "..")) {
            const inner = `${path}/${name}`;
            if (FS.isDir(FS.stat(inner).mode)) this.removeFolder(inner);
            else FS.unlink(inner);
        }
        FS.rmdir(path);
    }
}

// converts a value to the text for --set
function format(value) {
    if (Array.isArray(value) || ArrayBuffer.isView(value)) return `[${Array.from(value, format).join(", ")}]`;
    return Number.isNaN(value) ? "auto" : String(value);
}

const numbers = (...values) => values.flatMap((value) => (typeof value === "object" ? Array.from(value) : [value])).join(" ");

// a handle of the module for a scene, which has its own folder
class Handle {
    constructor(memory, kind, text, { files = {}, path = "scene.yaml", set = {} } = {}) {
        this.memory = memory;
        this.kind = kind;
        this.handle = 0;
        this.folder = memory.makeFolder(files);
        memory.open++;
        const overrides = Object.entries(set).map(([key, value]) => `${key}=${format(value)}`);
        const create = memory.core[`_pel_wasm_${kind}_create`];
        try {
            this.handle = memory.withText(`${this.folder}/${checkName(path)}`, (name) =>
                memory.withText(text, (at, size) => memory.withTexts(overrides, (list) => create(name, at, size, list, overrides.length))));
        } catch (error) {
            this.dispose();
            throw error;
        }
        if (this.handle !== 0 && this.call("status") === 0) return;
        const error = this.handle !== 0 ? this.error() : outOfMemory();
        this.dispose();
        throw error;
    }

    call(name, ...values) {
        if (this.handle === 0) throw new Error("the simulation was disposed. create a new one");
        return this.memory.core[`_pel_wasm_${this.kind}_${name}`](this.handle, ...values);
    }

    // replaces the paths of files by the names that the caller uses
    local(text) {
        return text.replaceAll(`${this.folder}/`, "");
    }

    text(name) {
        return this.memory.text(this.call(name));
    }

    json(name) {
        return JSON.parse(this.text(name));
    }

    error() {
        return new PellicleError(JSON.parse(this.local(this.text("error"))));
    }

    // throws the error of the last call
    check() {
        if (this.call("status") !== 0) throw this.error();
    }

    dispose() {
        if (this.handle) this.call("destroy");
        this.handle = 0;
        if (!this.folder) return;
        this.memory.removeFolder(this.folder);
        this.folder = "";
        this.memory.open--;
        this.memory.shrink();
    }
}

/* ---- simulations ---- */

export class Simulation {
    #handle;
    #hello;

    constructor(memory, text, options) {
        this.#handle = new Handle(memory, "sim", text, options);
        this.#hello = this.#handle.json("hello");
    }

    dispose() {
        this.#handle.dispose();
    }

    /* ---- properties and state ---- */

    get title() {
        return this.#hello.title;
    }

    get dt() {
        return this.#hello.dt;
    }

    get bodies() {
        return this.#hello.bodies.map(({ name, closed }, b) => ({
            name,
            closed,
            vertexCount: this.#handle.call("vertex_count", b),
            triangleCount: this.#handle.call("triangle_count", b),
        }));
    }

    get fields() {
        return this.#hello.fields;
    }

    get box() {
        return { low: this.#hello.low, high: this.#hello.high };
    }

    get notes() {
        return this.#handle.json("notes");
    }

    get time() {
        return this.#handle.call("time");
    }

    get stepCount() {
        return this.#handle.call("step_count");
    }

    get hash() {
        return this.summary().hash;
    }

    summary() {
        return this.#handle.json("summary");
    }

    #body(body) {
        const index = typeof body === "string" ? this.#hello.bodies.findIndex(({ name }) => name === body) : body;
        if (!this.#hello.bodies[index]) throw new RangeError(`there is no body ${JSON.stringify(body)}. use one of ${this.#hello.bodies.map(({ name }) => name).join(", ")}`);
        return index;
    }

    #view(Kind, address, length) {
        return this.#handle.memory.view(Kind, address, length);
    }

    positions(body = 0) {
        const index = this.#body(body);
        return this.#view(Float32Array, this.#handle.call("positions", index), 3 * this.#handle.call("vertex_count", index));
    }

    triangles(body = 0) {
        const index = this.#body(body);
        return this.#view(Uint32Array, this.#handle.call("triangles", index), 3 * this.#handle.call("triangle_count", index));
    }

    surfaceRevision(body = 0) {
        return this.#handle.call("revision", this.#body(body));
    }

    field(name, body = 0) {
        const index = this.#body(body);
        const field = this.fields.findIndex((known) => known.name === name);
        if (field < 0) throw new RangeError(`there is no field '${name}'. use one of ${this.fields.map((known) => known.name).join(", ")}`);
        const address = this.#handle.call("field", field, index);
        this.#handle.check();
        return this.#view(Float32Array, address, this.fields[field].components * this.#handle.call("vertex_count", index));
    }

    pick(origin, direction) {
        const address = this.#handle.call("pick", ...origin, ...direction);
        this.#handle.check();
        const [isHit, body, triangle, meshVertex, distance, ...rest] = this.#view(Float64Array, address, 17);
        if (!isHit) return null;
        return { body, triangle, meshVertex, distance, point: rest.slice(0, 3), normal: rest.slice(3, 6), vertices: rest.slice(6, 9), weights: rest.slice(9, 12) };
    }

    tips(body = 0) {
        const number = this.#body(body);
        const address = this.#handle.call("tips", number);
        this.#handle.check();
        const [count] = this.#view(Float64Array, address, 1);
        const numbers = this.#view(Float64Array, address, 1 + 12 * count).slice(1);
        return Array.from({ length: count }, (_, t) => {
            const [vertex, ...rest] = numbers.slice(12 * t, 12 * t + 12);
            return { body: number, vertex, position: rest.slice(0, 3), ahead: rest.slice(3, 6), force: rest.slice(6, 9), release: rest[9], rate: rest[10] };
        });
    }

    rigid(body = 0) {
        const address = this.#handle.call("rigid", this.#body(body));
        if (!address) return null;
        const [mass, ...rest] = this.#view(Float64Array, address, 21);
        const [center, rotation, velocity, spin, momentum, angularMomentum] = [
            [0, 3],
            [3, 7],
            [7, 10],
            [10, 13],
            [13, 16],
            [16, 19],
        ].map(([begin, end]) => rest.slice(begin, end));
        return { mass, center, rotation, velocity, spin, momentum, angularMomentum, kineticEnergy: rest[19] };
    }

    joint(name) {
        const address = this.#handle.memory.withText(name, (at) => this.#handle.call("joint", at));
        if (!address) return null;
        const numbers = this.#view(Float64Array, address, 10);
        const [position, speed] = numbers;
        return { position, speed, force: [...numbers.slice(2, 5)], torque: [...numbers.slice(5, 8)], load: numbers[8], work: numbers[9] };
    }

    /* ---- steps and changes ---- */

    step(count = 1) {
        this.#handle.call("step", count);
        this.#handle.check();
    }

    apply(line) {
        this.#handle.memory.withText(line, (at) => this.#handle.call("apply", at));
        this.#handle.check();
    }

    parameters() {
        return this.#handle.json("parameters").list;
    }

    set(path, value) {
        this.apply(`set ${path} ${format(value)}`);
    }

    grasp(origin, direction, { reach = 0, anew = false } = {}) {
        this.apply(`grasp ${numbers(origin, direction, reach, anew ? 1 : 0)}`);
        return this.summary().hand.kind === "grasp";
    }

    grab(origin, direction, { stiffness = this.#hello.stiffness, reach = 0 } = {}) {
        this.apply(`grab ${numbers(origin, direction, stiffness, reach)}`);
        return this.summary().hand.kind === "grab";
    }

    press({ shape = "sphere", radius, position, rotation = [0, 0, 0, 1] }) {
        this.apply(`press ${shape} ${numbers(radius, position, rotation)}`);
    }

    move(target) {
        this.apply(`move ${numbers(target)}`);
    }

    release() {
        this.apply("release");
    }

    pin(origin, direction, reach = 0) {
        this.apply(`pin ${numbers(origin, direction, reach)}`);
    }

    unpin(origin, direction, reach = 0) {
        this.apply(`unpin ${numbers(origin, direction, reach)}`);
    }

    cut(origin, direction) {
        this.apply(`cut ${numbers(origin, direction)}`);
    }

    inflate(body, pressure) {
        this.apply(`inflate ${this.#hello.bodies[this.#body(body)].name} ${numbers(pressure)}`);
    }

    mark() {
        this.apply("mark");
    }

    undo() {
        const done = this.#handle.call("undo");
        this.#handle.check();
        return done === 1;
    }

    reset() {
        this.#handle.call("reset");
        this.#handle.check();
    }

    scene() {
        const address = this.#handle.call("scene");
        this.#handle.check();
        return this.#handle.local(this.#handle.memory.text(address));
    }
}

// A simulation that runs in real time and uses the messages of `pellicle live` (src/live/message.h).
export class Live {
    #handle;

    // receive(message) gets strings and ArrayBuffers
    constructor(memory, text, options, receive) {
        this.#handle = new Handle(memory, "live", text, options);
        this.receive = receive;
    }

    dispose() {
        this.#handle.dispose();
    }

    send(line) {
        this.#handle.memory.withText(line, (at) => this.#handle.call("line", at));
    }

    // executes due steps and returns the seconds until the next turn
    turn() {
        const rest = this.#handle.call("turn");
        for (;;) {
            const message = this.#handle.memory.bytes(this.#handle.call("take"));
            if (message.length === 0) return rest;
            if (this.#handle.call("is_binary")) this.receive(message.slice().buffer);
            else this.receive(this.#handle.local(this.#handle.memory.decoder.decode(message)));
        }
    }
}

export class Pellicle {
    #memory;

    constructor(core, make) {
        this.#memory = new Memory(core, make);
    }

    get memoryBytes() {
        return this.#memory.core.HEAPU8.length;
    }

    simulation(text, options) {
        return new Simulation(this.#memory, text, options);
    }

    live(text, options, receive) {
        return new Live(this.#memory, text, options, receive);
    }
}

// bytes: the contents of core.wasm
export async function instantiate(bytes) {
    const make = () => makeCore({ wasmBinary: bytes, printErr: () => {}, print: () => {} });
    return new Pellicle(await make(), make);
}
