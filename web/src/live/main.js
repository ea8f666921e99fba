// The live page: converts input of the user to lines for the program, and messages of the program to pictures.
import { Vector3 } from "three";
import { fitColours, mapGradient, mapNames } from "../colour.js";
import { formatForce, formatNumber, formatTogether, plainName, withUnit } from "../format.js";
import { element } from "../plots.js";
import { Immersive, immersiveKinds } from "./immersive.js";
import { Parameters } from "./parameters.js";
import { findPad, readPad } from "./pads.js";
import { LivePlots } from "./plots.js";
import { Stage } from "./stage.js";
import { Trainer } from "./trainer.js";
import { linesOf } from "./yaml.js";

const $ = (id) => document.getElementById(id);

const state = {
    mode: "pull",
    shape: "sphere",
    radius: 0.12, // in units of half the size of the bodies
    depth: 0.15, // in the same unit
    reach: 0.15, // in the same unit, of a grasp
    brush: 0.08, // in the same unit
    bite: 0.045, // in the same unit, of forceps
    blade: 0.06, // in the same unit, half the edge of a blade or hook
    edge: "blade", // or scissors
    anew: true, // forceps grasp the flap of a tear anew
    lift: 0, // in the same unit, of forceps above the height of those of the scene, or above the surface
    grip: 0, // decimal exponent of a factor on the stiffness that the program proposes
    field: "",
    map: "", // automatic
    surface: "smooth",
    contacts: false,
    marks: true,
    playing: false,
};
let hello = null;
let frame = null; // the newest frame
let shown = null; // the last drawn frame
let latestScore = null; // the newest frame with a score
let hand = null; // the present action of the pointer
const ruler = []; // up to two points on surfaces

const stage = new Stage($("view"), () => needs());
const plots = new LivePlots($("plots"));
let wire = null;
const send = (line) => wire.send(line);
const parameters = new Parameters($("parameters"), send);
const trainer = new Trainer($("trainer"), { send, fromAbove: () => stage.reset() });

/* ---- messages ---- */

function receive(message) {
    const actions = { hello: start, parameters: showParameters, surface: showSurface, frame: takeFrame, notice: showNotice, scene: saveScene };
    actions[message.type]?.(message);
}

function start(message) {
    hello = message;
    shown = frame = hand = pointed = latestScore = null;
    ruler.length = 0;
    range.reset();
    message.circle = message.tools.find(({ circle }) => circle)?.circle ?? null;
    plots.setTools(message.tools.map(({ name }) => name));
    trainer.setScene(message);
    if (message.circle) $("marks").checked = state.marks = false;
    $("notice").hidden = true;
    stage.setScene(message);
    immersive.place();
    makeOptions();
    $("title").textContent = message.title || message.path.split("/").pop() || fileName;
    document.title = `${$("title").textContent} – Pellicle live`;
    const known = message.fields.map(({ name }) => name);
    if (!known.includes(state.field)) state.field = "";
    fill("colour", [["", "none"], ...known.map((name) => [name, plainName(name)])], state.field);
    if (state.field) send(`field ${state.field}`);
}

function showSurface(message) {
    stage.setSurface(message.bodies, message.tool ?? null);
}

function showParameters(message) {
    latestParameters = message;
    const scale = (2 * (hello?.stiffness ?? 1)) / stage.size;
    parameters.show(message, Number(scale.toPrecision(2)));
}
let latestParameters = null;

function takeFrame(message) {
    frame = message;
    owed++;
    if (!document.hidden) acknowledge();
    if (message.measures) plots.add(message);
    if (message.score) latestScore = message;
    schedule();
}

// The program sends the next frame while this one is drawn. A hidden page draws no frames and acknowledges none.
let owed = 0;
function acknowledge() {
    for (; owed > 0; owed--) send("received");
}

function showNotice({ kind, text }) {
    if (kind === "refused" && parameters.refuse(text)) return;
    const notice = $("notice");
    // problem and remedy of a message both start with a small letter
    notice.textContent = text.replace(/(^|\. )([a-z])/g, (_, before, letter) => before + letter.toUpperCase());
    notice.className = kind === "note" ? "note" : "error";
    notice.hidden = false;
    clearTimeout(noticeTimer);
    noticeTimer = setTimeout(() => (notice.hidden = true), 12000);
}
let noticeTimer = 0;

