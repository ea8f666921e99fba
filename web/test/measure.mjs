// Measures a run of 200 frames and 20,000 triangles: writing the report, opening it, pictures a second.
// usage: node test/measure.mjs PROGRAM
import { execFileSync } from "node:child_process";
import { mkdtempSync, rmSync, statSync } from "node:fs";
import { loadavg, tmpdir } from "node:os";
import { join, resolve } from "node:path";
import { startBrowser } from "./browser.mjs";
import { writeRun } from "./large.mjs";

const program = resolve(process.argv[2] ?? "../build/release/pellicle");
const folder = mkdtempSync(join(tmpdir(), "pellicle-measure-"));
const report = join(folder, "report.html");
const size = writeRun(join(folder, "run"));
console.log(`${size.vertices} vertices, ${size.triangles} triangles, 200 frames; load ${loadavg()[0].toFixed(1)}`);

const writing = [];
for (let i = 0; i < 3; i++) {
    const start = performance.now();
    execFileSync(program, ["report", join(folder, "run"), "-o", report, "-q"]);
    writing.push((performance.now() - start) / 1000);
}
console.log(`report written in ${writing.map((s) => s.toFixed(2)).join(", ")} s, ${(statSync(report).size / 1e6).toFixed(1)} MB`);

const browser = await startBrowser();
for (let i = 0; i < 3; i++) {
    const { page, errors, drawn, opened } = await browser.open(report);
    const rate = await page.evaluate(async () => {
        const { view, setPlaying } = globalThis.pellicle;
        setPlaying(true);
        await new Promise((done) => setTimeout(done, 500));
        const [pictures, start] = [view.pictures, performance.now()];
        await new Promise((done) => setTimeout(done, 4000));
        return ((view.pictures - pictures) / (performance.now() - start)) * 1000;
    });
    const times = `first picture after ${(drawn / 1000).toFixed(2)} s, all frames after ${(opened / 1000).toFixed(2)} s`;
    console.log(`${times}, ${rate.toFixed(0)} pictures a second; load ${loadavg()[0].toFixed(1)}`, ...errors);
    await page.close();
}
await browser.close();
rmSync(folder, { recursive: true, force: true });
