// The bodies: one three.js scene per run, drawn side by side on one canvas with one camera.
import {
    BufferAttribute,
    BufferGeometry,
    ClampToEdgeWrapping,
    Color,
    DataTexture,
    DoubleSide,
    LineSegments,
    Matrix4,
    Mesh,
    NearestFilter,
    PerspectiveCamera,
    Quaternion,
    RGBAFormat,
    Scene,
    ShaderMaterial,
    Vector2,
    Vector3,
    WebGLRenderer,
} from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { mapBytes } from "./colour.js";
import { fillPositions, fillValues } from "./data.js";

// A key light from above on the left, a weak light from the right, a highlight and a bright rim; inner sides are darker.
// x: factor on the colour, y: added brightness.
const lightShader = `
    vec2 lightOf(vec3 normal, vec3 eye, float inside) {
        vec3 key = vec3(-0.371, 0.557, 0.743);
        float facing = max(dot(normal, eye), 0.0), rim = 1.0 - facing;
        float shine = max(dot(normal, normalize(key + eye)), 0.0);
        shine *= shine;
        shine *= shine;
        shine *= shine;
        float light = 0.5 + 0.55 * max(dot(normal, key), 0.0) + 0.15 * max(dot(normal, vec3(0.83, -0.21, 0.52)), 0.0);
        return vec2(light, 0.1 * shine * shine + 0.16 * rim * rim * rim) * inside;
    }`;

const mapShader = `
    uniform sampler2D map;
    uniform vec2 range;
    uniform vec3 plain;
    uniform bool coloured;
    varying float fieldValue;
    vec3 colourOf() {
        float place = clamp((fieldValue - range.x) / max(range.y - range.x, 1e-30), 0.0, 1.0);
        return coloured ? texture2D(map, vec2(place, 0.5)).rgb : plain;
    }`;

// The light is computed per vertex for fine meshes (FINE), which is faster with software rendering, otherwise per pixel.
export const vertexShader = `
    attribute float value;
    varying float fieldValue;
    varying vec3 viewNormal, viewPosition;
    varying vec4 light;
    ${lightShader}
    void main() {
        vec4 place = modelViewMatrix * vec4(position, 1.0);
        viewPosition = place.xyz;
        viewNormal = normalMatrix * normal;
        #ifdef FINE
            vec3 eye = normalize(-viewPosition), facing = normalize(viewNormal);
            light = vec4(lightOf(facing, eye, 1.0), lightOf(-facing, eye, 0.6));
        #endif
        fieldValue = value;
        gl_Position = projectionMatrix * place;
    }`;

export const surfaceShader = `
    varying vec3 viewNormal, viewPosition;
    varying vec4 light;
    ${mapShader}
    ${lightShader}
    void main() {
        #ifdef FINE
            vec2 lit = gl_FrontFacing ? light.xy : light.zw;
        #else
            #ifdef FLAT
                vec3 normal = normalize(cross(dFdx(viewPosition), dFdy(viewPosition)));
            #else
                vec3 normal = normalize(gl_FrontFacing ? viewNormal : -viewNormal);
            #endif
            vec2 lit = lightOf(normal, normalize(-viewPosition), gl_FrontFacing ? 1.0 : 0.6);
        #endif
        gl_FragColor = vec4(colourOf() * lit.x + lit.y, 1.0);
    }`;

export const lineShader = `
    uniform float opacity;
    ${mapShader}
    void main() {
        gl_FragColor = vec4(colourOf(), opacity);
    }`;

// number of vertices from which the light is computed per vertex
export const FINE_COUNT = 4000;

// every edge once, as pairs of vertices
export function listEdges(corners, vertexCount) {
    const keys = new Float64Array(corners.length);
    for (let i = 0; i < corners.length; i++) {
        const a = corners[i];
        const b = corners[i % 3 === 2 ? i - 2 : i + 1];
        keys[i] = Math.min(a, b) * vertexCount + Math.max(a, b);
    }
    keys.sort();
    const pairs = [];
    for (let i = 0; i < keys.length; i++)
        if (i === 0 || keys[i] !== keys[i - 1]) pairs.push(Math.floor(keys[i] / vertexCount), keys[i] % vertexCount);
    return new Uint32Array(pairs);
}

