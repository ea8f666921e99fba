// The 3D picture: bodies, tools, the hand, pins and contacts. Coordinates are relative to the middle of the bodies at rest, in
// units of half their size, as in the report.
import {
    ArrowHelper,
    BackSide,
    BoxGeometry,
    BufferAttribute,
    BufferGeometry,
    CapsuleGeometry,
    DoubleSide,
    FrontSide,
    LineBasicMaterial,
    LineLoop,
    Matrix4,
    Mesh,
    Points,
    PointsMaterial,
    Quaternion,
    Scene,
    ShaderMaterial,
    SphereGeometry,
    Vector3,
    WebGLRenderer,
} from "three";
import {
    FINE_COUNT,
    fillNormals,
    firstView,
    isSoftware,
    listEdges,
    makeEye,
    makeSurface,
    makeUniforms,
    showMap,
    styleLines,
    surfaceShader,
    upOf,
    vertexShader,
} from "../view.js";

class Body {
    constructor(stage, closed) {
        this.stage = stage;
        this.closed = closed;
        this.outside = null; // outer side of the triangles; both sides for open bodies
        Object.assign(this, makeSurface(stage.uniforms));
        this.pins = this.makePoints("#1d6fd1", 5);
        this.contacts = this.makePoints("#d1341d", 4);
        this.count = 0;
        for (const object of [this.surface, this.lines, this.pins, this.contacts]) {
            object.frustumCulled = false;
            stage.scene.add(object);
        }
    }

    makePoints(colour, size) {
        return new Points(new BufferGeometry(), new PointsMaterial({ color: colour, size, sizeAttenuation: false }));
    }

    dispose() {
        for (const object of [this.surface, this.lines, this.pins, this.contacts]) {
            this.stage.scene.remove(object);
            object.geometry.dispose();
            object.material.dispose();
        }
    }

    setSurface({ vertices, corners, pins }) {
        this.corners = corners;
        this.pinned = Uint32Array.from(pins.keys()).filter((v) => pins[v]);
        this.edges = null;
        if (vertices !== this.count) this.allocate(vertices);
        // through a cut the inner side is seen
        if (this.first && 3 * vertices > this.first.length) this.outside = DoubleSide;
        this.surface.geometry.setIndex(new BufferAttribute(corners, 1));
        this.pins.geometry.setIndex(new BufferAttribute(this.pinned, 1));
    }

    allocate(count) {
        this.count = count;
        this.positions = new Float32Array(3 * count);
        this.normals = new Float32Array(3 * count);
        this.values = new Float32Array(count);
        const attributes = {
            position: new BufferAttribute(this.positions, 3),
            normal: new BufferAttribute(this.normals, 3),
            value: new BufferAttribute(this.values, 1),
        };
        for (const object of [this.surface, this.lines, this.pins, this.contacts]) {
            object.geometry.dispose();
            object.geometry = new BufferGeometry();
            for (const name in attributes) object.geometry.setAttribute(name, attributes[name]);
        }
        const fine = count >= FINE_COUNT;
        this.surface.material.defines = fine ? { FINE: 1 } : {};
        this.surface.material.needsUpdate = true;
    }

    show({ positions, values, contacts }, withContacts) {
        const { centre, size } = this.stage;
        for (let i = 0; i < positions.length; i += 3)
            for (let c = 0; c < 3; c++) this.positions[i + c] = (positions[i + c] - centre[c]) / size;
        this.first ??= this.positions.slice();
        fillNormals(this.corners, this.positions, this.normals);
        this.outside ??= this.closed ? outsideOf(this.corners, this.positions) : DoubleSide;
        if (values) this.values.set(values);
        const { position, normal, value } = this.surface.geometry.attributes;
        position.needsUpdate = normal.needsUpdate = true;
        if (values) value.needsUpdate = true;
        this.contacts.visible = withContacts;
        if (withContacts) {
            const touched = Uint32Array.from(contacts.keys()).filter((v) => contacts[v]);
            this.contacts.geometry.setIndex(new BufferAttribute(touched, 1));
        }
    }

