// Measures the JavaScript package beside the program, one thread each, in turns: the shortest processor time of a step,
// which other work on the machine changes least; and sizes.
// usage: node test/measure-wasm.mjs PROGRAM [ROUNDS]
import { spawnSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { loadavg, tmpdir } from "node:os";
import { join, resolve } from "node:path";
import { gzipSync } from "node:zlib";
import { load } from "../../build/wasm/pellicle/pellicle.js";

const program = resolve(process.argv[2] ?? "../build/release/pellicle");
const rounds = Number(process.argv[3] ?? 5);
const folder = mkdtempSync(join(tmpdir(), "pellicle-measure-"));
const packed = (name) => gzipSync(readFileSync(new URL(`../../build/${name}`, import.meta.url)), { level: 9 }).length / 1e6;
for (const name of ["wasm/pellicle/core.wasm", "wasm/pellicle/core.mjs", "web/play.html"]) console.log(`${name}: ${packed(name).toFixed(2)} MB with gzip`);

const shell = (frequency, method, more) =>
    `version: 1\nbodies:\n  - { name: ball, mesh: { shape: geodesic-sphere, frequency: ${frequency}, radius: 0.1 },\n` +
    "      membrane: { preset: rubber, thickness: 0.001 }, mass: { density: 1000 } }\n" +
    `solver: { method: ${method}, dt: 0.005, substeps: 10, second_order: false }\n${more}duration: 10\n`;
const installed = (name) => readFileSync(new URL(`../../scenes/${name}.yaml`, import.meta.url), "utf8");
const scenes = [
    ["sphere-press", installed("sphere-press"), 40000],
    ["lens-capsule", installed("lens-capsule"), 4000],
    ["organ-press", installed("organ-press"), 60],
    ["shell-crushed", installed("shell-crushed"), 40],
    ["20,480 triangles, pbd", shell(32, "pbd", ""), 20],
    ["20,480 triangles, xpbd", shell(32, "xpbd", ""), 20],
    ["5,120 triangles, xpbd, self-contact", shell(16, "xpbd", "contact: { self: true }\n"), 20],
];

const pellicle = await load();
// Steps until the module is compiled well, as it is after the first seconds on a page.
function warm(text, steps) {
    const simulation = pellicle.simulation(text);
    for (const start = performance.now(); performance.now() - start < 3000; ) simulation.step(Math.ceil(steps / 10));
    simulation.dispose();
}

function stepHere(text, steps) {
    const simulation = pellicle.simulation(text);
    const start = process.cpuUsage().user;
    simulation.step(steps);
    const time = (process.cpuUsage().user - start) / 1000 / steps;
    simulation.dispose();
    return time;
}

// processor seconds of a run
function runThere(path, text, steps) {
    const dt = /dt: ([\d.]+)/.exec(text)?.[1] ?? 0.01;
    const sets = [`duration=${dt * steps}`, `output.every=${dt * steps}`].flatMap((set) => ["--set", set]);
    const words = [program, "run", path, "-o", join(folder, "run"), "-q", "--threads", "1", ...sets];
    rmSync(join(folder, "run"), { recursive: true, force: true });
    const { status, stderr } = spawnSync("bash", ["-c", 'TIMEFORMAT=%U; time "$@"', "bash", ...words]);
    if (status !== 0) throw new Error(stderr.toString());
    return Number(stderr.toString().trim().split("\n").at(-1));
}

console.log("scene | wasm [ms] | native [ms] | share");
for (const [name, text, steps] of scenes) {
    warm(text, steps);
    const path = join(folder, "scene.yaml");
    writeFileSync(path, text);
    const times = Array.from({ length: rounds }, () => [stepHere(text, steps), runThere(path, text, steps + 1), runThere(path, text, 1)]);
    const [here, whole, start] = [0, 1, 2].map((i) => Math.min(...times.map((time) => time[i])));
    const there = (1000 * (whole - start)) / steps;
    console.log(`${name} | ${here.toPrecision(3)} | ${there.toPrecision(3)} | ${(there / here).toFixed(2)}; load ${loadavg()[0].toFixed(1)}`);
}
rmSync(folder, { recursive: true, force: true });
