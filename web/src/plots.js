// Plots of series.csv with uPlot, with a line at the present time of the player.
import uPlot from "uplot";
import "uplot/dist/uPlot.min.css";
import { formatNumber, formatTogether, plainName, unitOf } from "./format.js";

// groups of columns: a column belongs to the first group that accepts it; the last group accepts all
const groups = [
    { title: "Volume and area", unit: "ratio", takes: (name) => /_ratio$/.test(name) },
    { title: "Energy", unit: "J", takes: (name) => /_energy$/.test(name) },
    { title: "Force", unit: "N", takes: (name) => name === "max_force" || /_force$/.test(name) },
    { title: "Displacement", unit: "m", takes: (name) => /displacement$/.test(name) },
    { title: "Contacts", unit: "", takes: (name) => /contacts$/.test(name) },
    // pairs that pass each stage of the search in a frame, from the broad phase to contacts
    {
        title: "Contact search",
        unit: "pairs",
        log: true,
        takes: (name) => /^contact_(candidates|passed_filter|passed_hull|cubics|pairs)$/.test(name),
    },
    { title: "Contact solving", unit: "", takes: (name) => /^contact_(dropped|rounds|fall_backs|tools_held|tangled)$/.test(name) },
    { title: "Contact time", unit: "ms per frame", takes: (name) => /^contact_\w+_ms$/.test(name) },
    { title: "Mesh", unit: "", takes: (name) => name === "vertices" || name === "triangles" },
    { title: "Step time", unit: "ms", takes: (name) => name === "step_ms" },
    { title: "More", unit: null, takes: () => true, choose: true },
];

export const palettes = {
    light: ["#0f6ab4", "#c2410c", "#0b7a53", "#8b3fa8", "#8a6d00", "#b3245f"],
    dark: ["#6cb4f0", "#fb923c", "#4ecb97", "#d19cf0", "#e3c34b", "#f587b0"],
};
const dashes = [[], [7, 4], [2, 3], [9, 3, 2, 3]];

// column names of all runs, each once
function allNames(runs) {
    return [...new Set(runs.flatMap((run) => run.table.names))].filter((name) => name !== "frame" && name !== "time");
}

const columnOf = (run, name) => run.table.columns[run.table.names.indexOf(name)];

// columns with the same value in all rows are not shown
const varies = (runs, name) =>
    runs.some((run) => {
        const column = columnOf(run, name);
        return column?.some((value) => value !== column[0]);
    });

function listGroups(runs) {
    const left = new Set(allNames(runs));
    const result = [];
    for (const group of groups) {
        const names = [...left].filter(group.takes);
        names.forEach((name) => left.delete(name));
        const telling = names.filter((name) => varies(runs, name));
        if (telling.length > 0) result.push({ ...group, names: telling });
    }
    return result;
}

// x, and one list per run and column, at common times
function tabulate(runs, names) {
    const tables = runs.map((run) => {
        const x = columnOf(run, run.timed ? "time" : "frame") ?? columnOf(run, "frame") ?? [];
        return [x, ...names.map((name) => columnOf(run, name) ?? Array(x.length).fill(null))];
    });
    return tables.length > 1 ? uPlot.join(tables) : tables[0];
}

export function element(tag, className, text) {
    const made = document.createElement(tag);
    if (className) made.className = className;
    if (text !== undefined) made.textContent = text;
    return made;
}

// scale for counts from 0 to millions: asinh behaves like a logarithm but includes 0
const logarithmic = {
    scale: { distr: 4, asinh: 1, range: (_, low, high) => [Math.min(low, 0), 1.2 * Math.max(high, 1)] },
    splits: (_, axis, low, high) => {
        const powers = Math.floor(Math.log10(Math.max(high, 1)));
        const step = Math.ceil((powers + 1) / 4);
        return [0, ...Array.from({ length: Math.floor(powers / step) + 1 }, (_, i) => 10 ** (i * step))];
    },
};

class Chart {
    constructor(parent, runs, group, seek) {
        this.runs = runs;
        this.group = group;
        this.seek = seek;
        this.names = group.choose ? group.names.slice(0, 1) : group.names;
        this.unit = runs.every((run) => run.timed) ? " s" : "";
        this.figure = element("figure");
        const head = element("figcaption");
        this.legend = element("div", "keys");
        if (group.choose) head.append(this.makeChooser());
        else head.append(element("h3", "", group.unit ? `${group.title} [${group.unit}]` : group.title));
        head.append(this.legend);
        this.place = element("div", "chart");
        this.figure.append(head, this.place);
        parent.append(this.figure);
    }

    makeChooser() {
        const label = element("label", "", "More ");
        const select = element("select");
        for (const name of this.group.names) {
            const unit = unitOf(name);
            select.append(new Option(unit ? `${plainName(name)} [${unit}]` : plainName(name), name));
        }
        select.addEventListener("change", () => {
            this.names = [select.value];
            this.build(this.theme, this.time);
        });
        label.append(select);
        return label;
    }

