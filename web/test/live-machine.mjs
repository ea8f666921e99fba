// The live page before programs of other machines: the same hand gives the same 64-bit hash. Prints the hash, or what differs.
// usage: node live-machine.mjs PROGRAM [-- PROGRAM OF ANOTHER MACHINE WITH ITS EMULATOR]...
import { startBrowser } from "./browser.mjs";
import { startProgram } from "./program.mjs";

const steps = 20;

// pulls at the body, takes some steps, and ends the program; the hash
async function pull(browser, words) {
    const live = await startProgram(words, "organ-press", "--paused");
    try {
        const { page, errors } = await browser.visit(live.address);
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
        await live.stop();
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
}
