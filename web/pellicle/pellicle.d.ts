// Types of the package `pellicle`. SI units. Vectors are arrays of three numbers; rotations are unit quaternions x, y, z, w.

export type Vector = readonly [number, number, number] | ArrayLike<number>;
export type Quaternion = readonly [number, number, number, number] | ArrayLike<number>;
/** A value of a parameter: NaN or "auto" for `auto`, strings for words, arrays for vectors. */
export type Value = number | boolean | string | ArrayLike<number>;

/** An error of the library with problem, place and remedy; `message` contains all of them. */
export class PellicleError extends Error {
    /** "bad scene", "bad argument", "diverged", ... */
    readonly status: string;
    readonly what: string;
    readonly remedy: string;
    /** name of the file, as the caller named it; "" = none */
    readonly file: string;
    /** from 1; 0 = none */
    readonly line: number;
    readonly column: number;
}

export interface SceneOptions {
    /** Mesh files of the scene as text or bytes. The keys are their paths in the scene. */
    files?: Record<string, string | Uint8Array | ArrayBuffer>;
    /** Name of the scene in messages; mesh paths are relative to its folder. Default: scene.yaml */
    path?: string;
    /** Changes of the scene, like `--set` of the program: { "solver.dt": 0.005 } */
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
    /** true: it can change while the simulation runs; false: `refusal` has the reason, `remedy` what to do instead */
    readonly live: boolean;
    readonly refusal: string;
    readonly remedy: string;
    /** default and present value: null = auto; for a word its index in `words`, for a switch 0 or 1 */
    readonly preset: readonly (number | null)[];
    readonly value: readonly (number | null)[];
    readonly words?: readonly string[];
}

/** the end of a cut or tear inside the surface */
export interface Tip {
    /** index into `bodies` */
    readonly body: number;
    readonly vertex: number;
    /** m */
    readonly position: readonly number[];
    /** unit length, in the rest shape */
    readonly ahead: readonly number[];
    /** N, configurational force in the rest shape */
    readonly force: readonly number[];
    /** N, its magnitude */
    readonly release: number;
    /** J/m2; NaN for springs without thickness */
    readonly rate: number;
}

export interface Hit {
    /** index into `bodies` */
    readonly body: number;
    /** row of `triangles` */
    readonly triangle: number;
    /** nearest vertex of the body's mesh */
    readonly meshVertex: number;
    /** m, along the ray */
    readonly distance: number;
    /** m */
    readonly point: readonly number[];
    /** of the triangle, unit length */
    readonly normal: readonly number[];
    /** corners of the triangle as rows of `positions`, and barycentric weights of the point */
    readonly vertices: readonly number[];
    readonly weights: readonly number[];
}

export interface Summary {
    /** s */
    readonly time: number;
    readonly step: number;
    /** of time, positions and velocities, 16 hexadecimal digits */
    readonly hash: string;
    /** the spring of `grab`, the tool of `press` or `grasp`, or the blade of `cut`; lengths in m, force in N */
    readonly hand: {
        readonly kind: "free" | "grab" | "press" | "cut" | "grasp";
        readonly shape: string;
        readonly radius: number;
        readonly point: readonly number[];
        readonly rotation: readonly number[];
        readonly target: readonly number[];
        readonly force: readonly number[];
    };
    /** position in m, force in N */
    readonly tools: readonly { name: string; position: readonly number[]; rotation: readonly number[]; force: readonly number[] }[];
    /** energies and works in J, displacement in m */
    readonly measures: {
        readonly volume: number | null;
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
    /** If the surface may open: length in m, energy in J, release in N, rate in J/m2. */
    readonly tear?: {
        readonly length: number;
        readonly fracture_energy: number;
        readonly islands: number;
        readonly tips: readonly { position: readonly number[]; release: number; rate: number | null }[];
    };
    /** If forceps of the scene lead a tear: the hole around their axis and the forces (pel_score of pellicle/session.h); SI units. */
    readonly score?: {
        readonly whole: boolean;
        readonly aim: number;
        readonly along: readonly number[];
        readonly across: readonly number[];
        readonly radius: readonly number[];
        readonly swept: number;
        readonly diameter: number;
        readonly offset: number | null;
        readonly roundness: number | null;
        readonly run_outs: number;
        readonly force_peak: number;
        readonly force_rms: number;
        readonly time: number;
        readonly touches: number;
    };
}

/** Of the center of mass of a rigid body. */
export interface RigidReading {
    /** kg */
    readonly mass: number;
    /** m */
    readonly center: readonly number[];
    /** unit quaternion (x, y, z, w) from the rest shape to now */
    readonly rotation: readonly number[];
    /** m/s */
    readonly velocity: readonly number[];
    /** rad/s */
    readonly spin: readonly number[];
    /** N s */
    readonly momentum: readonly number[];
    /** N m s, about the center */
    readonly angularMomentum: readonly number[];
    /** J */
    readonly kineticEnergy: number;
}

/** What a joint does on its body, in the mean of the last step, and its motor since the start. */
export interface JointReading {
    /** rad of a hinge, m of a slider, else 0 */
    readonly position: number;
    /** rad/s or m/s */
    readonly speed: number;
    /** N, motor included */
    readonly force: readonly number[];
    /** N m, about the point of the joint, motor included */
    readonly torque: readonly number[];
    /** N m or N, of the motor or the limit along the axis */
    readonly load: number;
    /** J */
    readonly work: number;
}

/**
 * A simulation of a scene. If the library refuses a call, the method throws a PellicleError and the simulation is unchanged.
 * The arrays of `positions`, `triangles` and `field` are views of the memory of the module without a copy. They are valid until
 * the next call of any function of the package; copy them with `slice()` to keep them.
 */
export interface Simulation {
    readonly title: string;
    /** s */
    readonly dt: number;
    readonly bodies: readonly Body[];
    readonly fields: readonly Field[];
    /** bounding box of all bodies at rest, m */
    readonly box: { readonly low: readonly number[]; readonly high: readonly number[] };
    /** changes that were made while meshes were read, such as split quads */
    readonly notes: readonly string[];
    /** s */
    readonly time: number;
    readonly stepCount: number;
    /** equal to that of the native program in the same state (exceptions: docs/javascript.md) */
    readonly hash: string;
    summary(): Summary;

