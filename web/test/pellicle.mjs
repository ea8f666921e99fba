// The JavaScript package in Node.js: the same bits as the program, views, picking, grasps, tools, parameters, errors.
// usage: node pellicle.mjs PROGRAM
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";
import { load, PellicleError } from "../../build/wasm/pellicle/pellicle.js";
import { remote } from "../../build/wasm/pellicle/remote.js";

const program = resolve(process.argv[2]);
const scenes = new URL("../../scenes/", import.meta.url);
const folder = mkdtempSync(join(tmpdir(), "pellicle-wasm-"));
const pellicle = await load();

/* ---- scenes ---- */

const sphere = `version: 1
bodies:
  - { name: ball, mesh: { shape: geodesic-sphere, frequency: 8, radius: 0.1 }, membrane: { preset: rubber, thickness: 0.002 }, mass: { density: 1000 } }
`;
const pressed = `${sphere}tools:
  - { name: finger, shape: sphere, radius: 0.05, motion: [ { time: 0, position: [0, 0, 0.2] }, { time: 0.2, position: [0, 0, 0.1] } ] }
solver: { method: METHOD, dt: 0.005 }
contact: { self: true, thickness: 0.002 }
duration: 1
`;
const still = pressed.replace(/tools:\n.*\n/, "").replace("METHOD", "xpbd");
const file = `version: 1
bodies:
  - { name: body, mesh: { file: meshes/body.ply, scale: 2 }, mass: { total: 1 }, springs: { stiffness: 3, damping: 0.01 }, volumetric: { stiffness: 1.5, damping: 0.01 } }
loads:
  - { name: pull, body: body, force: [0, 0, 1] }
solver: { method: quasi-static, dt: 0.01 }
duration: 1
`;

/* ---- the same bits ---- */

// the hash of the program after so many steps
function nativeHash(path, steps) {
    const out = join(folder, "run");
    execFileSync(program, ["run", path, "-o", out, "-q", "--threads", "1", "--set", "output.every_frame=1", "--set", `stop.frames=${steps}`],
        { stdio: "pipe" });
    const summary = JSON.parse(readFileSync(join(out, "summary.json"), "utf8"));
    rmSync(out, { recursive: true });
    assert.equal(summary.steps, steps);
    return summary.state_hash.replace(/^0x/, "");
}

function compare(name, path, steps, files) {
    const simulation = pellicle.simulation(readFileSync(path, "utf8"), { files });
    simulation.step(steps);
    assert.equal(simulation.hash, nativeHash(path, steps), `${name}: the bits differ`);
    simulation.dispose();
}

// functions that C libraries round differently: powers, angles of fibres, turns, exponentials
const gas = sphere.replace("membrane:", "bending: { model: hinge }, pressure: { gas: { pressure: 2000, outside: 1000 } }, membrane:");
const withFunctions = {
    "gas, implicit": `${gas}loads: [ { name: pull, body: ball, force: [0, 0, 1], at: { nearest: [0, 0, 0.1] } } ]
solver: { method: implicit, dt: 0.005 }
duration: 1
`,
    "fibres and drag, xpbd": `${gas.replace("pressure: {", "anisotropy: { mode: active, direction: principal, rest_length: 0.9, stiffness: 1.0e+4 }, pressure: {")}solver: { method: xpbd, dt: 0.005, drag: 2 }
duration: 1
`,
};

function sameBits() {
    for (const [name, steps] of [["sphere-press", 60], ["hanging-sheet", 20], ["shrinking-torus", 10], ["sphere-refine", 40], ["sphere-explicit", 40],
        ["lens-capsule", 40], ["balloon", 4], ["caving-ball", 2], ["twisted-tube", 2], ["organ-press", 5]])
        compare(name, new URL(`${name}.yaml`, scenes).pathname, steps);
    for (const [name, text] of Object.entries(withFunctions)) {
        const path = join(folder, "functions.yaml");
        writeFileSync(path, text);
        compare(name, path, 10);
    }
    for (const method of ["pbd", "xpbd", "descent"]) {
        const path = join(folder, `${method}.yaml`);
        writeFileSync(path, pressed.replace("METHOD", method));
        compare(`contact, ${method}`, path, 40);
    }
}

