// The live page in Chromium: a drag deforms, a slider changes, a bad value is refused in place, reset and undo give the
// same hash, a saved session repeats to the bit, the tab can be closed and opened again.
// usage: node live.mjs PROGRAM [FOLDER FOR PICTURES]
import assert from "node:assert/strict";
import { execFileSync, spawn } from "node:child_process";
import { mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";
import { startBrowser } from "./browser.mjs";

const program = resolve(process.argv[2]);
const pictures = process.argv[3] && resolve(process.argv[3]);
const folder = mkdtempSync(join(tmpdir(), "pellicle-live-"));

/* ---- the program ---- */

// all that was started: what is left keeps this test from ending
const children = [];

// { address, stop() }; sessions are kept in the folder of the test
async function serve(...words) {
    const env = { ...process.env, XDG_STATE_HOME: folder };
    const child = spawn(program, ["live", ...words, "--no-open", "-q"], { stdio: ["ignore", "pipe", "inherit"], env });
    children.push(child);
    const address = await new Promise((done, fail) => {
        let text = "";
        child.stdout.on("data", (bytes) => {
            text += bytes;
            const found = /^live at (http:\S+)\n/.exec(text);
            if (found) done(found[1]);
        });
        child.on("exit", (status) => fail(new Error(`the program ended with ${status}`)));
    });
    const ended = new Promise((done) => child.on("exit", done));
    return {
        address,
        async stop() {
            child.kill("SIGTERM");
            assert.equal(await ended, 0);
        },
    };
}

/* ---- what the page is asked ---- */

const frame = (page) =>
    page.evaluate(() => {
        const { time, step, hash, hand, measures, undo, playing } = globalThis.pellicle.frame;
        return { time, step, hash, hand, measures, undo, playing };
    });
const until = (page, condition, value) => page.waitForFunction(condition, value, { timeout: 20000 });
const pause = async (page) => {
    await page.evaluate(() => globalThis.pellicle.send("pause"));
    await until(page, () => !globalThis.pellicle.frame.playing && globalThis.pellicle.frame.hash);
};

async function picture(page, name) {
    if (!pictures) return;
    await page.waitForTimeout(600);
    await page.screenshot({ path: join(pictures, `${name}.png`), fullPage: name.includes("phone") });
}

// presses at the middle of the picture, moves there and holds
async function drag(page, x, y, steps = 12) {
    const box = await page.locator("#view").boundingBox();
    const [a, b] = [box.x + box.width / 2, box.y + box.height / 2];
    await page.mouse.move(a, b);
    await page.mouse.down();
    for (let i = 1; i <= steps; i++) {
        await page.mouse.move(a + (x * i) / steps, b + (y * i) / steps);
        await page.waitForTimeout(25);
    }
}

/* ---- the parts ---- */

async function pulling(page) {
    await pause(page);
    await page.click("#restart");
    await until(page, () => globalThis.pellicle.frame.step === 0 && globalThis.pellicle.frame.hash);
    const start = await frame(page);
    await drag(page, 90, -90);
    await until(page, () => globalThis.pellicle.frame.hand.kind === "grab" && Math.hypot(...globalThis.pellicle.frame.hand.force) > 0.1);
    await until(page, () => globalThis.pellicle.frame.measures?.max_displacement > 0.02);
    assert.match(await page.textContent("#newton"), /N$/);
    await picture(page, "pull");
    await page.mouse.up();
    await until(page, () => globalThis.pellicle.frame.hand.kind === "free");
    await pause(page);
    assert.notEqual((await frame(page)).hash, start.hash);
    await page.click("#undo");
    await until(page, (hash) => globalThis.pellicle.frame.hash === hash, start.hash);
    assert.equal((await frame(page)).undo, 0);
    return start.hash;
}

async function pressing(page, shape) {
    await page.click("[data-mode=press]");
    await page.selectOption("#options select", shape);
    await drag(page, 10, 10);
    await until(page, () => globalThis.pellicle.frame.hand.kind === "press" && Math.hypot(...globalThis.pellicle.frame.hand.force) > 0.01);
    await picture(page, `press-${shape}`);
    await page.mouse.up();
    await until(page, () => globalThis.pellicle.frame.hand.kind === "free");
}

// meshes press once there is contact: a shape, and a file beside the scene; a film of that; what was done is repeated
async function pressingMeshes(page) {
    const hold = async (shape) => {
        await page.selectOption("#options select", shape);
        await drag(page, 10, 10);
    };
    await page.click("[data-mode=press]");
    await hold("torus");
    await until(page, () => /is a mesh, which needs contact/.test(document.getElementById("notice").textContent));
    await page.mouse.up();
    await page.click("#options button");
    await until(page, () => globalThis.pellicle.hello.contact && globalThis.pellicle.frame);
    await page.click("#film");
    for (const shape of ["torus", "a%20ring.ply"]) {
        await hold(shape);
        await until(page, () => {
            const { frame, stage } = globalThis.pellicle;
            return frame.hand.shape === "mesh" && Math.hypot(...frame.hand.force) > 0.01 && stage.tools.has(stage.held.name);
        });
        await picture(page, `press-${shape.replace(/%20|\..*/g, "")}`);
        await page.mouse.up();
        await until(page, () => globalThis.pellicle.frame.hand.kind === "free");
    }
    const [download] = await Promise.all([page.waitForEvent("download"), page.click("#film")]);
    const film = join(folder, "session.webm");
    await download.saveAs(film);
    assert.equal(readFileSync(film).subarray(0, 4).toString("hex"), "1a45dfa3", "a film is WebM");
    assert.ok(readFileSync(film).length > 5000);
    mkdirSync(join(folder, "elsewhere"));
    await saving(page, "elsewhere");
}

// a mesh without a scene, as a shell
async function shelling(browser) {
    const server = await serve(join(folder, "a ring.ply"), "--shell");
    const { page, errors } = await browser.visit(server.address);
    await page.evaluate(() => globalThis.pellicle.send("play"));
    await until(page, () => globalThis.pellicle.parameters.list.some(({ path }) => path === "bodies.body.membrane.young"));
    await page.click("[data-mode=pull]");
    const at = await page.evaluate(() => {
        const { stage } = globalThis.pellicle;
        const body = stage.bodies[0];
        const seen = [...Array(body.count).keys()].map((v) => {
            const point = body.point({ corners: [v], weights: [1] });
            return { ...stage.project(point), depth: point.distanceTo(stage.camera.position) };
        });
        return seen.reduce((best, at) => (at.depth < best.depth ? at : best));
    });
    const box = await page.locator("#view").boundingBox();
    await page.mouse.move(box.x + at.x, box.y + at.y);
    await page.mouse.down();
    for (let i = 1; i <= 12; i++) await page.mouse.move(box.x + at.x + 5 * i, box.y + at.y - 5 * i);
    await until(page, () => globalThis.pellicle.frame.hand.kind === "grab" && Math.hypot(...globalThis.pellicle.frame.hand.force) > 0);
    await until(page, () => globalThis.pellicle.frame.measures?.max_displacement > 0.001);
    await picture(page, "shell");
    await page.mouse.up();
    assert.deepEqual(errors, []);
    await page.close();
    await server.stop();
}

// a gamepad and a SpaceMouse that are not there
async function playingPads(page) {
    const pad = (axes, values, mapping = "standard") =>
        page.evaluate(
            ([axes, values, mapping]) => {
                const buttons = Array.from({ length: mapping === "standard" ? 17 : 2 }, (_, i) => ({ value: values[i] ?? 0 }));
                navigator.getGamepads = () => [null, { connected: true, mapping, axes, buttons }];
                dispatchEvent(new Event("gamepadconnected"));
            },
            [axes, values, mapping],
        );
    const pressed = () => {
        const { hand } = globalThis.pellicle.frame;
        return hand.kind === "press" && Math.hypot(...hand.force) > 0.01;
    };
    const free = () => globalThis.pellicle.frame.hand.kind === "free";
    const place = () => page.evaluate(() => document.getElementById("aim").style.transform);
    await page.click("[data-mode=press]");
    await pad([0, 0, 0, 0], {});
    await page.waitForSelector("#aim:not([hidden])");
    const middle = await place();
    await pad([0.6, 0, 0, 0], {});
    await until(page, (before) => document.getElementById("aim").style.transform !== before, middle);
    // in the middle again
    await page.evaluate(() => globalThis.pellicle.aim(0.5, 0.5));
    await pad([0, 0, 0, 0], { 7: 0.9 });
    await until(page, pressed);
    await picture(page, "gamepad");
    await pad([0, 0, 0, 0], {});
    await until(page, free);
    await pad([0, 0, 0, 0], { 5: 1 });
    await until(page, () => globalThis.pellicle.state.mode === "forceps");
    await pad([0, 0, 0, 0], { 4: 1 });
    await until(page, () => globalThis.pellicle.state.mode === "press");
    // the cap of a SpaceMouse, pushed down
    await pad([0, 0, 0.8, 0, 0, 0], {}, "");
    await until(page, pressed);
    await pad([0, 0, 0, 0, 0, 0], {}, "");
    await until(page, free);
    await page.evaluate(() => (navigator.getGamepads = () => []));
    await page.waitForSelector("#aim", { state: "hidden" });
}

// depth by the force on a pen
async function pressingPen(page) {
    const depth = async (pressure) => {
        await page.evaluate((pressure) => {
            const canvas = document.getElementById("view");
            const box = canvas.getBoundingClientRect();
            canvas.setPointerCapture = () => {};
            const at = { clientX: box.x + box.width / 2, clientY: box.y + box.height / 2, pointerType: "pen", pointerId: 7, pressure };
            canvas.dispatchEvent(new PointerEvent("pointerdown", { ...at, button: 0 }));
            canvas.dispatchEvent(new PointerEvent("pointermove", at));
        }, pressure);
        await until(page, () => Math.hypot(...globalThis.pellicle.frame.hand.force) > 0);
        await page.waitForTimeout(700);
        const { hand } = await frame(page);
        await page.evaluate(() => document.getElementById("view").dispatchEvent(new PointerEvent("pointerup", { pointerType: "pen", pointerId: 7 })));
        await until(page, () => globalThis.pellicle.frame.hand.kind === "free");
        return Math.hypot(...hand.force);
    };
    await page.click("[data-mode=press]");
    const [light, firm] = [await depth(0.35), await depth(0.8)];
    assert.ok(firm > 1.2 * light && light > 0, `${light} and ${firm} N`);
}

async function pinning(page) {
    const count = () => page.evaluate(() => globalThis.pellicle.stage.bodies[0].pinned.length);
    const before = await count();
    await page.click("[data-mode=pin]");
    await drag(page, 60, 0);
    await page.mouse.up();
    await until(page, (n) => globalThis.pellicle.stage.bodies[0].pinned.length > n, before);
    await picture(page, "pins");
    await page.click("[data-mode=unpin]");
    await drag(page, 60, 0);
    await page.mouse.up();
    await until(page, (n) => globalThis.pellicle.stage.bodies[0].pinned.length <= n + 2, before);
}

// the lines of each tool at the pointer belong to a scene that the program accepts
async function copying(page) {
    const box = await page.locator("#view").boundingBox();
    const text = readFileSync(scene, "utf8");
    for (const mode of ["press", "pin", "pull", "measure"]) {
        await page.click(`[data-mode=${mode}]`);
        await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
        await page.keyboard.press("y");
        await until(page, (word) => globalThis.pellicle.copied.includes(word), { press: "tools:", pin: "pinned:", pull: "loads:", measure: "nearest" }[mode]);
        const lines = await page.evaluate(() => globalThis.pellicle.copied);
        const whole = {
            press: text + lines,
            pull: text + lines,
            pin: text.replace("springs:", `${lines.split("\n")[1]}, springs:`),
            measure: text.replace("springs:", `pinned: ${lines.split("\n")[1]}, springs:`),
        }[mode];
        assert.notEqual(whole, text);
        const path = join(folder, `${mode}.yaml`);
        writeFileSync(path, whole);
        execFileSync(program, ["check", path], { stdio: "pipe" });
    }
    // the ball of the lines starts outside of the ball of the scene and is pressed into it
    const press = execFileSync(program, ["run", join(folder, "press.yaml"), "-o", join(folder, "pressed"), "-q"], { stdio: "pipe" });
    const summary = JSON.parse(readFileSync(join(folder, "pressed", "summary.json"), "utf8"));
    assert.ok(summary.max_displacement > 0.01, `the tool of the copied lines moves ${summary.max_displacement} m ${press}`);
    await page.click("[data-mode=pull]");
}

async function cutting(page) {
    const count = () => page.evaluate(() => globalThis.pellicle.stage.bodies[0].count);
    const before = await count();
    await page.click("[data-mode=cut]");
    await drag(page, 120, 40);
    await page.mouse.up();
    await until(page, (n) => globalThis.pellicle.stage.bodies[0].count > n, before);
    await picture(page, "cut");
    await page.click("#undo");
    await until(page, (n) => globalThis.pellicle.stage.bodies[0].count === n, before);
}

// scissors cut along a drag once it ends, leave by themselves, and undo shuts the cut
async function snipping(page) {
    const count = () => page.evaluate(() => globalThis.pellicle.stage.bodies[0].count);
    const before = await count();
    await page.click("[data-mode=blade]");
    await page.selectOption("#options select", "scissors");
    await drag(page, 160, 30);
    assert.ok(await page.isVisible("#length"), "the drag shows its length");
    assert.equal((await frame(page)).hand.kind, "free");
    await picture(page, "scissors");
    await page.mouse.up();
    await until(page, () => globalThis.pellicle.frame.hand.shape === "scissors" && globalThis.pellicle.frame.hand.kind === "press");
    await until(page, (n) => globalThis.pellicle.stage.bodies[0].count > n + 2 && globalThis.pellicle.frame.hand.kind === "free", before);
    await picture(page, "snipped");
    await page.click("#undo");
    await until(page, (n) => globalThis.pellicle.stage.bodies[0].count === n, before);
    await page.selectOption("#options select", "blade");
    await page.click("[data-mode=pull]");
}

async function sliding(page) {
    const path = "bodies.sphere.springs.stiffness";
    const valueOf = (path) => page.evaluate((path) => globalThis.pellicle.parameters.list.find((info) => info.path === path).value[0], path);
    const before = await valueOf(path);
    const slider = page.locator(`[id="p-${path}"]`);
    await slider.evaluate((input) => {
        input.value = 300;
        input.dispatchEvent(new Event("input", { bubbles: true }));
        input.dispatchEvent(new Event("change", { bubbles: true }));
    });
    await until(page, ([path, before]) => globalThis.pellicle.parameters.list.find((info) => info.path === path).value[0] > before, [path, before]);
    const number = page.locator(`[id="p-${path}-2"]`);
    const changed = await valueOf(path);
    await number.fill("-5");
    await number.press("Enter");
    await until(page, () => [...document.querySelectorAll(".refused")].some((text) => !text.hidden && text.textContent.includes("stiffness")));
    assert.equal(await valueOf(path), changed, "a value that is refused changes nothing");
    // a second refusal stands there too, not over the picture
    await page.evaluate((path) => globalThis.pellicle.send(`set ${path} -6`), path);
    await until(page, () => [...document.querySelectorAll(".refused")].some((text) => !text.hidden && text.textContent.includes("-6")));
    assert.ok(await page.evaluate(() => document.getElementById("notice").hidden));
    const isSeen = () => {
        const box = [...document.querySelectorAll(".refused")].find((text) => !text.hidden).getBoundingClientRect();
        return box.top >= 0 && box.bottom <= innerHeight;
    };
    assert.ok(await page.evaluate(isSeen), "what is refused is in sight");
    await picture(page, "refused");
    await number.fill("3");
    await number.press("Enter");
    await until(page, (path) => globalThis.pellicle.parameters.list.find((info) => info.path === path).value[0] === 3, path);
}

async function colouring(page) {
    await page.selectOption("#colour", "displacement");
    await until(page, () => globalThis.pellicle.frame.field === "displacement" && !document.getElementById("legend").hidden);
    assert.match(await page.textContent("#legend-name"), /displacement/);
    assert.match(await page.getAttribute("#legend-bar", "style"), /^background: linear-gradient\(to right, rgb\(221, 221, 221\)/, "grey is zero");
    await page.selectOption("#surface", "edges");
    await picture(page, "colours");
    await page.selectOption("#surface", "smooth");
}

async function measuring(page) {
    // on a ball of radius 1 that was let go
    await page.click("#restart");
    await until(page, () => globalThis.pellicle.frame.step === 0);
    await page.click("[data-mode=measure]");
    await drag(page, 0, 0, 1);
    await page.mouse.up();
    await until(page, () => /mean curvature (1|0\.9[5-9]|1\.0[0-5])\d* m⁻¹/.test(document.getElementById("length").textContent));
    const box = await page.locator("#view").boundingBox();
    await page.mouse.click(box.x + box.width / 2 + 60, box.y + box.height / 2);
    await until(page, () => / m( |$)/.test(document.getElementById("length").textContent));
    const covers = () => {
        const [line, label] = ["ruler", "length"].map((id) => document.getElementById(id));
        return label.getBoundingClientRect().top <= line.firstElementChild.getBoundingClientRect().bottom;
    };
    assert.equal(await page.evaluate(covers), false, "the label stands below the line");
    const beyond = () => document.getElementById("length").getBoundingClientRect().right - document.getElementById("view").getBoundingClientRect().right;
    assert.ok((await page.evaluate(beyond)) <= 0, "the label is inside the picture");
    await picture(page, "measure");
    await page.click("[data-mode=pull]");
}

// the pressure that no scene has; undo takes it back
async function inflating(page) {
    await page.click("#restart");
    await until(page, () => globalThis.pellicle.frame.step === 0 && globalThis.pellicle.frame.hash);
    const { hash } = await frame(page);
    const slider = page.locator('[id="p-inflate.sphere"]');
    await slider.evaluate((input) => {
        input.value = 300;
        input.dispatchEvent(new Event("input", { bubbles: true }));
        input.dispatchEvent(new Event("change", { bubbles: true }));
    });
    await page.click("#play");
    await until(page, () => globalThis.pellicle.plots.rows.at(-1).volume_ratio > 1.01);
    await picture(page, "inflated");
    await page.click("#undo");
    await pause(page);
    await page.click("#restart");
    await until(page, (hash) => globalThis.pellicle.frame.hash === hash, hash);
    assert.match(await slider.getAttribute("aria-valuetext"), /^0 Pa/);
}

async function typing(page) {
    const camera = () => page.evaluate(() => globalThis.pellicle.stage.camera.position.toArray().join(" "));
    const press = (key) => page.keyboard.press(key);
    await page.focus("#view");
    await press(" ");
    await until(page, () => globalThis.pellicle.frame.playing);
    await press(" ");
    await until(page, () => !globalThis.pellicle.frame.playing);
    const { step } = await frame(page);
    await press("s");
    await until(page, (step) => globalThis.pellicle.frame.step === step + 1, step);
    for (const [i, mode] of ["pull", "press", "forceps", "blade", "hook", "pin", "unpin", "cut", "measure", "turn"].entries()) {
        await press(String((i + 1) % 10));
        assert.equal(await page.evaluate(() => globalThis.pellicle.state.mode), mode);
    }
    for (const key of ["+", "-", "Shift+ArrowLeft", "Shift+ArrowUp", "v"]) {
        const before = await camera();
        await press(key);
        assert.notEqual(await camera(), before, key);
    }
    await press("?");
    await page.waitForSelector("#keys[open]");
    await picture(page, "keys");
    await press("Escape");
    await page.waitForSelector("#keys:not([open])", { state: "attached" });
    await page.evaluate(() =>
        document.getElementById("file").addEventListener("click", (event) => {
            event.preventDefault();
            document.body.dataset.asked = "yes";
        }, { once: true }),
    );
    await press("o");
    assert.equal(await page.getAttribute("body", "data-asked"), "yes", "o opens a scene");
    await press("r");
    await until(page, () => globalThis.pellicle.frame.step === 0);
    await press("1");
}

// a tool of the scene has its force in the plot; the camera follows a body that falls, and one click brings it back
async function following(browser) {
    const path = join(folder, "falling.yaml");
    writeFileSync(
        path,
        "version: 1\nbodies:\n" +
            "  - { name: sphere, mesh: { shape: geodesic-sphere, frequency: 5 }, mass: { total: 1 },\n" +
            "      springs: { stiffness: 30, damping: 1 }, volumetric: { stiffness: 20, damping: 1 } }\n" +
            "tools: [{ name: probe, shape: sphere, radius: 0.3, motion: [{ time: 0, position: [0, 0, 1.35] }, { time: 0.2, position: [0, 0, 1.1] }] }]\n" +
            "solver: { method: quasi-static, dt: 0.01 }\nduration: 9\n",
    );
    const server = await serve(path);
    const { page, errors } = await browser.visit(server.address);
    await until(page, () => globalThis.pellicle.plots.rows.at(-1)?.["force of probe"] > 0.01);
    assert.match(await page.textContent("#plots figure"), /Force of hand and tools.*hand.*probe/);
    await picture(page, "tool");
    // another scene, in free fall
    const falling =
        "version: 1\nbodies: [{ name: sphere, mesh: { shape: geodesic-sphere, frequency: 5 }, mass: { total: 1 }, springs: { stiffness: 30, damping: 0 } }]\n" +
        "gravity: [0, 0, -9.81]\nsolver: { method: explicit, dt: 0.004, drag: 0 }\nduration: 9\n";
    await page.evaluate((text) => {
        globalThis.pellicle.send(`open ${text}`);
        globalThis.pellicle.send("play");
    }, falling);
    await until(page, () => globalThis.pellicle.plots.tools.length === 0);
    assert.match(await page.textContent("#plots figure"), /^Force of the hand/);
    await until(page, () => globalThis.pellicle.plots.rows.at(-1)?.max_displacement > 4);
    await pause(page);
    const outside = () => {
        const { stage } = globalThis.pellicle;
        const { clientWidth: width, clientHeight: height } = document.getElementById("view");
        const [body] = stage.bodies;
        return [...Array(body.count).keys()].filter((v) => {
            const { x, y } = stage.project(body.point({ corners: [v], weights: [1] }));
            return x < 0 || y < 0 || x > width || y > height;
        }).length;
    };
    assert.equal(await page.evaluate(outside), 0, "the camera follows a body that nothing holds");
    await page.click("#reset");
    await page.waitForTimeout(200);
    await picture(page, "followed");
    assert.equal(await page.evaluate(outside), 0, "the whole body is in the picture");
    await page.click("#back");
    await until(page, () => globalThis.pellicle.frame.step === 0);
    await page.waitForFunction(() => document.getElementById("back").hidden);
    assert.equal(await page.evaluate(outside), 0, "the camera comes back with the body");
    assert.deepEqual(errors, []);
    await page.close();
    await server.stop();
}

// what was done since the start, saved as the user does, gives the same bits in a run
async function saving(page, name = ".") {
    await pause(page);
    const { hash, step } = await frame(page);
    assert.ok(step > 10);
    const [download] = await Promise.all([page.waitForEvent("download"), page.click("#save")]);
    const file = join(folder, name, "session.yaml");
    await download.saveAs(file);
    assert.match(readFileSync(file, "utf8"), /\nsession:\n {2}- "/);
    execFileSync(program, ["run", file, "-o", join(folder, name, "run"), "-q"], { stdio: ["ignore", "ignore", "inherit"] });
    const summary = JSON.parse(readFileSync(join(folder, name, "run", "summary.json"), "utf8"));
    assert.equal(summary.steps, step);
    assert.equal(summary.state_hash.replace(/^0x/, ""), hash, "a session repeats to the bit");
    return file;
}

// a scene without a title is named by its file, not by the scene before
async function naming(page) {
    const untitled = join(folder, "untitled one.yaml");
    writeFileSync(untitled, readFileSync(scene, "utf8").replace(/^title:.*\n/m, ""));
    await page.setInputFiles("#file", untitled);
    await until(page, () => document.getElementById("title").textContent === "untitled one.yaml");
    assert.match(await page.title(), /^untitled one\.yaml/);
}

// the same bits again, step by step on the page
async function opening(page, file, hash, last) {
    await page.setInputFiles("#file", file);
    await until(page, () => globalThis.pellicle.frame?.step === 0);
    assert.match(await page.textContent("#title"), /^a ball of tissue$/);
    for (let step = 0; step < last; ) {
        const count = Math.min(100, last - step);
        await page.evaluate((count) => {
            for (let i = 0; i < count; i++) globalThis.pellicle.send("step");
        }, count);
        step += count;
        await until(page, (step) => globalThis.pellicle.frame?.step === step, step);
    }
    await until(page, (hash) => globalThis.pellicle.frame.hash === hash, hash);
}

async function comingBack(browser, address, page) {
    await page.close();
    const again = await browser.visit(address);
    await again.page.evaluate(() => globalThis.pellicle.send("play"));
    const { time } = await frame(again.page);
    await until(again.page, (time) => globalThis.pellicle.frame.time > time, time);
    return again;
}

async function looks(browser, address) {
    for (const [name, options] of [["dark", { dark: true }], ["phone", { viewport: { width: 390, height: 844 } }]]) {
        const { page, errors } = await browser.visit(address, options);
        await picture(page, name);
        const wide = await page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
        assert.ok(wide <= 0, `${name}: ${wide} pixels too wide`);
        const unnamed = await page.evaluate(() =>
            [...document.querySelectorAll("input:not([hidden]), select, button")].filter((item) => !(item.labels?.length || item.getAttribute("aria-label") || item.textContent.trim())).map((item) => item.outerHTML));
        assert.deepEqual(unnamed, []);
        assert.deepEqual(errors, []);
        await page.close();
    }
}

// another page of the same browser cannot come in
async function intruding(browser, address) {
    const port = new URL(address).port;
    const { page } = await browser.visit(address);
    const opened = (url) =>
        page.evaluate((url) => new Promise((done) => {
            const socket = new WebSocket(url, "pellicle");
            socket.onopen = () => done(true);
            socket.onerror = () => done(false);
        }), url);
    assert.equal(await opened(`ws://127.0.0.1:${port}/?token=0123456789abcdef0123456789abcdef`), false);
    assert.equal((await fetch(`http://127.0.0.1:${port}/`)).status, 403);
    assert.equal(new URL(page.url()).search, "", "the token is not in the address bar");
    await page.goto("about:blank");
    assert.equal(await opened(`ws://127.0.0.1:${port}/${new URL(address).search}`), false, "a page of another origin");
    await page.close();
}

/* ---- all of it ---- */

const scene = join(folder, "ball.yaml");
writeFileSync(
    scene,
    "version: 1\ntitle: a ball of tissue\nbodies:\n" +
        "  - { name: sphere, mesh: { shape: geodesic-sphere, frequency: 8 }, mass: { total: 1 }, scale_with_area: true,\n" +
        "      springs: { stiffness: 3, damping: 0.01 }, volumetric: { stiffness: 1.5, damping: 0.01 } }\n" +
        "solver: { method: quasi-static, dt: 0.01 }\nduration: 1\n",
);
execFileSync(program, ["shape", "torus", "-o", join(folder, "a ring.ply")], { stdio: "pipe" });
if (pictures) mkdirSync(pictures, { recursive: true });
const browser = await startBrowser();
const server = await serve(scene);
try {
    let { page, errors } = await browser.visit(server.address);
    await pulling(page);
    await sliding(page);
    for (const shape of ["sphere", "capsule", "box"]) await pressing(page, shape);
    await pressingPen(page);
    await playingPads(page);
    await pinning(page);
    await copying(page);
    await cutting(page);
    await colouring(page);
    await measuring(page);
    await snipping(page);
    await inflating(page);
    await typing(page);
    await pressingMeshes(page);
    const { hash, step } = (await pause(page), await frame(page));
    const file = await saving(page);
    await opening(page, file, hash, step);
    await naming(page);
    assert.deepEqual(errors, []);
    ({ page, errors } = await comingBack(browser, server.address, page));
    assert.deepEqual(errors, []);
    await page.close();
    await looks(browser, server.address);
    await intruding(browser, server.address);
    await server.stop();
    await shelling(browser);
    await following(browser);
    console.log("the live page pulls, presses with shapes and meshes, films, pins, slides, inflates, colours, measures, follows, saves and repeats, by pointer and keys");
} finally {
    for (const child of children) child.kill("SIGKILL");
    await browser.close();
    rmSync(folder, { recursive: true, force: true });
}
