// Types of pellicle/three.js. The geometries are those of three.js.
import type { Simulation } from "./pellicle.js";

export interface Source<Geometry> {
    geometry: Geometry;
    /** vertex of the mesh file for each vertex of the geometry */
    vertices: Uint32Array;
}

/** Text of an OBJ file with the triangles of a geometry. Vertices at the same place are one. */
export function fromThree(geometry: object): { obj: string; vertices: Uint32Array };

/** A geometry that follows a body of a simulation. Call update() after steps. With `source` it keeps texture coordinates, colours and groups. */
export function toThree<Geometry extends object>(
    three: { BufferAttribute: new (...values: any[]) => any; BufferGeometry: new () => Geometry },
    simulation: Pick<Simulation, "positions" | "triangles" | "surfaceRevision">,
    body?: string | number,
    source?: Source<Geometry> | null,
): { geometry: Geometry; update(): void };