function meshBytes() {
    const mesh = join(folder, "meshes", "body.ply");
    execFileSync("mkdir", ["-p", join(folder, "meshes")]);
    execFileSync(program, ["shape", "geodesic-sphere", "-o", mesh], { stdio: "pipe" });
    const path = join(folder, "file.yaml");
    writeFileSync(path, file);
    compare("a mesh from bytes", path, 20, { "meshes/body.ply": readFileSync(mesh) });
    return readFileSync(mesh);
}

/* ---- interaction ---- */

function interaction() {
    const simulation = pellicle.simulation(still, { set: { "solver.substeps": 5 } });
    const start = simulation.hash;
    assert.deepEqual(simulation.bodies, [{ name: "ball", closed: true, vertexCount: 642, triangleCount: 1280 }]);
    const hit = simulation.pick([0, -1, 0], [0, 2, 0]);
    assert.equal(hit.body, 0);
    assert.ok(Math.abs(hit.point[1] + 0.1) < 2e-3 && Math.abs(hit.weights[0] + hit.weights[1] + hit.weights[2] - 1) < 1e-12);
    assert.equal(simulation.pick([0, -1, 0], [0, -1, 0]), null);

    const before = simulation.positions("ball").slice();
    simulation.mark();
    assert.equal(simulation.grab([0, -1, 0], [0, -1, 0]), false);
    assert.equal(simulation.grab([0, -1, 0], [0, 1, 0], { reach: 0.03 }), true);
    simulation.move([0, -0.15, 0]);
    simulation.step(5);
    const { hand, measures, time, step } = simulation.summary();
    assert.ok(hand.kind === "grab" && hand.force[1] < -1 && measures.max_displacement > 1e-2);
    assert.ok(Math.abs(time - 0.025) < 1e-12 && step === 5 && simulation.stepCount === 5);
    const view = simulation.positions();
    assert.ok(view.some((x, i) => Math.abs(x - before[i]) > 1e-3));
    assert.ok(simulation.triangles().every((v) => v < 642));
    assert.equal(simulation.field("displacement").length, 3 * 642);
    assert.ok(simulation.field("displacement").some((x) => Math.abs(x) > 1e-3));

    // a scene that the program repeats to the bit
    simulation.release();
    simulation.press({ shape: "box", radius: 0.02, position: [0.2, 0, 0] });
    simulation.move([0.1, 0, 0]);
    simulation.set("bodies.ball.membrane.young", 5e5);
    simulation.inflate("ball", 10);
    simulation.step(15);
    const path = join(folder, "session.yaml");
    writeFileSync(path, simulation.scene());
    assert.equal(nativeHash(path, 20), simulation.hash, "a session repeats to the bit");
    assert.equal(simulation.parameters().find(({ path }) => path === "bodies.ball.membrane.young").value[0], 5e5);

    assert.equal(simulation.undo(), true);
    assert.equal(simulation.hash, start);
    simulation.step(3);
    simulation.reset();
    assert.equal(simulation.hash, start);
    assert.deepEqual(simulation.positions(), before);
    assert.equal(simulation.undo(), false);
    simulation.dispose();
    assert.throws(() => simulation.step(), /disposed/);
}

// no copy: the view sees the next state at the same place
function views() {
    const simulation = pellicle.simulation(still);
    simulation.inflate("ball", 100);
    const first = simulation.positions();
    const kept = first.slice();
    simulation.step(5);
    const second = simulation.positions();
    assert.equal(first.buffer, second.buffer);
    assert.equal(first.byteOffset, second.byteOffset);
    assert.ok(first.some((x, i) => x !== kept[i]));
    simulation.dispose();
}

/* ---- errors ---- */

function refusal(action, expected) {
    assert.throws(action, (error) => {
        assert.ok(error instanceof PellicleError, String(error));
        for (const [key, value] of Object.entries(expected))
            if (value instanceof RegExp) assert.match(error[key], value);
            else assert.equal(error[key], value);
        return true;
    });
}

