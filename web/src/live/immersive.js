// The bodies in a headset, or in the camera picture of a phone (WebXR Device API, W3C): they stand before the eyes, and controllers,
// hands or a finger use the tool of the page in all directions of space.
import { BufferGeometry, CanvasTexture, Color, Group, Line, LineBasicMaterial, Matrix4, Mesh, MeshBasicMaterial, Quaternion, SphereGeometry, Sprite, SpriteMaterial, Vector3 } from "three";
import { firstView } from "../view.js";

// half the size of the bodies, their distance from the eyes and how far they are below them [m]
const stand = { half: 0.25, away: 0.6, below: 0.2 };
// dead zone of a stick; speed of turning [rad/s] and of scaling [factor per s]
const stick = { dead: 0.2, turn: 1.2, scale: 2 };
// seconds between two texts of a label and between two pulses
const pauses = { text: 0.1, pulse: 0.04 };

// the kinds of session that this browser and its devices have, with their names
export async function immersiveKinds() {
    const known = [
        ["immersive-vr", "VR"],
        ["immersive-ar", "AR"],
    ];
    const has = await Promise.all(known.map(([kind]) => navigator.xr?.isSessionSupported(kind).catch(() => false) ?? false));
    return known.filter((_, i) => has[i]);
}

// a text that stands in space
class Label {
    constructor() {
        this.canvas = document.createElement("canvas");
        Object.assign(this.canvas, { width: 512, height: 64 });
        this.texture = new CanvasTexture(this.canvas);
        this.object = new Sprite(new SpriteMaterial({ map: this.texture, depthTest: false }));
        this.object.scale.set(0.16, 0.02, 1);
        this.object.position.set(0, 0.03, -0.02);
        this.object.renderOrder = 3;
    }

    show(text) {
        if (text === this.text) return;
        this.text = text;
        const pen = this.canvas.getContext("2d");
        pen.clearRect(0, 0, this.canvas.width, this.canvas.height);
        Object.assign(pen, { font: "600 40px system-ui, sans-serif", textAlign: "center", textBaseline: "middle", lineWidth: 8, strokeStyle: "#000", fillStyle: "#fff" });
        pen.strokeText(text, 256, 32);
        pen.fillText(text, 256, 32);
        this.texture.needsUpdate = true;
    }

    dispose() {
        this.texture.dispose();
        this.object.material.dispose();
    }
}

// a controller, a hand or a finger: its ray, the mark where it meets a body, its label and its buttons
class Pointer {
    constructor(group) {
        this.group = group;
        this.source = null; // null = not there
        this.acts = false; // the tool of the page is in use
        this.reach = 0; // distance of what it holds, in the units of the picture
        this.grip = null; // while it carries the bodies
        this.pressed = {};
        this.line = new Line(new BufferGeometry().setFromPoints([new Vector3(), new Vector3(0, 0, -1)]), new LineBasicMaterial({ color: "#8fb4e8", transparent: true, opacity: 0.7 }));
        this.mark = new Mesh(new SphereGeometry(0.004, 16, 12), new MeshBasicMaterial({ color: "#1d6fd1", depthTest: false }));
        this.mark.renderOrder = 2;
        this.label = new Label();
        group.add(this.line, this.mark, this.label.object);
    }

    ray() {
        const origin = new Vector3().setFromMatrixPosition(this.group.matrixWorld);
        const direction = new Vector3(0, 0, -1).transformDirection(this.group.matrixWorld);
        return { origin, direction, reach: this.acts ? this.reach : 0 };
    }

    // distance [m] of what the ray meets, Infinity for nothing
    point(distance) {
        const isScreen = this.source.targetRayMode === "screen";
        this.line.visible = !isScreen;
        this.label.object.visible = !isScreen;
        this.line.scale.z = Math.min(distance, 2);
        this.mark.visible = !isScreen && distance < Infinity;
        this.mark.position.z = -Math.min(distance, 2);
    }

