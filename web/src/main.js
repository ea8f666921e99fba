// The report page: state, controls, and the loop that draws changes.
import { fitColours, mapGradient, mapNames } from "./colour.js";
import { componentsAt, fillValues, locate, positionAt, readRuns } from "./data.js";
import { showDetails, showFacts } from "./details.js";
import { formatNumber, formatTogether, formatVector, plainName, unitOfField, withUnit } from "./format.js";
import { Plots } from "./plots.js";
import { View } from "./view.js";

const $ = (id) => document.getElementById(id);

const state = {
    time: null, // until the first picture
    playing: false,
    speed: 1,
    field: "",
    map: "", // automatic
    range: "run",
    surface: "smooth",
    shading: "smooth",
    picked: null, // { body, vertex }
};

const { runs, finished } = readRuns(() => needs("frames"));
// the leader is the run with the most frames: its frames are the steps of the slider
const leader = runs.reduce((best, run) => (run.frames.length > best.frames.length ? run : best), runs[0]);
let view = null;
let plots = null;

/* ---- the loop ---- */

const stale = new Set();
let scheduled = false;
let lastTick = 0;

// requests a redraw because "frames", "picture" or "colour" changed
function needs(what) {
    stale.add(what);
    if (scheduled) return;
    scheduled = true;
    requestAnimationFrame(tick);
}

const lastTime = () => Math.max(...runs.map((run) => run.frames[run.ready - 1]?.time ?? 0));
const firstTime = () => Math.min(...runs.map((run) => run.frames[0].time));

// real time for runs of 2 s to 40 s; other runs are shown in 10 s
function baseSpeed() {
    const length = Math.max(...runs.map((run) => run.frames.at(-1).time)) - firstTime();
    return leader.timed && length >= 2 && length <= 40 ? 1 : length / 10;
}

function advance(now) {
    const passed = Math.min((now - lastTick) / 1000, 0.25);
    state.time += passed * state.speed * baseSpeed();
    if (state.time <= lastTime()) return;
    const whole = runs.every((run) => run.ready === run.frames.length);
    state.time = whole ? firstTime() : lastTime();
}

function tick(now) {
    scheduled = false;
    if (runs.some((run) => run.ready === 0)) return;
    if (!view) start();
    if (state.playing) {
        advance(now);
        view.adapt(now - lastTick);
    }
    lastTick = now;
    if (stale.delete("frames") | stale.delete("colour") || state.playing) showFrames();
    stale.clear();
    if (state.playing) needs("frames");
    view.setFine(false);
    drawPicture();
    clearTimeout(rest);
    if (!state.playing) rest = setTimeout(() => view.setFine(true) && drawPicture(), 250);
}

let rest = 0;
function drawPicture() {
    view.draw({ surface: state.surface, shading: state.shading, ink: theme().ink });
    placeMark();
}

/* ---- frames and colour ---- */

const fieldOf = (run) => run.fields.find((field) => field.name === state.field) ?? null;

// position of each run in time; between two frames only while playing
function places() {
    return runs.map((run) => {
        const place = locate(run, state.time);
        return state.playing ? place : { index: place.index, weight: 0 };
    });
}

function showFrames() {
    const now = places();
    runs.forEach((run, i) => view.bodies[i].show(now[i].index, now[i].weight, fieldOf(run)));
    showColour();
    plots.follow(state.time);
    // texts change ten times a second at most while playing: laying them out takes longer than the picture
    if (state.playing && performance.now() - lastTexts < 100) return;
    lastTexts = performance.now();
    plots.showValues();
    showTexts(now);
    showReading(now);
}

let lastTexts = 0;

function showTexts(now) {
    const { index } = now[leader.index];
    const frame = leader.frames[index];
    const slider = $("frame");
    slider.max = leader.ready - 1;
    slider.value = index;
    const clock = leader.timed ? `${formatNumber(frame.time, 4)} s` : "";
    slider.setAttribute("aria-valuetext", `frame ${frame.number} of ${leader.frame_total - 1} ${clock}`);
    $("clock").textContent = `${clock}  frame ${frame.number}/${leader.frame_total - 1}`;
}

function rangeOf() {
    const fields = runs.map(fieldOf);
    if (state.range === "run") {
        const all = fields.filter(Boolean).map((field) => field.magnitudes);
        return [Math.min(...all.map((range) => range[0])), Math.max(...all.map((range) => range[1]))];
    }
    if (state.range === "inner") return innerRange(fields);
    let range = [Infinity, -Infinity];
    runs.forEach((_, i) => fields[i] && (range = widen(range, view.bodies[i].values)));
    return range;
}

