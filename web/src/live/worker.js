// A worker that plays a simulation. The first message is { core, scene, files, paused }, all others are lines for the
// player; what the player posts goes to the page, and { failure: { message } } where it cannot run.
import { instantiate } from "pellicle/module.js";

let live = null;
let timer = 0;
const waiting = []; // lines that came before there was a player
// timers wait 4 ms at least: a message to oneself comes at once, but after those of the page that are there
const soon = new MessageChannel();
let isSoon = false;
soon.port1.onmessage = () => {
    isSoon = false;
    turn();
};

function turn() {
    clearTimeout(timer);
    if (!live) return;
    try {
        const rest = live.turn();
        if (rest > 0) timer = setTimeout(turn, Math.min(1000 * rest, 100));
        else if (!isSoon) soon.port2.postMessage((isSoon = true));
    } catch (error) {
        live = null;
        postMessage({ failure: { message: error.message } });
    }
}

async function start({ core, scene, files, paused }) {
    try {
        const pellicle = await instantiate(core);
        live = pellicle.live(scene, { files }, (message) => postMessage(message, typeof message === "string" ? [] : [message]));
    } catch (error) {
        postMessage({ failure: { message: error.message } });
        return;
    }
    for (const line of waiting.splice(0)) live.send(line);
    if (!paused) live.send("play");
    turn();
}

onmessage = ({ data }) => {
    if (typeof data !== "string") start(data);
    else if (live) {
        live.send(data);
        // a step that is due must not be put off by many lines
        clearTimeout(timer);
        timer = setTimeout(turn, 0);
    } else waiting.push(data);
};