    dispose() {
        this.group.remove(this.line, this.mark, this.label.object);
        for (const object of [this.line, this.mark]) {
            object.geometry.dispose();
            object.material.dispose();
        }
        this.label.dispose();
    }
}

export class Immersive {
    // uses: begin(ray) gives the hit or null, move(ray, squeeze), end(), undo(), next(), label() and strength() (0 to 1) of the force,
    // tick(now) draws, background() of a session that shows nothing of the room, ended()
    constructor(stage, uses) {
        this.stage = stage;
        this.uses = uses;
        this.rig = new Group(); // from metres before the eyes to the units of the picture
        this.pointers = [];
        this.last = { now: 0, text: 0, pulse: 0 };
        stage.renderer.xr.addEventListener("sessionend", () => this.end());
    }

    // starts a session, or ends the one that runs
    async toggle(kind) {
        const { xr } = this.stage.renderer;
        if (xr.isPresenting) return xr.getSession().end();
        const session = await navigator.xr.requestSession(kind, { optionalFeatures: ["hand-tracking"] });
        xr.enabled = true;
        xr.setReferenceSpaceType("local");
        await xr.setSession(session);
        this.away = this.stage.camera.position.clone().sub(this.stage.controls.target);
        this.isPlaced = false;
        this.pointers = [0, 1].map((i) => this.makePointer(xr.getController(i)));
        this.stage.immerse(this.rig, kind === "immersive-vr" ? new Color(this.uses.background()) : null);
        this.stage.renderer.setAnimationLoop((now, frame) => frame && this.frame(now, frame));
    }

    end() {
        const { renderer } = this.stage;
        renderer.setAnimationLoop(null);
        renderer.xr.enabled = false;
        for (const pointer of this.pointers) {
            this.release(pointer);
            for (const [name, listener] of Object.entries(pointer.listeners)) pointer.group.removeEventListener(name, listener);
            this.rig.remove(pointer.group);
            pointer.dispose();
        }
        this.pointers = [];
        this.stage.emerge();
        this.uses.ended();
    }

    makePointer(group) {
        const pointer = new Pointer(group);
        pointer.listeners = {
            connected: ({ data }) => (pointer.source = data),
            disconnected: () => {
                this.release(pointer);
                pointer.grip = pointer.source = null;
            },
            selectstart: () => this.take(pointer),
            selectend: () => this.release(pointer),
            squeezestart: () => (pointer.grip = this.carried(pointer)),
            squeezeend: () => (pointer.grip = null),
        };
        for (const [name, listener] of Object.entries(pointer.listeners)) group.addEventListener(name, listener);
        this.rig.add(group);
        return pointer;
    }

    take(pointer) {
        if (this.pointers.some(({ acts }) => acts)) return;
        this.rig.updateMatrixWorld(true);
        const hit = this.uses.begin(pointer.ray());
        if (!hit) return;
        pointer.acts = true;
        pointer.reach = hit.place.distance;
    }

    release(pointer) {
        if (pointer.acts) this.uses.end();
        pointer.acts = false;
    }

    // what the rig is seen from a pointer; it stays so while the pointer carries the bodies
    carried(pointer) {
        return new Matrix4().compose(this.rig.position, this.rig.quaternion, this.rig.scale).multiply(pointer.group.matrix);
    }

    setRig(matrix) {
        matrix.decompose(this.rig.position, this.rig.quaternion, this.rig.scale);
    }

    // puts the bodies before the eyes in the next picture
    place() {
        this.isPlaced = false;
    }

