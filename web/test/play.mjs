// The page of `pellicle live --html` in Chromium, from file://: it plays by itself, a drag deforms, undo and reset restore
// the hash, what was done gives the same bits in a run of the program; meshes are inside.
// usage: node play.mjs PROGRAM [FOLDER FOR PICTURES]
import assert from "node:assert/strict";
import { execFileSync, spawnSync } from "node:child_process";
import { existsSync, mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";
import { startBrowser } from "./browser.mjs";

const program = resolve(process.argv[2]);
const pictures = process.argv[3] && resolve(process.argv[3]);
const folder = mkdtempSync(join(tmpdir(), "pellicle-play-"));
const run = (...words) => execFileSync(program, words, { stdio: "pipe" }).toString();

/* ---- what the page is asked ---- */

const until = (page, condition, value) => page.waitForFunction(condition, value, { timeout: 30000 });
const send = (page, line) => page.evaluate((line) => globalThis.pellicle.send(line), line);
const hashOf = async (page) => {
    await send(page, "pause");
    await until(page, () => !globalThis.pellicle.frame.playing && globalThis.pellicle.frame.hash);
    return page.evaluate(() => globalThis.pellicle.frame.hash);
};

async function picture(page, name) {
    if (!pictures) return;
    mkdirSync(pictures, { recursive: true });
    await page.waitForTimeout(600);
    await page.screenshot({ path: join(pictures, `${name}.png`) });
}

/* ---- the parts ---- */

async function playing(page) {
    await until(page, () => globalThis.pellicle.frame.playing && globalThis.pellicle.frame.time > 0.02);
    await page.click("#restart");
    await until(page, () => globalThis.pellicle.frame.step === 0 && globalThis.pellicle.frame.hash);
    return hashOf(page);
}

async function pulling(page, start) {
    const box = await page.locator("#view").boundingBox();
    const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
    await page.mouse.move(x, y);
    await page.mouse.down();
    for (let i = 1; i <= 10; i++) await page.mouse.move(x + 9 * i, y - 9 * i);
    await until(page, () => globalThis.pellicle.frame.hand.kind === "grab" && globalThis.pellicle.frame.measures?.max_displacement > 0.02);
    await picture(page, "play-pull");
    await page.mouse.up();
    await until(page, () => globalThis.pellicle.frame.hand.kind === "free");
    const pulled = await hashOf(page);
    assert.notEqual(pulled, start);
    return pulled;
}

// the session of the page gives the same bits in the program, beside the mesh that was inside
async function saving(page, hash) {
    const [download] = await Promise.all([page.waitForEvent("download"), page.click("#save")]);
    const file = join(folder, "session.yaml");
    await download.saveAs(file);
    assert.match(readFileSync(file, "utf8"), /\n {6}file: meshes\/body\.ply\n/);
    run("run", file, "-o", join(folder, "run"), "-q");
    const summary = JSON.parse(readFileSync(join(folder, "run", "summary.json"), "utf8"));
    assert.equal(summary.state_hash.replace(/^0x/, ""), hash, "a session repeats to the bit");
}

async function goingBack(page, start) {
    await page.click("#undo");
    await until(page, (hash) => globalThis.pellicle.frame.hash === hash, start);
    for (let i = 0; i < 5; i++) await send(page, "step");
    await until(page, () => globalThis.pellicle.frame.step === 5);
    await page.click("#restart");
    await until(page, (hash) => globalThis.pellicle.frame.step === 0 && globalThis.pellicle.frame.hash === hash, start);
}

async function refusing(page) {
    await send(page, "set bodies.body.springs.stiffness -1");
    await until(page, () => /stiffness/.test([...document.querySelectorAll(".refused, #notice")].map((text) => text.textContent).join()));
    await send(page, "open nonsense: [");
    await until(page, () => /was not opened/.test(document.getElementById("notice").textContent));
}

// a page that cannot simulate says why
async function failing(browser, html) {
    const broken = join(folder, "broken.html");
    writeFileSync(broken, readFileSync(html, "utf8").replace("\\nversion: 1\\n", "\\nversion: 9\\n"));
    const { page } = await browser.play(broken);
    assert.match(await page.textContent("#facts"), /cannot run: scene\.yaml:2:10: error: version/);
    await page.close();
}

/* ---- the page and its scene ---- */

function writePage() {
    mkdirSync(join(folder, "meshes"));
    run("shape", "geodesic-sphere", "-o", join(folder, "meshes", "body.ply"), "--set", "frequency=8");
    const scene = join(folder, "tissue.yaml");
    writeFileSync(
        scene,
        "version: 1\ntitle: tissue </script> & more\nbodies:\n" +
            "  - { name: body, mesh: { file: meshes/body.ply }, mass: { total: 1 }, scale_with_area: true,\n" +
            "      springs: { stiffness: 3, damping: 0.01 }, volumetric: { stiffness: 1.5, damping: 0.01 } }\n" +
            "solver: { method: quasi-static, dt: 0.01 }\nduration: 1\n",
    );
    const html = join(folder, "tissue.html");
    run("live", scene, "--html", html, "-q");
    assert.ok(!readFileSync(html, "utf8").includes(folder), "the page has a path of this machine");
    return html;
}

// a scene that cannot be simulated leaves no page
function refusesScene() {
    const scene = join(folder, "bad.yaml");
    const html = join(folder, "bad.html");
    writeFileSync(scene, "version: 1\nbodies: [ { mesh: { file: nothing.ply } } ]\nduration: 1\n");
    const { status, stderr } = spawnSync(program, ["live", scene, "--html", html]);
    assert.equal(status, 2);
    assert.match(stderr.toString(), /bad\.yaml:2:.*nothing\.ply/);
    assert.ok(!existsSync(html));
}

const browser = await startBrowser();
try {
    refusesScene();
    const html = writePage();
    const { page, errors, drawn } = await browser.play(html);
    const start = await playing(page);
    const pulled = await pulling(page, start);
    await saving(page, pulled);
    await goingBack(page, start);
    await refusing(page);
    assert.equal(await page.textContent("#title"), "tissue </script> & more");
    assert.deepEqual(errors, []);
    await page.close();
    await failing(browser, html);
    console.log(`a page without a program plays, pulls, saves and goes back; its first picture came after ${Math.round(drawn)} ms`);
} finally {
    await browser.close();
    rmSync(folder, { recursive: true, force: true });
}