function errors(mesh) {
    refusal(() => pellicle.simulation(`${sphere}solvr: {}\n`), { status: "bad scene", file: "scene.yaml", line: 4, column: 1, message: /unknown key 'solvr'.*solver/ });
    refusal(() => pellicle.simulation("a: ["), { file: "scene.yaml", what: /not YAML/ });
    refusal(() => pellicle.simulation(file, { path: "press.yaml" }), { status: "bad file", file: "press.yaml", line: 3, message: /meshes\/body\.ply/ });
    refusal(() => pellicle.simulation(file, { files: { "meshes/body.ply": mesh.subarray(0, 2000) } }), { file: "meshes/body.ply" });
    refusal(() => pellicle.simulation(file.replace("body.ply", "body.fbx"), { files: { "meshes/body.fbx": "Kaydara FBX Binary" } }), { file: "meshes/body.fbx", remedy: /\.ply/ });
    refusal(() => pellicle.simulation(file, { files: { "meshes/body.ply": mesh }, set: { "solver.dt": -1 } }), { message: /solver\.dt/ });
    assert.throws(() => pellicle.simulation(file, { files: { "../body.ply": mesh } }), /relative path/);

    const simulation = pellicle.simulation(still);
    const { hash } = simulation;
    refusal(() => simulation.set("bodies.ball.membrane.young", -1), { status: "bad argument", message: /young/ });
    refusal(() => simulation.set("bodies.ball.membrane.yung", 1), { message: /young/ });
    refusal(() => simulation.set("solver.method", "pbd"), { message: /method/ });
    refusal(() => simulation.press({ shape: "cone", radius: 1, position: [0, 0, 1] }), { message: /cone/ });
    refusal(() => simulation.move([0, 0, Infinity]), { status: "bad argument" });
    assert.throws(() => simulation.positions("bal"), /ball/);
    assert.throws(() => simulation.field("displacemnt"), /displacement/);
    assert.equal(simulation.hash, hash);
    simulation.dispose();
}

// what is disposed of is free again
function memory() {
    const once = () => {
        const simulation = pellicle.simulation(still);
        simulation.step(2);
        const size = simulation.positions().buffer.byteLength;
        simulation.dispose();
        return size;
    };
    const size = once();
    for (let i = 0; i < 60; i++) assert.equal(once(), size);
}

// a scene that is too large leaves no gigabytes behind, and the next one has the same bits
async function tooLarge() {
    const hash = () => {
        const simulation = pellicle.simulation(still);
        simulation.step(2);
        const result = simulation.hash;
        simulation.dispose();
        return result;
    };
    const [before, size] = [hash(), pellicle.memoryBytes];
    refusal(() => pellicle.simulation(sphere.replace("frequency: 8", "frequency: 900") + "duration: 1\n"), { what: /^out of memory/ });
    assert.throws(() => pellicle.simulation(still, { files: { "../a": "" } }));
    for (let i = 0; i < 100 && pellicle.memoryBytes > size; i++) await new Promise((done) => setTimeout(done, 100));
    assert.ok(pellicle.memoryBytes <= size, `${pellicle.memoryBytes} bytes stay`);
    assert.equal(hash(), before);
}

// a simulation in a worker has the same bits, copies that stay, and the errors of the library
async function inWorker() {
    const worker = await remote();
    try {
        const simulation = await worker.simulation(still);
        const { time, positions, fields } = await simulation.advance({ count: 3, positions: ["ball"], fields: [["displacement", 0]] });
        const own = pellicle.simulation(still);
        own.step(3);
        assert.equal(time, own.time);
        assert.deepEqual(positions[0], own.positions("ball").slice());
        assert.equal(fields[0].length, positions[0].length);
        assert.equal(await simulation.get("hash"), own.hash);
        const [before] = [positions[0].slice(), await simulation.step(5)];
        assert.deepEqual(positions[0], before, "a copy changed");
        await assert.rejects(simulation.set("solver.dt", -1), (error) => error.what.length > 0 && error.remedy.length > 0);
        await assert.rejects(worker.simulation("version: 1\nsolvr: {}\n"), (error) => error.line === 2 && /solvr/.test(error.message));
        await simulation.dispose();
        await assert.rejects(simulation.step());
        own.dispose();
    } finally {
        worker.close();
    }
}

try {
    const { version } = JSON.parse(readFileSync(new URL("../../build/wasm/pellicle/package.json", import.meta.url), "utf8"));
    assert.ok(execFileSync(program, ["--version"]).toString().includes(version), `the package is of version ${version}`);
    sameBits();
    const mesh = meshBytes();
    interaction();
    views();
    errors(mesh);
    memory();
    await tooLarge();
    await inWorker();
    console.log("the package gives the bits of the program, and its errors");
} finally {
    rmSync(folder, { recursive: true, force: true });
}
