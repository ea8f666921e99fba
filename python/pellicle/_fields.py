"""Vertex fields by name, from what a simulation can read."""

from __future__ import annotations

from typing import TYPE_CHECKING, Callable, Union

import numpy as np

from . import _core

if TYPE_CHECKING:
    from .simulation import Simulation

Body = Union[int, str]
Field = Callable[["Simulation", Body], np.ndarray]
_ENERGIES = ("spring_energy", "volumetric_energy", "membrane_energy", "bending_energy", "fibre_energy")


def _energies(sim: "Simulation", body: Body) -> np.ndarray:
    return sim._core.energies(body, np.empty((5, sim._core.counts(body)[0])))


def _of_measure(name: str) -> Field:
    return lambda sim, body: sim.mesh(body).measure()[name]


def _of_array(name: str) -> Field:
    number = [row[0] for row in _core.ARRAYS].index(name)
    return lambda sim, body: sim._core.get(number, body, None)


_virials = _of_array("spring_virials")


def _displacement(sim: "Simulation", body: Body) -> np.ndarray:
    return sim.positions(body) - sim.rest_positions(body)


def _smooth(values: np.ndarray, weights: np.ndarray, triangles: np.ndarray, count: int) -> np.ndarray:
    """The mean of the triangles around each vertex, by weight."""
    corners = triangles.ravel()
    sums = np.stack([np.bincount(corners, np.repeat(column * weights, 3), count) for column in values.T], axis=-1)
    total = np.bincount(corners, np.repeat(weights, 3), count)[:, None]
    return np.divide(sums, total, out=np.zeros_like(sums), where=total > 0)


def _tension(sim: "Simulation", body: Body) -> np.ndarray:
    """Virials of springs and shell over twice a third of the areas around."""
    corners = sim.positions(body)[sim.triangles(body)]
    areas = 0.5 * np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    third = np.bincount(sim.triangles(body).ravel(), np.repeat(areas / 3, 3), len(sim.positions(body)))
    virials = _virials(sim, body)
    return np.divide(virials, 2 * third, out=np.zeros_like(third), where=third > 0)


# columns of pel_triangle_mechanics: area, rest area, thickness, strain, second Piola-Kirchhoff stress, force, moment, energies
_AREA, _REST_AREA, _THICKNESS = 0, 1, 2
_COLUMNS = {"strain": 3, "piola_stress": 9, "membrane_force": 15, "bending_moment": 21}
_DENSITIES = {"membrane_energy_density": 27, "fibre_energy_density": 28, "bending_energy_density": 29}
_AT_REST = {"strain", "piola_stress"}


def _mechanics(sim: "Simulation", body: Body, first: int, count: int, at_rest: bool) -> np.ndarray:
    table = sim._core.mechanics(body, np.empty((sim._core.counts(body)[1], 30)))
    weights = table[:, _REST_AREA if at_rest else _AREA]
    return _smooth(table[:, first : first + count], weights, sim.triangles(body), sim._core.counts(body)[0])


def _of_mechanics(name: str) -> Field:
    if name in _DENSITIES:
        return lambda sim, body: _mechanics(sim, body, _DENSITIES[name], 1, True)[:, 0]
    return lambda sim, body: _mechanics(sim, body, _COLUMNS[name], 6, name in _AT_REST)


def _cauchy(sim: "Simulation", body: Body) -> np.ndarray:
    force, thickness = _mechanics(sim, body, 15, 6, False), _mechanics(sim, body, _THICKNESS, 1, False)
    return np.divide(force, thickness, out=np.zeros_like(force), where=thickness > 0)


# ---- in the plane of a vertex: its smooth normal, by area ----


def _normals(sim: "Simulation", body: Body, at_rest: bool) -> np.ndarray:
    corners = (sim.rest_positions(body) if at_rest else sim.positions(body))[sim.triangles(body)]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    areas = 0.5 * np.linalg.norm(normals, axis=1)
    sums = _smooth(normals, np.ones(len(areas)), sim.triangles(body), sim._core.counts(body)[0])
    length = np.linalg.norm(sums, axis=1, keepdims=True)
    return np.divide(sums, length, out=np.zeros_like(sums), where=length > 0)