function widen([low, high], values) {
    for (const value of values) {
        if (value < low) low = value;
        if (value > high) high = value;
    }
    return [low, high];
}

// range without the smallest 1 % and the largest 1 % of the values, from at most 24 frames of each run
const innerRanges = new Map();
function innerRange(fields) {
    const ready = runs.map((run) => run.ready).join();
    const key = `${state.field} ${ready}`;
    if (innerRanges.has(key)) return innerRanges.get(key);
    const samples = [];
    runs.forEach((run, i) => {
        if (!fields[i]) return;
        const step = Math.max(1, Math.floor(run.ready / 24));
        for (let f = 0; f < run.ready; f += step) {
            const values = new Float32Array(run.topologies[run.frames[f].topology][0]);
            fillValues(run, fields[i], f, 0, values);
            const stride = Math.max(1, Math.floor(values.length / 2000));
            for (let v = 0; v < values.length; v += stride) samples.push(values[v]);
        }
    });
    const ordered = Float64Array.from(samples).sort();
    const at = (part) => ordered[Math.round(part * (ordered.length - 1))];
    const range = [at(0.01), at(0.99)];
    innerRanges.set(key, range);
    return range;
}

function showColour() {
    const coloured = runs.some(fieldOf);
    view.uniforms.coloured.value = coloured;
    $("legend").hidden = !coloured;
    $("map").disabled = $("range").disabled = !coloured;
    if (!coloured) return;
    const { map, low, high } = fitColours(...rangeOf(), state.map);
    showMap(map);
    view.uniforms.range.value.set(low, high);
    const field = fieldOf(runs.find(fieldOf));
    const name = plainName(state.field);
    $("legend-name").textContent = withUnit(field.components > 1 ? `|${name}|` : name, unitOfField(field) && `[${unitOfField(field)}]`);
    const ticks = formatTogether([low, low + (high - low) / 2, high], 3);
    [...$("legend-ticks").children].forEach((tick, i) => (tick.textContent = ticks[i]));
}

let shownMap = "";
function showMap(name) {
    if (name === shownMap) return;
    shownMap = name;
    view.setMap(name);
    $("legend-bar").style.background = mapGradient(name);
}

/* ---- seeking and playing ---- */

function seek(time) {
    state.time = Math.max(firstTime(), Math.min(lastTime(), time));
    needs("frames");
}

// opens the page at the frame with the largest displacement of the leader, unless the user has moved already
function seekMost() {
    const { names, columns } = leader.table;
    const displacements = columns[names.indexOf("max_displacement")] ?? [];
    const rows = columns[names.indexOf(leader.timed ? "time" : "frame")];
    let most = 0;
    displacements.forEach((value, row) => value > displacements[most] && (most = row));
    if (displacements.length > 0 && !state.playing && (state.time ?? firstTime()) === firstTime()) seekFrame(rows[most]);
}

// shows the frame of the leader that is nearest to a time
function seekFrame(time) {
    const { index, weight } = locate(leader, time);
    seek(leader.frames[Math.min(index + (weight > 0.5 ? 1 : 0), leader.ready - 1)].time);
}

function step(count) {
    pause();
    const { index } = locate(leader, state.time);
    seek(leader.frames[Math.max(0, Math.min(leader.ready - 1, index + count))].time);
}

function setPlaying(playing) {
    state.playing = playing;
    lastTick = performance.now();
    if (playing && state.time >= lastTime()) state.time = firstTime();
    document.body.classList.toggle("playing", playing);
    $("play").setAttribute("aria-label", playing ? "Pause" : "Play");
    $("reading-values").setAttribute("aria-live", playing ? "off" : "polite");
    if (!playing) seek(leader.frames[locate(leader, state.time).index].time);
    needs("frames");
}

const pause = () => state.playing && setPlaying(false);

/* ---- picking ---- */

function pick(event) {
    const box = $("view").getBoundingClientRect();
    const found = view.pick(event.clientX - box.left, event.clientY - box.top);
    if (found) setPicked(found);
    else setPicked(null);
}

function setPicked(picked) {
    state.picked = picked;
    $("reading").hidden = !picked;
    if (picked) $("vertex").value = picked.vertex;
    needs("frames");
}

function readingRows(run, index, vertex) {
    const position = positionAt(run, index, vertex);
    const rows = [["position", formatVector(position), "m"]];
    for (const field of run.fields) {
        const values = componentsAt(run, field, index, vertex);
        const unit = unitOfField(field);
        const name = plainName(field.name);
        if (field.components === 1) {
            rows.push([name, formatNumber(values[0], 4), unit]);
            continue;
        }
        const length = field.channels === 1 ? values[0] : Math.hypot(...values);
        rows.push([`|${name}|`, formatNumber(length, 4), unit]);
        if (field.channels > 1) rows.push(["", formatVector(values), unit]);
    }
    return rows;
}

