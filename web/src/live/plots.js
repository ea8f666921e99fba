// Plots of the measures of the last frames, with uPlot.
import uPlot from "uplot";
import "uplot/dist/uPlot.min.css";
import { formatNumber, formatTogether } from "../format.js";
import { element, palettes } from "../plots.js";

const WINDOW = 300;
// maximum number of tools in the plot of forces, which has a colour for each and one for the hand
const MOST_TOOLS = 5;
const keyOf = (tool) => `force of ${tool}`;
const forces = (tools) => ({
    title: tools.length > 0 ? "Force of hand and tools [N]" : "Force of the hand [N]",
    columns: [[tools.length > 0 ? "hand" : "force", "force"], ...tools.map((name) => [name, keyOf(name)])],
});
const groups = [
    forces([]),
    { title: "Volume and area [ratio]", columns: [["volume", "volume_ratio"], ["area", "area_ratio"]] },
    { title: "Energy [J]", columns: [["elastic", "elastic_energy"], ["kinetic", "kinetic_energy"]] },
    { title: "Energy balance [J]", columns: [["work of hand and tools", "work_hand"], ["dissipated", "dissipated"], ["error", "energy_error"]] },
    { title: "Step time [ms]", columns: [["step", "step_ms"]] },
];

// uPlot has no ticks for ranges below 1e-16: six digits, and nothing below 1e-12
const tidy = (value) => (Math.abs(value) < 1e-12 ? 0 : Number(value.toPrecision(6)));

class Chart {
    constructor(parent, group) {
        this.group = group;
        this.figure = element("figure");
        const head = element("figcaption");
        this.title = element("h3");
        this.legend = element("div", "keys");
        head.append(this.title, this.legend);
        this.place = element("div", "chart");
        this.figure.append(head, this.place);
        parent.append(this.figure);
    }

    build(theme, data) {
        this.plot?.destroy();
        this.title.textContent = this.group.title;
        const axis = { stroke: theme.ink, font: `11px ${theme.font}`, grid: { stroke: theme.grid, width: 1 }, ticks: { stroke: theme.grid, width: 1, size: 4 } };
        const colours = palettes[theme.name];
        this.legend.replaceChildren();
        this.values = this.group.columns.map(([label], i) => {
            const key = element("span", "key");
            const swatch = element("i");
            swatch.style.borderTop = `2px solid ${colours[i]}`;
            const value = element("b");
            key.append(swatch, ...(this.group.columns.length > 1 ? [element("span", "", label)] : []), value);
            this.legend.append(key);
            return value;
        });
        this.plot = new uPlot(
            {
                width: this.place.clientWidth || 320,
                height: 104,
                padding: [8, 18, 0, 0],
                legend: { show: false },
                cursor: { show: false },
                scales: { x: { time: false } },
                axes: [
                    { ...axis, size: 24, values: (_, ticks) => formatTogether(ticks).map((text, i) => text + (i === ticks.length - 1 ? " s" : "")) },
                    { ...axis, size: 58, values: (_, ticks) => formatTogether(ticks) },
                ],
                series: [{}, ...this.group.columns.map((_, i) => ({ stroke: colours[i], width: 1.6, points: { show: false } }))],
            },
            data,
            this.place,
        );
    }

    show(data) {
        this.plot.setData(data);
        this.values.forEach((value, i) => (value.textContent = formatNumber(data[i + 1].at(-1), 3)));
    }

    resize() {
        const width = this.place.clientWidth;
        if (width > 0 && this.plot && width !== this.plot.width) this.plot.setSize({ width, height: 104 });
    }
}

export class LivePlots {
    constructor(parent) {
        this.rows = [];
        this.tools = [];
        this.charts = groups.map((group) => new Chart(parent, group));
        new ResizeObserver(() => this.charts.forEach((chart) => chart.resize())).observe(parent);
    }

    table(group) {
        return [this.rows.map((row) => row.time), ...group.columns.map(([, name]) => this.rows.map((row) => row[name]))];
    }

    build(theme) {
        this.theme = theme;
        this.charts.forEach((chart) => chart.build(theme, this.table(chart.group)));
    }

    // names of the scene's tools
    setTools(names) {
        this.tools = names.slice(0, MOST_TOOLS);
        this.rows = [];
        this.charts[0].group = forces(this.tools);
        this.build(this.theme);
    }

    // adds a frame with measures; if its time is earlier than before, removes the later rows
    add(frame) {
        if (this.rows.length > 0 && frame.time < this.rows.at(-1).time) this.rows = this.rows.filter((row) => row.time < frame.time);
        if (this.rows.at(-1)?.time === frame.time) this.rows.pop();
        const row = { force: Math.hypot(...frame.hand.force), step_ms: frame.step_ms, ...frame.measures };
        for (const { name, force } of frame.tools) if (this.tools.includes(name)) row[keyOf(name)] = Math.hypot(...force);
        for (const name in row) row[name] = row[name] === null ? null : tidy(row[name]);
        this.rows.push({ time: frame.time, ...row });
        if (this.rows.length > WINDOW) this.rows.shift();
    }

    show() {
        if (this.rows.length > 0) this.charts.forEach((chart) => chart.show(this.table(chart.group)));
    }
}