def _principal(tensors: np.ndarray, normals: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Principal values of tensors (xx, yy, zz, xy, yz, xz) in the planes, larger first, and the directions of the first."""
    full = tensors[:, [0, 3, 5, 3, 1, 4, 5, 4, 2]].reshape(-1, 3, 3)
    # axes in the plane, the first away from the axis of space that is nearest to the plane
    first = np.eye(3)[np.argmin(np.abs(normals), axis=1)]
    first -= np.einsum("vi,vi->v", first, normals)[:, None] * normals
    first /= np.linalg.norm(first, axis=1, keepdims=True)
    second = np.cross(normals, first)
    a, b, c = (np.einsum("vi,vij,vj->v", p, full, q) for p, q in ((first, first), (second, second), (first, second)))
    size, angle = np.hypot(0.5 * (a - b), c), 0.5 * np.arctan2(2 * c, a - b)
    values = np.stack([0.5 * (a + b) + size, 0.5 * (a + b) - size], axis=1)
    return values, np.cos(angle)[:, None] * first + np.sin(angle)[:, None] * second


def _principal_stress(sim: "Simulation", body: Body) -> tuple[np.ndarray, np.ndarray]:
    return _principal(_cauchy(sim, body), _normals(sim, body, False))


def _von_mises(side: float) -> Field:
    """N / h + side 6 M / h^2"""

    def field(sim: "Simulation", body: Body) -> np.ndarray:
        thickness = _mechanics(sim, body, _THICKNESS, 1, False)
        moment = _mechanics(sim, body, _COLUMNS["bending_moment"], 6, False)
        bending = np.divide(6 * moment, thickness**2, out=np.zeros_like(moment), where=thickness > 0)
        values, _ = _principal(_cauchy(sim, body) + side * bending, _normals(sim, body, False))
        return np.sqrt(values[:, 0] ** 2 - values[:, 0] * values[:, 1] + values[:, 1] ** 2)

    return field


FIELDS: dict[str, Field] = {
    "displacement": _displacement,
    "velocity": _of_array("velocities"),
    "force": _of_array("forces"),
    "energy": lambda sim, body: _energies(sim, body).sum(axis=0),
    **{name: (lambda sim, body, row=row: _energies(sim, body)[row].copy()) for row, name in enumerate(_ENERGIES)},
    "pressure": _of_array("pressure_forces"),
    "contact": _of_array("contacts"),
    "contact_force": _of_array("contact_forces"),
    "area": _of_measure("area"),
    "normal": _of_measure("normal"),
    "mean_curvature": _of_measure("mean_curvature"),
    "gaussian_curvature": _of_measure("gaussian_curvature"),
    "stress": _tension,
    **{name: _of_mechanics(name) for name in (*_COLUMNS, *_DENSITIES)},
    "cauchy_stress": _cauchy,
    "principal_strain": lambda sim, body: _principal(FIELDS["strain"](sim, body), _normals(sim, body, True))[0],
    "principal_stress": lambda sim, body: _principal_stress(sim, body)[0],
    "principal_direction": lambda sim, body: _principal_stress(sim, body)[1],
    "von_mises_top": _von_mises(1),
    "von_mises_bottom": _von_mises(-1),
}


def observe(sim: "Simulation", body: Body, name: str) -> np.ndarray:
    if not isinstance(name, str):
        raise TypeError("name: must be a text")
    if name not in FIELDS:
        near = f"; did you mean {_nearest(name)!r}?" if _nearest(name) else ""
        raise KeyError(f"name: {name!r} is no field{near}")
    return FIELDS[name](sim, body)


def _nearest(name: str) -> str:
    import difflib

    return next(iter(difflib.get_close_matches(name, FIELDS, 1)), "")
