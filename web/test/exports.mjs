// GLB files before the official glTF validator: no error, no warning.
// usage: node exports.mjs PROGRAM
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import validator from "gltf-validator";
import { writeRun } from "./large.mjs";

const program = process.argv[2];
const folder = mkdtempSync(join(tmpdir(), "pellicle-exports-"));

async function validate(input, name) {
    const path = join(folder, name);
    execFileSync(program, ["convert", input, path, "-q"], { stdio: "inherit" });
    const report = await validator.validateBytes(new Uint8Array(readFileSync(path)));
    const { numErrors, numWarnings, messages } = report.issues;
    assert.deepEqual([numErrors, numWarnings], [0, 0], JSON.stringify(messages.slice(0, 5), null, 1));
    return report.info;
}

const size = writeRun(join(folder, "run"), { rings: 20, columns: 31, frames: 12 });
const run = await validate(join(folder, "run"), "run.glb");
assert.equal(run.totalVertexCount, size.vertices);
assert.equal(run.totalTriangleCount, size.triangles);
assert.equal(run.animationCount, 1);
assert.equal(run.hasMorphTargets, true);

writeRun(join(folder, "still"), { rings: 5, columns: 6, frames: 1 });
assert.equal((await validate(join(folder, "still"), "still.glb")).animationCount, 0);

// a body that refines: one set of triangles for all frames
const scene = join(folder, "refined.yaml");
writeFileSync(scene, `version: 1
bodies:
  - { name: ball, mesh: { shape: geodesic-sphere, frequency: 4 }, mass: { per_vertex: 1 }, springs: { stiffness: 3 },
      volumetric: { stiffness: 1.5 }, refine: { levels: 2, above: 0.5, dwell: 5, interval: 3 } }
tools:
  - { name: probe, shape: sphere, radius: 0.25, body: ball,
      motion: [{ time: 0, position: [0, 0, 1.3] }, { time: 0.3, position: [0, 0, 0.9] }] }
solver: { dt: 0.01 }
duration: 0.4
output: { every: 0.1 }
`);
execFileSync(program, ["run", scene, "-o", join(folder, "refined"), "-q"], { stdio: "inherit" });
const refined = await validate(join(folder, "refined"), "refined.glb");
assert.ok(refined.totalTriangleCount > 320 && refined.hasMorphTargets);

execFileSync(program, ["shape", "torus", "-o", join(folder, "torus.ply")], { stdio: "ignore" });
await validate(join(folder, "torus.ply"), "torus.glb");
rmSync(folder, { recursive: true, force: true });
console.log("ok");