    setStyle(surface, ink) {
        const wire = surface === "wireframe";
        this.surface.visible = !wire;
        this.lines.visible = surface !== "smooth";
        if (this.lines.visible && !this.edges && this.corners) {
            this.edges = listEdges(this.corners, this.count);
            this.lines.geometry.setIndex(new BufferAttribute(this.edges, 1));
        }
        styleLines(this.lines, wire, this.stage.uniforms.coloured.value, ink);
    }

    // { distance, corners, weights } of the first triangle on the ray, or null
    hit(origin, direction) {
        const [a, u, w, p, q, s] = Array.from({ length: 6 }, () => new Vector3());
        let best = null;
        for (let i = 0; i < this.corners.length; i += 3) {
            a.fromArray(this.positions, 3 * this.corners[i]);
            u.fromArray(this.positions, 3 * this.corners[i + 1]).sub(a);
            w.fromArray(this.positions, 3 * this.corners[i + 2]).sub(a);
            p.crossVectors(direction, w);
            const determinant = u.dot(p);
            if (Math.abs(determinant) < 1e-14) continue;
            s.subVectors(origin, a);
            const x = s.dot(p) / determinant;
            q.crossVectors(s, u);
            const y = direction.dot(q) / determinant;
            const distance = w.dot(q) / determinant;
            if (x < 0 || y < 0 || x + y > 1 || distance <= 0 || (best && distance >= best.distance)) continue;
            best = { distance, corners: [...this.corners.subarray(i, i + 3)], weights: [1 - x - y, x, y], normal: u.clone().cross(w).normalize() };
        }
        return best;
    }

    // mean curvature at a point, from the cotangent Laplacian at the corners; positive on a sphere. It is 0 at corners on a
    // boundary.
    curvature({ corners, weights }) {
        const [x, y, z, toY, toZ, side] = Array.from({ length: 6 }, () => new Vector3());
        const rings = new Map(corners.map((v) => [v, { laplacian: new Vector3(), area: 0, others: new Map() }]));
        for (let i = 0; i < this.corners.length; i++) {
            const ring = rings.get(this.corners[i]);
            if (!ring) continue;
            const start = i - (i % 3);
            const [next, last] = [this.corners[start + ((i + 1) % 3)], this.corners[start + ((i + 2) % 3)]];
            x.fromArray(this.positions, 3 * this.corners[i]);
            toY.subVectors(x, y.fromArray(this.positions, 3 * next));
            toZ.subVectors(x, z.fromArray(this.positions, 3 * last));
            side.subVectors(z, y);
            const double = side.clone().cross(toY).length();
            if (!(double > 0)) continue;
            ring.area += double / 6;
            // cotangents of the angles at z and at y
            ring.laplacian.addScaledVector(toY, side.dot(toZ) / -double).addScaledVector(toZ, side.dot(toY) / double);
            for (const other of [next, last]) ring.others.set(other, (ring.others.get(other) ?? 0) + 1);
        }
        return corners.reduce((sum, v, c) => {
            const { laplacian, area, others } = rings.get(v);
            const normal = side.fromArray(this.normals, 3 * v).normalize();
            const closed = [...others.values()].every((count) => count === 2);
            return sum + (closed && area > 0 ? (weights[c] * laplacian.dot(normal)) / (4 * area) : 0);
        }, 0);
    }

    // the present position of a point of the surface
    point({ corners, weights }) {
        const at = new Vector3();
        corners.forEach((v, c) => at.addScaledVector(new Vector3().fromArray(this.positions, 3 * v), weights[c]));
        return at;
    }
}

// share of the picture that the bodies fill, and the way that a free body goes before the camera follows [half sizes of the bodies]
const FILL = 0.82;
const LOOSE = 0.1;
// growth of the bodies that the camera follows
const MOST_GROWTH = 5;