// why: text for the user if there is no connection; "" = connected
function showConnection(why) {
    document.body.classList.toggle("away", why !== "");
    if (why !== "") {
        hand = null;
        $("facts").textContent = why;
    }
}

/* ---- pictures ---- */

let scheduled = false;
let changed = false; // camera, theme or display of the bodies have changed
let lastPicture = 0;

function schedule() {
    if (scheduled || stage.immersed) return;
    scheduled = true;
    requestAnimationFrame((now) => {
        scheduled = false;
        // a headset asks for pictures by itself
        if (!stage.immersed) tick(now);
    });
}

// requests a new picture
function needs() {
    changed = true;
    schedule();
}

// Draws only if something has changed: with software rendering, a picture takes longer than a step.
function tick(now) {
    if (!hello) return;
    const hasPad = followPad(now);
    acknowledge();
    hand?.tick?.();
    if (frame !== shown) takePicture(now);
    if (changed) draw();
    if (hand?.tick || hasPad) schedule();
}

function takePicture(now) {
    if (stage.showFrame(frame, state.contacts)) {
        if (shown && frame.playing) stage.adapt(now - lastPicture);
        lastPicture = now;
        showColour();
        showTexts(now);
        changed = true;
    }
    shown = frame;
}

function draw() {
    changed = false;
    stage.coarsen();
    drawPicture();
    clearTimeout(rest);
    rest = setTimeout(() => stage.refine() && drawPicture(), 250);
}

let rest = 0;
function drawPicture() {
    stage.draw({ surface: state.surface, ink: theme().ink, marks: state.marks });
    placeLabels();
}

// half sizes of the bodies from where they began, beyond which the page offers to bring them back
const FAR = 2;
const bringBack = () => (frame.undo > 0 ? send("undo") : restart());

let lastTexts = 0;
function showTexts(now) {
    const changes = state.playing !== frame.playing;
    state.playing = frame.playing;
    if (frame.playing && !changes && now - lastTexts < 120) return;
    lastTexts = now;
    document.body.classList.toggle("playing", frame.playing);
    $("play").setAttribute("aria-label", frame.playing ? "Pause" : "Play");
    $("undo").disabled = frame.undo === 0;
    $("back").hidden = !(stage.drift > FAR);
    $("clock").textContent = `${formatNumber(frame.time, 4)} s`;
    const pace = frame.pace > 0 ? ` · ${formatNumber(frame.pace, 2)} × real time · ${formatNumber(frame.step_ms, 3)} ms per step` : "";
    const vertices = stage.bodies.reduce((sum, body) => sum + body.count, 0);
    $("facts").textContent = `${vertices.toLocaleString("en")} vertices${pace}`;
    plots.show();
    if (latestScore) trainer.show(latestScore, frame);
}

/* ---- colour ---- */

// range of the colours: only widens for the same field, so a colour means about the same in all pictures
const range = {
    low: Infinity,
    high: -Infinity,
    reset() {
        this.low = Infinity;
        this.high = -Infinity;
    },
    take(values) {
        for (const value of values) {
            if (value < this.low) this.low = value;
            if (value > this.high) this.high = value;
        }
    },
};

function showColour() {
    const coloured = Boolean(state.field) && frame.field === state.field;
    stage.uniforms.coloured.value = coloured;
    $("legend").hidden = !coloured;
    $("map").disabled = !coloured;
    if (!coloured) return;
    frame.bodies.forEach((body) => range.take(body.values));
    const { map, low, high } = fitColours(range.low, range.high, state.map);
    showMap(map);
    stage.uniforms.range.value.set(low, high);
    const { name, unit, components } = hello.fields.find((field) => field.name === state.field);
    $("legend-name").textContent = withUnit(components > 2 ? `|${plainName(name)}|` : plainName(name), unit && `[${unit.replace(/m2$/, "m²")}]`);
    const ticks = formatTogether([low, low + (high - low) / 2, high], 3);
    [...$("legend-ticks").children].forEach((tick, i) => (tick.textContent = ticks[i]));
}

function setField(name) {
    state.field = name;
    $("colour").value = name;
    range.reset();
    send(`field ${name || "none"}`);
}

function setMap(name) {
    state.map = name;
    if (frame) showColour();
    needs();
}

