"""The series of several runs as tables of pandas and xarray, which are imported when they are asked for."""

from __future__ import annotations

import os
from typing import Any, Iterable, Iterator, Sequence, Union

import numpy as np

from .mesh import PathLike
from .results import Run, read_run


class Runs(Sequence[Run]):
    """Several runs, by the names of their folders: ``runs["soft"]``, ``runs[0]``.

    Attributes
    ----------
    names : tuple of str
        Names of the folders; whole paths where two folders have the same name.
    """

    def __init__(self, folders: Iterable[PathLike]) -> None:
        self._runs = [read_run(folder) for folder in folders]
        paths = [os.path.abspath(run.folder) for run in self._runs]
        names = [os.path.basename(path) for path in paths]
        self.names: tuple[str, ...] = tuple(paths if len(set(names)) < len(names) else names)

    def __len__(self) -> int:
        return len(self._runs)

    def __getitem__(self, index: Any) -> Any:
        if isinstance(index, str):
            if index not in self.names:
                raise KeyError(f"there is no run {index!r}. the runs are {', '.join(self.names)}")
            return self._runs[self.names.index(index)]
        return self._runs[index]

    def __iter__(self) -> Iterator[Run]:
        return iter(self._runs)

    def columns(self) -> list[str]:
        """Columns of series.csv that any of the runs has, in the order of their first appearance."""
        return list(dict.fromkeys(name for run in self._runs for name in run.series))

    def to_pandas(self) -> Any:
        """A DataFrame with a row for each frame of each run; the index has the levels ``run`` and ``frame``. Cells that a run lacks are NaN.

        Raises
        ------
        ImportError
            pandas is not installed.
        """
        pandas = _module("pandas", "python3-pandas")
        tables = {name: pandas.DataFrame(run.series) for name, run in zip(self.names, self._runs)}
        table = pandas.concat(tables, names=["run", "row"]).reset_index("row", drop=True)
        return table.astype({"frame": int}).set_index("frame", append=True)

    def to_xarray(self) -> Any:
        """A Dataset with the dimensions ``run`` and ``frame``; shorter runs end in NaN. ``time`` [s] is a variable of both.

        Raises
        ------
        ImportError
            xarray is not installed.
        """
        xarray = _module("xarray", "python3-xarray")
        length = max((len(run.series["frame"]) for run in self._runs), default=0)
        variables = {}
        for name in self.columns():
            if name == "frame":
                continue
            values = np.full((len(self), length), np.nan)
            for row, run in zip(values, self._runs):
                column = run.series.get(name, np.empty(0))
                row[: len(column)] = column
            variables[name] = (("run", "frame"), values)
        return xarray.Dataset(variables, coords={"run": list(self.names), "frame": np.arange(length)})

    def __repr__(self) -> str:
        return f"<Runs: {', '.join(self.names)}>"


def _module(name: str, package: str) -> Any:
    import importlib

    try:
        return importlib.import_module(name)
    except ImportError:
        raise ImportError(f"{name} is not installed. install it with 'pip install {name}', or Debian's {package}") from None


def read_runs(folders: Union[PathLike, Iterable[PathLike]]) -> Runs:
    """Read the results of several runs: ``pellicle.read_runs(["results/soft", "results/stiff"]).to_pandas()``.

    Parameters
    ----------
    folders : paths, or one path
        Folders of runs. One path is that of a folder that contains folders of runs.

    Raises
    ------
    Error
        A folder does not exist or contains no run.
    """
    if isinstance(folders, (str, os.PathLike)):
        parent = os.fspath(folders)
        if os.path.isfile(os.path.join(parent, "series.csv")) or not os.path.isdir(parent):
            return Runs([parent])
        inside = sorted(entry.path for entry in os.scandir(parent) if entry.is_dir())
        return Runs(path for path in inside if os.path.isfile(os.path.join(path, "series.csv")))
    return Runs(folders)