// vertex normals, weighted by area; the shader normalizes them
export function fillNormals(corners, positions, normals) {
    normals.fill(0);
    for (let i = 0; i < corners.length; i += 3) {
        const a = 3 * corners[i];
        const b = 3 * corners[i + 1];
        const c = 3 * corners[i + 2];
        const ux = positions[b] - positions[a];
        const uy = positions[b + 1] - positions[a + 1];
        const uz = positions[b + 2] - positions[a + 2];
        const wx = positions[c] - positions[a];
        const wy = positions[c + 1] - positions[a + 1];
        const wz = positions[c + 2] - positions[a + 2];
        const nx = uy * wz - uz * wy;
        const ny = uz * wx - ux * wz;
        const nz = ux * wy - uy * wx;
        for (const at of [a, b, c]) {
            normals[at] += nx;
            normals[at + 1] += ny;
            normals[at + 2] += nz;
        }
    }
}

/* ---- what the report and the live page draw with ---- */

// uniforms of all surfaces of a picture: colour map, range, colour without a field
export function makeUniforms() {
    const texture = new DataTexture(mapBytes("viridis"), 256, 1, RGBAFormat);
    texture.magFilter = texture.minFilter = NearestFilter;
    texture.wrapS = texture.wrapT = ClampToEdgeWrapping;
    texture.needsUpdate = true;
    return {
        map: { value: texture },
        range: { value: new Vector2(0, 1) },
        plain: { value: new Vector3(0.82, 0.6, 0.52) },
        coloured: { value: false },
    };
}

export function showMap(uniforms, name) {
    uniforms.map.value.image.data.set(mapBytes(name));
    uniforms.map.value.needsUpdate = true;
}

// a surface without triangles, and the lines of its edges
export function makeSurface(uniforms) {
    const options = { vertexShader, uniforms, side: DoubleSide };
    const surface = new Mesh(
        new BufferGeometry(),
        new ShaderMaterial({
            ...options,
            fragmentShader: surfaceShader,
            polygonOffset: true,
            polygonOffsetFactor: 1,
            polygonOffsetUnits: 1,
        }),
    );
    const lines = new LineSegments(new BufferGeometry(), new ShaderMaterial({ ...options, fragmentShader: lineShader, transparent: true }));
    lines.material.uniforms = { ...uniforms, coloured: { value: false }, plain: { value: new Color() }, opacity: { value: 1 } };
    return { surface, lines };
}

// edges without a surface are drawn in the text colour or by the field, edges on a surface in thin black
export function styleLines(lines, alone, coloured, ink) {
    const uniforms = lines.material.uniforms;
    uniforms.coloured.value = alone && coloured;
    uniforms.opacity.value = alone ? 1 : 0.35;
    uniforms.plain.value.set(alone ? ink : "#000000").convertLinearToSRGB();
}

// the axis of a scene's `up` (x, y or z; default z)
export const upOf = (axis) => new Vector3(axis === "x" ? 1 : 0, axis === "y" ? 1 : 0, axis === "x" || axis === "y" ? 0 : 1);

// the direction from which bodies are first seen
export const firstView = (up) => new Vector3(0.5, -0.75, 0.5).normalize().applyQuaternion(new Quaternion().setFromUnitVectors(new Vector3(0, 0, 1), up));

export function makeEye(canvas, changed, up) {
    const camera = new PerspectiveCamera(28, 1, 0.01, 100);
    camera.up.copy(up);
    const controls = new OrbitControls(camera, canvas);
    controls.enableDamping = false;
    controls.minDistance = 0.05;
    controls.maxDistance = 40;
    controls.addEventListener("change", changed);
    return { camera, controls };
}

// Tools with few triangles are drawn with flat shading, so the edges of boxes are visible.
const FLAT_COUNT = 100;