let shownMap = "";
function showMap(name) {
    if (name === shownMap) return;
    shownMap = name;
    stage.setMap(name);
    $("legend-bar").style.background = mapGradient(name);
}

function setSurface(name) {
    state.surface = name;
    $("surface").value = name;
    needs();
}

/* ---- labels ---- */

function put(id, at, text) {
    const label = $(id);
    label.hidden = !at;
    if (!at) return;
    label.textContent = text;
    // keep the label inside the picture
    const most = $("view").clientWidth - label.offsetWidth - 4;
    label.style.transform = `translate(${Math.max(4, Math.min(at.x + 12, most))}px, ${at.y - 12}px)`;
}

function placeLabels() {
    const held = shown?.hand ?? frame?.hand;
    const newton = held && held.kind !== "free" ? Math.hypot(...held.force) : 0;
    put("newton", stage.arrow.visible ? stage.project(stage.tip) : null, formatForce(newton));
    placeRuler();
}

function placeRuler() {
    const snipped = hand?.line?.();
    const points = snipped ?? ruler.map(({ body, place }) => stage.bodies[body].point(place));
    const [a, b] = points.map((point) => stage.project(point));
    $("ruler").toggleAttribute("hidden", !b);
    if (!a) return put("length", null);
    const line = $("ruler").firstElementChild;
    for (const [name, value] of Object.entries(b ? { x1: a.x, y1: a.y, x2: b.x, y2: b.y } : {})) line.setAttribute(name, value);
    // place the label below the line
    const below = b && { x: (a.x + b.x) / 2, y: Math.max(a.y, b.y) + 24 };
    const length = b && `${formatNumber(points[0].distanceTo(points[1]) * stage.size, 4)} m`;
    if (snipped) return put("length", below, length);
    const bends = ruler.map(({ body, place }) => formatNumber(stage.bodies[body].curvature(place) / stage.size, 3)).join(" → ");
    const valueAt = ({ body, place }) => place.corners.reduce((sum, v, c) => sum + place.weights[c] * stage.bodies[body].values[v], 0);
    const values = stage.uniforms.coloured.value ? ruler.map((at) => formatNumber(valueAt(at), 3)).join(" → ") : "";
    const bent = `mean curvature ${bends} m⁻¹`;
    if (!b) return put("length", a, [bent, values, "select a second point"].filter(Boolean).join("   "));
    put("length", below, [length, bent, values].filter(Boolean).join("   "));
}

/* ---- the hand ---- */

const solids = ["sphere", "capsule", "box"];
const numbers = (values) => values.map((value) => Number(value.toPrecision(9))).join(" ");
const rayText = ({ origin, direction }) => `${numbers(stage.outward(origin))} ${numbers(direction.toArray())}`;
const stiffness = () => (hello?.stiffness ?? 1) * 10 ** state.grip;
const moveTo = (point) => send(`move ${numbers(stage.outward(point))}`);

