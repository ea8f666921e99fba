// Sliders for the parameters of the simulation, from the table that the program sends.
import { formatNumber, plainName } from "../format.js";
import { element } from "../plots.js";

const SLIDER_STEPS = 400;

// scale of a slider: linear between bounds; without bounds, logarithmic around the first value
function scaleOf({ kind, least, most }, first) {
    if (least !== null && most !== null && (kind !== "integer" || most - least <= 1000))
        return { to: (x) => least + x * (most - least), from: (v) => (v - least) / (most - least) };
    if (first > 0) {
        const low = Math.max(first / 100, least ?? 0);
        const ratio = (first * 100) / low;
        return { to: (x) => low * ratio ** x, from: (v) => Math.log(Math.max(v, low) / low) / Math.log(ratio) };
    }
    const low = least !== null && least >= 0 ? least : -10;
    return { to: (x) => low + x * (10 - low), from: (v) => (v - low) / (10 - low) };
}

const plain = (value) => (value === null ? "" : String(Number(value.toPrecision(6))));

class Row {
    constructor(info, set, begin) {
        this.info = info;
        this.set = set;
        this.begin = begin;
        const name = info.path.split(".").at(-1);
        const unit = info.unit ? ` [${info.unit}]` : "";
        this.root = element("div", "parameter");
        this.root.title = info.live ? info.path : `${info.path}: ${info.refusal}. ${info.remedy}`;
        const label = element("label", "", plainName(name) + unit);
        label.htmlFor = `p-${info.path}`;
        this.root.append(label);
        this.error = element("p", "refused");
        this.error.hidden = true;
        this.build();
        this.root.append(this.error);
        this.show(info);
    }

    build() {
        const { kind, live, path } = this.info;
        this.root.classList.add(kind);
        if (!live) return this.add(element("output"));
        if (kind === "switch") return this.add(this.makeSwitch());
        if (kind === "word") return this.add(this.makeChoice());
        if (kind === "vector") {
            this.numbers = ["x", "y", "z"].map((axis, i) => {
                const input = this.add(this.makeNumber(`${path} ${axis}`));
                if (i > 0) input.id += axis;
                return input;
            });
            return null;
        }
        this.scale = scaleOf(this.info, this.info.value[0] ?? this.info.preset[0]);
        this.slider = this.add(this.makeSlider());
        return this.add(this.makeNumber(path));
    }

    add(control) {
        control.id = this.slider || this.numbers ? `p-${this.info.path}-${this.root.children.length}` : `p-${this.info.path}`;
        this.root.append(control);
        this.control = control;
        return control;
    }

    makeSwitch() {
        const input = element("input");
        input.type = "checkbox";
        input.addEventListener("change", () => this.change(input.checked ? "true" : "false"));
        return input;
    }

    makeChoice() {
        const select = element("select");
        select.append(...this.info.words.map((word) => new Option(word, word)));
        select.addEventListener("change", () => this.change(select.value));
        return select;
    }

    makeSlider() {
        const input = element("input");
        input.type = "range";
        input.min = 0;
        input.max = SLIDER_STEPS;
        input.step = 1;
        let held = false;
        input.addEventListener("input", () => {
            if (!held) this.begin();
            held = true;
            this.change(plain(this.round(this.scale.to(input.valueAsNumber / SLIDER_STEPS))), true);
        });
        input.addEventListener("change", () => (held = false));
        return input;
    }

    makeNumber(label) {
        const input = element("input");
        input.type = "text";
        input.inputMode = "decimal";
        input.setAttribute("aria-label", label);
        input.placeholder = this.info.auto ? "auto" : "";
        input.addEventListener("change", () => {
            const texts = this.numbers?.map((number) => number.value.trim());
            this.change(texts ? `[${texts.join(", ")}]` : input.value.trim() || "auto");
            // without focus, the field shows the value that the program sends back
            input.blur();
        });
        return input;
    }

    round(value) {
        return this.info.kind === "integer" ? Math.round(value) : Number(value.toPrecision(3));
    }

    change(text, goesOn = false) {
        if (!goesOn) this.begin();
        this.error.hidden = true;
        this.set(this.info.path, text);
    }

