// Colour maps and the rule that chooses map and range: those of `pellicle render` (view/color_map.c, view/render.c).
// tests/view/test_color_map.c compares the anchors, at equal distances, with the formulas there.
const anchors = {
    viridis: "440154 482878 3e4989 31688e 26828e 1f9e89 35b779 6ece58 b5de2b fde725",
    cividis: "00204d 00336f 39486b 575c6d 707173 8a8779 a69d75 c4b56c e4cf5b ffea46",
    "cool-warm": "3b4cc0 6788ee 9abbff c9d7f0 edd1c2 f7a889 e26952 b40426",
};

export const mapNames = Object.keys(anchors);

const isFromZero = (low, high) => low === 0 || (low > 0 && low < 0.1 * high);

function chooseMap(low, high) {
    if (low < 0 && high > 0 && -low > 0.05 * high && high > -0.05 * low) return "cool-warm";
    return isFromZero(low, high) ? "warm" : "viridis";
}

// map and range of a field with values from low to high: grey is zero. chosen: name of a map, or "" for automatic
export function fitColours(low, high, chosen) {
    const map = chosen || chooseMap(low, high);
    if (map === "cool-warm" && low < 0 && high > 0) {
        high = Math.max(-low, high);
        low = -high;
    } else if (isFromZero(low, high)) {
        low = 0;
    }
    const size = Math.max(Math.abs(low), Math.abs(high));
    if (size === 0) return { map, low, high: 1 };
    const margin = high - low < 1e-9 * size ? 0.05 * size : 0;
    return { map, low: low - margin, high: high + margin };
}

const hexes = (name) => anchors[name].split(" ");

// 256 colours as RGBA bytes
export function mapBytes(name) {
    const colours = hexes(name).map((hex) => [0, 2, 4].map((at) => parseInt(hex.slice(at, at + 2), 16)));
    const bytes = new Uint8Array(256 * 4);
    for (let i = 0; i < 256; i++) {
        const place = (i / 255) * (colours.length - 1);
        const a = Math.min(Math.floor(place), colours.length - 2);
        for (let c = 0; c < 3; c++)
            bytes[4 * i + c] = Math.round(colours[a][c] + (place - a) * (colours[a + 1][c] - colours[a][c]));
        bytes[4 * i + 3] = 255;
    }
    return bytes;
}

export const mapGradient = (name) =>
    `linear-gradient(to right, ${hexes(name)
        .map((hex) => `#${hex}`)
        .join(", ")})`;
