// Colour maps, and the choice of map and range as in `pellicle render` (view/color_map.c, view/render.c).
// tests/view/test_color_map.c compares the equidistant anchors with the formulas there.
const anchors = {
    viridis: "470155 48186a 472d7b 434086 3d528c 34638e 2b728e 23818d 1f908b 219f87 2aae80 3dbc74 5ac861 80d349 acdc30 d8e21d fce721",
    cividis: "002051 012b65 11366c 26426e 3c4d6e 51586e 62646f 727071 7f7c75 8c8877 9a9478 a9a177 bbaf71 cebd68 e2cb5c f3da4f fdea45",
    "cool-warm": "3b4cc0 445acc 4d68d7 5775e1 6282ea 6c8ef1 779af7 82a5fb 8db0fe 98b9ff a3c2ff aec9fd b8d0f9 c2d5f4 ccd9ee d5dbe6 dddddd e5d8d1 ecd3c5 f1ccb9 f5c4ad f7bba0 f7b194 f7a687 f49a7b f18d6f ec7f63 e57058 de604d d55042 cb3e38 c0282f b40426",
};
// the upper half of cool-warm
anchors.warm = anchors["cool-warm"].slice(anchors["cool-warm"].length / 2 - 3);

export const mapNames = Object.keys(anchors);

const isFromZero = (low, high) => low === 0 || (low > 0 && low < 0.1 * high);

function chooseMap(low, high) {
    if (low < 0 && high > 0 && -low > 0.05 * high && high > -0.05 * low) return "cool-warm";
    return isFromZero(low, high) ? "warm" : "viridis";
}

// map and range for values from low to high; in cool-warm and warm, grey is zero. chosen: name of a map, or "" for automatic
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
