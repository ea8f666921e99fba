// The JavaScript package in Node.js, as one of the machines of tools/machines: steps a scene and writes the hash of its end to OUT/summary.json.
// usage: node run-wasm.mjs SCENE STEPS OUT
import { mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { load } from "../build/wasm/pellicle/pellicle.js";

const [path, steps, out] = process.argv.slice(2);
const scene = readFileSync(path, "utf8");
const meshes = [...scene.matchAll(/\bfile: *([^ ,}]+)/g)].map(([, name]) => name);
const files = Object.fromEntries(meshes.map((name) => [name, readFileSync(join(dirname(path), name))]));
const simulation = (await load()).simulation(scene, { files });
simulation.step(Number(steps));
mkdirSync(out, { recursive: true });
writeFileSync(join(out, "summary.json"), `{"state_hash": "${simulation.hash}"}\n`);