    // puts the bodies before the eyes, upright and as the page showed them
    put(pose) {
        const { camera, controls } = this.stage;
        const { position, orientation } = pose.transform;
        const eyes = new Vector3(position.x, position.y, position.z);
        const back = new Vector3(0, 0, 1).applyQuaternion(new Quaternion(orientation.x, orientation.y, orientation.z, orientation.w));
        const up = new Vector3(0, 1, 0);
        const level = (vector, axis, other) => {
            const flat = vector.clone().addScaledVector(axis, -vector.dot(axis));
            return flat.lengthSq() > 1e-4 ? flat.normalize() : other.addScaledVector(axis, -other.dot(axis)).normalize();
        };
        const behind = level(back, up, new Vector3(0, 0, 1));
        const away = level(this.away, camera.up, firstView(camera.up));
        const basis = (axis, z) => new Matrix4().makeBasis(new Vector3().crossVectors(axis, z), axis, z);
        const turn = basis(camera.up, away).multiply(basis(up, behind).transpose());
        const factor = 1 / stand.half;
        const middle = eyes.addScaledVector(behind, -stand.away).addScaledVector(up, -stand.below);
        this.rig.scale.setScalar(factor);
        this.rig.quaternion.setFromRotationMatrix(turn);
        this.rig.position.copy(controls.target).sub(middle.applyQuaternion(this.rig.quaternion).multiplyScalar(factor));
    }

    // turns and scales what is seen about the middle of the bodies
    change(angle, factor) {
        const { target } = this.stage.controls;
        const turn = new Quaternion().setFromAxisAngle(this.stage.camera.up, angle);
        this.rig.position.sub(target).applyQuaternion(turn).divideScalar(factor).add(target);
        this.rig.quaternion.premultiply(turn);
        this.rig.scale.divideScalar(factor);
    }

    readButtons(pointer, seconds) {
        const pad = pointer.source.gamepad;
        if (!pad || pad.mapping !== "xr-standard") return;
        const isDown = (i) => pad.buttons[i]?.pressed ?? false;
        const actions = { 3: () => this.place(), 4: this.uses.undo, 5: this.uses.next };
        for (const [i, act] of Object.entries(actions)) {
            if (isDown(i) && !pointer.pressed[i]) act();
            pointer.pressed[i] = isDown(i);
        }
        const [x, y] = [2, 3].map((axis) => (Math.abs(pad.axes[axis] ?? 0) > stick.dead ? pad.axes[axis] : 0));
        if (x !== 0 || y !== 0) this.change(-x * stick.turn * seconds, stick.scale ** (-y * seconds));
    }

    follow(pointer) {
        if (pointer.grip) this.setRig(pointer.grip.clone().multiply(pointer.group.matrix.clone().invert()));
        this.rig.updateMatrixWorld(true);
        const ray = pointer.ray();
        if (pointer.acts) {
            const squeeze = pointer.source.gamepad?.buttons[0]?.value;
            // a switch has no travel that could set a depth
            this.uses.move(ray, squeeze > 0 && squeeze < 1 ? squeeze : undefined);
            pointer.point(pointer.reach / this.rig.scale.x);
            return;
        }
        const hit = this.stage.pick(ray);
        pointer.point(hit ? hit.place.distance / this.rig.scale.x : Infinity);
    }

    // the force in the hand and beside it
    tell(pointer, now) {
        if (now - this.last.text > 1000 * pauses.text) pointer.label.show(this.uses.label(pointer.acts));
        const strength = pointer.acts ? this.uses.strength() : 0;
        const motor = pointer.source.gamepad?.hapticActuators?.[0];
        if (strength > 0.02 && motor && now - this.last.pulse > 1000 * pauses.pulse) {
            motor.pulse(strength, 1000 * pauses.pulse);
            this.last.pulse = now;
        }
    }

    frame(now, frame) {
        const { xr } = this.stage.renderer;
        const pose = frame.getViewerPose(xr.getReferenceSpace());
        const seconds = Math.min((now - this.last.now) / 1000, 0.1);
        this.last.now = now;
        if (!this.isPlaced && pose) {
            this.put(pose);
            this.isPlaced = true;
        }
        for (const pointer of this.pointers) {
            if (!pointer.source || !pointer.group.visible) continue;
            this.readButtons(pointer, seconds);
            this.follow(pointer);
            this.tell(pointer, now);
        }
        if (now - this.last.text > 1000 * pauses.text) this.last.text = now;
        this.uses.tick(now);
    }
}