// the smallest and the largest of many numbers
function extremes(values) {
    return values.reduce(([low, high], value) => [Math.min(low, value), Math.max(high, value)], [Infinity, -Infinity]);
}

// the outer side of a closed surface, by the sign of its volume
function outsideOf(corners, positions) {
    const [a, b, c] = Array.from({ length: 3 }, () => new Vector3());
    let volume = 0;
    for (let i = 0; i < corners.length; i += 3) {
        [a, b, c].forEach((point, k) => point.fromArray(positions, 3 * corners[i + k]));
        volume += a.dot(b.cross(c));
    }
    return volume < 0 ? BackSide : FrontSide;
}

// of the hand: edges along z, and the line on which scissors close
const edges = { blade: (radius) => [0, 0, -radius, 0, 0, radius], hook: (radius) => [0, 0, -radius, 0, 0, radius], scissors: (radius) => [0, 0, 0, 2 * radius, 0, 0] };

// a rod along an edge, six numbers
function edgeGeometry(edge) {
    const from = new Vector3(...edge.slice(0, 3));
    const along = new Vector3(...edge.slice(3)).sub(from);
    const length = along.length();
    const turn = new Quaternion().setFromUnitVectors(new Vector3(0, 1, 0), along.clone().normalize());
    const middle = from.addScaledVector(along, 0.5);
    return new CapsuleGeometry(length / 40, length, 4, 12).applyQuaternion(turn).translate(middle.x, middle.y, middle.z);
}

function toolGeometry(tool, size) {
    const length = (value) => value / size;
    if (tool.shape === "sphere") return new SphereGeometry(length(tool.radius), 40, 24);
    if (tool.shape === "capsule") return new CapsuleGeometry(length(tool.radius), length(2 * tool.half_length), 12, 32).rotateX(Math.PI / 2);
    if (tool.shape === "box") return new BoxGeometry(...tool.half_extents.map((half) => length(2 * half)));
    if (tool.edge) return edgeGeometry(tool.edge.map(length));
    if (!tool.positions) return null;
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new BufferAttribute(Float32Array.from(tool.positions, length), 3));
    geometry.setIndex(new BufferAttribute(Uint32Array.from(tool.triangles), 1));
    geometry.computeVertexNormals();
    return geometry;
}

export class Stage {
    // changed() is called when the picture must be drawn again
    constructor(canvas, changed) {
        this.canvas = canvas;
        this.software = isSoftware();
        this.ratio = 1;
        this.isFine = false;
        this.intervals = [];
        this.pictures = 0;
        this.renderer = new WebGLRenderer({ canvas, antialias: !this.software, alpha: true, preserveDrawingBuffer: false });
        this.renderer.setClearColor(0x000000, 0);
        this.uniforms = makeUniforms();
        this.scene = new Scene();
        this.centre = [0, 0, 0];
        this.size = 1;
        this.bodies = [];
        this.tools = new Map();
        this.held = { name: "", mesh: null }; // the tool of the hand
        this.changed = changed;
        Object.assign(this, makeEye(canvas, changed, upOf("z")));
        this.arrow = new ArrowHelper(new Vector3(0, 0, 1), new Vector3(), 1, "#d1341d");
        this.arrow.line.material.depthTest = this.arrow.cone.material.depthTest = false;
        this.arrow.line.renderOrder = this.arrow.cone.renderOrder = 2;
        this.arrow.visible = false;
        this.scene.add(this.arrow);
        this.resize();
    }

    /* ---- places ---- */

    // converts metres to coordinates of the picture, and back
    inward(point) {
        return new Vector3(...point.map((x, c) => (x - this.centre[c]) / this.size));
    }

    outward(point) {
        return point.toArray().map((x, c) => x * this.size + this.centre[c]);
    }

    /* ---- contents ---- */

