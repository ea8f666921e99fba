// The examples of JavaScript: node.mjs prints a curve, the pages draw a cloth that hangs and a ball that lands, without an error.
// usage: node examples.mjs PROGRAM [FOLDER FOR PICTURES]
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { cpSync, mkdirSync, mkdtempSync, readFileSync, rmSync } from "node:fs";
import { createServer } from "node:http";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { fileURLToPath } from "node:url";
import { startBrowser } from "./browser.mjs";

const root = fileURLToPath(new URL("../..", import.meta.url));
const pictures = process.argv[3];
const folder = mkdtempSync(join(tmpdir(), "pellicle-examples-"));
cpSync(join(root, "examples/javascript"), folder, { recursive: true });
mkdirSync(join(folder, "node_modules"));
cpSync(join(root, "build/wasm/pellicle"), join(folder, "node_modules/pellicle"), { recursive: true });
cpSync(join(root, "web/node_modules/three"), join(folder, "node_modules/three"), { recursive: true });

const rows = execFileSync("node", ["node.mjs"], { cwd: folder, encoding: "utf8" }).trim().split("\n").slice(1);
const forces = rows.map((row) => Number(row.split(",")[1]));
assert.equal(forces.length, 10);
assert.ok(forces.every((force, i) => i === 0 || force > forces[i - 1]), `forces ${forces}`);

// a geometry with seams keeps its texture coordinates, and its doubled vertices move together
async function following() {
    const THREE = await import("three");
    const { load } = await import("../../build/wasm/pellicle/pellicle.js");
    const { fromThree, toThree } = await import("../../build/wasm/pellicle/three.js");
    const geometry = new THREE.SphereGeometry(0.1, 12, 8);
    const { obj, vertices } = fromThree(geometry);
    const count = Math.max(...vertices) + 1;
    assert.equal(count, 12 * 7 + 2);
    const simulation = (await load()).simulation(
        "version: 1\nbodies:\n  - { name: ball, mesh: { file: ball.obj }, mass: { density: 1000 }, springs: { young: 20000 }, volumetric: { young: 5000 } }\n" +
            "loads: [ { body: ball, force: [0, 0, 1], at: { nearest: [0, 0, 0.1] } } ]\nsolver: { method: xpbd, dt: 0.01 }\nduration: 1\n",
        { files: { "ball.obj": obj } },
    );
    assert.equal(simulation.bodies[0].vertexCount, count);
    assert.ok(simulation.bodies[0].closed, "seams are closed");
    const body = toThree(THREE, simulation, "ball", { geometry, vertices });
    body.geometry.attributes.position.array.forEach((x, i) => assert.ok(Math.abs(x - geometry.attributes.position.array[i]) < 1e-7));
    assert.deepEqual(body.geometry.attributes.uv.array, geometry.attributes.uv.array);
    simulation.step(10);
    body.update();
    const { position, normal } = body.geometry.attributes;
    const moved = simulation.positions("ball");
    vertices.forEach((v, i) => [0, 1, 2].forEach((k) => assert.equal(position.array[3 * i + k], moved[3 * v + k])));
    for (let i = 0; i < position.count; i++) {
        const [p, n] = [position, normal].map((attribute) => new THREE.Vector3().fromBufferAttribute(attribute, i));
        assert.ok(Math.abs(n.length() - 1) < 1e-5 && p.dot(n) > 0, "a normal points inward");
    }
    assert.ok(Math.max(...position.array.map((x, i) => Math.abs(x - geometry.attributes.position.array[i]))) > 1e-4, "nothing moved");
    // the body's own vertices
    const own = toThree(THREE, simulation, "ball");
    assert.equal(own.geometry.attributes.position.count, count);
    assert.deepEqual([...own.geometry.index.array], [...simulation.triangles("ball")]);
    assert.throws(() => fromThree(new THREE.BufferGeometry()), /no attribute position/);
}
await following();

const types = { html: "text/html", js: "text/javascript", mjs: "text/javascript", wasm: "application/wasm" };
const server = createServer((request, response) => {
    try {
        const path = new URL(request.url, "http://localhost").pathname;
        const bytes = readFileSync(join(folder, path));
        response.writeHead(200, { "content-type": types[path.split(".").pop()] ?? "application/octet-stream" }).end(bytes);
    } catch {
        response.writeHead(request.url === "/favicon.ico" ? 204 : 404).end();
    }
});
await new Promise((done) => server.listen(0, "127.0.0.1", done));
const browser = await startBrowser();
try {
    for (const [name, low, high] of [["canvas", -0.7, -0.45], ["three", -0.01, 0.03]]) {
        const { page, errors } = await browser.raw();
        await page.goto(`http://127.0.0.1:${server.address().port}/${name}.html`);
        await page.waitForFunction(() => globalThis.drawn > 20, null, { timeout: 120000 }).catch((error) => assert.fail(`${name}: ${error.message}, ${errors}`));
        await page.waitForFunction(([low, high]) => globalThis.lowest > low && globalThis.lowest < high, [low, high], { timeout: 120000 }).catch(async (error) => assert.fail(`${name}: ${error.message}, lowest ${await page.evaluate(() => globalThis.lowest)}`));
        if (pictures) await page.screenshot({ path: join(pictures, `${name}.png`) });
        assert.deepEqual(errors, [], name);
        await page.close();
    }
    console.log("the examples of JavaScript run: Node.js, a canvas, three.js with a worker");
} finally {
    await browser.close();
    server.close();
    rmSync(folder, { recursive: true, force: true });
}