// Each function starts the action of a tool at a point of a surface. It returns the action: move(ray) and end(), and tick() for
// each picture if needed.
const modes = {
    pull(ray, hit) {
        send("mark");
        send(`grab ${rayText(ray)} ${numbers([stiffness(), state.reach * stage.size])}`);
        return { kind: "pull", point: hit.point, move: (now) => moveTo(stage.onPlane(now, hit.point)), end: () => send("release") };
    },
    press(ray, hit) {
        const radius = state.radius;
        // start far enough away that a box over a dent is outside the body
        const clear = 0.3 * radius + 0.2;
        const start = hit.point.clone().addScaledVector(hit.normal, radius + clear);
        const flat = new Vector3(0, 0, 1).cross(hit.normal);
        const axis = state.shape === "capsule" ? (flat.lengthSq() > 1e-6 ? flat.normalize() : new Vector3(1, 0, 0)) : hit.normal;
        send("mark");
        send(`press ${state.shape} ${numbers([radius * stage.size, ...stage.outward(start), ...Stage.facing(axis).toArray()])}`);
        const began = performance.now();
        return {
            kind: "press",
            last: ray,
            move(now) {
                this.last = now;
            },
            // the depth grows to that of the slider in 0.5 s; the pressure of a pen or the travel of a trigger sets it directly
            tick() {
                const part = this.squeeze ?? Math.min((performance.now() - began) / 500, 1);
                const shift = stage.onPlane(this.last, hit.point).sub(hit.point);
                moveTo(start.clone().add(shift).addScaledVector(hit.normal, -part * (clear + state.depth)));
            },
            end: () => send("release"),
        };
    },
    forceps(ray, hit) {
        const anew = state.anew && hello.circle;
        const most = anew ? hello.circle.regrasp / 4 : Infinity;
        const place = (now) => (stage.circle ? stage.onCircle(now, state.lift) : stage.onPlane(now, hit.point.clone().addScaledVector(hit.normal, state.lift)));
        send("mark");
        send(`grasp ${rayText(ray)} ${numbers([Math.min(state.bite * stage.size, most)])} ${anew ? 1 : 0}`);
        return { kind: "forceps", last: ray, move(now) { this.last = now; moveTo(place(now)); }, end: () => send("release") };
    },
    blade: (ray, hit) => (state.edge === "scissors" ? snip(hit) : lead("blade", ray, hit)),
    hook: (ray, hit) => lead("hook", ray, hit),
    pin: (ray) => brush("pin", ray),
    unpin: (ray) => brush("unpin", ray),
    cut(ray) {
        send("mark");
        send(`cut ${rayText(ray)}`);
        return { kind: "cut", move: (now) => send(`cut ${rayText(now)}`), end: () => send("release") };
    },
    measure(_, hit) {
        if (ruler.length === 2) ruler.length = 0;
        ruler.push(hit);
        needs();
        return null;
    },
    turn: () => undefined,
};

// an edge along the normal, which comes down through the surface and then goes where the pointer is on it
function lead(shape, ray, hit) {
    const half = state.blade;
    const start = hit.point.clone().addScaledVector(hit.normal, 1.5 * half);
    send("mark");
    send(`press ${shape} ${numbers([half * stage.size, ...stage.outward(start), ...Stage.facing(hit.normal).toArray()])}`);
    moveTo(hit.point);
    return { kind: shape, move: (now) => moveTo(stage.pick(now)?.point ?? stage.onPlane(now, hit.point)), end: () => send("release") };
}

// scissors cut from where the drag begins to where it ends
function snip(hit) {
    let to = hit.point;
    const way = () => to.clone().sub(hit.point);
    send("mark");
    return {
        kind: "scissors",
        line: () => [hit.point, to],
        move(now) {
            to = stage.pick(now)?.point ?? stage.onPlane(now, hit.point);
            needs();
        },
        end() {
            const turn = Stage.along(way(), hit.normal);
            if (way().length() > leastSnip) send(`press scissors ${numbers([(way().length() / 2) * stage.size, ...stage.outward(hit.point), ...turn.toArray()])}`);
        },
    };
}
const leastSnip = 0.01; // in units of half the size of the bodies

function brush(word, ray) {
    const paint = (at) => send(`${word} ${rayText(at)} ${numbers([state.brush * stage.size])}`);
    send("mark");
    paint(ray);
    return { kind: word, move: paint, end: () => {} };
}

/* ---- lines of a scene ---- */

let pointed = null; // the last hit of the hand, or the place under the pointer

// copies the lines of a scene for the tool, pin or region at the pointer
async function copyLines(ray) {
    const hit = (ray && shown && stage.pick(ray)) || pointed;
    if (!hit) return showNotice({ kind: "note", text: "use the tool on a body first, or point at one and press y" });
    const place = stage.atFirst(hit);
    const body = hello.bodies[place.body].name;
    const sizes = { shape: state.shape, size: stage.size };
    for (const key of ["radius", "depth", "brush", "reach"]) sizes[key] = state[key] * stage.size;
    copied = linesOf(state.mode, { ...place, body }, sizes);
    try {
        await navigator.clipboard.writeText(copied);
        showNotice({ kind: "note", text: `copied for a scene: ${copied}` });
    } catch {
        download(new Blob([copied], { type: "application/yaml" }), "lines.yaml");
    }
}
let copied = "";

function copyButton() {
    const button = element("button", "quiet", "Copy as YAML");
    button.type = "button";
    button.title = "Copy the lines of a scene for the place where the tool was last used (y: at the pointer)";
    button.addEventListener("click", () => copyLines());
    return button;
}

