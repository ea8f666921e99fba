"""Triangle surface meshes."""

from __future__ import annotations

import os
from typing import Any, Mapping, Optional, Union

import numpy as np

from . import _core
from ._arrays import from_bytes, indices, numbers

PathLike = Union[str, "os.PathLike[str]"]


class Mesh:
    """An indexed triangle mesh with named numbers on its vertices.

    Parameters
    ----------
    positions : array_like, (n, 3)
        Vertices [m].
    triangles : array_like of int, (m, 3)
        Corners, counter-clockwise seen from outside.
    fields : mapping of str to array_like, optional
        Numbers on the vertices, (n,) or (n, k) each.

    Attributes
    ----------
    positions : numpy.ndarray, (n, 3), float64
    triangles : numpy.ndarray, (m, 3), int32
    fields : dict of str to numpy.ndarray
    notes : tuple of str
        Changes made by the reader of a file: polygons cut into triangles, vertices welded.

    Notes
    -----
    Arrays of the right type are taken without a copy, and each function takes them as they are when it is called.
    """

    __slots__ = ("positions", "triangles", "fields", "notes")

    def __init__(self, positions: Any, triangles: Any, fields: Optional[Mapping[str, Any]] = None) -> None:
        self.positions: np.ndarray = numbers(positions, "positions", (None, 3), finite=False)
        self.triangles: np.ndarray = indices(triangles, "triangles", (None, 3))
        self.fields: dict[str, np.ndarray] = dict(fields or {})
        self.notes: tuple[str, ...] = ()
        self._arguments()

    def _arguments(self) -> tuple[np.ndarray, np.ndarray, tuple]:
        """What _core takes as a mesh."""
        positions = numbers(self.positions, "positions", (None, 3), finite=False)
        triangles = indices(self.triangles, "triangles", (None, 3))
        fields = []
        for name, values in self.fields.items():
            if not isinstance(name, str):
                raise TypeError(f"fields: the name {name!r} is not a text")
            values = np.asarray(values)
            shape = (len(positions),) if values.ndim < 2 else (len(positions), None)
            values = numbers(values, f"fields[{name!r}]", shape, finite=False)
            fields.append((name, 1 if values.ndim == 1 else values.shape[1], values))
        return positions, triangles, tuple(fields)

    @classmethod
    def _of_core(cls, made: tuple[bytearray, bytearray, tuple]) -> "Mesh":
        mesh = cls.__new__(cls)
        mesh.positions = from_bytes(made[0], np.float64, -1, 3)
        mesh.triangles = from_bytes(made[1], np.int32, -1, 3)
        count = len(mesh.positions)
        mesh.fields = {
            name: from_bytes(values, np.float64, *((count,) if components == 1 else (count, components)))
            for name, components, values in made[2]
        }
        mesh.notes = ()
        return mesh

    # ---- from and to elsewhere ----

    @classmethod
    def read(cls, path: PathLike) -> "Mesh":
        """Read a mesh file: OBJ, PLY, STL, OFF, and by way of assimp glTF, FBX, 3MF, Collada and others.

        Raises
        ------
        Error
            A file that is missing or damaged, with its line.
        """
        notes: list[str] = []
        mesh = cls._of_core(_core.read_mesh(os.fspath(path), notes))
        mesh.notes = tuple(notes)
        return mesh

    @classmethod
    def shape(cls, name: str, **parameters: Any) -> "Mesh":
        """Make a shape: ``Mesh.shape("geodesic-sphere", frequency=8, radius=0.1)``.

        ``pellicle shape --help`` and docs/reference/scene.md list the shapes and their parameters.
        """

        def text(value: Any) -> str:
            return str(value).lower() if isinstance(value, (bool, np.bool_)) else str(value)

        if not isinstance(name, str):
            raise TypeError("name: must be a text")
        pairs = tuple((key, text(value)) for key, value in parameters.items())
        return cls._of_core(_core.make_shape(name, pairs))

    @classmethod
    def of(cls, other: Any) -> "Mesh":
        """Take a mesh of another library: one with ``vertices`` and ``faces`` (trimesh, Open3D, libigl tuples), or with
        ``points`` and ``cells`` (meshio; its point data become fields), or a pair (positions, triangles)."""
        if isinstance(other, Mesh):
            return other
        if hasattr(other, "vertices") and (hasattr(other, "faces") or hasattr(other, "triangles")):
            faces = other.faces if hasattr(other, "faces") else other.triangles
            return cls(np.asarray(other.vertices), np.asarray(faces))
        if hasattr(other, "points") and hasattr(other, "cells"):
            return cls(np.asarray(other.points), _cell_triangles(other.cells), getattr(other, "point_data", None))
        if isinstance(other, (tuple, list)) and len(other) == 2:
            return cls(other[0], other[1])
        raise TypeError(
            f"other: {type(other).__name__} is no mesh: needs vertices and faces, or points and cells, or a pair of arrays"
        )

    def write(self, path: PathLike) -> None:
        """Write OBJ, PLY (with the fields), STL or OFF, by the extension. The file appears whole or not at all."""
        _core.write_mesh(os.fspath(path), *self._arguments())

    # ---- made from this one ----

    def subdivide(self, levels: int = 1) -> "Mesh":
        """Modified-butterfly subdivision: each level turns a triangle into four; vertices keep their places."""
        return Mesh._of_core(_core.subdivide(*self._arguments(), levels))

    def repair(self, weld_tolerance: float = 0.0, drop_parts: int = 0) -> tuple["Mesh", dict[str, Any]]:
        """A repaired copy, and counts of the repairs.

        Welds vertices within `weld_tolerance` [m], drops broken, flat and duplicate triangles, cuts non-manifold pieces
        apart and turns all triangles outward. Drops parts of at most `drop_parts` triangles that no edge connects with
        the largest part.
        """
        mesh, summary = _core.repair(*self._arguments(), float(weld_tolerance), drop_parts)
        return Mesh._of_core(mesh), summary

    # ---- questions ----

    def check(self) -> dict[str, Any]:
        """Everything that is wrong, and figures of the mesh.

        Returns
        -------
        dict
            ``issues`` is a list with name, severity, count, elements (the first 1000), doc and remedy of each kind that
            was found; the other keys are figures such as ``closed``, ``manifold``, ``genus``, ``area`` [m2], ``volume``
            [m3] and ``quality_min``.
        """
        report = _core.check(*self._arguments())
        for issue in report["issues"]:
            issue["elements"] = from_bytes(issue["elements"], np.int32, -1)
        return report

    def self_intersections(self, limit: int = 100_000) -> np.ndarray:
        """Pairs of triangles that cut or touch each other beyond shared corners, decided exactly: (k, 2), first < second.

        At most `limit` of them; an empty result is a certificate that there are none.
        """
        count, pairs = _core.self_intersections(*self._arguments(), limit)
        return from_bytes(pairs, np.int32, -1, 2)[: min(count, limit)]

    def measure(self) -> dict[str, np.ndarray]:
        """Measures on the vertices.

        Returns
        -------
        dict
            ``area`` (n,) [m2], ``normal`` (n, 3), ``mean_curvature`` (n,) [1/m], ``gaussian_curvature`` (n,) [1/m2].
        """
        arguments = self._arguments()
        count = len(arguments[0])
        areas, normals, mean, gaussian = (np.empty(count), np.empty((count, 3)), np.empty(count), np.empty(count))
        _core.measure(*arguments, areas, normals, mean, gaussian)
        return {"area": areas, "normal": normals, "mean_curvature": mean, "gaussian_curvature": gaussian}

    @property
    def area(self) -> float:
        """Area of the surface [m2]."""
        return self.check()["area"]

    @property
    def volume(self) -> float:
        """Enclosed volume [m3] of the closed parts; positive when they are turned outward."""
        return self.check()["volume"]

    def __repr__(self) -> str:
        fields = f", fields {', '.join(self.fields)}" if self.fields else ""
        return f"<Mesh: {len(self.positions)} vertices, {len(self.triangles)} triangles{fields}>"


def _cell_triangles(cells: Any) -> np.ndarray:
    """Triangles of the cells of meshio: a dict, a list of pairs, or blocks with type and data."""
    if isinstance(cells, Mapping):
        blocks = list(cells.items())
    else:
        blocks = [(c.type, c.data) if hasattr(c, "type") else (c[0], c[1]) for c in cells]
    triangles = [np.asarray(data) for kind, data in blocks if kind == "triangle"]
    triangles += [np.asarray(data)[:, corners] for kind, data in blocks if kind == "quad" for corners in ([0, 1, 2], [0, 2, 3])]
    if not triangles:
        raise ValueError("other: its cells hold no triangles")
    return np.concatenate(triangles)