// A tool of a run: a rigid surface with its position and rotation in each frame; null if the frame does not have it.
class Tool {
    constructor(tool, uniforms, centre, size) {
        const own = { ...uniforms, coloured: { value: false }, plain: { value: new Vector3(0.5, 0.55, 0.61) } };
        const corners = Uint32Array.from(tool.triangles);
        const positions = Float32Array.from(tool.positions, (x) => x / size);
        const normals = new Float32Array(positions.length);
        fillNormals(corners, positions, normals);
        this.mesh = makeSurface(own).surface;
        this.mesh.name = tool.name;
        this.mesh.geometry.setAttribute("position", new BufferAttribute(positions, 3));
        this.mesh.geometry.setAttribute("normal", new BufferAttribute(normals, 3));
        this.mesh.geometry.setAttribute("value", new BufferAttribute(new Float32Array(positions.length / 3), 1));
        this.mesh.geometry.setIndex(new BufferAttribute(corners, 1));
        this.mesh.material.defines = corners.length < 3 * FLAT_COUNT ? { FLAT: 1 } : {};
        this.mesh.frustumCulled = false;
        this.poses = tool.poses.map((pose) => {
            if (!pose) return null;
            const [a, b, c, d, e, f, g, h, i, ...at] = pose;
            const turn = new Quaternion().setFromRotationMatrix(new Matrix4().set(a, b, c, 0, d, e, f, 0, g, h, i, 0, 0, 0, 0, 1));
            return { turn, place: new Vector3(...at.map((x, k) => (x - centre[k]) / size)) };
        });
    }

    show(index, weight) {
        const now = this.poses[index];
        const next = (weight > 0 && this.poses[index + 1]) || now;
        this.mesh.visible = now !== null;
        if (!now) return;
        this.mesh.position.lerpVectors(now.place, next.place, weight);
        this.mesh.quaternion.slerpQuaternions(now.turn, next.turn, weight);
    }
}

// One run: geometry of the present topology. Positions are relative to the middle of the box, in units of its size, so a body
// of any size far from the origin keeps all digits of a float.
class Body {
    constructor(run, uniforms, centre, size) {
        this.run = run;
        this.centre = centre;
        this.size = size;
        this.scene = new Scene();
        this.shown = "";
        this.topology = -1;
        Object.assign(this, makeSurface(uniforms));
        this.surface.frustumCulled = this.lines.frustumCulled = false;
        this.tools = (run.tools ?? []).map((tool) => new Tool(tool, uniforms, centre, size));
        this.scene.add(this.surface, this.lines, ...this.tools.map((tool) => tool.mesh));
    }

    setTopology(topology) {
        const count = this.run.topologies[topology][0];
        const corners = this.run.corners[topology];
        this.topology = topology;
        this.positions = new Float32Array(3 * count);
        this.normals = new Float32Array(3 * count);
        this.values = new Float32Array(count);
        const attributes = {
            position: new BufferAttribute(this.positions, 3),
            normal: new BufferAttribute(this.normals, 3),
            value: new BufferAttribute(this.values, 1),
        };
        for (const object of [this.surface, this.lines]) {
            object.geometry.dispose();
            object.geometry = new BufferGeometry();
            for (const name in attributes) object.geometry.setAttribute(name, attributes[name]);
        }
        this.surface.geometry.setIndex(new BufferAttribute(corners, 1));
        this.edges = null;
    }

    // index and weight: see data.locate; field: null = none
    show(index, weight, field) {
        const frame = this.run.frames[index];
        const shown = `${index} ${weight} ${field?.name}`;
        if (shown === this.shown) return;
        if (this.topology !== frame.topology) this.setTopology(frame.topology);
        this.shown = shown;
        this.index = index;
        for (const tool of this.tools) tool.show(index, weight);
        fillPositions(this.run, index, weight, this.positions);
        const { centre, size, positions } = this;
        for (let i = 0; i < positions.length; i += 3)
            for (let c = 0; c < 3; c++) positions[i + c] = (positions[i + c] - centre[c]) / size;
        fillNormals(this.run.corners[frame.topology], positions, this.normals);
        if (field) fillValues(this.run, field, index, weight, this.values);
        const { position, normal, value } = this.surface.geometry.attributes;
        position.needsUpdate = normal.needsUpdate = true;
        if (field) value.needsUpdate = true;
    }

    // largest distance of a vertex from the middle, in the units of the picture
    radius() {
        let squared = 0;
        for (let i = 0; i < this.positions?.length; i += 3)
            squared = Math.max(squared, this.positions[i] ** 2 + this.positions[i + 1] ** 2 + this.positions[i + 2] ** 2);
        return Math.sqrt(squared) || 1;
    }