    /** (vertexCount x 3), m. `body` is a number or a name; default: 0. */
    positions(body?: number | string): Float32Array;
    /** (triangleCount x 3), rows of `positions` */
    triangles(body?: number | string): Uint32Array;
    /** increases when the triangles change (refinement, cuts) */
    surfaceRevision(body?: number | string): number;
    /** (vertexCount x components) */
    field(name: string, body?: number | string): Float32Array;
    /** First intersection of a ray with a body, origin in m; null if the ray meets no body. */
    pick(origin: Vector, direction: Vector): Hit | null;

    /** The ends of cuts and tears inside the surface of a body, and in bodies that tear its sharp notches. */
    tips(body?: number | string): readonly Tip[];

    /** Place and motion of a rigid body; null for a body that deforms. */
    rigid(body?: number | string): RigidReading | null;
    /** What a joint does, by its name; null if none has it. */
    joint(name: string): JointReading | null;

    /** Takes `count` steps (default: 1). If a step diverges, the simulation returns to the last mark, or to the start. */
    step(count?: number): void;
    parameters(): readonly Parameter[];
    /** Changes a parameter while the simulation runs: set("bodies.ball.membrane.young", 2e4). */
    set(path: string, value: Value): void;
    /**
     * Holds the surface by a spring of `stiffness` [N/m] at the point where a ray meets it, on the vertices within `reach` [m].
     * False: the ray meets no body.
     */
    grab(origin: Vector, direction: Vector, options?: { stiffness?: number; reach?: number }): boolean;
    /**
     * Forceps: holds one connected patch of the surface within `reach` [m] of where a ray meets it, and goes where `move` asks. With `anew`,
     * where forceps of the scene lead a tear, it grasps the flap anew behind the tip. False: the ray meets no body.
     */
    grasp(origin: Vector, direction: Vector, options?: { reach?: number; anew?: boolean }): boolean;
    /**
     * Adds a tool that `move` moves: sphere, box (half edge `radius`), capsule (half length 2 `radius`), blade or hook (edge from -`radius` to
     * `radius` along its z axis), scissors (2 `radius` long along x, closing within 0.25 s); lengths in m.
     */
    press(options: { shape?: "sphere" | "capsule" | "box" | "blade" | "hook" | "scissors"; radius: number; position: Vector; rotation?: Quaternion }): void;
    /** Sets the target [m] of the end of the spring, or of the tool. */
    move(target: Vector): void;
    /** Releases the surface, or removes the tool. */
    release(): void;
    /** Pins the vertices within `reach` [m] of the hit at their present positions; `unpin` releases them. */
    pin(origin: Vector, direction: Vector, reach?: number): void;
    unpin(origin: Vector, direction: Vector, reach?: number): void;
    /** The first call sets a blade where the ray meets a body, further ones lead it there: the surface opens until `release`. */
    cut(origin: Vector, direction: Vector): void;
    /** Sets a pressure [Pa] along the normals of a body, in addition to that of the scene. */
    inflate(body: number | string, pressure: number): void;
    /** Marks the start of an interaction: `undo` returns here. */
    mark(): void;
    /** Returns to the last mark. False: there was no mark, and the simulation is at its start. */
    undo(): boolean;
    /** Returns to the start. */
    reset(): void;
    /** Executes a command of a session, as text (pellicle/session.h). */
    apply(line: string): void;
    /** The scene with all commands as its `session`: `pellicle run` repeats them. */
    scene(): string;
    /** Frees the memory of the simulation; all further calls throw. */
    dispose(): void;
}

/** A simulation that runs in real time and uses the messages of the page of `pellicle live`. */
export interface Live {
    send(line: string): void;
    /** Executes the steps that are due; returns the time until the next turn [s]. */
    turn(): number;
    dispose(): void;
}

export interface Pellicle {
    /** Reads a scene (YAML or JSON). Throws a PellicleError with file, line and column if it is refused. */
    simulation(scene: string, options?: SceneOptions): Simulation;
    live(scene: string, options: SceneOptions, receive: (message: string | ArrayBuffer) => void): Live;
    /** Size of the module's memory. It grows with simulations, and is small again soon after the last one of a large module was disposed or refused. */
    readonly memoryBytes: number;
}

/** Loads the module. source: bytes of core.wasm or its URL; default: the file of the package. */
export function load(source?: string | URL | ArrayBuffer | ArrayBufferView): Promise<Pellicle>;
