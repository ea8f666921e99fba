// The trainer in Chromium: forceps by mouse take over from those of the scene and tear the capsule of a lens around, with undo and
// replay; a blade opens it. With PELLICLE_ALL a newcomer's drag goes once around: the hole is whole, and the page tells how round.
// usage: node trainer.mjs PROGRAM [FOLDER FOR PICTURES]
import assert from "node:assert/strict";
import { loadavg } from "node:os";
import { join, resolve } from "node:path";
import { startBrowser } from "./browser.mjs";
import { startProgram } from "./program.mjs";

const program = resolve(process.argv[2]);
const pictures = process.argv[3] && resolve(process.argv[3]);
const isAll = Boolean(process.env.PELLICLE_ALL);
const live = await startProgram([program], "capsulorhexis");

/* ---- the page ---- */

const until = (page, condition, value) => page.waitForFunction(condition, value, { timeout: 100000 });
const picture = async (page, name) => pictures && (await page.waitForTimeout(500), await page.screenshot({ path: join(pictures, `${name}.png`) }));
const shown = (page, key) => page.textContent(`[data-score=${key}]`);
const number = async (page, key) => Number.parseFloat((await shown(page, key)).replace(/^.*, up to /, ""));

// the place on the screen of a point [m]
const place = (page, point) =>
    page.evaluate((x) => {
        const { stage } = globalThis.pellicle;
        const at = stage.project(stage.inward(x));
        const box = document.getElementById("view").getBoundingClientRect();
        return [box.left + at.x, box.top + at.y];
    }, point);
const point = (page, ...x) => place(page, x);
const now = (page) =>
    page.evaluate(() => {
        const { newest, stage } = globalThis.pellicle;
        return { time: newest.time, pictures: stage.pictures, clock: performance.now(), force: Math.hypot(...newest.hand.force), swept: newest.score?.swept };
    });

async function reset(page) {
    await page.click("#restart");
    await until(page, () => globalThis.pellicle.frame.step === 0 && !globalThis.pellicle.frame.playing);
}

// Presses at the flap and drags around the axis, a little outside of the circle, at `speed` [m/s of the simulation], until the hole is
// whole or the pointer is at `last` [rad].
async function dragAround(page, last, seen = () => {}) {
    const radius = 0.0036, speed = 0.0015, first = 0.7;
    await page.click("[data-mode=forceps]");
    await page.mouse.move(...(await point(page, 0.0018, 0.0015, 0.0018)));
    await page.mouse.down();
    await until(page, () => globalThis.pellicle.frame.hand.kind === "grasp");
    const start = (await now(page)).time;
    for (let angle = first; angle < last && (await shown(page, "swept")) !== "whole"; ) {
        const state = await now(page);
        angle = first + (speed / 0.00275) * (state.time - start);
        await page.mouse.move(...(await point(page, radius * Math.cos(angle), radius * Math.sin(angle), 0.002)));
        await seen(angle, state);
        await page.waitForTimeout(10);
    }
}

/* ---- the parts ---- */

async function takingOver(page) {
    await until(page, () => !document.getElementById("trainer").hidden && globalThis.pellicle.frame.measures);
    await until(page, () => Number.parseFloat(document.querySelector("[data-score=swept]").textContent) > 50);
    await picture(page, "trainer-start");
    assert.match(await shown(page, "diameter"), /of 5.5 mm$/);
    await reset(page);
    const hash = await page.evaluate(() => globalThis.pellicle.frame.hash);
    let most = 0;
    await dragAround(page, 1.9, (_, { force }) => (most = Math.max(most, force)));
    assert.ok(most > 0.005 && most < 0.04, `${most} N`);
    assert.match(await page.textContent("#newton"), / mN$/);
    assert.equal(await page.evaluate(() => globalThis.pellicle.frame.tools.length), 2);
    await picture(page, "trainer-drag");
    // the tear follows the forceps, later where the machine is busy
    await until(page, () => Number.parseFloat(document.querySelector("[data-score=swept]").textContent) > 66);
    await page.mouse.up();
    assert.ok((await number(page, "peak")) > 3);
    assert.equal(await shown(page, "touches"), "none");
    await page.evaluate(() => globalThis.pellicle.send("pause"));
    await page.click("#undo");
    await until(page, (before) => globalThis.pellicle.frame.hash === before, hash);
}

// opens a straight cut through the middle, and undo shuts it
async function blading(page) {
    const count = await page.evaluate(() => globalThis.pellicle.stage.bodies[0].count);
    await page.click("[data-mode=blade]");
    await page.mouse.move(...(await point(page, -0.002, -0.001, 0.0018)));
    await page.mouse.down();
    await until(page, () => globalThis.pellicle.frame.hand.kind === "press" && globalThis.pellicle.frame.hand.shape === "blade");
    for (let i = 1; i <= 40; i++) {
        await page.mouse.move(...(await point(page, -0.002 + 0.00005 * i, -0.001, 0.0019)));
        await page.waitForTimeout(20);
    }
    await until(page, (before) => globalThis.pellicle.frame.hand.kind === "press" && globalThis.pellicle.stage.bodies[0].count > before, count + 4);
    await picture(page, "trainer-blade");
    await page.mouse.up();
    await page.evaluate(() => globalThis.pellicle.send("pause"));
    await page.click("#undo");
    await until(page, (before) => globalThis.pellicle.stage.bodies[0].count <= before, count);
}

async function goingRound(page) {
    await reset(page);
    const begin = await now(page);
    let next = 0;
    await dragAround(page, 9.5, async (angle) => {
        if (angle > 1.6 + 1.4 * next) await picture(page, `trainer-${next++}`);
    });
    const end = await now(page);
    await page.mouse.up();
    await picture(page, "trainer-end");
    const seconds = (end.clock - begin.clock) / 1000;
    for (const key of ["swept", "diameter", "offset", "roundness", "run_outs", "peak", "touches", "time"]) console.log(key, await shown(page, key));
    console.log(`${((end.pictures - begin.pictures) / seconds).toFixed(1)} pictures a second, ${((end.time - begin.time) / seconds).toFixed(2)} of real time, load ${loadavg()[0].toFixed(1)}`);
    assert.equal(await shown(page, "swept"), "whole");
    assert.ok((await number(page, "diameter")) > 4.4 && (await number(page, "diameter")) < 6);
    assert.ok((await number(page, "roundness")) > 65);
}

async function replaying(page) {
    const { time } = await now(page);
    await page.click("#trainer button:has-text('Replay')");
    await until(page, (end) => globalThis.pellicle.frame?.time < end / 2, time);
    await until(page, () => globalThis.pellicle.frame?.hand.kind === "grasp");
}

const browser = await startBrowser();
try {
    const { page, errors } = await browser.visit(live.address);
    await takingOver(page);
    await blading(page);
    if (isAll) await goingRound(page);
    else await dragAround(page, 0.9), await page.mouse.up();
    await replaying(page);
    assert.deepEqual(errors, []);
} finally {
    await browser.close();
    await live.stop();
}
