// Surfaces of three.js: a mesh file from a geometry, and a geometry that follows a body. three.js itself is passed in, so that
// this module needs no package.

// vertices that are nearer than this share of the size of the geometry are one: sines of full turns are not exactly 0
const SAME = 1e-6;

// Text of an OBJ file with the triangles of a BufferGeometry, and the vertex of the file that each vertex of the geometry is:
// vertices at the same place are one, so that seams of texture coordinates and normals do not cut the surface.
export function fromThree(geometry) {
    const position = geometry.getAttribute("position");
    if (!position) throw new TypeError("the geometry has no attribute position");
    const points = Array.from({ length: position.count }, (_, i) => [position.getX(i), position.getY(i), position.getZ(i)]);
    const low = [0, 1, 2].map((k) => points.reduce((least, point) => Math.min(least, point[k]), Infinity));
    const size = points.reduce((most, point) => Math.max(most, ...point.map((x, k) => x - low[k])), 0) || 1;
    // a cell of a grid has one vertex; a point looks for it in the cells that it is near
    const cell = (point, shift) => point.map((x, k) => Math.floor((x - low[k]) / (4 * SAME * size) + 0.5 + 0.25 * shift[k])).join(" ");
    const shifts = [0, 1, 2, 3, 4, 5, 6, 7].map((bits) => [0, 1, 2].map((k) => ((bits >> k) & 1 ? 1 : -1)));
    const vertices = new Uint32Array(position.count);
    const known = new Map();
    const lines = [];
    points.forEach((point, i) => {
        const near = shifts.map((shift) => cell(point, shift));
        const found = near.find((key) => known.has(key));
        vertices[i] = found === undefined ? lines.length : known.get(found);
        if (found !== undefined) return;
        near.forEach((key) => known.set(key, lines.length));
        lines.push(`v ${point.join(" ")}`);
    });
    const corners = geometry.index ? Array.from(geometry.index.array, (i) => vertices[i]) : Array.from(vertices);
    for (let i = 0; i + 2 < corners.length; i += 3) {
        const [a, b, c] = corners.slice(i, i + 3);
        // poles of spheres and tips of cones have triangles without area
        if (a !== b && b !== c && c !== a) lines.push(`f ${a + 1} ${b + 1} ${c + 1}`);
    }
    return { obj: `${lines.join("\n")}\n`, vertices };
}

// normals of the vertices of a surface, weighted by the areas of the triangles
function fillNormals(positions, triangles, normals) {
    normals.fill(0);
    for (let i = 0; i < triangles.length; i += 3) {
        const [a, b, c] = [3 * triangles[i], 3 * triangles[i + 1], 3 * triangles[i + 2]];
        const [ux, uy, uz] = [0, 1, 2].map((k) => positions[b + k] - positions[a + k]);
        const [wx, wy, wz] = [0, 1, 2].map((k) => positions[c + k] - positions[a + k]);
        const [nx, ny, nz] = [uy * wz - uz * wy, uz * wx - ux * wz, ux * wy - uy * wx];
        for (const v of [a, b, c]) {
            normals[v] += nx;
            normals[v + 1] += ny;
            normals[v + 2] += nz;
        }
    }
    for (let v = 0; v < normals.length; v += 3) {
        const length = Math.hypot(normals[v], normals[v + 1], normals[v + 2]) || 1;
        for (let k = 0; k < 3; k++) normals[v + k] /= length;
    }
}

// A geometry that follows a body: { geometry, update() }. Call update() after steps, before a picture. Without `source` the geometry
// has the body's own vertices, and new ones where it refines or is cut. With `source`, which is { geometry, vertices } of
// fromThree, it is a copy of that geometry with its texture coordinates, colours and groups, whose positions and normals move.
export function toThree({ BufferAttribute, BufferGeometry }, simulation, body = 0, source = null) {
    const geometry = source ? source.geometry.clone() : new BufferGeometry();
    let revision = NaN;
    let normals = new Float32Array(0);

    function allocate(count) {
        const own = source ? source.vertices.length : count;
        normals = new Float32Array(3 * count);
        geometry.setAttribute("position", new BufferAttribute(new Float32Array(3 * own), 3));
        geometry.setAttribute("normal", new BufferAttribute(new Float32Array(3 * own), 3));
        if (!source) geometry.setIndex(new BufferAttribute(simulation.triangles(body).slice(), 1));
        if (source && Math.max(...source.vertices) >= count) throw new RangeError("the body is not the one that was made of this geometry: it has fewer vertices");
    }

    function update() {
        const positions = simulation.positions(body).slice();
        const triangles = simulation.triangles(body);
        const now = simulation.surfaceRevision(body);
        if (now !== revision) allocate(positions.length / 3);
        revision = now;
        fillNormals(positions, triangles, normals);
        const { position, normal } = geometry.attributes;
        for (const [from, to] of [[positions, position], [normals, normal]]) {
            if (source) source.vertices.forEach((v, i) => to.array.set(from.subarray(3 * v, 3 * v + 3), 3 * i));
            else to.array.set(from);
            to.needsUpdate = true;
        }
        geometry.boundingSphere = geometry.boundingBox = null;
    }

    update();
    return { geometry, update };
}
