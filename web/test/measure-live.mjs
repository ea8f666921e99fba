// Measures the live page in Chromium with software GL: from the event of a pointer that drags to the end of the picture
// that shows it, pictures a second, and the share of the simulation's thread that serves.
// usage: node test/measure-live.mjs PROGRAM [SECONDS] [FREQUENCY]
import { spawn } from "node:child_process";
import { mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { loadavg, tmpdir } from "node:os";
import { join, resolve } from "node:path";
import { startBrowser } from "./browser.mjs";

const program = resolve(process.argv[2] ?? "../build/release/pellicle");
const seconds = Number(process.argv[3] ?? 10);
const frequency = Number(process.argv[4] ?? 32);
const folder = mkdtempSync(join(tmpdir(), "pellicle-measure-"));
const path = join(folder, "scene.yaml");
writeFileSync(
    path,
    `version: 1\nbodies:\n  - { name: ball, mesh: { shape: geodesic-sphere, frequency: ${frequency} }, mass: { total: 1 }, scale_with_area: true,\n` +
        "      springs: { stiffness: 3, damping: 0.01 }, volumetric: { stiffness: 1.5, damping: 0.01 } }\n" +
        "solver: { method: quasi-static, dt: 0.01 }\nduration: 1\n",
);

// the program says where the page is
const child = spawn(program, ["live", path, "--no-open", "--fresh", "-q"], { stdio: ["ignore", "pipe", "inherit"] });
const address = await new Promise((done) => child.stdout.on("data", (bytes) => done(/http:\S+/.exec(bytes)[0])));

// In the page: each move is followed by an echo; the frame that brings it back is drawn, and a fence says when the
// picture is complete.
function watch() {
    const { stage, send } = globalThis.pellicle;
    const canvas = document.getElementById("view");
    const gl = stage.renderer.getContext();
    const moves = [];
    const channel = new MessageChannel();
    const seen = { event: [], received: [], drawn: [], done: [], intervals: [], serving: [], pictures: 0 };
    const { wire } = globalThis.pellicle;
    const received = wire.received;
    let newest = 0;
    wire.received = (message) => {
        received(message);
        if (!(message.echo > newest)) return;
        seen.received.push(performance.now() - moves[newest].at);
        newest = message.echo;
    };
    let pictures = [];
    let last = 0;
    canvas.addEventListener("onpointerrawupdate" in canvas ? "pointerrawupdate" : "pointermove", (event) => {
        moves.push({ number: moves.length + 1, at: event.timeStamp });
        seen.event.push(performance.now() - event.timeStamp);
        send(`echo ${moves.length}`);
    });
    const draw = stage.draw.bind(stage);
    let first = 0; // the first move that no picture has shown
    stage.draw = (options) => {
        draw(options);
        const now = performance.now();
        const { echo, serving } = globalThis.pellicle.newest;
        seen.pictures++;
        if (last) seen.intervals.push(now - last);
        last = now;
        if (!(echo > first)) return;
        const fence = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
        gl.flush();
        seen.serving.push(serving);
        seen.drawn.push(now - moves[first].at);
        pictures.push({ fence, at: moves[first].at });
        first = echo;
        channel.port2.postMessage(0);
    };
    channel.port1.onmessage = () => {
        pictures = pictures.filter(({ fence, at }) => {
            const isDone = gl.getSyncParameter(fence, gl.SYNC_STATUS) === gl.SIGNALED;
            if (isDone) seen.done.push(performance.now() - at);
            return !isDone;
        });
        if (pictures.length > 0) setTimeout(() => channel.port2.postMessage(0), 1);
    };
    globalThis.seen = seen;
}

const middle = (values) => values.sort((a, b) => a - b)[Math.floor(values.length / 2)];
const browser = await startBrowser();
try {
    const { page } = await browser.visit(address);
    await page.waitForTimeout(2000);
    await page.evaluate(watch);
    const box = await page.locator("#view").boundingBox();
    const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
    await page.mouse.move(x, y);
    await page.mouse.down();
    const start = performance.now();
    for (let i = 0; performance.now() - start < 1000 * seconds; i++) {
        await page.mouse.move(x + 60 * Math.cos(i / 10), y - 60 * Math.sin(i / 10));
        await page.waitForTimeout(11 + 7 * Math.random());
    }
    await page.mouse.up();
    const seen = await page.evaluate(() => ({ ...globalThis.seen, ratio: globalThis.pellicle.stage.ratio, step: globalThis.pellicle.frame.step_ms }));
    const ms = (values) => `${middle(values).toFixed(1)} ms`;
    console.log(`drag to picture, medians of ${seen.done.length}: the page has the move after ${ms(seen.event)}, the frame after ${ms(seen.received)}, has drawn it after ${ms(seen.drawn)}, the picture is complete after ${ms(seen.done)}`);
    console.log(`${seen.pictures} pictures, one every ${ms(seen.intervals)}, at ${seen.ratio.toFixed(2)} of the resolution`);
    console.log(`a step ${seen.step.toFixed(2)} ms; serving ${(100 * middle(seen.serving)).toFixed(1)} % of the thread; load ${loadavg()[0].toFixed(1)}`);
} finally {
    await browser.close();
    child.kill("SIGTERM");
    rmSync(folder, { recursive: true, force: true });
}
