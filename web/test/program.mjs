// Starts `pellicle live` with a scene, without a kept session, for a test.
import { spawn } from "node:child_process";
import { mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";

// words: the program, after an emulator where there is one; { address, stop() }, stop returns its exit status
export async function startProgram(words, ...more) {
    const folder = mkdtempSync(join(tmpdir(), "pellicle-live-"));
    const child = spawn(words[0], [...words.slice(1), "live", ...more, "--no-open", "--fresh", "-q"], { stdio: ["ignore", "pipe", "inherit"], env: { ...process.env, XDG_STATE_HOME: folder } });
    const ended = new Promise((done) => child.on("exit", done));
    const address = await new Promise((done, fail) => {
        child.stdout.on("data", (bytes) => done(/http:\S+/.exec(bytes)[0]));
        ended.then((status) => fail(new Error(`${words.join(" ")} ended with ${status}`)));
    });
    return {
        address,
        async stop() {
            child.kill("SIGTERM");
            const status = await ended;
            rmSync(folder, { recursive: true, force: true });
            return status;
        },
    };
}
