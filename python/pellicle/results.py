"""Whole runs and their results."""

from __future__ import annotations

import csv
import json
import os
import shutil
from typing import Any, Iterator, Mapping, Optional, Sequence, Union

import numpy as np

from . import _core
from .mesh import Mesh, PathLike
from .simulation import Scene, Source, _has_mesh, _keep_meshes


class Frame:
    """One frame of a run: `time` [s] and `mesh`, whose fields are those that the scene asked for."""

    __slots__ = ("time", "mesh")

    def __init__(self, time: float, mesh: Mesh) -> None:
        self.time = time
        self.mesh = mesh

    def __repr__(self) -> str:
        return f"<Frame at {self.time:.6g} s: {self.mesh!r}>"


class Frames(Sequence[Frame]):
    """Frames of a run, read when asked for: ``run.frames[-1].mesh.positions``."""

    def __init__(self, folder: str) -> None:
        self._list: list[tuple[str, float]] = _core.list_frames(folder)

    @property
    def times(self) -> np.ndarray:
        """Times of the frames [s]."""
        return np.array([time for _, time in self._list])

    def __len__(self) -> int:
        return len(self._list)

    def __getitem__(self, index: Any) -> Any:
        if isinstance(index, slice):
            return [self[i] for i in range(*index.indices(len(self)))]
        path, time = self._list[index]
        return Frame(time, Mesh._of_core(_core.read_vtp(path)[0]))

    def __iter__(self) -> Iterator[Frame]:
        return (self[i] for i in range(len(self)))


class Run:
    """The folder of a run.

    Attributes
    ----------
    folder : str
    series : dict of str to numpy.ndarray
        Columns of series.csv, a number for each frame; cells that are empty or no number are NaN.
    summary : dict
        summary.json.
    """

    def __init__(self, folder: PathLike) -> None:
        self.folder = os.fspath(folder)
        if not os.path.isdir(self.folder):
            raise _core.Error(f"{self.folder}: error: there is no such folder. name the folder of a run")
        self.series = _read_series(os.path.join(self.folder, "series.csv"))
        self.summary = _read_summary(os.path.join(self.folder, "summary.json"))
        self._frames: Optional[Frames] = None

    @property
    def frames(self) -> Frames:
        """The frames, read when asked for."""
        if self._frames is None:
            self._frames = Frames(self.folder)
        return self._frames

    @property
    def final(self) -> Mesh:
        """The surface at the end."""
        return Mesh.read(os.path.join(self.folder, "final.ply"))

    def show(self, path: Optional[PathLike] = None) -> Any:
        """The report of the run: shown in a notebook; elsewhere written to `path` (report.html in the folder by default)."""
        from . import notebook

        return notebook.show_run(self, path)

    def _repr_html_(self) -> str:
        from . import notebook

        return notebook.run_html(self)

    def __repr__(self) -> str:
        return f"<Run {self.folder!r}: {self.summary.get('status', 'unfinished')}, {len(self.series.get('frame', ()))} frames>"


def _number(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        return np.nan


def _read_series(path: str) -> dict[str, np.ndarray]:
    try:
        with open(path, newline="", encoding="utf-8") as file:
            rows = list(csv.reader(file))
    except FileNotFoundError:
        raise _core.Error(f"{path}: error: there is no series. name the folder of a run") from None
    if not rows:
        raise _core.Error(f"{path}: error: the series is empty. run the scene again")
    names, lines = rows[0], [row for row in rows[1:] if len(row) == len(rows[0])]
    return {name: np.array([_number(row[i]) for row in lines]) for i, name in enumerate(names)}


def _read_summary(path: str) -> dict[str, Any]:
    """Empty while the run is in progress."""
    try:
        with open(path, encoding="utf-8") as file:
            return json.load(file)
    except FileNotFoundError:
        return {}
    except ValueError as error:
        raise _core.Error(f"{path}: error: no JSON: {error}. run the scene again") from None


def read_run(folder: PathLike) -> Run:
    """Read the folder of a run: series, frames and summary.

    Raises
    ------
    Error
        A folder that does not exist or holds no run.
    """
    return Run(folder)


def run(
    source: Union[Source, Scene],
    folder: PathLike,
    overrides: Optional[Mapping[str, Any]] = None,
    frames: int = 0,
    threads: int = 0,
) -> Run:
    """Run a scene to its end into a folder, as ``pellicle run`` does, and read it.

    Parameters
    ----------
    source : path, mapping or Scene
        Meshes in a mapping are kept in ``meshes`` of the folder, so that its scene.yaml runs again.
    folder : path
        Made when missing.
    overrides : mapping, optional
        As those of `Scene`.
    frames : int
        Stop with the frame of this number; 0: at the end of the scene.
    threads : int
        0: all processors. The results do not depend on it.

    Raises
    ------
    Error
        The scene is refused, or the run fails; the files in the folder are complete.
    KeyboardInterrupt
        Ctrl-C; the run can be continued from its checkpoint by ``pellicle run --resume``.
    """
    folder = os.path.abspath(os.fspath(folder))
    for name, value in (("frames", frames), ("threads", threads)):
        if not isinstance(value, int) or not 0 <= value < 2**31:
            raise ValueError(f"{name}: must be an integer of at least 0")
    if isinstance(source, Scene):
        overrides = {**source._overrides, **(overrides or {})}
        source = source._source
    if isinstance(source, Mapping) and _has_mesh(source):
        meshes = os.path.join(folder, "meshes")
        shutil.rmtree(meshes, ignore_errors=True)
        os.makedirs(meshes)
        source = _keep_meshes(source, meshes, "")
    scene = Scene(source, overrides)
    _core.run(scene._core, folder, frames, threads, None)
    return Run(folder)
