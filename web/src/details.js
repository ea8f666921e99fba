// What stands around the picture: facts of the runs, what was thinned, the scene, versions and the state's hash.
import { formatNumber, plainName, unitOf, withUnit } from "./format.js";

function element(tag, className, text) {
    const made = document.createElement(tag);
    if (className) made.className = className;
    if (text !== undefined) made.textContent = text;
    return made;
}

const count = (number, one, several) => `${number.toLocaleString("en")} ${number === 1 ? one : several}`;

// the least and the largest of some numbers
function countRange(numbers, one, several) {
    const [least, most] = [Math.min(...numbers), Math.max(...numbers)];
    return (least < most ? `${least.toLocaleString("en")} to ` : "") + count(most, one, several);
}

export function thinned(run) {
    const notes = [...run.notes];
    if (run.series_thinned) notes.push("the plots show some of the rows of series.csv");
    if (run.scene_thinned) notes.push("the scene is cut");
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

// the members of summary.json that are a number or a text
function factRows(run) {
    const rows = [
        ["folder", run.name],
        ["report by", run.program],
        ["state hash", run.facts.state_hash ?? run.stateHash],
    ];
    for (const [key, value] of Object.entries(run.facts)) {
        if (key === "state_hash" || value === null || typeof value === "object" || value === "") continue;
        const text = typeof value === "number" ? withUnit(formatNumber(value, 6), unitOf(key)) : String(value);
        rows.push([key === "version" ? "run by" : plainName(key.replace(/_s$/, "")), key === "version" ? `pellicle ${value}` : text]);
    }
    return rows.filter(([, text]) => text);
}

export function showDetails(parent, runs) {
    for (const run of runs) {
        const fold = element("details");
        fold.append(element("summary", "", runs.length > 1 ? `${run.name}: scene, versions and results` : "Scene, versions and results"));
        const list = element("dl");
        for (const [name, text] of factRows(run)) list.append(element("dt", "", name), element("dd", "", text));
        const body = element("div", "fold");
        body.append(list);
        if (run.scene) body.append(element("pre", "", run.scene));
        fold.append(body);
        parent.append(fold);
    }
}
