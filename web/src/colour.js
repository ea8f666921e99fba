// Perceptual colour maps, given by anchors at equal distances (viridis and cividis: CC0; cool-warm: Moreland 2009).
const anchors = {
    viridis: "440154 482878 3e4989 31688e 26828e 1f9e89 35b779 6ece58 b5de2b fde725",
    cividis: "00204d 00336f 39486b 575c6d 707173 8a8779 a69d75 c4b56c e4cf5b ffea46",
    "cool-warm": "3b4cc0 6788ee 9abbff c9d7f0 edd1c2 f7a889 e26952 b40426",
};

export const mapNames = Object.keys(anchors);
export const isDiverging = (name) => name === "cool-warm";

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