function rayOf(event) {
    const box = $("view").getBoundingClientRect();
    return stage.ray(event.clientX - box.left, event.clientY - box.top);
}

// starts an action at a ray and returns what it met; null if the ray meets no body or the tool is `turn`
function begin(ray) {
    const hit = shown && stage.pick(ray);
    if (hand || !hit || state.mode === "turn") return null;
    hand = modes[state.mode](ray, hit);
    pointed = hit;
    // start playing after the mark, so that undo returns to the state before
    if (hand && !state.playing) send("play");
    schedule();
    return hit;
}

function end() {
    hand?.end();
    hand = null;
    stage.controls.enabled = true;
}

// half of the maximum pressure of a pen gives the depth of the slider
function squeezeBy(event) {
    if (hand && event.pointerType === "pen") hand.squeeze = 2 * event.pressure;
}

let under = null; // ray of the pointer over the picture

function listenToPicture() {
    const canvas = $("view");
    canvas.addEventListener(
        "pointerdown",
        (event) => {
            if (event.button !== 0 || event.ctrlKey || event.metaKey || !begin(rayOf(event))) return;
            stage.controls.enabled = false;
            canvas.setPointerCapture(event.pointerId);
            squeezeBy(event);
        },
        { capture: true },
    );
    canvas.addEventListener("pointermove", (event) => (under = rayOf(event)));
    canvas.addEventListener("pointerleave", () => (under = null));
    // raw moves arrive at once; other moves wait for the next picture
    canvas.addEventListener("onpointerrawupdate" in canvas ? "pointerrawupdate" : "pointermove", (event) => {
        if (!hand || aim.acts) return;
        hand.move(rayOf(event));
        squeezeBy(event);
    });
    canvas.addEventListener("pointerup", end);
    canvas.addEventListener("pointercancel", end);
    canvas.addEventListener(
        "wheel",
        (event) => {
            if (hand?.kind !== "press" && hand?.kind !== "forceps") return;
            event.preventDefault();
            event.stopImmediatePropagation();
            if (hand.kind === "press") state.depth = Math.max(0, Math.min(1, state.depth - 0.0005 * event.deltaY));
            else {
                state.lift = Math.max(-1, Math.min(1, state.lift - 0.0002 * event.deltaY));
                hand.move(hand.last);
            }
            makeOptions();
        },
        { capture: true, passive: false },
    );
}

/* ---- gamepads ---- */

// speed of the pointer [heights of the picture per s], of turning [rad/s], of zooming [factor per s]; squeezes at which an action
// starts and ends
const padSpeed = { aim: 0.6, turn: 1.8, zoom: 2, begin: 0.15, end: 0.05 };
const aim = { x: 0.5, y: 0.5, last: 0, acts: false, buttons: {} }; // position relative to the size of the picture

const padActions = {
    undo: () => send("undo"),
    view: () => stage.reset(true),
    play: () => playOrPause(),
    before: () => nextMode(-1),
    next: () => nextMode(1),
};

function pressPadButtons(buttons) {
    for (const [name, isDown] of Object.entries(buttons)) if (isDown && !aim.buttons[name]) padActions[name]();
    aim.buttons = buttons;
}

// reads the gamepad and acts on its input; false if there is none
function followPad(now) {
    const pad = findPad();
    $("aim").hidden = !pad;
    if (!pad) return false;
    const seconds = Math.min((now - aim.last) / 1000, 0.1);
    const asked = readPad(pad);
    const { width, height } = $("view").getBoundingClientRect();
    const clamp = (value) => Math.max(0, Math.min(1, value));
    aim.last = now;
    aim.x = clamp(aim.x + (asked.aim[0] * padSpeed.aim * seconds * height) / width);
    aim.y = clamp(aim.y + asked.aim[1] * padSpeed.aim * seconds);
    const [x, y] = [aim.x * width, aim.y * height];
    $("aim").style.transform = `translate(${x}px, ${y}px)`;
    if (asked.turn.some((part) => part !== 0)) stage.turn(...asked.turn.map((part) => part * padSpeed.turn * seconds));
    if (asked.zoom !== 0) stage.zoom(padSpeed.zoom ** (asked.zoom * seconds));
    if (!aim.acts && asked.squeeze > padSpeed.begin) aim.acts = begin(stage.ray(x, y)) !== null;
    else if (aim.acts && asked.squeeze < padSpeed.end) {
        aim.acts = false;
        end();
    } else if (aim.acts && hand) {
        hand.move(stage.ray(x, y));
        hand.squeeze = asked.squeeze;
    }
    pressPadButtons(asked.buttons);
    return true;
}