    setScene({ low, high, bodies, tools, up, circle }) {
        // the controls keep the axis that they were made with
        if (!upOf(up).equals(this.camera.up)) {
            this.controls.dispose();
            Object.assign(this, makeEye(this.canvas, this.changed, upOf(up)));
            this.rig?.add(this.camera);
            this.resize();
        }
        this.bodies.forEach((body) => body.dispose());
        for (const name of this.tools.keys()) this.removeTool(name);
        this.centre = low.map((x, c) => (x + high[c]) / 2);
        this.size = Math.hypot(...low.map((x, c) => high[c] - x)) / 2 || 1;
        this.half = low.map((x, c) => (high[c] - x) / 2 / this.size);
        this.setCircle(circle);
        this.bodies = bodies.map(({ closed }) => new Body(this, closed));
        this.isNew = true;
        for (const tool of tools) this.addTool(tool);
        this.reset();
    }

    // the circle that a tear is led on, seen from above; none without
    setCircle(circle) {
        if (this.circle) this.scene.remove(this.circle.line);
        this.circle = null;
        if (!circle) return;
        const axis = new Vector3(...circle.axis).normalize();
        const place = this.inward(circle.place);
        const centre = this.inward(circle.center);
        centre.addScaledVector(axis, place.clone().sub(centre).dot(axis));
        const turn = new Quaternion().setFromUnitVectors(new Vector3(0, 0, 1), axis);
        const points = Array.from({ length: 96 }, (_, i) => new Vector3(Math.cos((i * Math.PI) / 48), Math.sin((i * Math.PI) / 48), 0).multiplyScalar(circle.radius / this.size).applyQuaternion(turn).add(centre));
        const material = new LineBasicMaterial({ color: "#d1841d", depthTest: false, transparent: true, opacity: 0.8 });
        const line = new LineLoop(new BufferGeometry().setFromPoints(points), material);
        line.renderOrder = 1;
        this.scene.add(line);
        this.circle = { line, axis, place };
    }

    firstAway() {
        if (!this.circle) return firstView(this.camera.up);
        // from above, but for the little that keeps the picture upright
        const side = new Vector3(0, -1, 0).addScaledVector(this.circle.axis, this.circle.axis.y);
        return this.circle.axis.clone().addScaledVector(side.lengthSq() > 0.1 ? side : new Vector3(1, 0, 0), 1e-3).normalize();
    }

    addTool(tool) {
        const geometry = toolGeometry(tool, this.size);
        if (!geometry) return;
        const uniforms = { ...this.uniforms, coloured: { value: false }, plain: { value: new Vector3(0.62, 0.67, 0.72) } };
        const mesh = new Mesh(geometry, new ShaderMaterial({ vertexShader, fragmentShader: surfaceShader, uniforms, side: DoubleSide }));
        mesh.frustumCulled = false;
        this.tools.set(tool.name, mesh);
        this.scene.add(mesh);
    }

    removeTool(name) {
        const mesh = this.tools.get(name);
        this.scene.remove(mesh);
        mesh.geometry.dispose();
        mesh.material.dispose();
        this.tools.delete(name);
    }

    // tool: mesh of the hand's tool; null = none
    setSurface(bodies, tool) {
        bodies.forEach((body, b) => this.bodies[b].setSurface(body));
        this.held.mesh = tool;
        if (this.tools.has(this.held.name)) this.removeTool(this.held.name);
    }

    // false if the frame does not belong to the present surface
    showFrame(frame, withContacts) {
        if (frame.bodies.length !== this.bodies.length || frame.bodies.some((body, b) => body.positions.length !== 3 * this.bodies[b].count)) return false;
        frame.bodies.forEach((body, b) => this.bodies[b].show(body, withContacts));
        if (this.isNew) this.reset();
        this.isNew = false;
        this.follow();
        this.showTools(frame);
        this.showForce(frame.hand);
        return true;
    }

