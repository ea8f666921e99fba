// The live page in a headset, which iwer emulates: the bodies stand before the eyes, a controller pulls and presses in all directions,
// carries, turns and scales them, its buttons undo and change the tool, and the page is as before once the session ends.
// usage: node immersive.mjs PROGRAM [FOLDER FOR PICTURES]
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { join, resolve } from "node:path";
import { fileURLToPath } from "node:url";
import { startBrowser } from "./browser.mjs";
import { startProgram } from "./program.mjs";

const program = resolve(process.argv[2]);
const pictures = process.argv[3] && resolve(process.argv[3]);
const live = await startProgram([program], "organ-press");

/* ---- the headset ---- */

const emulator = readFileSync(fileURLToPath(new URL("../node_modules/iwer/build/iwer.min.js", import.meta.url)), "utf8");
const headset = `${emulator}
globalThis.headset = new IWER.XRDevice(IWER.metaQuest3);
headset.installRuntime({ polyfillLayers: false, forceInstall: true });
headset.position.set(0, 1.6, 0); // the origin of its "local" space
headset.stereoEnabled = true;`;

const until = (page, condition, value) => page.waitForFunction(condition, value, { timeout: 60000 });
const settle = (page) => page.evaluate(() => new Promise((done) => setTimeout(done, 200)));
const picture = async (page, name) => pictures && (await settle(page), await page.screenshot({ path: join(pictures, `${name}.png`) }));
// moves the right controller [m]; it points straight ahead
const move = (page, ...at) => page.evaluate(([x, y, z]) => globalThis.headset.controllers.right.position.set(x, y, z), at);
const set = (page, button, value) => page.evaluate(([id, to]) => globalThis.headset.controllers.right.updateButtonValue(id, to), [button, value]);
async function tap(page, button) {
    await set(page, button, 1);
    await settle(page);
    await set(page, button, 0);
    await settle(page);
}
// where the middle of the picture stands in the room, in metres, and metres a unit of the picture
const stand = (page) =>
    page.evaluate(() => {
        const { stage, immersive } = globalThis.pellicle;
        immersive.rig.updateMatrixWorld(true);
        return { middle: immersive.rig.worldToLocal(stage.controls.target.clone()).toArray(), unit: 1 / immersive.rig.scale.x, up: stage.camera.up.clone().applyQuaternion(immersive.rig.quaternion.clone().invert()).toArray() };
    });
const near = (a, b, most) => a.forEach((x, i) => assert.ok(Math.abs(x - b[i]) < most, `${a} is not ${b} within ${most}`));

/* ---- the parts ---- */

async function entering(page, kind) {
    await page.evaluate((id) => document.getElementById(id).click(), kind);
    await until(page, () => globalThis.pellicle.stage.immersed && globalThis.pellicle.immersive.isPlaced);
    const { middle, unit, up } = await stand(page);
    near(middle, [0, -0.2, -0.6], 1e-3);
    near(up, [0, 1, 0], 1e-6);
    assert.equal(unit.toFixed(6), "0.250000");
}

async function pulling(page) {
    await move(page, 0.02, 1.4, 0);
    await settle(page);
    await picture(page, "headset");
    await set(page, "trigger", 1);
    await until(page, () => globalThis.pellicle.frame.hand.kind === "grab");
    const before = await page.evaluate(() => globalThis.pellicle.frame.hand.target);
    // up, to the right and nearer: no plane of the picture holds it
    const way = [0.03, 0.05, 0.08];
    await move(page, 0.02 + way[0], 1.4 + way[1], way[2]);
    await until(page, (from) => Math.hypot(...globalThis.pellicle.frame.hand.target.map((x, c) => x - from[c])) > 0 && Math.hypot(...globalThis.pellicle.frame.hand.force) > 0, before);
    await settle(page);
    const after = await page.evaluate(
        ([from, to]) => {
            const { stage, immersive, frame } = globalThis.pellicle;
            const turned = immersive.rig.position.clone().fromArray(to).applyQuaternion(immersive.rig.quaternion).multiplyScalar(immersive.rig.scale.x * stage.size);
            return { moved: frame.hand.target.map((x, c) => x - from[c]), asked: turned.toArray(), size: stage.size, label: immersive.pointers.map(({ label }) => label.text) };
        },
        [before, way],
    );
    near(after.moved, after.asked, 1e-3 * after.size);
    assert.ok(after.label.some((text) => /^Pull [\d.]+ .?N$/.test(text)), `labels ${after.label}`);
    await until(page, () => globalThis.headset.pulses > 0);
    await picture(page, "headset-pull");
    await set(page, "trigger", 0);
    await until(page, () => globalThis.pellicle.frame.hand.kind === "free");
    const { undo } = await page.evaluate(() => globalThis.pellicle.frame);
    await tap(page, "a-button");
    await until(page, (count) => globalThis.pellicle.frame.undo === count - 1, undo);
}

