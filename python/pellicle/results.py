"""Runs and their results."""

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
    """One frame of a run: `time` [s], and `mesh` with the fields of the scene's ``output.fields``."""

    __slots__ = ("time", "mesh")

    def __init__(self, time: float, mesh: Mesh) -> None:
        self.time = time
        self.mesh = mesh

    def __repr__(self) -> str:
        return f"<Frame at {self.time:.6g} s: {self.mesh!r}>"


class Frames(Sequence[Frame]):
    """Frames of a run: ``run.frames[-1].mesh.positions``. A frame is read from its file on each access."""

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
    """The results in the folder of a run.

    Attributes
    ----------
    folder : str
        Path of the folder.
    series : dict of str to numpy.ndarray
        Columns of series.csv, one number per frame. A cell that is empty or not a number is NaN.
    summary : dict
        Contents of summary.json (docs/results.md); empty while the run is in progress.
    """

    def __init__(self, folder: PathLike) -> None:
        self.folder = os.fspath(folder)
        if not os.path.isdir(self.folder):
            raise _core.Error(f"{self.folder}: error: there is no folder at this path. pass the path of a run's folder")
        self.series = _read_series(os.path.join(self.folder, "series.csv"))
        self.summary = _read_summary(os.path.join(self.folder, "summary.json"))
        self._frames: Optional[Frames] = None

    @property
    def frames(self) -> Frames:
        """The frames of the run; each is read on access."""
        if self._frames is None:
            self._frames = Frames(self.folder)
        return self._frames

    @property
    def final(self) -> Mesh:
        """The surface at the end of the run (final.ply)."""
        return Mesh.read(os.path.join(self.folder, "final.ply"))

    def show(self, path: Optional[PathLike] = None) -> Any:
        """Show the report of the run.

        In a notebook without `path` the report is shown. Otherwise it is written to `path` (default: report.html in the folder of
        the run), and the result is the path.
        """
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
        raise _core.Error(f"{path}: error: this file does not exist. pass the path of a run's folder") from None
    if not rows:
        raise _core.Error(f"{path}: error: the file is empty. run the scene again")
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
        raise _core.Error(f"{path}: error: invalid JSON: {error}. run the scene again") from None


def read_run(folder: PathLike) -> Run:
    """Read the results in the folder of a run: series, frames and summary.

    Raises
    ------
    Error
        The folder does not exist or contains no run.
    """
    return Run(folder)


def run(
    source: Union[Source, Scene],
    folder: PathLike,
    overrides: Optional[Mapping[str, Any]] = None,
    frames: int = 0,
    threads: int = 0,
    overwrite: bool = False,
) -> Run:
    """Run a scene to its end like ``pellicle run``, write the results into a folder, and read them.

    Parameters
    ----------
    source : path, mapping or Scene
        The scene. `Mesh` objects in a mapping are written to the subfolder ``meshes``, so that the folder's scene.yaml can be
        run again.
    folder : path
        Folder of the results; created if it does not exist.
    overrides : mapping, optional
        Changes of the scene, as for `Scene`.
    frames : int
        Number of the frame at which the run ends (frame 0 is the initial state). 0: the run ends at the end of the scene.
    threads : int
        Threads of the run. 0: the number of the scene. The results do not depend on it.
    overwrite : bool
        Remove the older run in the folder; otherwise it moves aside to ``folder.1``.

    Returns
    -------
    Run

    Raises
    ------
    Error
        The scene is refused, or the run fails. The files in the folder are complete up to the failure.
    KeyboardInterrupt
        Ctrl-C was pressed. ``pellicle run --resume`` continues the run from its checkpoint.
    """
    folder = os.path.abspath(os.fspath(folder))
    for name, value in (("frames", frames), ("threads", threads)):
        if not isinstance(value, int) or not 0 <= value < 2**31:
            raise ValueError(f"{name}: must be an integer within 0 .. {2**31 - 1}, not {value!r}")
    if isinstance(source, Scene):
        overrides = {**source._overrides, **(overrides or {})}
        source = source._source
    if isinstance(source, Mapping) and _has_mesh(source):
        meshes = os.path.join(folder, "meshes")
        _core.take_folder(folder, overwrite)
        overwrite = True
        shutil.rmtree(meshes, ignore_errors=True)
        os.makedirs(meshes)
        source = _keep_meshes(source, meshes, "")
    scene = Scene(source, overrides)
    _core.run(scene._core, folder, frames, threads, None, overwrite)
    return Run(folder)
