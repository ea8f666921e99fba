// Lines of a scene for the tool, pin or region at a place of a body at rest.

const text = (values) => `[${values.map((value) => Number(value.toPrecision(5))).join(", ")}]`;
const short = (value) => Number(value.toPrecision(3));

// mode: of the hand; place: { body, point, normal } at rest [m]; sizes [m]: { shape, radius, depth, brush, reach }
export function linesOf(mode, { body, point, normal }, { shape, radius, depth, brush, reach, size }) {
    const name = JSON.stringify(body);
    if (mode === "press") {
        const above = `{ ray: { origin: ${text(point.map((x, c) => x + 0.01 * size * normal[c]))}, direction: ${text(normal.map((x) => -x))} } }`;
        const solid = { capsule: `shape: capsule\n    radius: ${short(radius)}\n    length: ${short(2 * radius)}`, box: `shape: box\n    size: ${text([2 * radius, 2 * radius, 2 * radius].map(short))}` };
        return `tools:
  - name: tool1
    ${solid[shape] ?? `shape: sphere\n    radius: ${short(radius)}`}
    motion:
      - { time: 0, position: { above: ${above}, by: ${short(0.3 * radius)} } }
      - { time: 1, position: { above: ${above}, by: ${-short(depth)} } }
`;
    }
    if (mode === "pin" || mode === "unpin") return `# of the body ${name}\npinned: { sphere: { center: ${text(point)}, radius: ${short(brush)} } }\n`;
    if (mode === "pull")
        return `loads:
  - { name: pull, body: ${name}, force: ${text(normal)}, at: { nearest: ${text(point)}, falloff: ${short(reach)} } }
`;
    return `# a region of the body ${name}\n{ nearest: ${text(point)} }\n`;
}
