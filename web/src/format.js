// Formats numbers and units for display.
const superscripts = "⁰¹²³⁴⁵⁶⁷⁸⁹";

function superscript(number) {
    const digits = [...String(Math.abs(number))].map((digit) => superscripts[digit]).join("");
    return (number < 0 ? "⁻" : "") + digits;
}

// at least `digits` significant digits, with a power of ten if the number is very small or large
export function formatNumber(value, digits = 3) {
    if (!Number.isFinite(value)) return "–";
    if (value === 0) return "0";
    const exponent = Math.floor(Math.log10(Math.abs(value)));
    if (exponent >= -3 && exponent < 6) {
        const text = value.toPrecision(Math.max(digits, exponent + 1));
        const plain = text.includes(".") ? text.replace(/\.?0+$/, "") : text;
        return plain.replace("-", "−");
    }
    const [mantissa, power] = value.toExponential(digits - 1).split("e");
    const short = mantissa.includes(".") ? mantissa.replace(/\.?0+$/, "") : mantissa;
    return `${short.replace("-", "−")}·10${superscript(Number(power))}`;
}

// of a force [N], in mN below 1 N
export const formatForce = (newton, digits = 3) => (newton < 1 ? `${formatNumber(1e3 * newton, digits)} mN` : `${formatNumber(newton, digits)} N`);

// numbers with a common power of ten, with enough digits to distinguish them or `digits` digits of the largest
export function formatTogether(values, digits = 0) {
    const largest = Math.max(...values.map(Math.abs));
    if (!(largest > 0) || !Number.isFinite(largest)) return values.map((value) => formatNumber(value));
    const exponent = Math.floor(Math.log10(largest) + 1e-9);
    const power = exponent >= -3 && exponent < 6 ? 0 : exponent;
    const ordered = values.map((value) => value / 10 ** power).sort((a, b) => a - b);
    const steps = ordered.slice(1).map((value, i) => value - ordered[i]).filter((step) => step > 1e-9 * largest / 10 ** power);
    const step = digits > 0 || steps.length === 0 ? 10 ** (exponent - power - Math.max(digits, 3) + 1) : Math.min(...steps);
    let decimals = Math.min(12, Math.max(0, Math.ceil(-Math.log10(step) - 1e-9)));
    // steps such as 2.5 need one more digit
    const scaled = step * 10 ** decimals;
    if (decimals < 12 && Math.abs(scaled - Math.round(scaled)) > 1e-6) decimals++;
    return values.map((value) => {
        const text = String(Number((value / 10 ** power).toFixed(decimals))).replace("-", "−");
        return power === 0 || text === "0" ? text : `${text}·10${superscript(power)}`;
    });
}

// such as (1, 2, 3)·10⁻⁶
export function formatVector(values) {
    const texts = formatTogether(values, 3);
    const power = /·10.*$/.exec(texts.find((text) => text.includes("·")) ?? "")?.[0] ?? "";
    return `(${texts.map((text) => text.replace(/·10.*$/, "")).join(", ")})${power}`;
}

// unit of a field or column, by its name; empty if it has none or an unknown one
const units = [
    [/(_ratio|level|body|contact|contacts|vertices|triangles|count|frame|quality)$/, ""],
    [/^(work_(tools|loads|pressure|gravity|material)|dissipated_(drag|solver)|energy_error)$/, "J"],
    [/energy$/, "J"],
    [/force(_max|_x|_y|_z)?$/, "N"],
    [/(displacement|thickness|distance|radius)$/, "m"],
    [/velocity|speed/, "m/s"],
    [/(pressure|stress|young|modulus)$/, "Pa"],
    [/gaussian_curvature$/, "1/m²"],
    [/curvature$/, "1/m"],
    [/area$/, "m²"],
    [/volume$/, "m³"],
    [/_ms$/, "ms"],
    [/^time$|_s$/, "s"],
    [/_[xyz]$/, "m"],
];

export const unitOf = (name) => units.find(([pattern]) => pattern.test(name))?.[1] ?? "";

// unit of a field of a run: from the table of the library if the field is in it, otherwise by name
export const unitOfField = (field) => field.unit?.replace(/m2$/, "m²") ?? unitOf(field.name);

export const withUnit = (text, unit) => (unit ? `${text} ${unit}` : text);

// step_ms -> step, kinetic_energy -> kinetic energy
export const plainName = (name) => name.replace(/_ms$/, "").replaceAll("_", " ");