/* ---- headsets ---- */

const handForce = () => (shown && shown.hand.kind !== "free" ? Math.hypot(...shown.hand.force) : 0);
const immersive = new Immersive(stage, {
    begin,
    move(ray, squeeze) {
        hand?.move(ray);
        if (hand && squeeze !== undefined) hand.squeeze = squeeze;
    },
    end,
    undo: () => send("undo"),
    next: () => nextMode(1),
    label(acts) {
        const name = modeNames.find(([mode]) => mode === state.mode)[1];
        return acts && handForce() > 0 ? `${name} ${formatForce(handForce())}` : name;
    },
    // half at the force of the spring that pulls by a quarter of half the size of the bodies
    strength: () => handForce() / (handForce() + 0.25 * (hello.stiffness ?? 1) * stage.size),
    background: () => getComputedStyle(document.body).backgroundColor,
    tick(now) {
        changed = true;
        tick(now);
    },
    ended: needs,
});

async function offerImmersion() {
    for (const [kind, name] of await immersiveKinds()) {
        const button = element("button", "quiet", name);
        button.type = "button";
        button.id = kind;
        button.title = `Show the bodies ${kind === "immersive-vr" ? "in the headset" : "in the room"}; once more: end it`;
        const refuse = ({ message }) => showNotice({ kind: "error", text: `the browser did not start ${name}: ${message}` });
        button.addEventListener("click", () => immersive.toggle(kind).catch(refuse));
        $("film").before(button);
    }
}

/* ---- controls ---- */

function fill(id, entries, value, changed) {
    const select = $(id);
    select.replaceChildren(...entries.map(([key, text]) => new Option(text, key)));
    select.value = value;
    if (changed) select.addEventListener("change", () => changed(select.value));
}

const modeNames = [
    ["pull", "Pull"],
    ["press", "Press"],
    ["forceps", "Forceps"],
    ["blade", "Blade"],
    ["hook", "Hook"],
    ["pin", "Pin"],
    ["unpin", "Unpin"],
    ["cut", "Cut"],
    ["measure", "Measure"],
    ["turn", "Turn"],
];

// 1 to 9, then 0
const keyOfMode = (i) => String((i + 1) % 10);

function setMode(mode) {
    state.mode = mode;
    for (const button of $("modes").children) {
        const chosen = button.dataset.mode === mode;
        button.setAttribute("aria-checked", chosen);
        button.tabIndex = chosen ? 0 : -1;
    }
    $("view").classList.toggle("turning", mode === "turn");
    makeOptions();
}

function nextMode(way) {
    const index = modeNames.findIndex(([mode]) => mode === state.mode);
    setMode(modeNames.at((index + way) % modeNames.length)[0]);
}

function slider(text, key, low, high, show) {
    const label = element("label", "", text);
    const input = element("input");
    const value = element("output");
    Object.assign(input, { type: "range", min: low, max: high, step: (high - low) / 100, value: state[key] });
    const update = () => (value.textContent = show(state[key]));
    input.addEventListener("input", () => {
        state[key] = input.valueAsNumber;
        update();
    });
    update();
    label.append(input, value);
    return label;
}

function checkbox(text, key) {
    const label = element("label", "tick", text);
    const input = element("input");
    Object.assign(input, { type: "checkbox", checked: state[key] });
    input.addEventListener("change", () => (state[key] = input.checked));
    label.append(input);
    return label;
}

const metres = (part) => `${formatNumber(part * stage.size, 2)} m`;

