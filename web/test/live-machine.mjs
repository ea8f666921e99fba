// The live page before programs of other machines: the same hand gives the same 64-bit hash. Prints the hash, or what differs.
// usage: node live-machine.mjs PROGRAM [-- PROGRAM OF ANOTHER MACHINE WITH ITS EMULATOR]...
import { spawn } from "node:child_process";
import { mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { startBrowser } from "./browser.mjs";

const folder = mkdtempSync(join(tmpdir(), "pellicle-machines-"));
const steps = 20;

// pulls at the body, takes some steps, and ends the program; the hash
async function pull(browser, words) {
    const child = spawn(words[0], [...words.slice(1), "live", "organ-press", "--no-open", "--fresh", "--paused", "-q"], { stdio: ["ignore", "pipe", "inherit"], env: { ...process.env, XDG_STATE_HOME: folder } });
    const ended = new Promise((done) => child.on("exit", done));
    try {
        const address = await new Promise((done, fail) => {
            child.stdout.on("data", (bytes) => done(/http:\S+/.exec(bytes)[0]));
            ended.then((status) => fail(new Error(`${words.join(" ")} ended with ${status}`)));
        });
        const { page, errors } = await browser.visit(address);
        await page.evaluate((count) => {
            const { send } = globalThis.pellicle;
            for (const line of ["grab 0 0 1 0 0 -1 200 0.03", "move 0.02 0.01 0.2"]) send(line);
            for (let i = 0; i < count; i++) send("step");
        }, steps);
        await page.waitForFunction((count) => globalThis.pellicle.frame.step === count && globalThis.pellicle.frame.hash, steps, { timeout: 120000 });
        const { hash, hand } = await page.evaluate(() => globalThis.pellicle.frame);
        if (errors.length > 0 || hand.kind !== "grab") throw new Error(`${words.join(" ")}: ${errors.join(", ") || "nothing is held"}`);
        await page.close();
        return hash;
    } finally {
        child.kill("SIGTERM");
        await ended;
    }
}

const programs = process.argv.slice(2).join("\n").split("\n--\n").map((words) => words.split("\n"));
const browser = await startBrowser();
try {
    const hashes = [];
    for (const words of programs) hashes.push(await pull(browser, words));
    console.log(hashes.join("  "));
    if (new Set(hashes).size > 1) process.exitCode = 1;
} finally {
    await browser.close();
    rmSync(folder, { recursive: true, force: true });
}