    // computes the light per vertex, per pixel or per triangle
    setLight(flat) {
        const fine = this.run.topologies[this.topology][0] >= FINE_COUNT;
        const kind = flat ? "FLAT" : fine ? "FINE" : "";
        const { material } = this.surface;
        if (material.userData.kind === kind) return;
        material.userData.kind = kind;
        material.defines = kind ? { [kind]: 1 } : {};
        material.needsUpdate = true;
    }

    setStyle(surface, ink) {
        const wire = surface === "wireframe";
        this.surface.visible = !wire;
        this.lines.visible = surface !== "smooth";
        if (this.lines.visible && !this.edges && this.topology >= 0) {
            this.edges = listEdges(this.run.corners[this.topology], this.run.topologies[this.topology][0]);
            this.lines.geometry.setIndex(new BufferAttribute(this.edges, 1));
        }
        styleLines(this.lines, wire, this.surface.material.uniforms.coloured.value, ink);
    }

    // nearest vertex of the first triangle on the ray; -1 if the ray meets no triangle
    hit(origin, direction) {
        const corners = this.run.corners[this.topology];
        const [a, u, w, p, q, s] = Array.from({ length: 6 }, () => new Vector3());
        let best = Infinity;
        let found = -1;
        for (let i = 0; i < corners.length; i += 3) {
            a.fromArray(this.positions, 3 * corners[i]);
            u.fromArray(this.positions, 3 * corners[i + 1]).sub(a);
            w.fromArray(this.positions, 3 * corners[i + 2]).sub(a);
            p.crossVectors(direction, w);
            const determinant = u.dot(p);
            if (Math.abs(determinant) < 1e-14) continue;
            s.subVectors(origin, a);
            const x = s.dot(p) / determinant;
            q.crossVectors(s, u);
            const y = direction.dot(q) / determinant;
            const distance = w.dot(q) / determinant;
            if (x < 0 || y < 0 || x + y > 1 || distance <= 0 || distance >= best) continue;
            best = distance;
            const weights = [1 - x - y, x, y];
            found = corners[i + weights.indexOf(Math.max(...weights))];
        }
        return found;
    }
}

// whether the processor draws the pictures (software rendering); antialiasing would double the time there
export function isSoftware() {
    const context = document.createElement("canvas").getContext("webgl2");
    const names = context?.getExtension("WEBGL_debug_renderer_info");
    const name = context?.getParameter(names ? names.UNMASKED_RENDERER_WEBGL : context.RENDERER) ?? "";
    context?.getExtension("WEBGL_lose_context")?.loseContext();
    return /swiftshader|llvmpipe|softpipe|software|basic render/i.test(name);
}

function unionBox(runs) {
    const low = [0, 1, 2].map((c) => Math.min(...runs.map((run) => run.low[c])));
    const high = [0, 1, 2].map((c) => Math.max(...runs.map((run) => run.high[c])));
    const centre = low.map((x, c) => (x + high[c]) / 2);
    const size = Math.hypot(...low.map((x, c) => high[c] - x)) / 2 || 1;
    return { centre, size };
}

export class View {
    // changed() is called when the picture must be drawn again
    constructor(canvas, runs, changed) {
        this.canvas = canvas;
        this.pictures = 0;
        this.software = isSoftware();
        this.motionRatio = 1;
        this.intervals = [];
        this.renderer = new WebGLRenderer({ canvas, antialias: !this.software, alpha: true });
        this.renderer.setClearColor(0x000000, 0);
        this.renderer.setScissorTest(true);
        this.uniforms = makeUniforms();
        const { centre, size } = unionBox(runs);
        this.bodies = runs.map((run) => new Body(run, this.uniforms, centre, size));
        Object.assign(this, makeEye(canvas, changed, upOf(/^up: (\w)/m.exec(runs[0].scene)?.[1])));
        this.resize();
    }

    // camera distance at which the present body fits into its cell, with a margin for its motion
    reset() {
        const { width, height } = this.cells?.[0] ?? { width: 1, height: 1 };
        const half = Math.tan(((this.camera.fov / 2) * Math.PI) / 180) * Math.min(1, width / height);
        const radius = 1.15 * Math.max(...this.bodies.map((body) => body.radius()));
        const distance = Math.max(0.5, radius) / Math.sin(Math.atan(half));
        this.controls.target.set(0, 0, 0);
        this.camera.position.copy(firstView(this.camera.up)).multiplyScalar(distance);
        this.controls.update();
    }

