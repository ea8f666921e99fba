// Types of the package `pellicle`. SI units. Vectors are arrays of three numbers, rotations quaternions x, y, z, w.

export type Vector = readonly [number, number, number] | ArrayLike<number>;
export type Quaternion = readonly [number, number, number, number] | ArrayLike<number>;
/** `auto` is NaN or "auto"; words are strings; vectors arrays. */
export type Value = number | boolean | string | ArrayLike<number>;

/** What went wrong, where, and what to do about it; `message` is all of it as one text. */
export class PellicleError extends Error {
    /** "bad scene", "bad argument", "diverged", ... */
    readonly status: string;
    readonly what: string;
    readonly remedy: string;
    /** as the caller named it; "" = none */
    readonly file: string;
    /** from 1; 0 = none */
    readonly line: number;
    readonly column: number;
}

export interface SceneOptions {
    /** Mesh files of the scene, by the paths that the scene uses: text or bytes. */
    files?: Record<string, string | Uint8Array | ArrayBuffer>;
    /** Name of the scene in messages; mesh paths are relative to its folder. Default: scene.yaml */
    path?: string;
    /** Changes to the scene, as `--set` of the program: { "solver.dt": 0.005 } */
    set?: Record<string, Value>;
}

export interface Body {
    readonly name: string;
    readonly closed: boolean;
    readonly vertexCount: number;
    readonly triangleCount: number;
}

export interface Field {
    readonly name: string;
    /** "" = none */
    readonly unit: string;
    /** 1; 2 = principal values; 3 = vector; 6 = tensor xx, yy, zz, xy, yz, xz */
    readonly components: 1 | 2 | 3 | 6;
    readonly doc: string;
}

export interface Parameter {
    readonly path: string;
    readonly row: string;
    readonly kind: "number" | "integer" | "switch" | "word" | "vector";
    readonly unit: string;
    /** null = no bound */
    readonly least: number | null;
    readonly most: number | null;
    readonly open: boolean;
    readonly auto: boolean;
    readonly keyed: boolean;
    readonly field: boolean;
    /** whether it can change while the simulation runs; else `refusal` and `remedy` say why not and what to do */
    readonly live: boolean;
    readonly refusal: string;
    readonly remedy: string;
    /** null = auto; the index of a word, 0 or 1 of a switch */
    readonly preset: readonly (number | null)[];
    readonly value: readonly (number | null)[];
    readonly words?: readonly string[];
}

export interface Hit {
    /** index into `bodies` */
    readonly body: number;
    /** row of `triangles` */
    readonly triangle: number;
    /** vertex of the mesh as it was given */
    readonly meshVertex: number;
    readonly distance: number;
    readonly point: readonly number[];
    readonly normal: readonly number[];
    /** rows of `positions`, and the barycentric weights */
    readonly vertices: readonly number[];
    readonly weights: readonly number[];
}

export interface Summary {
    readonly time: number;
    readonly step: number;
    /** of the whole state, 16 hexadecimal digits */
    readonly hash: string;
    readonly hand: {
        readonly kind: "free" | "grab" | "press";
        readonly shape: string;
        readonly radius: number;
        readonly point: readonly number[];
        readonly rotation: readonly number[];
        readonly target: readonly number[];
        readonly force: readonly number[];
    };
    readonly tools: readonly { name: string; position: readonly number[]; rotation: readonly number[]; force: readonly number[] }[];
    readonly measures: {
        readonly volume_ratio: number | null;
        readonly area_ratio: number;
        readonly elastic_energy: number;
        readonly kinetic_energy: number;
        readonly max_displacement: number;
        readonly contacts: number;
        readonly work_hand: number;
        readonly dissipated: number;
        readonly energy_error: number;
    };
}

/**
 * A simulation of a scene. Every method throws a PellicleError if the library refuses the call; the simulation is unchanged
 * then. Arrays of `positions`, `triangles` and `field` are views of the memory of the module without a copy: they hold
 * until the next call of anything of the package. Copy them with `slice()` to keep them.
 */
export interface Simulation {
    readonly title: string;
    /** s */
    readonly dt: number;
    readonly bodies: readonly Body[];
    readonly fields: readonly Field[];
    /** the box about all bodies at rest, m */
    readonly box: { readonly low: readonly number[]; readonly high: readonly number[] };
    /** changes made by the mesh reader, such as triangulated quads */
    readonly notes: readonly string[];
    /** s */
    readonly time: number;
    readonly stepCount: number;
    /** equal to the native program's in the same state (exceptions: docs/javascript.md) */
    readonly hash: string;
    summary(): Summary;

    /** (vertexCount x 3), m. `body` is an index or a name, default 0. */
    positions(body?: number | string): Float32Array;
    /** (triangleCount x 3), rows of `positions` */
    triangles(body?: number | string): Uint32Array;
    /** grows when the triangles change (refinement) */
    surfaceRevision(body?: number | string): number;
    /** (vertexCount x components) */
    field(name: string, body?: number | string): Float32Array;
    /** null where the ray meets no body */
    pick(origin: Vector, direction: Vector): Hit | null;

    /** Does `count` steps (default 1). After a step that diverged the simulation is back at the last mark. */
    step(count?: number): void;
    parameters(): readonly Parameter[];
    /** Changes a parameter while the simulation runs: set("bodies.ball.membrane.young", 2e4). */
    set(path: string, value: Value): void;
    /** Takes hold of the surface where a ray meets it, by a spring [N/m] on the vertices within reach [m]. False: no body is met. */
    grab(origin: Vector, direction: Vector, options?: { stiffness?: number; reach?: number }): boolean;
    /** A tool that `move` moves: sphere, box (half edge `radius`) or capsule (half length 2 `radius`). */
    press(options: { shape?: "sphere" | "capsule" | "box"; radius: number; position: Vector; rotation?: Quaternion }): void;
    /** where the hand goes: the end of the spring, or the tool */
    move(target: Vector): void;
    release(): void;
    /** Holds the vertices within reach [m] of the hit where they are; `unpin` releases them. */
    pin(origin: Vector, direction: Vector, reach?: number): void;
    unpin(origin: Vector, direction: Vector, reach?: number): void;
    /** pressure [Pa] along the normals of a body */
    inflate(body: number | string, pressure: number): void;
    /** the begin of an interaction: `undo` goes back to here */
    mark(): void;
    /** False: no mark was left, and the simulation is back at its start. */
    undo(): boolean;
    reset(): void;
    /** A command of a session as text (pellicle/session.h). */
    apply(line: string): void;
    /** The scene with all that was done as its `session`: `pellicle run` repeats it. */
    scene(): string;
    /** Frees its memory; every other call throws then. */
    dispose(): void;
}

/** A simulation at the pace of the clock that speaks the messages of the page of `pellicle live`. */
export interface Live {
    send(line: string): void;
    /** Executes due steps and returns the seconds until the next turn. */
    turn(): number;
    dispose(): void;
}

export interface Pellicle {
    /** Reads a scene (YAML or JSON); throws a PellicleError with file, line and column. */
    simulation(scene: string, options?: SceneOptions): Simulation;
    live(scene: string, options: SceneOptions, receive: (message: string | ArrayBuffer) => void): Live;
}

/** Loads the module; source: bytes of core.wasm or its address, default: the file of the package. */
export function load(source?: string | URL | ArrayBuffer | ArrayBufferView): Promise<Pellicle>;
