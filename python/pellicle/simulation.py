"""Scenes and simulations."""

from __future__ import annotations

import difflib
import json
import os
import tempfile
from typing import Any, Mapping, Optional, Union

import numpy as np

from . import _core
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
_MATERIAL = ("young", "thickness", "poisson", "bending", "pressure")


def _plain(value: Any) -> Any:
    """numpy's numbers and arrays as JSON takes them"""
    if isinstance(value, np.ndarray):
        return value.tolist()
    if isinstance(value, np.generic):
        return value.item()
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    if isinstance(value, range):
        return list(value)
    if isinstance(value, Mesh):
        raise TypeError("scene: a Mesh cannot stand here: write it to a file and give {'file': path}")
    raise TypeError(f"scene: a {type(value).__name__} cannot stand in a scene")


def _override(path: str, value: Any) -> str:
    if not isinstance(path, str):
        raise TypeError("overrides: paths must be texts such as 'bodies.ball.membrane.young'")
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
    """A scene that was read and checked: bodies, solver, loads, tools and output.

    Parameters
    ----------
    source : path or mapping
        A scene file, or a dict with the keys of one (docs/reference/scene.md). Where a file has
        ``mesh: { file: ... }`` the dict may hold a `Mesh`. ``duration`` may be left out of a dict that is stepped by hand.
    overrides : mapping of str to value, optional
        Changes such as ``{"solver.dt": 0.001, "bodies.ball.membrane.young": 2e4}``.

    Attributes
    ----------
    title : str
    bodies, loads : tuple of str
    duration, dt : float
        [s]
    notes : tuple of str
        Changes made while meshes were read.

    Raises
    ------
    Error
        An unknown key, a value out of range, a mesh that cannot be read; with file, line, column and remedy.

    Notes
    -----
    The model (topology, masses, materials) is made once; all simulations of a scene share it, in any number of threads.
    """

    def __init__(self, source: Source, overrides: Optional[Mapping[str, Any]] = None) -> None:
        self._source = source
        self._overrides = dict(overrides or {})
        notes: list[str] = []
        texts = tuple(_override(path, value) for path, value in self._overrides.items())
        if isinstance(source, Mapping):
            self._core = _parse(source, texts, notes)
        else:
            self._core = _core.Scene(os.fspath(source), None, texts, notes)
        info = self._core.info()
        self.title: str = info["title"]
        self.bodies: tuple[str, ...] = info["bodies"]
        self.loads: tuple[str, ...] = info["loads"]
        self.duration: float = info["duration"]
        self.dt: float = info["dt"]
        self._is_static: bool = info["is_static"]
        self.notes: tuple[str, ...] = tuple(notes)

    def text(self) -> str:
        """The scene as YAML with all defaults written out."""
        return self._core.text()

    def prepare(self) -> "Scene":
        """Make the model now; before threads make simulations of one scene."""
        self._core.prepare()
        return self

    def simulation(self, threads: int = 0, record_contacts: bool = False, **solver: Any) -> "Simulation":
        """A new simulation of the scene's model.

        Parameters
        ----------
        threads : int
            Threads of a step; 0: all processors. The results do not depend on it. Use 1 where many simulations run at once.
        record_contacts : bool
            Keep what `Simulation.contact_records` gives.
        **solver
            Keys of ``solver`` that are different in this simulation: ``scene.simulation(dt=0.001)``.
        """
        if not isinstance(threads, int) or not 0 <= threads < 2**15:
            raise ValueError("threads: must be an integer within 0 .. 32767")
        self._core.prepare()
        other = self
        if solver:
            other = Scene(self._source, {**self._overrides, **{f"solver.{key}": value for key, value in solver.items()}})
        return Simulation(self, self._core.simulation(other._core, threads, record_contacts))

    def __repr__(self) -> str:
        return f"<Scene {self.title!r}: {', '.join(self.bodies)}>"


def _parse(source: Mapping[str, Any], overrides: tuple[str, ...], notes: list[str]) -> Any:
    """A scene from a dict; meshes pass through files, which keep every bit."""
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
    """A simulation of a scene file (or dict): ``Scene(path, overrides).simulation(threads, record_contacts)``."""
    return Scene(path, overrides).simulation(threads, record_contacts)


def _ray(origin: Any, direction: Any) -> np.ndarray:
    return np.concatenate([numbers(origin, "origin", (3,)), numbers(direction, "direction", (3,))])


