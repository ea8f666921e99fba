"""Studies: many runs of one scene with different parameters, and one table."""

from __future__ import annotations

import csv
import json
import os
from typing import Any, Iterator, Mapping, Optional, Union

import numpy as np

from . import _core
from .mesh import PathLike
from .simulation import _plain

#: Workers of Dask that a run may lose; Dask itself tries a few times before it counts as one.
_LOSSES = 2


class Sweep:
    """The table of a study.

    Attributes
    ----------
    folder : str
        Holds runs.csv, and report.html with pictures of it.
    columns : dict of str to numpy.ndarray
        A column for each parameter and measure, a row for each run; NaN where a run failed. Columns that are no numbers
        (run by run: vectors, words, status, error) hold texts.
    """

    def __init__(self, folder: PathLike) -> None:
        self.folder = os.fspath(folder)
        path = os.path.join(self.folder, "runs.csv")
        try:
            with open(path, newline="", encoding="utf-8") as file:
                names, *rows = csv.reader(file)
        except FileNotFoundError:
            raise _core.Error(f"{path}: error: there is no table. runs are missing: do the study again to continue") from None
        self.columns: dict[str, np.ndarray] = {
            name: _column([row[i] for row in rows], name in ("status", "error")) for i, name in enumerate(names)
        }

    @property
    def failed(self) -> np.ndarray:
        """Numbers of the runs that failed; the columns status and error say why."""
        return np.flatnonzero(self.columns["status"] != "done")

    def __getitem__(self, name: str) -> np.ndarray:
        if name not in self.columns:
            raise KeyError(f"{name!r} is none of {', '.join(map(repr, self.columns))}")
        return self.columns[name]

    def __len__(self) -> int:
        return len(self.columns["run"])

    def __iter__(self) -> Iterator[str]:
        return iter(self.columns)

    def __repr__(self) -> str:
        return f"<Sweep {self.folder!r}: {len(self)} runs, {len(self.failed)} failed>"


def _column(texts: list[str], is_text: bool) -> np.ndarray:
    if not is_text:
        try:
            return np.array([float(text) if text else np.nan for text in texts])
        except ValueError:
            pass
    return np.array(texts, dtype=str)


def _write_parquet(table: Sweep) -> None:
    """The same as Parquet, where pyarrow is there."""
    try:
        import pyarrow
        import pyarrow.parquet
    except ImportError:
        return
    arrays = pyarrow.table({name: pyarrow.array(column) for name, column in table.columns.items()})
    pyarrow.parquet.write_table(arrays, os.path.join(table.folder, "runs.parquet"))


_studies: dict[tuple[str, Optional[str]], Any] = {}


def _run_one(path: str, text: Optional[str], run: int, folder: str) -> str:
    """A row; in a worker of Dask, which keeps the study between its runs."""
    key = (path, text)
    if key not in _studies:
        _studies.clear()
        _studies[key] = _core.Study(path, text)
    return _studies[key].run(run, folder)


def _sweep_dask(study: Any, path: str, text: Optional[str], folder: str, client: Any, retry: bool) -> None:
    from distributed import as_completed
    from distributed.scheduler import KilledWorker

    store = study.open(folder)
    lost: dict[int, int] = {}

    def submit(run: int) -> Any:
        return client.submit(_run_one, path, text, run, folder, pure=False)

    try:
        futures = {submit(run): run for run in range(study.info()[0]) if store.needs(run) or retry and store.failed(run)}
        pending = as_completed(list(futures))
        for future in pending:
            run = futures.pop(future)
            error = future.exception()
            if error is None:
                store.add(future.result())
                continue
            if not isinstance(error, KilledWorker):
                client.cancel(list(futures))
                raise error
            lost[run] = lost.get(run, 0) + 1
            if lost[run] >= _LOSSES:
                store.add(study.lost(run, "crashed", "workers of Dask ended again and again while they did this run"))
                continue
            again = submit(run)
            futures[again] = run
            pending.add(again)
        store.collect()
    finally:
        store.close()


def sweep(
    study: Union[PathLike, Mapping[str, Any]],
    folder: PathLike,
    jobs: int = 0,
    client: Any = None,
    timeout: float = 0,
    retry: bool = False,
) -> Sweep:
    """Do all runs of a study and give the table, as ``pellicle sweep`` does.

    Runs that are in the folder already are not done again: after Ctrl-C, a kill or a lost worker the same call continues.
    The table has the same bits on one core, on all cores and on Dask.

    Parameters
    ----------
    study : path or mapping
        A study file (docs/sweeps.md), or a dict with its keys; the path of its scene is then relative to the current folder.
    folder : path
        Made when missing.
    jobs : int
        Runs at a time on this machine; 0: one for each core.
    client : distributed.Client, optional
        Do the runs on the workers of this Dask cluster, which must see the study, its scene and meshes under the same paths.
    timeout : float
        Seconds that a run may take before it is ended and becomes a row with the status ``timeout``; 0: any. Not with
        `client`.
    retry : bool
        Do runs again that failed before.

    Raises
    ------
    Error
        The study is refused, or the folder holds another one. A run that fails, crashes or is killed is a row of the
        table, not an error.
    KeyboardInterrupt
        Ctrl-C.
    """
    if not isinstance(jobs, int) or not 0 <= jobs <= 1024:
        raise ValueError("jobs: must be an integer within 0 .. 1024")
    if not isinstance(timeout, (int, float)) or not 0 <= timeout < float("inf"):
        raise ValueError("timeout: must be a number of seconds, 0 for any")
    if client is not None and timeout:
        raise ValueError("timeout: must be 0 on Dask, whose workers do several runs in one process")
    folder = os.path.abspath(os.fspath(folder))
    if isinstance(study, Mapping):
        path, text = os.path.abspath("study"), json.dumps(study, default=_plain, indent=1)
    else:
        path, text = os.path.abspath(os.fspath(study)), None
    core = _core.Study(path, text)
    if client is None:
        core.execute(folder, jobs, timeout, retry)
    else:
        _sweep_dask(core, path, text, folder, client, retry)
    table = Sweep(folder)
    _write_parquet(table)
    return table
