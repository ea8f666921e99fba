"""Triangle surface meshes."""

from __future__ import annotations

import os
from typing import Any, Mapping, Optional, Union

import numpy as np

from . import _core
from ._arrays import from_bytes, indices, numbers

PathLike = Union[str, "os.PathLike[str]"]


class Mesh:
    """An indexed triangle mesh with named fields on its vertices.

    Parameters
    ----------
    positions : array_like, (n, 3)
        Positions of the vertices [m].
    triangles : array_like of int, (m, 3)
        Vertex numbers of the corners, from 0, counter-clockwise seen from outside.
    fields : mapping of str to array_like, optional
        Values on the vertices, each with the shape (n,) or (n, k).

    Attributes
    ----------
    positions : numpy.ndarray, (n, 3), float64
    triangles : numpy.ndarray, (m, 3), int32
    fields : dict of str to numpy.ndarray
    notes : tuple of str
        Changes that were made while a file was read: polygons split into triangles, vertices welded.

    Notes
    -----
    Arrays of the right type are not copied. Each function reads the values that the arrays have when it is called.
    """

    __slots__ = ("positions", "triangles", "fields", "notes")

    def __init__(self, positions: Any, triangles: Any, fields: Optional[Mapping[str, Any]] = None) -> None:
        self.positions: np.ndarray = numbers(positions, "positions", (None, 3), finite=False)
        self.triangles: np.ndarray = indices(triangles, "triangles", (None, 3))
        self.fields: dict[str, np.ndarray] = dict(fields or {})
        self.notes: tuple[str, ...] = ()
        self._arguments()

    def _arguments(self) -> tuple[np.ndarray, np.ndarray, tuple]:
        """The arguments that describe this mesh in calls of _core."""
        positions = numbers(self.positions, "positions", (None, 3), finite=False)
        triangles = indices(self.triangles, "triangles", (None, 3))
        fields = []
        for name, values in self.fields.items():
            if not isinstance(name, str):
                raise TypeError(f"fields: the name {name!r} must be a str")
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

    # ---- files, shapes, meshes of other libraries ----

    @classmethod
    def read(cls, path: PathLike) -> "Mesh":
        """Read a mesh file: OBJ, PLY, STL, OFF, VTP, glTF, USD as text, and through assimp FBX, 3MF, Collada and others.

        Raises
        ------
        Error
            The file is missing or damaged. The error has the line or the byte offset, if known.
        """
        notes: list[str] = []
        mesh = cls._of_core(_core.read_mesh(os.fspath(path), notes))
        mesh.notes = tuple(notes)
        return mesh

    @classmethod
    def shape(cls, name: str, **parameters: Any) -> "Mesh":
        """Generate a shape: ``Mesh.shape("geodesic-sphere", frequency=8, radius=0.1)``.

        ``pellicle shape --help`` and docs/reference/scene.md list the shapes and their parameters.
        """

        def text(value: Any) -> str:
            return str(value).lower() if isinstance(value, (bool, np.bool_)) else str(value)

        if not isinstance(name, str):
            raise TypeError("name: must be a str")
        pairs = tuple((key, text(value)) for key, value in parameters.items())
        return cls._of_core(_core.make_shape(name, pairs))

    @classmethod
    def of(cls, other: Any) -> "Mesh":
        """Convert a mesh of another library.

        Parameters
        ----------
        other : object
            An object with ``vertices`` and ``faces`` (trimesh), with ``vertices`` and ``triangles`` (Open3D), or with ``points``
            and ``cells`` (meshio; its point data become fields), or a pair (positions, triangles) (libigl).
        """
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
            f"other: {type(other).__name__} is no mesh. pass an object with vertices and faces, vertices and triangles, or "
            "points and cells, or a pair of arrays (positions, triangles)"
        )

    def write(self, path: PathLike) -> None:
        """Write an OBJ, PLY, STL, OFF or VTP file; the extension selects the format.

        PLY and VTP files contain the fields. After a failure there is no partial file, and an older file is unchanged.
        """
        _core.write_mesh(os.fspath(path), *self._arguments())

    # ---- new meshes from this one ----

    def subdivide(self, levels: int = 1) -> "Mesh":
        """Modified butterfly subdivision: each level splits every triangle into four. Existing vertices do not move."""
        return Mesh._of_core(_core.subdivide(*self._arguments(), levels))

    def repair(self, weld_tolerance: float = 0.0, drop_parts: int = 0) -> tuple["Mesh", dict[str, Any]]:
        """A repaired copy, and the number of changes of each kind.

        Welds vertices within `weld_tolerance` [m]; 0: vertices at exactly equal positions. Removes triangles with bad indices,
        without area, or with the same vertices as another, and vertices without triangles. Removes parts of at most `drop_parts`
        triangles that no edge connects with the largest part. Splits non-manifold edges and vertices, makes the winding
        consistent and turns closed components outward.
        """
        mesh, summary = _core.repair(*self._arguments(), float(weld_tolerance), drop_parts)
        return Mesh._of_core(mesh), summary

    # ---- checks and measures ----

    def check(self) -> dict[str, Any]:
        """Defects and properties of the mesh.

        Returns
        -------
        dict
            ``issues`` is a list with a dict for each kind of defect: name, severity, count, elements (numbers of the first
            1000), doc (description) and remedy. The other keys are properties such as ``closed``, ``manifold``, ``genus``,
            ``area`` [m2], ``volume`` [m3] and ``quality_min`` (1: equilateral, 0: no area).
        """
        report = _core.check(*self._arguments())
        for issue in report["issues"]:
            issue["elements"] = from_bytes(issue["elements"], np.int32, -1)
        return report

    def self_intersections(self, limit: int = 100_000) -> np.ndarray:
        """Pairs of triangles (k, 2), first < second, that intersect or touch beyond their shared corners.

        The test is exact. The result has at most `limit` pairs. If it is empty, the mesh has no self-intersections.
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
        """Volume enclosed by the closed components [m3]; positive if their triangles face outward."""
        return self.check()["volume"]

    def __repr__(self) -> str:
        fields = f", fields {', '.join(self.fields)}" if self.fields else ""
        return f"<Mesh: {len(self.positions)} vertices, {len(self.triangles)} triangles{fields}>"


def _cell_triangles(cells: Any) -> np.ndarray:
    """Triangles of meshio's cells: a dict, a list of pairs, or blocks with type and data. Quads are split."""
    if isinstance(cells, Mapping):
        blocks = list(cells.items())
    else:
        blocks = [(c.type, c.data) if hasattr(c, "type") else (c[0], c[1]) for c in cells]
    triangles = [np.asarray(data) for kind, data in blocks if kind == "triangle"]
    triangles += [np.asarray(data)[:, corners] for kind, data in blocks if kind == "quad" for corners in ([0, 1, 2], [0, 2, 3])]
    if not triangles:
        raise ValueError("other: its cells contain no triangles and no quads")
    return np.concatenate(triangles)