class Drag:
    """A hand that holds a piece of surface through a spring, made by `Simulation.drag`. Lets go at the end of ``with``."""

    def __init__(self, core: Any) -> None:
        self._core = core

    def move(self, target: Any) -> None:
        """Move the other end of the spring [m]; before each step."""
        self._core.move(numbers(target, "target", (3,)))

    def read(self) -> dict[str, Any]:
        """point and target [m], force of the spring on the surface and reaction on the hand [N], held_count."""
        return self._core.read()

    def end(self) -> None:
        """Let go. A second call does nothing."""
        self._core.end()

    def __enter__(self) -> "Drag":
        return self

    def __exit__(self, *unused: Any) -> None:
        self.end()


class Simulation:
    """A state of a model under loads and tools, made by `Scene.simulation` or `load_scene`.

    Bodies are given by name or number, in the order of the scene. Arrays are float64 copies with a row for each vertex, in
    the order of the body's mesh; with ``out=`` an array of yours is filled. The model keeps vertices in another order,
    so that a view without a copy is not possible; a copy of 10,000 vertices takes about 30 us.

    A simulation is used by one thread at a time, and steps leave other Python threads free. Calls from a second thread
    during a step raise RuntimeError.
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
            raise KeyError(f"{what}: {name!r} is none of {', '.join(map(repr, names)) or 'none'}")
        return name

    # ---- time ----

    def step(self, n: int = 1) -> None:
        """Do `n` steps of ``dt``.

        Raises
        ------
        Error
            The state diverged; the state is that before the failing step.
        """
        self._core.step(n)

    def run_until(self, time: float) -> None:
        """Step until the simulated time [s] is reached."""
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
        """Steps done."""
        return self._core.state()[1]

    @property
    def hash(self) -> int:
        """64-bit hash of time, positions and velocities: equal for equal bits."""
        return self._core.hash()

    # ---- arrays ----

    def positions(self, body: Union[int, str] = 0, out: Optional[np.ndarray] = None) -> np.ndarray:
        """Positions (vertex_count, 3) [m]."""
        return self._core.get(_POSITIONS, body, out)

    def velocities(self, body: Union[int, str] = 0, out: Optional[np.ndarray] = None) -> np.ndarray:
        """Velocities in the last step (vertex_count, 3) [m/s]."""
        return self._core.get(_NUMBER["velocities"], body, out)

    def forces(self, body: Union[int, str] = 0, out: Optional[np.ndarray] = None) -> np.ndarray:
        """Forces of springs, shell, pressure, damping, loads and gravity on the vertices (vertex_count, 3) [N]; no contact."""
        return self._core.get(_NUMBER["forces"], body, out)

    def rest_positions(self, body: Union[int, str] = 0, out: Optional[np.ndarray] = None) -> np.ndarray:
        """Positions at rest (vertex_count, 3) [m]."""
        return self._core.get(_NUMBER["rest_positions"], body, out)

    def masses(self, body: Union[int, str] = 0, out: Optional[np.ndarray] = None) -> np.ndarray:
        """Masses (vertex_count,) [kg]."""
        return self._core.get(_NUMBER["masses"], body, out)

    def triangles(self, body: Union[int, str] = 0, out: Optional[np.ndarray] = None) -> np.ndarray:
        """Corners of the present triangles (triangle_count, 3), int32."""
        return self._core.get(_NUMBER["triangles"], body, out)

    def mesh(self, body: Union[int, str] = 0) -> Mesh:
        """The present surface of a body."""
        return Mesh(self.positions(body), self.triangles(body))

    def set_positions(self, positions: Any, body: Union[int, str] = 0) -> None:
        """Put the vertices of a body (vertex_count, 3) [m]; velocities stay."""
        shape = (self._core.counts(body)[0], 3)
        self._core.set(0, body, numbers(positions, "positions", shape))

    def set_velocities(self, velocities: Any, body: Union[int, str] = 0) -> None:
        """Set the velocities of a body (vertex_count, 3) [m/s]."""
        shape = (self._core.counts(body)[0], 3)
        self._core.set(1, body, numbers(velocities, "velocities", shape))

    def field(
        self, body: Union[int, str], name: str, out: Optional[np.ndarray] = None, on: str = "vertices"
    ) -> np.ndarray:
        """A field by its name: (vertex_count,) or (vertex_count, k).

        `pellicle.field_names` lists them; docs/reference/scene.md (fields) says what they are and their units.

        Parameters
        ----------
        on : {"vertices", "triangles"}
            Stress, strain and their like are also there for each triangle: (triangle_count,) or (triangle_count, k).
        """
        if on not in ("vertices", "triangles"):
            raise ValueError("on: must be 'vertices' or 'triangles'")
        if not isinstance(name, str):
            raise TypeError("name: must be a text")
        number = _FIELD.get(name)
        if number is None:
            near = difflib.get_close_matches(name, _FIELD, 1)
            raise KeyError(f"name: {name!r} is no field" + (f"; did you mean {near[0]!r}?" if near else ""))
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
        """Put a tool at a position [m] and unit quaternion (x, y, z, w) in the next step; its keys are not used any more."""
        number = self._find(tool, self.tools, "tool")
        pose = np.concatenate([numbers(position, "position", (3,)), numbers(rotation, "rotation", (4,))])
        self._core.set_tool(number, pose)

    def tool(self, tool: Union[int, str]) -> dict[str, Any]:
        """Pose of a tool, force [N] and torque [N m] on it in the last step, vertices touched and held."""
        return self._core.tool(self._find(tool, self.tools, "tool"))

    def support(self, body: Union[int, str] = 0) -> dict[str, Any]:
        """Force [N] and torque [N m] of a body on its pins and supports."""
        return self._core.support(body)

    def set(self, path: str, value: Any) -> None:
        """Set a parameter by its path in the scene, between two steps: ``sim.set("bodies.ball.membrane.young", 2e4)``.

        The simulation continues from the present state with the new value. include/pellicle/live.h says what can change.

        Raises
        ------
        Error
            A path that does not exist, a value out of range, or a parameter that cannot change; nothing is changed then.
        """
        self._core.set_parameter(*_override(path, value).split("=", 1))

    def set_pins(self, vertices: Any, body: Union[int, str] = 0) -> None:
        """Hold these vertices of the body's mesh where they are now, instead of those held before; none: []."""
        self._core.set_pins(body, indices(vertices, "vertices", (None,)))

    # ---- picking and dragging ----

    def pick(self, origin: Any, direction: Any) -> Optional[dict[str, Any]]:
        """Where a ray from `origin` [m] along `direction` meets a body first, or None.

        Returns
        -------
        dict
            body, triangle, vertices (its corners), weights (barycentric place), mesh_vertex (the nearest one, for pins and
            loads), distance [m], point [m], normal.
        """
        return self._core.pick(_ray(origin, direction))

    def drag(self, origin: Any, direction: Any, stiffness: float, reach: float) -> Optional["Drag"]:
        """Take hold of the surface where a ray meets it, with a spring [N/m]; None where it meets nothing.

        Parameters
        ----------
        stiffness : float
            Of the spring [N/m].
        reach : float
            Vertices within this distance [m] of the hit are held, one at least.

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
        """Time, steps, hash and the measures of the present state: energies [J], volume and area over those at rest,
        largest displacement [m] and force [N]."""
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
        """Energy balance since the start [J]: works, energies, dissipation and the remaining error (docs/results.md)."""
        return self._core.ledger()

    def solver(self) -> dict[str, Any]:
        """How the last step went: iterations, residual [N], whether it converged, substeps."""
        return self._core.solver()

    def contacts(self) -> dict[str, Any]:
        """What contact did since the start: pairs, contacts, rounds, seconds. All zero without contact."""
        return self._core.contact()

    def contact_records(self) -> np.ndarray:
        """The contacts that had a force in the last step, one row each.

        Only kept by simulations that were made with ``record_contacts=True``.

        Returns
        -------
        numpy.ndarray
            Structured: ``records["force"]`` is (count, 3). Fields:

            bodies (2): numbers of the bodies of the first and second side; -1 second: a tool.
            tool: its number, -1: none.
            vertices (4), weights (4): corners of the features that touch, as rows of `positions` of their body, -1: unused.
            Weights above 0 are of the first side and sum to 1, those below 0 of the second.
            point (3): of the first side [m]. normal (3): from the second side to the first.
            force (3): on the first side, mean over the step [N]; each corner has its weight times it.
            gap: between both sides along the normal [m]; below 0 inside of a tool.

        Raises
        ------
        Error
            The simulation keeps no records.
        """
        records = self._core.contact_records()
        if records is None:
            raise _core.Error("contacts are not recorded. make the simulation with record_contacts=True")
        return np.frombuffer(records, _CONTACT)

    def intersections(self) -> int:
        """Pairs of triangles of all bodies and tools that cut each other at present, by the exact test."""
        return self._core.intersections()

    # ---- snapshots ----

    def save(self) -> bytes:
        """Everything that `load` needs to continue with the same bits."""
        return self._core.save()

    def load(self, snapshot: bytes) -> None:
        """Take the state of a snapshot of a simulation with the same scene.

        Raises
        ------
        Error
            A snapshot that is damaged or of another scene; the state stays as it was.
        """
        if not isinstance(snapshot, bytes):
            raise TypeError("snapshot: must be bytes, as Simulation.save gives them")
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
        """Potential energy [J] of the bodies at the positions `x` of all of them, one after the other; None: the present.

        Elastic energy, conservative pressure, gravity and loads, at the present time; no contact, tools or damping.

        Parameters
        ----------
        x : array_like, (vertex_count, 3) or (3 vertex_count,)
            [m]
        """
        return self._core.evaluate(self._x(x), None)

    def gradient(self, x: Any = None, out: Optional[np.ndarray] = None) -> np.ndarray:
        """Derivative of `energy` by the positions (vertex_count, 3) [N]: minus the forces."""
        x = self._x(x)
        out = room(out, x.shape)
        self._core.evaluate(x, out)
        return out

    def hessian(self, x: Any = None, parts: bool = False) -> Any:
        """Second derivative of `energy` as a scipy CSR matrix (3 vertex_count, 3 vertex_count) [N/m], exact.

        Parameters
        ----------
        parts : bool
            An enclosed gas, or a volume that is driven, adds a product c g g^T over a whole body, which would be dense.
            With True the result is (matrix, c, g) with c (k,) and g (k, 3 vertex_count); without, such scenes are refused.

        Raises
        ------
        Error
            Bending of the model midedge, which has unknowns in addition to the positions; a body that refines.
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
            raise _core.Error("an enclosed gas or driven volume adds a dense part to the Hessian. use hessian(parts=True)")
        return matrix

    def adjoint(
        self, loss_gradient: Any, rest_positions: bool = False, steps: int = 0, running: bool = False
    ) -> dict[str, Any]:
        """Derivatives of a function of the positions by the numbers of the model.

        For the method ``static`` of the state of rest, which must have converged; for ``implicit`` of the end of the last
        step, with its start as it is: one linear system. With `steps` for ``implicit``: takes so many steps, solved to
        rounding, and goes back along them, in the time of three to five times as many steps; the simulation is at their
        end then. Without tools and contact.

        Parameters
        ----------
        loss_gradient : array_like, (vertex_count, 3), or callable
            Derivative of your function by the positions of all bodies, one after the other, at the present state [1/m];
            with `steps`, after the last of them. Or, with `steps`, a function of positions, velocities and the number of
            the step (from 1) that returns it, or a pair: that and the derivative by the velocities [s/m].
        rest_positions : bool
            Also the derivatives by the positions at rest: of membranes and bending ``midedge``, no springs or fibres.
        steps : int
            Steps to take and to differentiate; 0: none.
        running : bool
            Your function is a sum over all these steps: `loss_gradient` is asked after each of them, the last one first.

        Returns
        -------
        dict
            forces (vertex_count, 3): by a force on each vertex [1/N];
            loads: for each load by name (or number) by a factor on it, 1 at present; gravity (3,): [s2/m];
            materials: for each body a dict with young, thickness, bending and pressure, by a factor on each, 1 at present,
            and poisson, by the ratio. The derivative by Young's modulus E is young / E;
            rest_positions (vertex_count, 3), when asked for: by the positions at rest [1/m];
            with `steps`: start_positions [1/m] and start_velocities [s/m] (vertex_count, 3), by the state before them. Rest
            positions leave it as it is: add start_positions where the bodies start at rest.

        Raises
        ------
        Error
            What cannot be asked, a state that is not a stable balance, or a step that does not converge.

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
            raise ValueError("steps: must be an integer of at least 0")
        if callable(loss_gradient) and steps == 0:
            raise ValueError("loss_gradient: a function needs steps; without them give an array")
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
        """The present state as a page: shown in a notebook; elsewhere written to `path` (pellicle.html by default)."""
        from . import notebook

        return notebook.show_simulation(self, path)

    def _repr_html_(self) -> str:
        from . import notebook

        return notebook.simulation_html(self)

    def __repr__(self) -> str:
        bodies = ", ".join(f"{name} ({self._core.counts(b)[0]})" for b, name in enumerate(self.scene.bodies))
        return f"<Simulation of {bodies} at {self.time:.6g} s>"