    turn(right, up) {
        const { camera, controls } = this;
        const offset = camera.position.clone().sub(controls.target);
        const elevation = Math.asin(offset.dot(camera.up) / offset.length());
        offset.applyAxisAngle(camera.up, -right);
        const side = new Vector3().crossVectors(offset, camera.up).normalize();
        if (Math.abs(elevation + up) < 1.5) offset.applyAxisAngle(side, up);
        camera.position.copy(controls.target).add(offset);
        controls.update();
    }

    zoom(factor) {
        const offset = this.camera.position.clone().sub(this.controls.target).multiplyScalar(1 / factor);
        this.camera.position.copy(this.controls.target).add(offset);
        this.controls.update();
    }

    // divides the canvas into cells of equal size, as square as possible
    resize() {
        const width = this.canvas.clientWidth;
        const height = this.canvas.clientHeight;
        if (width === 0 || height === 0) return;
        const count = this.bodies.length;
        let columns = 1;
        for (let n = 1; n <= count; n++) {
            const side = (n) => Math.min(width / n, height / Math.ceil(count / n));
            if (side(n) > side(columns)) columns = n;
        }
        const rows = Math.ceil(count / columns);
        this.cells = this.bodies.map((_, i) => ({
            x: Math.floor(((i % columns) * width) / columns),
            y: Math.floor((Math.floor(i / columns) * height) / rows),
            width: Math.floor(width / columns),
            height: Math.floor(height / rows),
        }));
        this.height = height;
        this.setFine(false);
        this.renderer.setSize(width, height, false);
        this.camera.aspect = this.cells[0].width / this.cells[0].height;
        this.camera.updateProjectionMatrix();
    }

    // Software rendering: during motion, an adapted resolution; without motion, twice the normal resolution.
    setFine(fine) {
        const ratio = this.software ? (fine ? 2 : this.motionRatio) : Math.min(window.devicePixelRatio, 2);
        if (ratio === this.renderer.getPixelRatio()) return false;
        this.renderer.setPixelRatio(ratio);
        return true;
    }

    // adapts the resolution of the next pictures to the time since the last picture [ms]
    adapt(interval) {
        this.intervals.push(interval);
        if (this.intervals.length < 6) return;
        const middle = this.intervals.sort((a, b) => a - b)[3];
        this.intervals = [];
        if (middle > 32) this.motionRatio = Math.max(0.5, this.motionRatio * 0.8);
        else if (middle < 22) this.motionRatio = Math.min(1, this.motionRatio * 1.25);
    }

    setMap(name) {
        showMap(this.uniforms, name);
    }

    draw(style) {
        this.bodies.forEach((body, i) => {
            const { x, y, width, height } = this.cells[i];
            body.setLight(style.shading === "flat");
            body.setStyle(style.surface, style.ink);
            this.renderer.setViewport(x, this.height - y - height, width, height);
            this.renderer.setScissor(x, this.height - y - height, width, height);
            this.renderer.render(body.scene, this.camera);
        });
        this.pictures++;
    }

    // { body, vertex } under a point of the canvas, or null
    pick(x, y) {
        const i = this.cells.findIndex((c) => x >= c.x && x < c.x + c.width && y >= c.y && y < c.y + c.height);
        if (i < 0) return null;
        const cell = this.cells[i];
        this.camera.updateMatrixWorld();
        const point = new Vector3(((x - cell.x) / cell.width) * 2 - 1, 1 - ((y - cell.y) / cell.height) * 2, 0.5);
        const direction = point.unproject(this.camera).sub(this.camera.position).normalize();
        const vertex = this.bodies[i].hit(this.camera.position, direction);
        return vertex < 0 ? null : { body: i, vertex };
    }

    // position of a vertex on the canvas [pixels]
    project(body, vertex) {
        const cell = this.cells[body];
        this.camera.updateMatrixWorld();
        const point = new Vector3().fromArray(this.bodies[body].positions, 3 * vertex).project(this.camera);
        return { x: cell.x + ((point.x + 1) / 2) * cell.width, y: cell.y + ((1 - point.y) / 2) * cell.height };
    }
}
