"""Scenes and simulations."""

from __future__ import annotations

import difflib
import json
import os
import tempfile
from typing import Any, Mapping, Optional, Union

import numpy as np

from . import _core, _places
from ._arrays import from_bytes, indices, numbers, room
from .mesh import Mesh, PathLike

Source = Union[PathLike, Mapping[str, Any]]
_FIELD = {row[0]: number for number, row in enumerate(_core.FIELDS)}
_NUMBER = {row[0]: number for number, row in enumerate(_core.ARRAYS)}
_POSITIONS = _NUMBER["positions"]
_CONTACT = np.dtype(
    [
        ("bodies", np.int32, 2),
        ("tool", np.int32),
        ("vertices", np.int32, 4),
        ("weights", np.float64, 4),
        ("point", np.float64, 3),
        ("normal", np.float64, 3),
        ("force", np.float64, 3),
        ("gap", np.float64),
    ],
    align=True,
)

# pel_tip
_TIP = np.dtype(
    [
        ("body", np.int32),
        ("vertex", np.int32),
        ("position", np.float64, 3),
        ("ahead", np.float64, 3),
        ("force", np.float64, 3),
        ("release", np.float64),
        ("rate", np.float64),
    ],
    align=True,
)
_MATERIAL = ("young", "thickness", "poisson", "bending", "pressure", "volume")


def _plain(value: Any) -> Any:
    """Convert numpy numbers, arrays, paths and ranges to values that JSON can contain."""
    if isinstance(value, np.ndarray):
        return value.tolist()
    if isinstance(value, np.generic):
        return value.item()
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    if isinstance(value, range):
        return list(value)
    if isinstance(value, Mesh):
        raise TypeError("scene: a Mesh is not supported here. write it to a file and give {'file': path}")
    raise TypeError(
        f"scene: a value of the type {type(value).__name__} is not supported. use numbers, str, bool, None, lists and dicts"
    )


def _override(path: str, value: Any) -> str:
    if not isinstance(path, str):
        raise TypeError(f"overrides: the path {path!r} must be a str such as 'bodies.ball.membrane.young'")
    return f"{path}={value if isinstance(value, str) else json.dumps(value, default=_plain)}"


def _keep_meshes(spec: Any, folder: str, place: str) -> Any:
    """A copy of a scene's dict with each Mesh replaced by a file in `folder`."""
    if isinstance(spec, Mesh):
        path = os.path.join(folder, f"{place}.ply")
        spec.write(path)
        return {"file": path}
    if isinstance(spec, Mapping):
        return {key: _keep_meshes(value, folder, f"{place}-{key}".strip("-")) for key, value in spec.items()}
    if isinstance(spec, (list, tuple)):
        return [_keep_meshes(value, folder, f"{place}-{number}") for number, value in enumerate(spec)]
    return spec


def _has_mesh(spec: Any) -> bool:
    if isinstance(spec, Mapping):
        return any(map(_has_mesh, spec.values()))
    return isinstance(spec, Mesh) or isinstance(spec, (list, tuple)) and any(map(_has_mesh, spec))