    showTools({ tools, hand }) {
        const held = hand.kind === "press" || hand.kind === "grasp" ? tools.at(-1).name : "";
        this.held.name = held;
        if (held && !this.tools.has(held))
            this.addTool({ name: held, shape: hand.shape, radius: hand.radius, half_length: 2 * hand.radius, half_extents: [hand.radius, hand.radius, hand.radius], edge: edges[hand.shape]?.(hand.radius), ...this.held.mesh });
        const names = new Set(tools.map((tool) => tool.name));
        for (const name of [...this.tools.keys()]) if (!names.has(name)) this.removeTool(name);
        for (const tool of tools) {
            const mesh = this.tools.get(tool.name);
            mesh?.position.copy(this.inward(tool.position));
            mesh?.quaternion.set(...tool.rotation);
        }
    }

    // draws the arrow: the spring while the hand pulls, the force while it presses
    showForce({ kind, point, target, force }) {
        const newton = Math.hypot(...force);
        this.arrow.visible = kind !== "free" && newton > 0;
        if (!this.arrow.visible) return;
        const from = this.inward(point);
        const way = kind === "grab" ? this.inward(target).sub(from) : new Vector3(...force).normalize().multiplyScalar(0.45);
        const length = Math.max(way.length(), 1e-6);
        this.arrow.position.copy(kind === "grab" ? from : from.clone().sub(way));
        this.arrow.setDirection(way.clone().normalize());
        this.arrow.setLength(length, Math.min(0.08, 0.4 * length), Math.min(0.05, 0.25 * length));
        this.tip = this.arrow.position.clone().add(way);
    }

    /* ---- camera ---- */

    // the points that a view must show: the present vertices of all bodies, or before the first frame the corners of their box at rest
    outline() {
        const points = [];
        for (const { positions } of this.bodies) for (let i = 0; i < (positions?.length ?? 0); i += 3) points.push(new Vector3().fromArray(positions, i));
        if (points.length === 0) for (let i = 0; i < 8; i++) points.push(new Vector3(...this.half.map((x, c) => ((i >> c) & 1 ? x : -x))));
        return points;
    }

    // shows all bodies so that they fill the picture; keeps the direction of the view if `turned`
    reset(turned = false) {
        const away = turned ? this.camera.position.clone().sub(this.controls.target).normalize() : this.firstAway();
        const right = new Vector3().crossVectors(this.camera.up, away).normalize();
        const axes = [right, new Vector3().crossVectors(away, right)];
        const points = this.outline();
        const target = new Vector3();
        for (const axis of [...axes, away]) {
            const [low, high] = extremes(points.map((point) => point.dot(axis)));
            target.addScaledVector(axis, (low + high) / 2);
        }
        const half = Math.tan(((this.camera.fov / 2) * Math.PI) / 180) * FILL;
        let distance = 0.1;
        for (const point of points) {
            const from = point.clone().sub(target);
            distance = Math.max(distance, from.dot(away) + Math.abs(from.dot(axes[0])) / (half * this.camera.aspect), from.dot(away) + Math.abs(from.dot(axes[1])) / half);
        }
        this.controls.target.copy(target);
        this.camera.position.copy(target).addScaledVector(away, distance);
        this.controls.update();
        this.framed = this.measure();
        if (this.framed) this.framed.most = MOST_GROWTH * this.framed.radius;
    }

    // middle and radius of the box of all bodies; null before the first frame
    measure() {
        const box = [new Vector3(Infinity, Infinity, Infinity), new Vector3(-Infinity, -Infinity, -Infinity)];
        const point = new Vector3();
        for (const { positions } of this.bodies)
            for (let i = 0; i < (positions?.length ?? 0); i += 3) {
                box[0].min(point.fromArray(positions, i));
                box[1].max(point);
            }
        const radius = box[0].distanceTo(box[1]) / 2;
        return radius < Infinity ? { middle: box[0].add(box[1]).divideScalar(2), radius } : null;
    }

