// The trainer: shows how the tear of a scene goes whose forceps lead one. The program measures it (pel_sim_get_score).
import { formatForce, formatNumber } from "../format.js";
import { element } from "../plots.js";

const degrees = (angle) => `${formatNumber((angle * 180) / Math.PI, 3)}°`;
const metres = (length) => (length === null ? "–" : `${formatNumber(1e3 * length, 3)} mm`);

const rows = [
    ["Way round", "swept", ({ score }) => (score.whole ? "whole" : degrees(score.swept))],
    ["Diameter", "diameter", ({ score }) => `${score.swept > 0 ? metres(score.diameter) : "–"} of ${metres(2 * score.aim)}`],
    ["Off centre", "offset", ({ score }) => metres(score.offset)],
    ["Roundness", "roundness", ({ score }) => (score.roundness === null ? "–" : `${formatNumber(100 * score.roundness, 3)} %`)],
    ["Run-outs", "run_outs", ({ score }) => String(score.run_outs)],
    ["Force", "force", (_, force) => formatForce(force)],
    ["Force RMS, peak", "peak", ({ score }) => `${formatForce(score.force_rms)}, ${formatForce(score.force_peak)}`],
    ["Posterior contact", "touches", ({ score }) => (score.touches > 0 ? "yes" : "none")],
    ["Tear", "length", ({ tear }) => `${metres(tear.length)}, ${formatNumber(1e6 * tear.fracture_energy, 3)} µJ`],
    ["Tips", "tips", ({ tear }) => `${tear.tips.length}, up to ${formatNumber(Math.max(0, ...tear.tips.map(({ rate }) => rate ?? 0)), 3)} J/m²`],
    ["Time", "time", ({ score }) => `${formatNumber(score.time, 3)} s`],
];

const svg = (name, attributes) => {
    const made = document.createElementNS("http://www.w3.org/2000/svg", name);
    for (const key in attributes) made.setAttribute(key, attributes[key]);
    return made;
};

// what differs between eyes: commands for the body
const eyes = [
    ["as in the scene", null],
    ["swollen, 5 mmHg", (body) => [`inflate ${body} 667`]],
    ["swollen, 20 mmHg", (body) => [`inflate ${body} 2666`]],
    ["young: stretches more", (body) => [`set bodies.${body}.springs.young 7e5`]],
    ["old: stiffer", (body) => [`set bodies.${body}.springs.young 3e6`]],
    ["weak zonules on one side", () => ["unpin 0.02 0 0 -1 0 0 0.003"]],
];

export class Trainer {
    constructor(parent, { send, fromAbove }) {
        this.parent = parent;
        this.send = send;
        const head = element("h2", "", "Trainer");
        this.picture = svg("svg", { viewBox: "-1.5 -1.5 3 3", role: "img", "aria-label": "The tear from above" });
        this.aim = svg("circle", { r: 1, class: "aim" });
        this.path = svg("path", { class: "path" });
        this.marks = svg("g", {});
        this.picture.append(this.aim, this.path, this.marks);
        const list = element("dl");
        this.values = rows.map(([name, key]) => {
            const value = element("dd");
            value.dataset.score = key;
            list.append(element("dt", "", name), value);
            return value;
        });
        const buttons = element("div", "row");
        this.eye = element("select");
        this.eye.append(...eyes.map(([name], i) => new Option(name, i)));
        this.eye.addEventListener("change", () => this.chooseEye(Number(this.eye.value)));
        const label = element("label", "", "Eye ");
        label.append(this.eye);
        buttons.append(label, this.button("From above", "Show the eye from above", fromAbove), this.button("Replay", "Repeat all interactions from the start", () => (send("replay"), send("play"))));
        const box = element("div", "score");
        box.append(this.picture, list);
        parent.append(head, box, buttons);
    }

    button(text, title, action) {
        const made = element("button", "quiet", text);
        Object.assign(made, { type: "button", title });
        made.addEventListener("click", action);
        return made;
    }

    setScene({ circle, bodies }) {
        this.parent.hidden = !circle;
        this.circle = circle;
        this.body = bodies[0].name;
        this.eye.value = "0";
        this.path.setAttribute("d", "");
        this.marks.replaceChildren();
        for (const value of this.values) value.textContent = "–";
    }

    // from the start, since the first steps decide how the body stands under its pressure
    chooseEye(index) {
        this.send("reset");
        const lines = eyes[index][1];
        for (const line of lines ? lines(this.body) : []) this.send(line);
    }

    // place across the axis, in radii of the circle
    flat(point, { along, across, aim }) {
        const way = point.map((x, c) => x - this.circle.center[c]);
        const dot = (axis) => way.reduce((sum, x, c) => sum + x * axis[c], 0) / aim;
        return [dot(along), -dot(across)];
    }

    // measured: the last frame with a score; frame: the present one
    show(measured, frame) {
        const { score } = measured;
        if (!this.circle || !measured.tear) return;
        const force = Math.max(Math.hypot(...frame.hand.force), ...frame.tools.map((tool) => Math.hypot(...tool.force)));
        rows.forEach(([, , text], i) => (this.values[i].textContent = text(measured, force)));
        const count = score.radius.length;
        const at = (k, side) => {
            const angle = (2 * Math.PI * (k + side)) / count;
            const r = score.radius[k] / score.aim;
            return `${(r * Math.cos(angle)).toFixed(4)} ${(-r * Math.sin(angle)).toFixed(4)}`;
        };
        const parts = [];
        for (let k = 0; k < count; k++)
            if (score.radius[k] > 0) parts.push(`${score.radius[(k + count - 1) % count] > 0 && k > 0 ? "L" : "M"}${at(k, 0)}L${at(k, 1)}`);
        this.path.setAttribute("d", parts.join(""));
        const dots = measured.tear.tips.map(({ position }) => [...this.flat(position, score), "tip"]);
        if (frame.hand.kind !== "free") dots.push([...this.flat(frame.hand.point, score), "hand"]);
        this.marks.replaceChildren(...dots.map(([cx, cy, kind]) => svg("circle", { cx, cy, r: 0.05, class: kind })));
    }
}
