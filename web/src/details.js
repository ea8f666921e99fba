// Facts about the runs: sizes, notes on thinning, the scene, versions and the hash of the state.
import { formatNumber, plainName, unitOf, withUnit } from "./format.js";

function element(tag, className, text) {
    const made = document.createElement(tag);
    if (className) made.className = className;
    if (text !== undefined) made.textContent = text;
    return made;
}

const count = (number, one, several) => `${number.toLocaleString("en")} ${number === 1 ? one : several}`;

// "count" or "minimum to maximum" of some numbers
function countRange(numbers, one, several) {
    const [least, most] = [Math.min(...numbers), Math.max(...numbers)];
    return (least < most ? `${least.toLocaleString("en")} to ` : "") + count(most, one, several);
}

export function thinned(run) {
    const notes = [...run.notes];
    if (run.series_thinned) notes.push("the plots show only some rows of series.csv");
    if (run.scene_thinned) notes.push("the end of the scene is omitted");
    return notes;
}

export function showFacts(parent, runs) {
    parent.replaceChildren(
        ...runs.map((run) => {
            const line = element("span", "facts");
            const parts = [
                countRange(run.topologies.map((sizes) => sizes[0]), "vertex", "vertices"),
                countRange(run.topologies.map((sizes) => sizes[1]), "triangle", "triangles"),
                count(run.frame_total, "frame", "frames"),
            ];
            if (run.timed) parts.push(`${formatNumber(run.frames.at(-1).time)} s`);
            if (run.facts.status && run.facts.status !== "done") parts.push(run.facts.status);
            line.append((runs.length > 1 ? `${run.name}: ` : "") + parts.join(" · "));
            const notes = thinned(run);
            if (notes.length > 0) line.append(element("em", "thinned", `Thinned to fit: ${notes.join("; ")}.`));
            return line;
        }),
    );
}

// the numbers and texts of summary.json
function factRows(run) {
    const rows = [
        ["folder", run.name],
        ["report written by", run.program],
        ["state hash", run.facts.state_hash ?? run.stateHash],
    ];
    for (const [key, value] of Object.entries(run.facts)) {
        if (key === "state_hash" || value === null || typeof value === "object" || value === "") continue;
        const text = typeof value === "number" ? withUnit(formatNumber(value, 6), unitOf(key)) : String(value);
        rows.push([key === "version" ? "simulated by" : plainName(key.replace(/_s$/, "")), key === "version" ? `pellicle ${value}` : text]);
    }
    return rows.filter(([, text]) => text);
}

/* ---- contact ---- */

function makeTable(title, heads, rows) {
    const table = element("table", "numbers");
    const line = (cells) => {
        const tr = element("tr");
        cells.forEach((cell, i) => {
            const made = element(i === 0 || cells === heads ? "th" : "td", "", cell);
            if (made.tagName === "TH") made.scope = cells === heads ? "col" : "row";
            tr.append(made);
        });
        return tr;
    };
    table.append(element("caption", "", title), line(heads), ...rows.map(line));
    return table;
}

const share = (part, whole) => (whole > 0 ? `${formatNumber((100 * part) / whole)} %` : "–");
const whole = (number) => (Number.isFinite(number) ? number.toLocaleString("en") : "–");

// tables of contact: pairs after each stage of the search, times, events; none without contact
function contactTables(run) {
    const contact = run.facts.contact;
    if (!contact) return [];
    const stages = [
        ["candidates", contact.candidates],
        ["passed the filter", contact.passed_filter],
        ["passed the hull test", contact.passed_hull],
        ["cubics solved", contact.cubics],
        ["contacts", contact.pairs],
    ];
    const steps = Math.max(run.facts.steps ?? 0, 1);
    const times = [
        ["find", contact.find_s],
        ["solve", contact.solve_s],
        ["guard", contact.guard_s],
    ];
    const others = [
        ["rounds", contact.rounds],
        ["fall-backs (vertices stepped back)", contact.fall_backs],
        ["contacts dropped", contact.dropped],
        ["tools held back", contact.tools_held],
        ["pairs tangled at the end", contact.tangled],
    ];
    return [
        makeTable("Contact: pairs of the whole run", ["stage", "pairs", "share of the candidates"], stages.map(([name, n]) => [name, whole(n), share(n, contact.candidates)])),
        makeTable("Contact: time", ["part", "ms per step", "total [s]"], times.map(([name, s]) => [name, formatNumber((1000 * s) / steps), formatNumber(s)])),
        makeTable("Contact: events", ["event", "count"], others.map(([name, n]) => [name, whole(n)])),
    ];
}

export function showDetails(parent, runs) {
    for (const run of runs) {
        const fold = element("details");
        fold.append(element("summary", "", runs.length > 1 ? `${run.name}: scene, versions and results` : "Scene, versions and results"));
        const list = element("dl");
        for (const [name, text] of factRows(run)) list.append(element("dt", "", name), element("dd", "", text));
        const body = element("div", "fold");
        const left = element("div");
        left.append(list, ...contactTables(run));
        body.append(left);
        if (run.scene) body.append(element("pre", "", run.scene));
        fold.append(body);
        parent.append(fold);
    }
}