    // The camera goes with bodies that nothing holds as soon as they leave the middle of the picture, and steps back from bodies that grow.
    follow() {
        const now = this.measure();
        if (!now || !this.framed) return;
        const { middle, radius } = now;
        const { framed } = this;
        const held = this.bodies.some(({ pinned }) => pinned?.length > 0);
        const growth = radius > 1.02 * framed.radius && radius < framed.most ? radius / framed.radius : 1;
        this.drift = held ? 0 : middle.length();
        const shift = middle.clone().sub(framed.middle);
        const excess = growth > 1 ? shift.length() : held ? 0 : shift.length() - LOOSE;
        if (growth === 1 && !(excess > 0)) return;
        if (excess > 0) shift.setLength(excess);
        const away = this.camera.position.clone().sub(this.controls.target).multiplyScalar(growth);
        framed.radius *= growth;
        framed.middle.add(shift);
        this.controls.target.add(shift);
        this.camera.position.copy(this.controls.target).add(away);
        this.rig?.position.add(shift);
        this.controls.update();
    }

    turn(right, up) {
        const offset = this.camera.position.clone().sub(this.controls.target);
        const elevation = Math.asin(offset.dot(this.camera.up) / offset.length());
        offset.applyAxisAngle(this.camera.up, -right);
        const side = new Vector3().crossVectors(offset, this.camera.up).normalize();
        if (Math.abs(elevation + up) < 1.5) offset.applyAxisAngle(side, up);
        this.camera.position.copy(this.controls.target).add(offset);
        this.controls.update();
    }

    zoom(factor) {
        const offset = this.camera.position.clone().sub(this.controls.target).multiplyScalar(1 / factor);
        this.camera.position.copy(this.controls.target).add(offset);
        this.controls.update();
    }

    resize() {
        const { clientWidth: width, clientHeight: height } = this.canvas;
        if (width === 0 || height === 0 || this.immersed) return;
        this.renderer.setPixelRatio(this.software ? this.ratio : Math.min(window.devicePixelRatio, 2));
        this.renderer.setSize(width, height, false);
        this.camera.aspect = width / height;
        this.camera.updateProjectionMatrix();
    }

    // software rendering: adapts the resolution to the time between two pictures
    adapt(interval) {
        if (!this.software) return;
        this.intervals.push(interval);
        if (this.intervals.length < 8) return;
        const middle = this.intervals.sort((a, b) => a - b)[4];
        this.intervals = [];
        const ratio = middle > 40 ? Math.max(0.5, this.ratio * 0.8) : middle < 22 ? Math.min(1, this.ratio * 1.25) : this.ratio;
        this.ratio = ratio;
    }

    // Software rendering: if nothing moves, draws at full resolution and with the inner sides of closed bodies. False if the last
    // picture was already drawn like this.
    refine() {
        if (!this.software || this.isFine || this.immersed) return false;
        this.isFine = true;
        this.renderer.setPixelRatio(2);
        return true;
    }

    // returns to the resolution for motion
    coarsen() {
        this.isFine = false;
        if (this.software && !this.immersed && this.renderer.getPixelRatio() !== this.ratio) this.renderer.setPixelRatio(this.ratio);
    }

    setMap(name) {
        showMap(this.uniforms, name);
    }

    draw({ surface, ink, marks }) {
        for (const body of this.bodies) {
            body.setStyle(surface, ink);
            body.surface.material.side = this.software && !this.isFine ? body.outside : DoubleSide;
            body.pins.visible = marks;
        }
        this.renderer.render(this.scene, this.camera);
        this.pictures++;
    }

    /* ---- headset ---- */

    // whether a headset draws, see immersive.js
    get immersed() {
        return this.renderer.xr.isPresenting;
    }

    // the camera becomes the eyes in a rig, which goes from metres to the units of the picture
    immerse(rig, background) {
        const { fov, position, quaternion, scale } = this.camera;
        this.outer = { fov, position: position.clone(), quaternion: quaternion.clone(), scale: scale.clone() };
        this.rig = rig;
        this.scene.background = background;
        this.scene.add(rig.add(this.camera));
    }

