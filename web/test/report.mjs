// The report page in Chromium: it loads, plays, changes colour, its plots follow, a vertex is read, and nothing is said
// on the console or asked of the network.
// usage: node report.mjs PROGRAM [FOLDER FOR PICTURES]
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";
import { fileURLToPath } from "node:url";
import { startBrowser } from "./browser.mjs";
import { writeRun } from "./large.mjs";

const program = process.argv[2];
const pictures = process.argv[3] && resolve(process.argv[3]);
const scenes = fileURLToPath(new URL("../../scenes", import.meta.url));
const folder = mkdtempSync(join(tmpdir(), "pellicle-report-"));
const at = (...names) => join(folder, ...names);
const pellicle = (...words) => execFileSync(program, words, { stdio: ["ignore", "pipe", "inherit"] }).toString();

/* ---- what the page is asked ---- */

const state = (page) => page.evaluate(() => ({ time: globalThis.pellicle.state.time, pictures: globalThis.pellicle.view.pictures }));
const clock = (page) => page.textContent("#clock");
const line = (page) => page.$eval(".now", (element) => new DOMMatrix(getComputedStyle(element).transform).e);
const legend = (page) => page.textContent("#legend");
const settle = (page) => page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));

// number of different colours in the middle of the canvas, and their sum
const colours = (page) =>
    page.evaluate(() => {
        const { view, state } = globalThis.pellicle;
        view.draw({ surface: state.surface, shading: state.shading, ink: "#000000" });
        const gl = view.renderer.getContext();
        const [width, height] = [view.canvas.width, view.canvas.height];
        const bytes = new Uint8Array(4 * width * height);
        gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, bytes);
        let sum = 0;
        for (let i = 0; i < bytes.length; i++) sum = (sum * 31 + bytes[i]) % 4294967291;
        return { sum, different: new Set(new Uint32Array(bytes.buffer)).size };
    });

async function picture(page, name) {
    if (!pictures) return;
    await page.waitForTimeout(500);
    await page.screenshot({ path: join(pictures, `${name}.png`) });
}

/* ---- the parts ---- */

async function playing(page) {
    await page.keyboard.press("Home");
    await settle(page);
    const before = await state(page);
    await page.keyboard.press("Space");
    await page.waitForFunction(
        ([time, drawn]) => globalThis.pellicle.state.time > time && globalThis.pellicle.view.pictures > drawn + 3,
        [before.time, before.pictures],
    );
    assert.equal(await page.getAttribute("#play", "aria-label"), "Pause");
    await page.keyboard.press("Space");
    await settle(page);
    const after = await state(page);
    await page.waitForTimeout(200);
    assert.equal((await state(page)).time, after.time, "it stands still when paused");
}