    build(theme, time) {
        this.theme = theme;
        this.time = time;
        this.plot?.destroy();
        this.data = tabulate(this.runs, this.names);
        this.makeLegend();
        const axis = {
            stroke: theme.ink,
            font: `11px ${theme.font}`,
            grid: { stroke: theme.grid, width: 1 },
            ticks: { stroke: theme.grid, width: 1, size: 4 },
        };
        const options = {
            width: this.place.clientWidth || 320,
            height: 132,
            padding: [8, 18, 0, 0],
            legend: { show: false },
            cursor: { sync: { key: "pellicle" }, drag: { x: false, y: false }, points: { size: 6 } },
            scales: { x: { time: false }, y: this.group.log ? logarithmic.scale : {} },
            axes: [
                { ...axis, size: 26, values: (_, ticks) => formatTogether(ticks).map((text, i) => text + (i === ticks.length - 1 ? this.unit : "")) },
                { ...axis, size: 58, values: (_, ticks) => (this.group.log ? ticks.map((tick) => (tick == null ? "" : formatNumber(tick, 1))) : formatTogether(ticks)), ...(this.group.log ? { splits: logarithmic.splits } : {}) },
            ],
            series: [{}, ...this.styles.map((style) => ({ stroke: style.colour, dash: style.dash, width: 1.6, points: { show: false }, spanGaps: true }))],
            hooks: {
                setCursor: [(u) => this.showValues(u.cursor.idx ?? null)],
                setSize: [() => this.follow(this.time)],
            },
        };
        this.plot = new uPlot(options, this.data, this.place);
        this.line = element("div", "now");
        this.plot.over.append(this.line);
        this.listen(this.plot.over);
        this.follow(time);
        this.showValues(null);
    }

    makeLegend() {
        const colours = palettes[this.theme.name];
        this.legend.replaceChildren();
        this.styles = [];
        const several = this.runs.length > 1;
        this.runs.forEach((run, r) =>
            this.names.forEach((name, n) => {
                const style = { colour: colours[(several ? r : n) % colours.length], dash: dashes[(several ? n : 0) % dashes.length] };
                const key = element("span", "key");
                const swatch = element("i");
                swatch.style.borderTop = `2px ${style.dash.length ? "dashed" : "solid"} ${style.colour}`;
                const parts = [several ? run.name : "", this.group.choose ? "" : plainName(name.replace(/^contact_/, ""))].filter(Boolean);
                style.value = element("b");
                key.append(swatch, ...(parts.length ? [element("span", "", parts.join(": "))] : []), style.value);
                this.legend.append(key);
                this.styles.push(style);
            }),
        );
    }

    // a click or a drag sets the time
    listen(over) {
        const go = (event) => this.seek(this.plot.posToVal(event.clientX - over.getBoundingClientRect().left, "x"));
        over.addEventListener("pointerdown", (event) => {
            if (event.button !== 0) return;
            over.setPointerCapture(event.pointerId);
            go(event);
        });
        over.addEventListener("pointermove", (event) => {
            if (over.hasPointerCapture(event.pointerId)) go(event);
        });
    }

    // shows the values at the pointer or, without one, at the present time
    showValues(index) {
        this.hovered = index;
        const row = index ?? nearestRow(this.data[0], this.time);
        this.styles.forEach((style, i) => {
            const value = this.data[i + 1][row];
            style.value.textContent = value == null ? "–" : formatNumber(value, 4);
        });
    }

    follow(time) {
        this.time = time;
        if (this.plot) this.line.style.transform = `translateX(${this.plot.valToPos(time, "x")}px)`;
    }

    resize() {
        const width = this.place.clientWidth;
        if (width > 0 && this.plot && width !== this.plot.width) this.plot.setSize({ width, height: 132 });
    }
}

function nearestRow(times, time) {
    let low = 0;
    let high = times.length - 1;
    while (low < high) {
        const middle = (low + high) >> 1;
        if (times[middle] < time) low = middle + 1;
        else high = middle;
    }
    return low > 0 && time - times[low - 1] < times[low] - time ? low - 1 : low;
}

export class Plots {
    constructor(parent, runs, seek) {
        const withRows = runs.filter((run) => run.table.columns[0]?.length > 1);
        this.charts = withRows.length === 0 ? [] : listGroups(withRows).map((group) => new Chart(parent, withRows, group, seek));
        if (this.charts.length === 0) parent.append(element("p", "empty", "There are no plots: the run has no series.csv with at least two rows."));
        new ResizeObserver(() => this.charts.forEach((chart) => chart.resize())).observe(parent);
    }

    build(theme, time) {
        this.charts.forEach((chart) => chart.build(theme, time));
    }

    follow(time) {
        this.charts.forEach((chart) => chart.follow(time));
    }

    // updates the numbers in the legends, except in plots under the pointer
    showValues() {
        this.charts.forEach((chart) => chart.hovered == null && chart.showValues(null));
    }
}