    refuse(text) {
        this.error.textContent = text;
        this.error.hidden = false;
        this.error.scrollIntoView({ block: "nearest" });
    }

    // shows the value that the program sent
    show(info) {
        this.info = info;
        const value = info.value[0];
        const note = info.keyed ? " (follows keys)" : info.field ? " (varies over the body)" : "";
        if (!info.live) this.control.textContent = this.textOf(info) + note;
        else if (info.kind === "switch") this.control.checked = value === 1;
        else if (info.kind === "word") this.control.value = info.words[value] ?? "";
        else if (this.numbers) this.numbers.forEach((input, i) => this.put(input, plain(info.value[i])));
        else {
            if (document.activeElement !== this.slider) this.slider.value = Math.round(SLIDER_STEPS * this.scale.from(value ?? info.preset[0] ?? 0));
            this.slider.setAttribute("aria-valuetext", value === null ? "auto" : `${formatNumber(value, 4)} ${info.unit}`);
            this.slider.setAttribute("aria-label", info.path);
            this.put(this.control, plain(value));
        }
        if (note) this.root.title = info.path + note;
    }

    put(input, text) {
        if (document.activeElement !== input) input.value = text;
    }

    textOf({ kind, value, words, unit }) {
        if (kind === "switch") return value[0] === 1 ? "yes" : "no";
        if (kind === "word") return words[value[0]] ?? "";
        return value[0] === null ? "auto" : value.map((number) => formatNumber(number, 4)).join(", ") + (unit ? ` ${unit}` : "");
    }
}

// bodies.ball.membrane.young -> ball, membrane
function groupOf(path) {
    const parts = path.split(".").slice(0, -1);
    if (parts.length === 0) return "world";
    return (["bodies", "tools", "loads"].includes(parts[0]) ? parts.slice(1) : parts).map((part) => plainName(part)).join(", ");
}

// the tools of the hand have no sliders
const isShown = ({ path }) => !/^tools\.(drag|hand)(-\d+)?\./.test(path);

export class Parameters {
    // send(line)
    constructor(parent, send) {
        this.parent = parent;
        this.send = send;
        this.rows = new Map();
        this.shape = "";
    }

    show({ list, inflate }, pressureScale) {
        const shown = list.filter(isShown);
        const shape = shown.map(({ path, live, kind }) => `${path} ${live} ${kind}`).join("\n") + Object.keys(inflate);
        const all = [...this.inflateRows(inflate, pressureScale), ...shown];
        if (shape !== this.shape) this.build(all);
        this.shape = shape;
        for (const info of all) this.rows.get(info.path).show(info);
    }

    // the additional pressure of each body (command `inflate`), which is not in the table
    inflateRows(inflate, scale) {
        return Object.entries(inflate).map(([body, value]) => ({
            path: `inflate.${body}`, kind: "number", unit: "Pa", least: -scale, most: scale, auto: false, live: true, keyed: false, field: false, preset: [0], value: [value],
        }));
    }

    build(list) {
        const open = new Set([...this.parent.querySelectorAll("details[open]")].map((part) => part.dataset.group));
        const groups = new Map();
        this.rows.clear();
        for (const info of list) {
            const group = groupOf(info.path);
            if (!groups.has(group)) groups.set(group, []);
            const row = new Row(info, (path, text) => this.change(path, text), () => this.send("mark"));
            this.rows.set(info.path, row);
            groups.get(group).push(row);
        }
        let first = this.rows.size > 0 && open.size === 0 ? 3 : 0;
        this.parent.replaceChildren(
            ...[...groups].map(([name, rows]) => {
                const part = element("details");
                part.dataset.group = name;
                part.open = open.has(name) || first-- > 0;
                part.append(element("summary", "", name), ...rows.map((row) => row.root));
                return part;
            }),
        );
    }

    change(path, text) {
        this.last = path;
        if (path.startsWith("inflate.")) this.send(`inflate ${path.slice(8)} ${text}`);
        else this.send(`set ${path} ${text}`);
    }

    // shows the error of a refused value beside its slider
    refuse(text) {
        const row = this.rows.get(this.last);
        if (!row) return false;
        row.refuse(text);
        return true;
    }
}