async function keys(page, last) {
    await page.keyboard.press("Home");
    await settle(page);
    assert.match(await clock(page), new RegExp(`frame 0/${last}`));
    await page.keyboard.press("ArrowRight");
    await settle(page);
    assert.match(await clock(page), /frame 1\//);
    await page.keyboard.press("PageDown");
    await settle(page);
    assert.match(await clock(page), /frame 11\//);
    await page.keyboard.press("End");
    await settle(page);
    assert.match(await clock(page), new RegExp(`frame ${last}/${last}`));
    const before = await colours(page);
    await page.keyboard.press("Shift+ArrowRight");
    await page.keyboard.press("+");
    await settle(page);
    assert.notEqual((await colours(page)).sum, before.sum, "the body turned");
    await page.keyboard.press("r");
    await settle(page);
    assert.equal((await colours(page)).sum, before.sum, "the view was reset");
}

// the tool stands where the series says
async function tools(page, name, rows) {
    const column = rows[0].indexOf(`${name}_z`);
    for (const frame of [0, 7]) {
        await page.keyboard.press("Home");
        for (let i = 0; i < frame; i++) await page.keyboard.press("ArrowRight");
        await settle(page);
        const seen = await page.evaluate(() => {
            const [body] = globalThis.pellicle.view.bodies;
            const [{ mesh }] = body.tools;
            return { name: mesh.name, visible: mesh.visible, z: body.centre[2] + body.size * mesh.position.z };
        });
        const z = Number(rows[frame + 1][column]);
        assert.ok(seen.visible && seen.name === name);
        assert.ok(Math.abs(seen.z - z) < 1e-5, `the tool is at ${seen.z} in frame ${frame}, the series says ${z}`);
    }
}

async function colouring(page) {
    const displacement = await colours(page);
    assert.ok(displacement.different > 100, "the body is shaded and coloured");
    assert.match(await legend(page), /displacement.*\[m\]/);
    assert.match(await page.getAttribute("#legend-bar", "style"), /^background: linear-gradient\(to right, rgb\(221, 221, 221\)/, "grey is zero");
    await page.selectOption("#colour", "force");
    await settle(page);
    const force = await colours(page);
    assert.notEqual(force.sum, displacement.sum);
    assert.match(await legend(page), /force.*\[N\]/);
    for (const [id, value] of [["map", "cividis"], ["range", "inner"], ["surface", "edges"], ["shading", "flat"], ["surface", "wireframe"]]) {
        const before = await colours(page);
        await page.selectOption(`#${id}`, value);
        await settle(page);
        assert.notEqual((await colours(page)).sum, before.sum, `${id} ${value} changes the picture`);
    }
    await page.selectOption("#colour", "");
    await settle(page);
    assert.ok(await page.isHidden("#legend"));
    await page.selectOption("#surface", "smooth");
    await page.selectOption("#colour", "displacement");
}

async function plotting(page) {
    await page.keyboard.press("Home");
    await settle(page);
    const start = await line(page);
    await page.keyboard.press("End");
    await settle(page);
    const end = await line(page);
    assert.ok(end > start + 100, "the line goes with the frame");
    const box = await (await page.$(".u-over")).boundingBox();
    await page.mouse.click(box.x + box.width / 2, box.y + box.height / 2);
    await settle(page);
    assert.ok(Math.abs((await line(page)) - box.width / 2) < 6, "a click on a plot goes there");
    assert.ok((await page.$$(".chart canvas")).length >= 5, "there are plots");
}

// what the page reads at a vertex is what the frame's file holds
async function picking(page, run) {
    await page.evaluate(() => document.activeElement.blur());
    await page.keyboard.press("Home");
    for (let i = 0; i < 7; i++) await page.keyboard.press("ArrowRight");
    const box = await (await page.$("#view")).boundingBox();
    await page.mouse.click(box.x + box.width / 2, box.y + box.height / 2);
    await page.waitForSelector("#reading:not([hidden])");
    await settle(page);
    const vertex = Number(await page.inputValue("#vertex"));
    const row = readFileSync(at("ascii_00007.ply"), "utf8").split("end_header\n")[1].split("\n")[vertex].split(" ").map(Number);
    const names = [...readFileSync(at("ascii_00007.ply"), "utf8").matchAll(/^property \w+ (\w+)$/gm)].map((match) => match[1]);
    const value = (name) => row[names.indexOf(name)];
    const shown = await page.evaluate(() =>
        Object.fromEntries([...document.querySelectorAll("#reading-values tr")].map((tr) => [...tr.cells].map((cell) => cell.textContent))),
    );
    const number = (text) => {
        const [, mantissa, power] = /^([−\d.]+)(?:·10([⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+))?/.exec(text);
        const exponent = [...(power ?? "⁰")].map((c) => (c === "⁻" ? "-" : "⁰¹²³⁴⁵⁶⁷⁸⁹".indexOf(c))).join("");
        return Number(mantissa.replace("−", "-")) * 10 ** Number(exponent);
    };
    const length = Math.hypot(...[0, 1, 2].map((c) => value(`displacement_${c}`)));
    assert.ok(Math.abs(number(shown["|displacement|"]) - length) < 1e-4, `|displacement| ${shown["|displacement|"]}, file ${length}`);
    assert.ok(Math.abs(number(shown.energy) - value("energy")) < 1e-4, `energy ${shown.energy}, file ${value("energy")}`);
    const [x, y, z] = shown.position.match(/[−\d.]+/g).map((text) => Number(text.replace("−", "-")));
    for (const [found, name] of [[x, "x"], [y, "y"], [z, "z"]]) assert.ok(Math.abs(found - value(name)) < 6e-3, `${name} ${found}`);
    await picture(page, `picked-${run}`);
    await page.fill("#vertex", "0");
    await settle(page);
    await page.keyboard.press("Escape");
    await page.click("#reading-close");
    assert.ok(await page.isHidden("#reading"));
}

async function themes(page) {
    const paper = () => page.evaluate(() => getComputedStyle(document.body).backgroundColor);
    const before = await paper();
    await page.click("#theme");
    assert.notEqual(await paper(), before);
    await page.click("#theme");
    assert.equal(await paper(), before);
    await page.click("summary");
    assert.match(await page.textContent("#details"), /state hash[0-9a-f]{16}/);
    assert.match(await page.textContent("#details pre"), /geodesic-sphere/);
    await page.click("summary");
}

/* ---- the pages ---- */

pellicle("run", join(scenes, "sphere-press.yaml"), "-o", at("ball"), "--frames", "30", "-q");
pellicle("run", join(scenes, "sphere-press-hollow.yaml"), "-o", at("hollow"), "--frames", "20", "-q");
pellicle("convert", at("ball"), at("ascii.ply"), "--format", "ply-ascii", "-q");
const browser = await startBrowser();

async function onPage(name, words, options, look) {
    pellicle("report", ...words, "-o", at(`${name}.html`), "-q");
    const { page, errors, opened } = await browser.open(at(`${name}.html`), options);
    await look(page);
    const overflow = await page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
    assert.ok(overflow <= 0, `${name}: the page is ${overflow} pixels too wide`);
    await picture(page, name);
    assert.deepEqual(errors, [], `${name}: console or network`);
    console.log(`${name}: opened in ${opened.toFixed(0)} ms`);
    await page.close();
}

// a shell that refines where a plate presses it
const refiningShell = `version: 1
bodies:
  - name: shell
    mesh: { shape: geodesic-sphere, frequency: 6, radius: 1 }
    mass: { density: 1000, thickness: 0.02 }
    membrane: { material: stvk, young: 1.0e5, poisson: 0.3, thickness: 0.02 }
    bending: { model: hinge }
    refine: { levels: 1, near_tools: 0.1, interval: 5 }
tools:
  - name: plate
    shape: box
    size: [2, 2, 0.1]
    motion: [ { position: [0, 0, 1.3] }, { time: 0.5, position: [0, 0, -0.7] } ]
  - name: floor
    shape: box
    size: [2, 2, 0.1]
    motion: [ { position: [0, 0, -1.1] } ]
contact: { self: true, thickness: 0.03 }
solver: { method: xpbd, dt: 0.01, drag: 1 }
duration: 0.5
output: { every: 0.05, fields: [contact, displacement] }
`;

// two runs whose triangles differ, as the frames of one
function changingRun() {
    mkdirSync(at("changing"));
    writeRun(at("changing", "coarse"), { rings: 8, columns: 12, frames: 3 });
    writeRun(at("changing", "fine"), { rings: 12, columns: 17, frames: 6 });
    const sets = [0, 1, 2, 3, 4, 5].map(
        (f) => `<DataSet timestep="${f}" file="${f < 3 ? "coarse" : "fine"}/frames/f0000${f}.vtp"/>`,
    );
    writeFileSync(at("changing", "frames.pvd"), `<VTKFile><Collection>${sets.join("")}</Collection></VTKFile>`);
}

await onPage("desktop", [at("ball")], {}, async (page) => {
    const rows = readFileSync(at("ball", "series.csv"), "utf8").trim().split("\n").map((row) => row.split(","));
    const displacements = rows.slice(1).map((row) => Number(row[rows[0].indexOf("max_displacement")]));
    const most = displacements.indexOf(Math.max(...displacements));
    assert.ok(most > 0);
    assert.match(await clock(page), new RegExp(`frame ${most}/30`), "it opens where the ball is pressed most");
    await playing(page);
    await keys(page, 30);
    await colouring(page);
    await plotting(page);
    await picking(page, "desktop");
    await themes(page);
});
await onPage("phone", [at("ball")], { viewport: { width: 390, height: 844 } }, playing);
await onPage("dark", [at("ball"), at("hollow")], { dark: true }, async (page) => {
    assert.equal((await page.$$(".label")).length, 2);
    await keys(page, 30);
    await page.keyboard.press("Home");
    for (let i = 0; i < 12; i++) await page.keyboard.press("ArrowRight");
});
writeRun(at("large"), { rings: 40, columns: 51, frames: 40 });
await onPage("thinned", [at("large"), "--limit", "1"], {}, async (page) => {
    assert.match(await page.textContent("#facts"), /Thinned to fit: .*magnitudes only.* of 40 frames are kept/);
    await playing(page);
});
changingRun();
await onPage("changing", [at("changing")], {}, async (page) => {
    const corners = () => page.evaluate(() => globalThis.pellicle.view.bodies[0].surface.geometry.index.count);
    await page.selectOption("#surface", "edges");
    await page.keyboard.press("Home");
    await settle(page);
    const coarse = await corners();
    await page.keyboard.press("End");
    await settle(page);
    assert.ok((await corners()) > coarse);
    await page.evaluate(() => document.activeElement.blur());
    await page.keyboard.press("Home");
    await settle(page);
    await playing(page);
});

writeFileSync(at("shell.yaml"), refiningShell);
pellicle("run", at("shell.yaml"), "-o", at("shell"), "-q");
await onPage("contact", [at("shell")], {}, async (page) => {
    const facts = JSON.parse(readFileSync(at("shell", "summary.json"), "utf8"));
    const rows = readFileSync(at("shell", "series.csv"), "utf8").trim().split("\n").map((row) => row.split(","));
    await tools(page, "plate", rows);
    assert.ok(facts.contact.candidates > facts.contact.pairs && facts.contact.pairs > 0, "the shell is touched");
    const titles = await page.$$eval("figcaption h3", (heads) => heads.map((head) => head.textContent));
    for (const title of ["Contact search [pairs]", "Contact time [ms per frame]", "Mesh"])
        assert.ok(titles.includes(title), `plot ${title} among ${titles.join(", ")}`);
    await page.click("summary");
    const numbers = await page.$$eval(".numbers tr", (all) => all.map((tr) => [...tr.cells].map((cell) => cell.textContent)));
    const cell = (name) => numbers.find((row) => row[0] === name)?.[1];
    const text = (number) => number.toLocaleString("en");
    assert.equal(cell("candidates"), text(facts.contact.candidates));
    assert.equal(cell("passed the filter"), text(facts.contact.passed_filter));
    assert.equal(cell("contacts"), text(facts.contact.pairs));
    assert.equal(cell("fall-backs (vertices stepped back)"), text(facts.contact.fall_backs));
    assert.ok(Number(cell("find")) > 0, "ms per step");
    await page.locator(".numbers").first().scrollIntoViewIfNeeded();
    await picture(page, "contact-numbers");
    await page.click("summary");
    await page.selectOption("#surface", "edges");
    await page.evaluate(() => document.activeElement.blur());
    await page.keyboard.press("End");
    await page.locator("figure", { hasText: "Contact search" }).evaluate((figure) => figure.scrollIntoView());
});

await browser.close();
rmSync(folder, { recursive: true, force: true });
console.log("ok");
