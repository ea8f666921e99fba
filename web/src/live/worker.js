// A worker that runs a simulation. The first message is { core, scene, files, paused }; all others are lines for the player.
// The worker posts the messages of the player to the page, or { failure: { message } } if the simulation cannot run.
import { instantiate } from "pellicle/module.js";

let live = null;
let timer = 0;
const waiting = []; // lines that arrived before the player was ready
// Timers wait at least 4 ms. A message to itself arrives at once, but after the waiting messages of the page.
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
        // many lines must not delay a step that is due
        clearTimeout(timer);
        timer = setTimeout(turn, 0);
    } else waiting.push(data);
};
