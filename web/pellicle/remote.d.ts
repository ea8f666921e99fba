// Types of pellicle/remote.js: a simulation in a worker.
import type { SceneOptions, Simulation } from "./pellicle.js";

type Remote<Method> = Method extends (...values: infer Values) => infer Result ? (...values: Values) => Promise<Result> : never;
type Methods = "step" | "positions" | "triangles" | "field" | "summary" | "pick" | "tips" | "apply" | "parameters" | "set" | "grab" | "grasp" | "press" | "move" | "release" | "pin" | "unpin" | "cut" | "inflate" | "mark" | "undo" | "reset" | "scene" | "surfaceRevision";

export type RemoteSimulation = { [Name in Methods]: Remote<Simulation[Name]> } & {
    /** a property such as "time", "bodies" or "hash" */
    get(property: string): Promise<any>;
    /** steps, then copies of positions of bodies and of fields [name, body], in one message */
    advance(what: { count: number; positions?: (string | number)[]; fields?: [string, string | number][] }): Promise<{ time: number; positions: Float32Array[]; fields: Float32Array[] }>;
    dispose(): Promise<void>;
};

export function remote(worker?: unknown): Promise<{
    simulation(scene: string, options?: SceneOptions): Promise<RemoteSimulation>;
    close(): void;
}>;