class Scene:
    """A scene, read and validated: bodies, solver, loads, tools and output.

    Parameters
    ----------
    source : path or mapping
        The path of a scene file, the name of an installed scene such as ``"balloon"``, or a dict with the keys of a scene file (docs/reference/scene.md). In a dict the value of
        ``mesh`` may be a `Mesh`, and ``version`` and ``duration`` may be omitted (default of ``duration``: 1 s).
    overrides : mapping of str to value, optional
        Changes such as ``{"solver.dt": 0.001, "bodies.ball.membrane.young": 2e4}``.

    Attributes
    ----------
    title : str
    bodies, loads : tuple of str
        Names, in the order of the scene.
    duration, dt : float
        Simulated time and time step [s].
    notes : tuple of str
        Changes that were made while meshes were read.

    Raises
    ------
    Error
        An unknown key, a value out of range, or a mesh that cannot be read. The error has file, line, column and remedy.

    Notes
    -----
    The model (topology, masses, materials) is built once. All simulations of a scene share it, also in several threads.
    """

    def __init__(self, source: Source, overrides: Optional[Mapping[str, Any]] = None) -> None:
        self._source = source
        self._overrides = dict(overrides or {})
        notes: list[str] = []
        texts = tuple(_override(path, value) for path, value in self._overrides.items())
        if isinstance(source, Mapping):
            self._core = _parse(source, texts, notes)
        else:
            self._core = _core.Scene(_places.scene(os.fspath(source)), None, texts, notes)
        info = self._core.info()
        self.title: str = info["title"]
        self.bodies: tuple[str, ...] = info["bodies"]
        self.loads: tuple[str, ...] = info["loads"]
        self.duration: float = info["duration"]
        self.dt: float = info["dt"]
        self._is_static: bool = info["is_static"]
        self.notes: tuple[str, ...] = tuple(notes)

    def text(self) -> str:
        """The scene as YAML, with the values of all defaults."""
        return self._core.text()

    def prepare(self) -> "Scene":
        """Build the model now, and return the scene. Call this before several threads create simulations of the scene."""
        self._core.prepare()
        return self

    def simulation(self, threads: int = 0, record_contacts: bool = False, **solver: Any) -> "Simulation":
        """A new simulation of the scene's model.

        Parameters
        ----------
        threads : int
            Threads of a step; 0: the number of the scene (default: all processors). The results do not depend on it. Use 1 if
            many simulations run at the same time.
        record_contacts : bool
            Record the contacts of each step for `Simulation.contact_records`.
        **solver
            Keys of ``solver`` with other values than in the scene: ``scene.simulation(dt=0.001)``.
        """
        if not isinstance(threads, int) or not 0 <= threads < 2**15:
            raise ValueError(f"threads: must be an integer within 0 .. 32767, not {threads!r}")
        self._core.prepare()
        other = self
        if solver:
            other = Scene(self._source, {**self._overrides, **{f"solver.{key}": value for key, value in solver.items()}})
        return Simulation(self, self._core.simulation(other._core, threads, record_contacts))

    def __repr__(self) -> str:
        return f"<Scene {self.title!r}: {', '.join(self.bodies)}>"


def _parse(source: Mapping[str, Any], overrides: tuple[str, ...], notes: list[str]) -> Any:
    """A scene from a dict. Meshes pass through temporary files, which keep every bit of the positions."""
    spec = {"version": 1, **({} if "stop" in source else {"duration": 1}), **source}
    if not _has_mesh(spec):
        return _core.Scene("scene", json.dumps(spec, default=_plain, indent=1), overrides, notes)
    with tempfile.TemporaryDirectory(prefix="pellicle-") as folder:
        spec = _keep_meshes(spec, folder, "")
        return _core.Scene("scene", json.dumps(spec, default=_plain, indent=1), overrides, notes)


def load_scene(
    path: Source,
    overrides: Optional[Mapping[str, Any]] = None,
    threads: int = 0,
    record_contacts: bool = False,
) -> "Simulation":
    """A simulation of a scene file or dict.

    Short form of ``Scene(path, overrides).simulation(threads, record_contacts)``.
    """
    return Scene(path, overrides).simulation(threads, record_contacts)


def _ray(origin: Any, direction: Any) -> np.ndarray:
    return np.concatenate([numbers(origin, "origin", (3,)), numbers(direction, "direction", (3,))])


class Drag:
    """A spring that holds vertices of a surface, created by `Simulation.drag`. The end of ``with`` releases them."""

    def __init__(self, core: Any) -> None:
        self._core = core

    def move(self, target: Any) -> None:
        """Set the position of the free end of the spring [m]. Call this before each step."""
        self._core.move(numbers(target, "target", (3,)))

    def read(self) -> dict[str, Any]:
        """State of the spring.

        Returns
        -------
        dict
            point: the held point of the surface [m]; target: the free end of the spring [m]; force: of the spring on the surface
            [N]; reaction: of the surface on the spring in the last step [N]; held_count: number of held vertices.
        """
        return self._core.read()

    def end(self) -> None:
        """Release the vertices. Further calls have no effect."""
        self._core.end()

    def __enter__(self) -> "Drag":
        return self

    def __exit__(self, *unused: Any) -> None:
        self.end()