    emerge() {
        this.scene.remove(this.rig.remove(this.camera));
        this.scene.background = this.rig = null;
        this.camera.fov = this.outer.fov;
        for (const part of ["position", "quaternion", "scale"]) this.camera[part].copy(this.outer[part]);
        this.resize();
    }

    /* ---- rays ---- */

    // the point that the pointer of a headset holds on its ray
    static held({ origin, direction, reach }) {
        return origin.clone().addScaledVector(direction, reach);
    }

    ray(x, y) {
        const { clientWidth: width, clientHeight: height } = this.canvas;
        this.camera.updateMatrixWorld();
        const direction = new Vector3((x / width) * 2 - 1, 1 - (y / height) * 2, 0.5).unproject(this.camera).sub(this.camera.position).normalize();
        return { origin: this.camera.position.clone(), direction };
    }

    // { body, point, normal toward the eye, place } or null
    pick({ origin, direction }) {
        let best = null;
        this.bodies.forEach((body, b) => {
            const place = body.corners ? body.hit(origin, direction) : null;
            if (place && (!best || place.distance < best.place.distance)) best = { body: b, place };
        });
        if (!best) return null;
        best.point = origin.clone().addScaledVector(direction, best.place.distance);
        best.normal = best.place.normal.dot(direction) > 0 ? best.place.normal.clone().negate() : best.place.normal;
        return best;
    }

    // { body, point, normal } of a hit on the body as the page first saw it [m]
    atFirst({ body: b, place, normal }) {
        const body = this.bodies[b];
        const isOld = place.corners.every((v) => 3 * v < body.first.length);
        const [x, y, z] = place.corners.map((v) => new Vector3().fromArray(isOld ? body.first : body.positions, 3 * v));
        const across = y.clone().sub(x).cross(z.clone().sub(x)).normalize();
        if (place.normal.dot(normal) < 0) across.negate();
        const point = x.multiplyScalar(place.weights[0]).addScaledVector(y, place.weights[1]).addScaledVector(z, place.weights[2]);
        return { body: b, point: this.outward(point), normal: across.toArray() };
    }

    // intersection of the ray with the plane of the circle's height, moved up by `lift` along its axis; or what the ray holds
    onCircle(ray, lift) {
        const { origin, direction } = ray;
        const { axis, place } = this.circle;
        if (ray.reach > 0) return Stage.held(ray);
        const way = (place.clone().sub(origin).dot(axis) + lift) / direction.dot(axis);
        return origin.clone().addScaledVector(direction, way);
    }

    // intersection of the ray with the plane through a point, parallel to the picture; or what the ray holds
    onPlane(ray, point) {
        const { origin, direction } = ray;
        if (ray.reach > 0) return Stage.held(ray);
        const normal = this.camera.getWorldDirection(new Vector3());
        const way = point.clone().sub(origin).dot(normal) / direction.dot(normal);
        return origin.clone().addScaledVector(direction, way);
    }

    // position of a point on the canvas [pixels]
    project(point) {
        this.camera.updateMatrixWorld();
        const at = point.clone().project(this.camera);
        return { x: ((at.x + 1) / 2) * this.canvas.clientWidth, y: ((1 - at.y) / 2) * this.canvas.clientHeight };
    }

    // rotation that turns the x axis to the direction and the z axis to the normal, a unit vector
    static along(direction, normal) {
        const x = direction.clone().addScaledVector(normal, -direction.dot(normal)).normalize();
        return new Quaternion().setFromRotationMatrix(new Matrix4().makeBasis(x, normal.clone().cross(x), normal));
    }

    // rotation that turns the z axis to the direction
    static facing(direction) {
        return new Quaternion().setFromUnitVectors(new Vector3(0, 0, 1), direction);
    }
}