function makeOptions() {
    const choice = (name, select, key) => {
        const label = element("label", "", name);
        select.value = state[key];
        select.addEventListener("change", () => {
            state[key] = select.value;
            makeOptions();
        });
        label.append(select);
        return label;
    };
    const shape = () => {
        const select = element("select");
        const group = (name, words) => {
            const made = element("optgroup");
            made.label = name;
            made.append(...words.map((word) => new Option(word.replaceAll("%20", " "), word)));
            return made;
        };
        const meshes = (hello?.presses ?? []).toSorted();
        const [files, made] = [true, false].map((isFile) => meshes.filter((word) => word.includes(".") === isFile));
        select.append(...solids.map((name) => new Option(name, name)), group("Meshes", made));
        if (files.length > 0) select.append(group("Files in the folder of the scene", files));
        if (![...solids, ...meshes].includes(state.shape)) state.shape = "sphere";
        return choice("Shape", select, "shape");
    };
    const edge = () => {
        const select = element("select");
        select.append(new Option("blade"), new Option("scissors"));
        return choice("Tool", select, "edge");
    };
    // meshes need contact, which cannot be switched on during a simulation
    const startContact = () => {
        if (solids.includes(state.shape) || hello.contact) return [];
        const button = element("button", "quiet", "Start again with contact");
        button.type = "button";
        button.title = "Mesh tools need contact: start the scene again with contact";
        button.addEventListener("click", () => send("contact"));
        return [button];
    };
    const made = {
        pull: () => [slider("Spring", "grip", -2, 2, () => `${formatNumber(stiffness(), 2)} N/m`), slider("Reach", "reach", 0, 0.6, metres)],
        press: () => [shape(), ...startContact(), slider("Size", "radius", 0.03, 0.5, metres), slider("Depth", "depth", 0, 1, metres)],
        forceps: () => [slider("Bite", "bite", 0.01, 0.15, metres), slider("Height", "lift", -1, 1, metres), ...(stage.circle ? [checkbox("Grasp anew", "anew")] : [])],
        blade: () => [edge(), ...(state.edge === "scissors" ? [] : [slider("Edge", "blade", 0.02, 0.3, (part) => metres(2 * part))])],
        hook: () => [slider("Edge", "blade", 0.02, 0.3, (part) => metres(2 * part))],
        pin: () => [slider("Brush", "brush", 0.01, 0.4, metres)],
        unpin: () => [slider("Brush", "brush", 0.01, 0.4, metres)],
    };
    $("options").replaceChildren(...(made[state.mode]?.() ?? []), copyButton());
}

function makeControls() {
    $("modes").append(
        ...modeNames.map(([mode, name], i) => {
            const button = element("button", "", name);
            button.type = "button";
            button.role = "radio";
            button.dataset.mode = mode;
            button.title = `${name} (${keyOfMode(i)})`;
            button.addEventListener("click", () => setMode(mode));
            return button;
        }),
    );
    $("modes").addEventListener("keydown", (event) => {
        const way = { ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1 }[event.key];
        if (!way) return;
        event.preventDefault();
        nextMode(way);
        $("modes").querySelector('[aria-checked="true"]').focus();
    });
    setMode("pull");
    $("colour").addEventListener("change", () => setField($("colour").value));
    fill("map", [["", "automatic"], ...mapNames.map((name) => [name, name])], state.map, setMap);
    fill("surface", [["smooth", "plain"], ["edges", "with edges"], ["wireframe", "wireframe"]], state.surface, setSurface);
    for (const key of ["contacts", "marks"])
        $(key).addEventListener("change", () => {
            state[key] = $(key).checked;
            if (frame) stage.showFrame(frame, state.contacts);
            needs();
        });
    $("play").addEventListener("click", playOrPause);
    $("step").addEventListener("click", step);
    $("undo").addEventListener("click", () => send("undo"));
    $("restart").addEventListener("click", restart);
    $("back").addEventListener("click", bringBack);
    $("reset").addEventListener("click", () => stage.reset(true));
    $("save").addEventListener("click", askForScene);
    $("open").addEventListener("click", () => $("file").click());
    $("file").addEventListener("change", openScene);
    $("film").addEventListener("click", film);
    setMap(state.map);
}

const playOrPause = () => send(state.playing ? "pause" : "play");
const restart = () => send("reset");
function step() {
    send("pause");
    send("step");
}

/* ---- files ---- */

function download(blob, name) {
    const link = element("a");
    link.href = URL.createObjectURL(blob);
    link.download = name;
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}

let asked = false;
function askForScene() {
    asked = true;
    send("save");
}

// saves the scene only if this page asked for it, not another page
function saveScene({ text }) {
    if (asked) download(new Blob([text], { type: "application/yaml" }), "session.yaml");
    asked = false;
}

