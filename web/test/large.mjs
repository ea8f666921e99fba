// A run folder of a wobbling ball, as large as wanted; every vertex moves in every frame.
import { mkdirSync, writeFileSync } from "node:fs";
import { join } from "node:path";

// grid on a sphere: rings x columns vertices and two poles
function ball(rings, columns) {
    const vertices = [[0, 0, 1]];
    const triangles = [];
    for (let r = 1; r <= rings; r++)
        for (let c = 0; c < columns; c++) {
            const [a, b] = [(Math.PI * r) / (rings + 1), (2 * Math.PI * c) / columns];
            vertices.push([Math.sin(a) * Math.cos(b), Math.sin(a) * Math.sin(b), Math.cos(a)]);
        }
    vertices.push([0, 0, -1]);
    const at = (r, c) => 1 + r * columns + (c % columns);
    for (let c = 0; c < columns; c++) {
        triangles.push([0, at(0, c), at(0, c + 1)]);
        for (let r = 0; r + 1 < rings; r++)
            triangles.push([at(r, c), at(r + 1, c), at(r + 1, c + 1)], [at(r, c), at(r + 1, c + 1), at(r, c + 1)]);
        triangles.push([at(rings - 1, c), vertices.length - 1, at(rings - 1, c + 1)]);
    }
    return { vertices, triangles };
}

function writeFrame(path, time, arrays, vertexCount, triangleCount) {
    const parts = [];
    let offset = 0;
    const describe = ({ name, type, components, data }) => {
        const line = `<DataArray type="${type}" Name="${name}" NumberOfComponents="${components}" format="appended" offset="${offset}"/>`;
        const size = Buffer.alloc(8);
        size.writeBigUInt64LE(BigInt(data.byteLength));
        parts.push(size, Buffer.from(data.buffer, data.byteOffset, data.byteLength));
        offset += 8 + data.byteLength;
        return line;
    };
    const head = `<?xml version="1.0"?>
<VTKFile type="PolyData" version="1.0" byte_order="LittleEndian" header_type="UInt64"><PolyData>
<FieldData>${describe({ name: "TimeValue", type: "Float64", components: 1, data: new Float64Array([time]) })}</FieldData>
<Piece NumberOfPoints="${vertexCount}" NumberOfVerts="0" NumberOfLines="0" NumberOfStrips="0" NumberOfPolys="${triangleCount}">
<PointData>${arrays.fields.map(describe).join("\n")}</PointData>
<Points>${describe(arrays.points)}</Points><Polys>${arrays.polys.map(describe).join("\n")}</Polys>
</Piece></PolyData><AppendedData encoding="raw">_`;
    writeFileSync(path, Buffer.concat([Buffer.from(head), ...parts, Buffer.from("</AppendedData></VTKFile>\n")]));
}

function wobble(vertices, time) {
    const points = new Float32Array(3 * vertices.length);
    const displacement = new Float32Array(3 * vertices.length);
    const force = new Float32Array(3 * vertices.length);
    const energy = new Float32Array(vertices.length);
    vertices.forEach((p, v) => {
        const wave = 0.08 * Math.sin(5 * p[0] + 3 * time) + 0.05 * Math.cos(7 * p[1] - 2 * time) * Math.sin(4 * p[2]);
        for (let c = 0; c < 3; c++) {
            displacement[3 * v + c] = wave * p[c];
            points[3 * v + c] = p[c] + displacement[3 * v + c];
            force[3 * v + c] = -wave * p[c] + 0.01 * Math.sin(40 * p[(c + 1) % 3] + time);
        }
        energy[v] = wave * wave;
    });
    return { points, displacement, force, energy };
}

export function writeRun(folder, { rings = 100, columns = 101, frames = 200, step = 0.05 } = {}) {
    const { vertices, triangles } = ball(rings, columns);
    const corners = Int32Array.from(triangles.flat());
    const ends = Int32Array.from(triangles, (_, t) => 3 * t + 3);
    mkdirSync(join(folder, "frames"), { recursive: true });
    const rows = ["frame,time,volume_ratio,elastic_energy,max_force,contacts,step_ms"];
    const sets = [];
    for (let f = 0; f < frames; f++) {
        const { points, displacement, force, energy } = wobble(vertices, f * step);
        const name = `frames/f${String(f).padStart(5, "0")}.vtp`;
        const arrays = {
            fields: [
                { name: "displacement", type: "Float32", components: 3, data: displacement },
                { name: "force", type: "Float32", components: 3, data: force },
                { name: "energy", type: "Float32", components: 1, data: energy },
            ],
            points: { name: "Points", type: "Float32", components: 3, data: points },
            polys: [
                { name: "connectivity", type: "Int32", components: 1, data: corners },
                { name: "offsets", type: "Int32", components: 1, data: ends },
            ],
        };
        writeFrame(join(folder, name), f * step, arrays, vertices.length, triangles.length);
        rows.push(`${f},${f * step},${1 + 0.05 * Math.sin(f / 9)},${f / frames},${Math.abs(Math.cos(f / 7))},${f % 5},2`);
        sets.push(`<DataSet timestep="${f * step}" group="" part="0" file="${name}"/>`);
    }
    writeFileSync(join(folder, "series.csv"), `${rows.join("\n")}\n`);
    const list = `<?xml version="1.0"?>\n<VTKFile type="Collection" version="1.0"><Collection>\n${sets.join("\n")}\n</Collection></VTKFile>\n`;
    writeFileSync(join(folder, "frames.pvd"), list);
    return { vertices: vertices.length, triangles: triangles.length };
}