class Simulation:
    """A simulation: the state of a model under loads and tools, created by `Scene.simulation` or `load_scene`.

    ``body`` is the name of a body, or its number from 0 in the order of the scene. Arrays are float64 copies with one row per
    vertex, in the order of the body's mesh. With ``out=array`` an existing array is filled. The library stores vertices in
    another order, so views without a copy are not possible (``bench/bench_python.py`` measures the time of a copy).

    Only one thread at a time may use a simulation: calls from a second thread during a step raise RuntimeError. Other Python
    threads run during steps.
    """

    def __init__(self, scene: Scene, core: Any) -> None:
        self.scene = scene
        self._core = core

    # ---- names ----

    @staticmethod
    def _find(name: Union[int, str], names: tuple[str, ...], what: str) -> int:
        if isinstance(name, str):
            if name in names:
                return names.index(name)
            known = ", ".join(map(repr, names))
            advice = f". use one of {known}" if known else " (the scene has none)"
            raise KeyError(f"{what}: there is no {what} {name!r}{advice}")
        return name

    # ---- time ----

    def step(self, n: int = 1) -> None:
        """Take `n` steps of the time step ``dt``.

        Raises
        ------
        Error
            A step failed, for example because the state diverged. The simulation has the state before this step.
        """
        self._core.step(n)

    def run_until(self, time: float) -> None:
        """Take steps until the simulated time is at least `time` [s]."""
        remaining = (float(time) - self.time) / self.scene.dt
        if not np.isfinite(remaining):
            raise ValueError("time: must be finite")
        self._core.step(max(0, int(np.ceil(remaining - 1e-9))))

    @property
    def time(self) -> float:
        """Simulated time [s]."""
        return self._core.time()

    @property
    def steps(self) -> int:
        """Number of steps since the start."""
        return self._core.state()[1]

    @property
    def hash(self) -> int:
        """64-bit hash of time, positions and velocities. States with the same bits have the same hash."""
        return self._core.hash()

    # ---- arrays ----

    def positions(self, body: Union[int, str] = 0, out: Optional[np.ndarray] = None) -> np.ndarray:
        """Positions (vertex_count, 3) [m]."""
        return self._core.get(_POSITIONS, body, out)

    def velocities(self, body: Union[int, str] = 0, out: Optional[np.ndarray] = None) -> np.ndarray:
        """Velocities in the last step (vertex_count, 3) [m/s]."""
        return self._core.get(_NUMBER["velocities"], body, out)

    def forces(self, body: Union[int, str] = 0, out: Optional[np.ndarray] = None) -> np.ndarray:
        """Forces on the vertices (vertex_count, 3) [N]: springs, shell, pressure, damping, loads and gravity, without contact."""
        return self._core.get(_NUMBER["forces"], body, out)

    def rest_positions(self, body: Union[int, str] = 0, out: Optional[np.ndarray] = None) -> np.ndarray:
        """Rest positions (vertex_count, 3) [m]."""
        return self._core.get(_NUMBER["rest_positions"], body, out)

    def masses(self, body: Union[int, str] = 0, out: Optional[np.ndarray] = None) -> np.ndarray:
        """Masses of the vertices (vertex_count,) [kg]."""
        return self._core.get(_NUMBER["masses"], body, out)

    def triangles(self, body: Union[int, str] = 0, out: Optional[np.ndarray] = None) -> np.ndarray:
        """Vertex numbers of the corners of the present triangles (triangle_count, 3), int32."""
        return self._core.get(_NUMBER["triangles"], body, out)

    def mesh(self, body: Union[int, str] = 0) -> Mesh:
        """The present surface of a body."""
        return Mesh(self.positions(body), self.triangles(body))

    def set_positions(self, positions: Any, body: Union[int, str] = 0) -> None:
        """Set the positions of a body (vertex_count, 3) [m]. Velocities do not change."""
        shape = (self._core.counts(body)[0], 3)
        self._core.set(0, body, numbers(positions, "positions", shape))

    def set_velocities(self, velocities: Any, body: Union[int, str] = 0) -> None:
        """Set the velocities of a body (vertex_count, 3) [m/s]."""
        shape = (self._core.counts(body)[0], 3)
        self._core.set(1, body, numbers(velocities, "velocities", shape))

    def field(
        self, body: Union[int, str], name: str, out: Optional[np.ndarray] = None, on: str = "vertices"
    ) -> np.ndarray:
        """The values of a field: (vertex_count,) or (vertex_count, k).

        `pellicle.field_names` lists the fields; docs/reference/scene.md (section "fields") has their meanings and units.

        Parameters
        ----------
        on : {"vertices", "triangles"}
            "triangles" returns one value per triangle, (triangle_count,) or (triangle_count, k). Only some fields, such as
            stress and strain, have values on triangles; other fields raise Error.
        """
        if on not in ("vertices", "triangles"):
            raise ValueError(f"on: must be 'vertices' or 'triangles', not {on!r}")
        if not isinstance(name, str):
            raise TypeError(f"name: must be a str, not {type(name).__name__}")
        number = _FIELD.get(name)
        if number is None:
            near = difflib.get_close_matches(name, _FIELD, 1)
            advice = f"did you mean {near[0]!r}?" if near else "pellicle.field_names lists the fields"
            raise KeyError(f"name: there is no field {name!r}. {advice}")
        return self._core.observe(number, body, on == "triangles", out)

    # ---- loads and tools ----

    @property
    def loads(self) -> tuple[str, ...]:
        """Names of the loads."""
        return self.scene.loads

    @property
    def tools(self) -> tuple[str, ...]:
        """Names of the tools."""
        return self._core.tools()

    def set_load(self, load: Union[int, str], force: Any) -> None:
        """Set the force [N] of a load, from the next step on."""
        number = self._find(load, self.loads, "load")
        self._core.set_load(number, numbers(force, "force", (3,)))

    def set_tool(self, tool: Union[int, str], position: Any, rotation: Any = (0, 0, 0, 1)) -> None:
        """Set the pose of a tool, from the next step on: position [m] and unit quaternion (x, y, z, w).

        The pose replaces the tool's motion from the scene.
        """
        number = self._find(tool, self.tools, "tool")
        pose = np.concatenate([numbers(position, "position", (3,)), numbers(rotation, "rotation", (4,))])
        self._core.set_tool(number, pose)

    def tool(self, tool: Union[int, str]) -> dict[str, Any]:
        """Pose of a tool, force [N] and torque [N m] on it in the last step, and the numbers of touched and held vertices."""
        return self._core.tool(self._find(tool, self.tools, "tool"))

    def support(self, body: Union[int, str] = 0) -> dict[str, Any]:
        """Force [N] and torque about the origin [N m] of a body on its pins and supports."""
        return self._core.support(body)

    def rigid(self, body: Union[int, str] = 0) -> Optional[dict[str, Any]]:
        """Place and motion of a rigid body: mass [kg], center [m], rotation (x, y, z, w), velocity [m/s], spin [rad/s], momentum [N s],
        angular_momentum about the center [N m s] and kinetic_energy [J]; None for a body that deforms."""
        return self._core.rigid(body)

    @property
    def joints(self) -> tuple[str, ...]:
        """Names of the joints of rigid bodies."""
        return self._core.joints()

    def joint(self, joint: Union[int, str]) -> dict[str, Any]:
        """A joint after the last step: position [rad or m] and speed [rad/s or m/s] of a hinge or slider, force [N] and torque about the point
        [N m] on its body, load [N m or N] of motor or limit along the axis, and work [J] of the motor since the start."""
        return self._core.joint(self._find(joint, self.joints, "joint"))

    def set(self, path: str, value: Any) -> None:
        """Set a parameter by its path in the scene, between two steps: ``sim.set("bodies.ball.membrane.young", 2e4)``.

        The simulation continues from the present state with the new value. docs/live.md describes which parameters can change.

        Raises
        ------
        Error
            The path does not exist, the value is out of range, or the parameter cannot change. The simulation is unchanged.
        """
        self._core.set_parameter(*_override(path, value).split("=", 1))

    def set_pins(self, vertices: Any, body: Union[int, str] = 0) -> None:
        """Pin these vertices of the body's mesh at their present positions. They replace all earlier pins; []: no pins."""
        self._core.set_pins(body, indices(vertices, "vertices", (None,)))

    # ---- cuts ----

    def cut(self, vertices: Any, body: Union[int, str] = 0) -> None:
        """Open the surface along edges: these vertices, which edges join, are doubled.

        The path runs through the surface, from a border, between borders, or back to its first vertex. Triangles and vertices
        keep their numbers, and copies come last.

        Raises
        ------
        Error
            No edge joins two of them, one is of the border, nothing opens, a body refines, or the lips would intersect. The
            simulation is unchanged.
        """
        self._core.cut(body, indices(vertices, "vertices", (None,)))

    def origins(self, body: Union[int, str] = 0, out: Optional[np.ndarray] = None) -> np.ndarray:
        """The vertex before all cuts that each vertex is a copy of (vertex_count,), int32; itself if it is none."""
        return self._core.get(_NUMBER["origins"], body, out)

    def tips(self, body: Union[int, str] = 0) -> np.ndarray:
        """The ends of cuts and tears inside the surface, in the order of their vertices; of bodies that tear also sharp notches.

        Returns
        -------
        numpy.ndarray
            Structured array: ``tips["position"]`` has the shape (count, 3). Fields:

            body, vertex: numbers of the body and of its vertex. position (3): at present [m].
            ahead (3): direction of the last edge of the cut, in the rest shape.
            force (3): configurational force in the rest shape, the energy that an advance of the tip releases per length [N].
            release: its magnitude [N]. rate: energy release rate [J/m2], release over the thickness; NaN for springs without one.
        """
        return np.frombuffer(self._core.tips(body), _TIP)

    def score(self) -> Optional[dict[str, Any]]:
        """How a tear goes that tools of the scene lead around an axis (``tools[].grasp.lead``); None if none does.

        Returns
        -------
        dict or None
            Of the hole, in the shape at rest: whole: it has joined itself and the piece has come off. aim: radius of the circle [m].
            radius (72): farthest open edge in each sector [m], 0 where none is open; sector k is around the direction
            cos(a) along + sin(a) across, a = 2 pi (k + 1/2) / 72. swept: angle of the sectors that are open [rad].
            diameter: of the circle with the area of the hole [m]. offset: of its centroid from the axis [m], and roundness, its smallest
            over its largest radius; NaN until all sectors are open. run_outs: places farther out than 1.15 times the circle.
            largest_radius [m].

            Of the tools: force_peak: largest force on one of them so far [N]. force_rms: root of the mean square over the steps
            with a force [N]. time: from the first to the last of these steps [s]. touches: steps in which a tool was at the
            surface on the far side.
        """
        return self._core.score()

    # ---- picking and dragging ----

    def pick(self, origin: Any, direction: Any) -> Optional[dict[str, Any]]:
        """First intersection of a ray with a body: the ray starts at `origin` [m] and runs along `direction`.

        Returns
        -------
        dict or None
            body: number of the body; triangle: number of the triangle; vertices: its corners; weights: barycentric coordinates of
            the point; mesh_vertex: nearest vertex of the body's mesh, for pins and loads; distance: along the ray [m];
            point [m]; normal: of the triangle, unit length. None if the ray meets no body.
        """
        return self._core.pick(_ray(origin, direction))

    def drag(self, origin: Any, direction: Any, stiffness: float, reach: float) -> Optional["Drag"]:
        """Hold the surface by a spring at the point where a ray meets it. None if the ray meets no body.

        Parameters
        ----------
        origin, direction : array_like, (3,)
            The ray, as for `pick`; `origin` in metres.
        stiffness : float
            Stiffness of the spring [N/m].
        reach : float
            The spring holds the vertices within this distance [m] of the point, at least the nearest one.

        Examples
        --------
        >>> with sim.drag([0, 0, 2], [0, 0, -1], stiffness=50, reach=0.1) as drag:
        ...     drag.move([0, 0, 1.2])
        ...     sim.step(100)
        ...     drag.read()["force"]
        """
        made = self._core.drag(_ray(origin, direction), float(stiffness), float(reach))
        return Drag(made) if made is not None else None

    # ---- numbers ----

    def summary(self) -> dict[str, Any]:
        """Measures of the present state.

        Returns
        -------
        dict
            Time [s], number of steps, hash, step size alpha with its stability limit, contact thickness [m], energies [J], ratios
            of volume and area to those at rest, largest displacement [m] and largest force [N].
        """
        time, steps, alpha, alpha_limit, thickness = self._core.state()
        return {
            "time": time,
            "steps": steps,
            "state_hash": f"{self._core.hash():016x}",
            "alpha": alpha,
            "alpha_limit": alpha_limit,
            "contact_thickness": thickness,
            **self._core.measure(),
        }

    def ledger(self) -> dict[str, float]:
        """Energy balance since the start [J]: work, energies, dissipation and the error (docs/results.md)."""
        return self._core.ledger()

    def solver(self) -> dict[str, Any]:
        """Convergence of the last step: iterations, residual [N], whether the step converged, substeps."""
        return self._core.solver()

    def contacts(self) -> dict[str, Any]:
        """Statistics of contact since the start: numbers of pairs, contacts and rounds, and times [s]. Zeros without contact."""
        return self._core.contact()

    def contact_records(self) -> np.ndarray:
        """The contacts with a force in the last step, one row per contact.

        The simulation must have been created with ``record_contacts=True``.

        Returns
        -------
        numpy.ndarray
            Structured array: ``records["force"]`` has the shape (count, 3). Fields:

            bodies (2): numbers of the bodies of the first and the second side. The second is -1 if this side is a tool.
            tool: number of the tool; -1: both sides are bodies.
            vertices (4), weights (4): corners of the touching features, as rows of `positions` of their body; -1: unused.
            Weights above 0 belong to the first side and sum to 1; weights below 0 belong to the second side.
            point (3): contact point on the first side [m]. normal (3): unit vector from the second side to the first.
            force (3): on the first side, mean over the step [N]. The share of each corner is its weight times this force.
            gap: distance of both sides along the normal [m]; negative inside a tool.

        Raises
        ------
        Error
            The simulation does not record contacts.
        """
        records = self._core.contact_records()
        if records is None:
            raise _core.Error("this simulation does not record contacts. create it with record_contacts=True")
        return np.frombuffer(records, _CONTACT)

    def intersections(self) -> int:
        """Number of intersecting pairs of triangles of all bodies and tools (without spheres and capsules), by the exact test."""
        return self._core.intersections()

    # ---- snapshots ----

    def save(self) -> bytes:
        """A snapshot of the state. After `load` the simulation continues with the same bits."""
        return self._core.save()

    def load(self, snapshot: bytes) -> None:
        """Restore a snapshot of a simulation of the same scene, from `save`.

        Raises
        ------
        Error
            The snapshot is damaged or belongs to another scene. The simulation is unchanged.
        """
        if not isinstance(snapshot, bytes):
            raise TypeError(f"snapshot: must be bytes from Simulation.save, not {type(snapshot).__name__}")
        self._core.load(snapshot)

    # ---- potential ----

    def _x(self, x: Any) -> np.ndarray:
        if x is None:
            return np.concatenate([self.positions(body) for body in range(len(self.scene.bodies))])
        count = sum(self._core.counts(body)[0] for body in range(len(self.scene.bodies)))
        if isinstance(x, np.ndarray) and x.shape == (3 * count,):
            x = x.reshape(count, 3)
        return numbers(x, "x", (count, 3))

    def energy(self, x: Any = None) -> float:
        """Potential energy of all bodies [J].

        Elastic energy, and the potentials of conservative pressure, gravity and loads, at the present time. Contact, tools, pins,
        supports and damping are not included.

        Parameters
        ----------
        x : array_like, (vertex_count, 3) or (3 vertex_count,)
            Positions [m] of the vertices of all bodies, one body after the other. None: the present positions.
        """
        return self._core.evaluate(self._x(x), None)

    def gradient(self, x: Any = None, out: Optional[np.ndarray] = None) -> np.ndarray:
        """Derivative of `energy` with respect to the positions (vertex_count, 3) [N]: minus the forces."""
        x = self._x(x)
        out = room(out, x.shape)
        self._core.evaluate(x, out)
        return out

    def hessian(self, x: Any = None, parts: bool = False) -> Any:
        """Exact second derivative of `energy` as a scipy CSR matrix (3 vertex_count, 3 vertex_count) [N/m].

        Parameters
        ----------
        x : array_like
            Positions [m], as for `energy`.
        parts : bool
            An enclosed gas or a target volume adds a dense term c g g^T for a whole body. True: the result is (matrix, c, g)
            with c (k,) [J/m6] and g (k, 3 vertex_count) [m2], and the Hessian is ``matrix + g.T @ diag(c) @ g``. False: a scene
            with such a term raises Error.

        Raises
        ------
        Error
            The scene has ``midedge`` bending, which has unknowns on edges, or a body that refines.
        """
        from scipy.sparse import csr_matrix

        starts, columns, values, coefficients, gradients = self._core.hessian(self._x(x))
        starts = from_bytes(starts, np.int32, -1)
        rows = len(starts) - 1
        matrix = csr_matrix(
            (from_bytes(values, np.float64, -1), from_bytes(columns, np.int32, -1), starts), shape=(rows, rows)
        )
        coefficients = from_bytes(coefficients, np.float64, -1)
        if parts:
            return matrix, coefficients, from_bytes(gradients, np.float64, len(coefficients), rows)
        if coefficients.any():
            raise _core.Error("an enclosed gas or a target volume adds a dense term to the Hessian. use hessian(parts=True)")
        return matrix

    def adjoint(
        self, loss_gradient: Any, rest_positions: bool = False, steps: int = 0, running: bool = False
    ) -> dict[str, Any]:
        """Derivatives of a function f of the positions with respect to parameters of the model (adjoint method).

        Without `steps` the derivatives come from one linear system. Under the method ``static`` they are those of the
        equilibrium, which must have converged. Under ``implicit`` they are those of the end of the last step for a constant state
        at its start.

        With `steps`, for the method ``implicit``: takes this number of steps, solves each to rounding, and then goes back through
        them. This takes the time of three to five times as many steps. Afterwards the simulation is at the end of the steps.

        Tools and contact are not supported.

        Parameters
        ----------
        loss_gradient : array_like, (vertex_count, 3), or callable
            Derivative of f with respect to the positions of all bodies, one body after the other [1/m], at the present state or,
            with `steps`, after the last step. With `steps` it may also be a function of positions [m], velocities [m/s] and the
            number of the step (from 1) that returns this derivative, or a pair of it and the derivative with respect to the
            velocities [s/m].
        rest_positions : bool
            True: also compute the derivatives with respect to the rest positions, through membranes and ``midedge`` bending only
            (not springs and fibres).
        steps : int
            Number of steps to take and to differentiate. 0: take no step.
        running : bool
            True: f is a sum over all these steps, and `loss_gradient` is called for each step, from the last to the first.

        Returns
        -------
        dict
            For f without a unit:

            forces (vertex_count, 3): with respect to a force on each vertex [1/N];
            loads: dict from the name (or number) of each load to the derivative with respect to a factor on it, 1 at present;
            gravity (3,): with respect to gravity [s2/m];
            materials: for each body a dict. young, thickness, bending (flexural rigidity) and pressure: with respect to a factor
            on the quantity, 1 at present. poisson: with respect to the ratio. The derivative with respect to Young's modulus E is
            young / E;
            rest_positions (vertex_count, 3), if requested: with respect to the rest positions [1/m];
            start_positions [1/m] and start_velocities [s/m] (vertex_count, 3), with `steps`: with respect to the state before the
            steps. The derivative for the rest positions assumes a constant start state: for bodies that start at rest, add
            start_positions.

        Raises
        ------
        Error
            The scene has an unsupported feature, the state is not a stable equilibrium, or a step does not converge.

        Examples
        --------
        >>> sheet = {"name": "sheet", "mesh": {"shape": "grid", "nx": 4, "ny": 4}, "mass": {"total": 0.1},
        ...          "membrane": {"young": 1e4, "poisson": 0.3, "thickness": 1e-3}}
        >>> sim = pellicle.load_scene({"bodies": [sheet], "gravity": [0, 0, -9.81], "duration": 1,
        ...                            "solver": {"method": "implicit", "dt": 0.01}})
        >>> found = sim.adjoint(lambda x, v, step: x / len(x), steps=20)
        >>> found["start_velocities"].shape
        (25, 3)
        """
        shape = self._x(None).shape
        if isinstance(steps, bool) or not isinstance(steps, (int, np.integer)) or steps < 0:
            raise ValueError(f"steps: must be an integer of at least 0, not {steps!r}")
        if callable(loss_gradient) and steps == 0:
            raise ValueError("loss_gradient: a function needs steps. pass steps of at least 1, or an array")
        gradient = None if callable(loss_gradient) else numbers(loss_gradient, "loss_gradient", shape)
        bodies, loads = self.scene.bodies, self.loads
        forces, rest = np.empty(shape), np.empty(shape) if rest_positions else None
        by_load, gravity, materials = np.empty(len(loads)), np.empty(3), np.empty((len(bodies), len(_MATERIAL)))
        results = forces, rest, by_load, gravity, materials
        start = {}
        if steps == 0:
            self._core.adjoint(gradient, *results)
        else:
            positions, velocities, by_positions, by_velocities = (np.zeros(shape) for _ in range(4))
            start = {"start_positions": np.empty(shape), "start_velocities": np.empty(shape)}

            def ask(step: int) -> None:
                answer = gradient if gradient is not None else loss_gradient(positions.copy(), velocities.copy(), step)
                x, v = answer if isinstance(answer, tuple) else (answer, 0.0)
                by_positions[:] = numbers(x, "loss_gradient", shape)
                by_velocities[:] = numbers(v, "loss_gradient", shape) if np.ndim(v) else v

            arrays = positions, velocities, by_positions, by_velocities
            self._core.adjoint_steps(ask, int(steps), bool(running), *arrays, *start.values(), *results)
        found = {
            "forces": forces,
            "loads": {name or number: float(by_load[number]) for number, name in enumerate(loads)},
            "gravity": gravity,
            "materials": {name: dict(zip(_MATERIAL, map(float, row))) for name, row in zip(bodies, materials)},
            **start,
        }
        return {**found, "rest_positions": rest} if rest_positions else found

    # ---- pictures ----

    def show(self, path: Optional[PathLike] = None) -> Any:
        """Show the present state as a page.

        In a notebook without `path` the page is shown. Otherwise it is written to `path` (default: pellicle.html), and the result
        is the path.
        """
        from . import notebook

        return notebook.show_simulation(self, path)

    def _repr_html_(self) -> str:
        from . import notebook

        return notebook.simulation_html(self)

    def __repr__(self) -> str:
        bodies = ", ".join(f"{name} ({self._core.counts(b)[0]})" for b, name in enumerate(self.scene.bodies))
        return f"<Simulation of {bodies} at {self.time:.6g} s>"