function showReading(now) {
    if (!state.picked) return;
    const { body, vertex } = state.picked;
    const run = runs[body];
    const { index } = now[body];
    const count = run.topologies[run.frames[index].topology][0];
    $("vertex").max = count - 1;
    const rows = vertex < count ? readingRows(run, index, vertex) : [["vertex", "not in this frame", ""]];
    if (runs.length > 1) rows.unshift(["run", run.name, ""]);
    const table = $("reading-values");
    if (table.rows.length !== rows.length) {
        table.replaceChildren(...rows.map(() => document.createElement("tr")));
        for (const row of table.rows) {
            const head = document.createElement("th");
            head.scope = "row";
            row.append(head, document.createElement("td"));
        }
    }
    rows.forEach(([name, text, unit], i) => {
        table.rows[i].cells[0].textContent = name;
        table.rows[i].cells[1].textContent = withUnit(text, unit);
    });
}

function placeMark() {
    const mark = $("mark");
    const run = state.picked && runs[state.picked.body];
    const body = state.picked && view.bodies[state.picked.body];
    const shown = run && state.picked.vertex < run.topologies[body.topology][0];
    mark.hidden = !shown;
    if (!shown) return;
    const { x, y } = view.project(state.picked.body, state.picked.vertex);
    mark.style.transform = `translate(${x}px, ${y}px)`;
}

/* ---- controls ---- */

function fill(id, entries, value, changed) {
    const select = $(id);
    select.replaceChildren(...entries.map(([key, text]) => new Option(text, key)));
    select.value = value;
    select.addEventListener("change", () => changed(select.value));
}

function setField(name) {
    state.field = name;
    $("colour").value = name;
    needs("frames");
}

function setMap(name) {
    state.map = name;
    $("map").value = name;
    needs("colour");
}

function setSurface(name) {
    state.surface = name;
    $("surface").value = name;
    needs("picture");
}

const surfaces = [
    ["smooth", "plain"],
    ["edges", "with edges"],
    ["wireframe", "wireframe"],
];

function makeControls() {
    const names = [...new Set(runs.flatMap((run) => run.fields.map((field) => field.name)))];
    fill("colour", [["", "none"], ...names.map((name) => [name, plainName(name)])], "", setField);
    fill("map", [["", "automatic"], ...mapNames.map((name) => [name, name])], state.map, setMap);
    const ranges = [
        ["run", "whole run"],
        ["inner", "inner 98 %"],
        ["frame", "this frame"],
    ];
    fill("range", ranges, state.range, (range) => {
        state.range = range;
        needs("colour");
    });
    fill("surface", surfaces, state.surface, setSurface);
    const shadings = [
        ["smooth", "smooth"],
        ["flat", "flat"],
    ];
    fill("shading", shadings, state.shading, (shading) => {
        state.shading = shading;
        needs("picture");
    });
    const speeds = [0.05, 0.1, 0.25, 0.5, 1, 2, 4, 8].map((speed) => [speed, `${speed} ×`]);
    fill("speed", speeds, 1, (speed) => (state.speed = Number(speed)));
    const base = baseSpeed();
    if (base !== 1) $("speed").title = `1 × shows ${formatNumber(base)} s of simulated time per second`;
    $("play").addEventListener("click", () => setPlaying(!state.playing));
    $("frame").addEventListener("input", () => {
        pause();
        seek(leader.frames[$("frame").valueAsNumber].time);
    });
    $("reset").addEventListener("click", () => view.reset());
    if (names.length > 0) setField(names[0]);
}

function listenToPicture() {
    const canvas = $("view");
    let down = null;
    canvas.addEventListener("pointerdown", (event) => (down = { x: event.clientX, y: event.clientY }));
    canvas.addEventListener("pointerup", (event) => {
        const still = down && Math.hypot(event.clientX - down.x, event.clientY - down.y) < 5;
        if (still && event.button === 0) pick(event);
        down = null;
    });
    $("reading-close").addEventListener("click", () => setPicked(null));
    $("reading-head").addEventListener("submit", (event) => event.preventDefault());
    $("vertex").addEventListener("input", () => {
        const input = $("vertex");
        if (input.validity.valid && input.value !== "") {
            state.picked = { body: state.picked?.body ?? 0, vertex: input.valueAsNumber };
            needs("frames");
        }
    });
}