async function pressing(page) {
    await tap(page, "b-button");
    assert.equal(await page.evaluate(() => globalThis.pellicle.state.mode), "press");
    await move(page, 0, 1.4, 0);
    await settle(page);
    const depthAt = async (travel) => {
        await set(page, "trigger", travel);
        await until(page, () => globalThis.pellicle.frame.hand.kind === "press");
        await settle(page);
        await settle(page);
        return page.evaluate(() => globalThis.pellicle.stage.inward(globalThis.pellicle.frame.hand.point).toArray());
    };
    // the travel of the trigger sets the depth
    const [shallow, deep] = [await depthAt(0.6), await depthAt(0.95)];
    const way = Math.hypot(...deep.map((x, c) => x - shallow[c]));
    const whole = await page.evaluate(() => 0.3 * globalThis.pellicle.state.radius + 0.2 + globalThis.pellicle.state.depth);
    assert.ok(Math.abs(way - 0.35 * whole) < 0.02, `the tool went ${way} of ${0.35 * whole}`);
    await picture(page, "headset-press");
    await set(page, "trigger", 0);
    await until(page, () => globalThis.pellicle.frame.hand.kind === "free");
}

// the grip carries the bodies, the stick turns and scales them, and a press of the stick brings them back
async function carrying(page) {
    const first = await stand(page);
    await set(page, "squeeze", 1);
    await settle(page);
    await move(page, 0.1, 1.5, 0.05);
    await settle(page);
    await set(page, "squeeze", 0);
    await settle(page);
    const carried = await stand(page);
    near(carried.middle, first.middle.map((x, c) => x + [0.1, 0.1, 0.05][c]), 1e-3);
    await page.evaluate(() => globalThis.headset.controllers.right.updateAxes("thumbstick", 1, -1));
    await settle(page);
    await page.evaluate(() => globalThis.headset.controllers.right.updateAxes("thumbstick", 0, 0));
    await settle(page);
    const turned = await stand(page);
    near(turned.middle, carried.middle, 1e-3);
    near(turned.up, [0, 1, 0], 1e-6);
    assert.ok(turned.unit > 1.02 * carried.unit, `${turned.unit} after ${carried.unit}`);
    await tap(page, "thumbstick");
    near((await stand(page)).middle, [0, -0.2, -0.6], 1e-3);
}

async function leaving(page, kind, before) {
    await page.evaluate((id) => document.getElementById(id).click(), kind);
    await until(page, () => !globalThis.pellicle.stage.immersed);
    const { count, after } = await page.evaluate(() => ({ count: globalThis.pellicle.stage.pictures, after: globalThis.view() }));
    near(after, before, 1e-9);
    await page.evaluate(() => globalThis.pellicle.stage.turn(0.1, 0));
    await until(page, (had) => globalThis.pellicle.stage.pictures > had, count);
}

const browser = await startBrowser();
let status;
try {
    const plain = await browser.visit(live.address);
    assert.equal(await plain.page.locator("#immersive-vr, #immersive-ar").count(), 0);
    await plain.page.close();
    const { page, errors } = await browser.visit(live.address, { script: { content: headset } });
    await until(page, () => document.getElementById("immersive-ar"));
    await page.evaluate(() => {
        const { stage } = globalThis.pellicle;
        globalThis.view = () => [stage.camera.fov, stage.camera.aspect, ...stage.camera.position, ...stage.controls.target];
        globalThis.headset.pulses = 0;
        for (const motor of globalThis.headset.controllers.right.inputSource.gamepad.hapticActuators) motor.pulse = async () => globalThis.headset.pulses++;
    });
    const before = await page.evaluate(() => globalThis.view());
    await entering(page, "immersive-vr");
    assert.ok(await page.evaluate(() => globalThis.pellicle.stage.scene.background !== null));
    await pulling(page);
    await pressing(page);
    await carrying(page);
    await leaving(page, "immersive-vr", before);
    const turned = await page.evaluate(() => globalThis.view());
    await entering(page, "immersive-ar");
    assert.ok(await page.evaluate(() => globalThis.pellicle.stage.scene.background === null));
    await leaving(page, "immersive-ar", turned);
    assert.deepEqual(errors, []);
} finally {
    await browser.close();
    status = await live.stop();
}
assert.equal(status, 0);
console.log("the live page in a headset: as asked");