let fileName = "opened scene"; // name of the last scene that this page opened
async function openScene() {
    const file = $("file").files[0];
    if (file) {
        fileName = file.name;
        send(`open ${await file.text()}`);
    }
    $("file").value = "";
}

let recorder = null;
function film() {
    if (recorder) {
        recorder.stop();
        recorder = null;
    } else {
        const parts = [];
        recorder = new MediaRecorder($("view").captureStream(30), { mimeType: "video/webm" });
        recorder.ondataavailable = ({ data }) => parts.push(data);
        recorder.onstop = () => download(new Blob(parts, { type: "video/webm" }), "session.webm");
        recorder.start();
    }
    $("film").setAttribute("aria-pressed", Boolean(recorder));
    $("film").textContent = recorder ? "Stop film" : "Film";
}

/* ---- keys ---- */

function cycle(id, change) {
    const { options, selectedIndex } = $(id);
    change(options[(selectedIndex + 1) % options.length].value);
}

const turn = 0.12;
const keys = {
    " ": playOrPause,
    s: step,
    u: () => send("undo"),
    "ctrl z": () => send("undo"),
    r: restart,
    v: () => stage.reset(true),
    c: () => cycle("colour", setField),
    w: () => cycle("surface", setSurface),
    "ctrl s": askForScene,
    o: () => $("file").click(),
    y: () => copyLines(under),
    "+": () => stage.zoom(1.15),
    "=": () => stage.zoom(1.15),
    "-": () => stage.zoom(1 / 1.15),
    "?": () => $("keys").showModal(),
    "shift ArrowLeft": () => stage.turn(-turn, 0),
    "shift ArrowRight": () => stage.turn(turn, 0),
    "shift ArrowUp": () => stage.turn(0, turn),
    "shift ArrowDown": () => stage.turn(0, -turn),
    ...Object.fromEntries(modeNames.map(([mode], i) => [keyOfMode(i), () => setMode(mode)])),
};

function listenToKeys() {
    addEventListener("keydown", (event) => {
        if (event.altKey || $("keys").open) return;
        const target = event.target.closest("input, select, button, summary, textarea, a");
        const ctrl = event.ctrlKey || event.metaKey;
        if (target && !ctrl && !(target.matches("button") && event.key !== " " && event.key !== "Enter")) return;
        if (target?.matches('input[type="text"], input[type="number"]')) return;
        const action = keys[ctrl ? `ctrl ${event.key}` : event.shiftKey && event.key.startsWith("Arrow") ? `shift ${event.key}` : event.key];
        if (!action) return;
        event.preventDefault();
        action();
    });
    $("keys-open").addEventListener("click", () => $("keys").showModal());
}

/* ---- light and dark ---- */

const prefersDark = matchMedia("(prefers-color-scheme: dark)");
const isDark = () => (document.documentElement.dataset.theme ?? (prefersDark.matches ? "dark" : "light")) === "dark";

function theme() {
    const style = getComputedStyle(document.documentElement);
    const read = (name) => style.getPropertyValue(name).trim();
    return { name: isDark() ? "dark" : "light", ink: read("--soft"), grid: read("--line"), font: "system-ui, sans-serif" };
}

function showTheme() {
    $("theme").textContent = isDark() ? "Light" : "Dark";
    plots.build(theme());
    needs();
}

prefersDark.addEventListener("change", showTheme);
$("theme").addEventListener("click", () => {
    document.documentElement.dataset.theme = isDark() ? "light" : "dark";
    showTheme();
});

// connect(received, changed) opens a channel with send(line): see wire.js and worker-wire.js
export function run(connect) {
    makeControls();
    listenToPicture();
    listenToKeys();
    addEventListener("gamepadconnected", needs);
    offerImmersion();
    showTheme();
    new ResizeObserver(() => {
        stage.resize();
        needs();
    }).observe($("picture"));
    wire = connect(receive, showConnection);
}

globalThis.pellicle = {
    state,
    aim: (x, y) => Object.assign(aim, { x, y }),
    stage,
    immersive,
    send,
    get wire() {
        return wire;
    },
    plots,
    get frame() {
        return shown;
    },
    get newest() {
        return frame;
    },
    get parameters() {
        return latestParameters;
    },
    get copied() {
        return copied;
    },
    get hello() {
        return hello;
    },
};