function cycle(id, change) {
    const { options, selectedIndex } = $(id);
    change(options[(selectedIndex + 1) % options.length].value);
}

const turn = 0.12;
const keys = {
    " ": () => setPlaying(!state.playing),
    ArrowLeft: () => step(-1),
    ArrowRight: () => step(1),
    PageUp: () => step(-10),
    PageDown: () => step(10),
    Home: () => step(-Infinity),
    End: () => step(Infinity),
    "+": () => view.zoom(1.15),
    "=": () => view.zoom(1.15),
    "-": () => view.zoom(1 / 1.15),
    r: () => view.reset(),
    c: () => cycle("colour", setField),
    w: () => cycle("surface", setSurface),
    "?": () => $("keys").showModal(),
    Escape: () => setPicked(null),
    "shift ArrowLeft": () => view.turn(-turn, 0),
    "shift ArrowRight": () => view.turn(turn, 0),
    "shift ArrowUp": () => view.turn(0, turn),
    "shift ArrowDown": () => view.turn(0, -turn),
};

function listenToKeys() {
    addEventListener("keydown", (event) => {
        if (event.ctrlKey || event.metaKey || event.altKey || $("keys").open) return;
        const target = event.target.closest("input, select, button, summary, textarea, a");
        const slider = target === $("frame");
        if (target && !slider && !(target.matches("button") && event.key !== " " && event.key !== "Enter")) return;
        const action = keys[event.shiftKey && event.key.startsWith("Arrow") ? `shift ${event.key}` : event.key];
        if (!action) return;
        event.preventDefault();
        action();
    });
    $("keys-open").addEventListener("click", () => $("keys").showModal());
}

/* ---- light and dark ---- */

function theme() {
    const style = getComputedStyle(document.documentElement);
    const read = (name) => style.getPropertyValue(name).trim();
    const dark = isDark();
    return { name: dark ? "dark" : "light", ink: read("--soft"), grid: read("--line"), font: "system-ui, sans-serif" };
}

const prefersDark = matchMedia("(prefers-color-scheme: dark)");
const isDark = () => (document.documentElement.dataset.theme ?? (prefersDark.matches ? "dark" : "light")) === "dark";

function showTheme() {
    $("theme").textContent = isDark() ? "Light" : "Dark";
    plots?.build(theme(), state.time);
    if (view) needs("picture");
}

function listenToTheme() {
    prefersDark.addEventListener("change", showTheme);
    $("theme").addEventListener("click", () => {
        document.documentElement.dataset.theme = isDark() ? "light" : "dark";
        showTheme();
    });
}

/* ---- start ---- */

function makeLabels() {
    const mark = document.createElement("div");
    mark.id = "mark";
    mark.hidden = true;
    $("labels").append(mark);
    if (runs.length < 2) return;
    for (const run of runs) {
        const label = document.createElement("span");
        label.className = "label";
        label.textContent = run.name;
        $("labels").append(label);
    }
}

function placeLabels() {
    document.querySelectorAll("#labels .label").forEach((label, i) => {
        label.style.left = `${view.cells[i].x}px`;
        label.style.top = `${view.cells[i].y}px`;
    });
}

function start() {
    view = new View($("view"), runs, () => needs("picture"));
    state.time ??= firstTime();
    for (let i = 0; i < 3; i++) $("legend-ticks").append(document.createElement("span"));
    makeLabels();
    makeControls();
    listenToPicture();
    listenToKeys();
    plots = new Plots($("plots"), runs, (time) => {
        pause();
        seekFrame(time);
    });
    plots.build(theme(), state.time);
    showFrames();
    view.reset();
    new ResizeObserver(() => {
        view.resize();
        placeLabels();
        needs("picture");
    }).observe($("picture"));
    showDetails($("details"), runs);
    globalThis.pellicle = { state, view, runs, seek, step, setPlaying };
}

function fail(error) {
    $("failure").hidden = false;
    $("failure").textContent = `This report cannot be shown. ${error.message}`;
    throw error;
}

listenToTheme();
showTheme();
if (runs.length === 0) {
    $("facts").textContent = "This page contains no run. Write a report with: pellicle report DIR (the folder of a run)";
} else {
    $("title").textContent = runs.map((run) => run.sceneTitle || run.name).filter((t, i, all) => all.indexOf(t) === i).join(" · ");
    document.title = `${runs.map((run) => run.name).join(", ")} – Pellicle`;
    showFacts($("facts"), runs);
    finished
        .then(() => {
            seekMost();
            document.body.classList.add("ready");
        })
        .catch(fail);
}
