"""Studies: many runs of one scene with different parameters, and one table of results."""

from __future__ import annotations

import csv
import json
import os
from typing import Any, Iterator, Mapping, Optional, Union

import numpy as np

from . import _core
from .mesh import PathLike
from .simulation import _plain

#: Number of KilledWorker errors after which a run has the status "crashed". Dask retries a run several times before each error.
_LOSSES = 2


class Sweep:
    """The table of a study.

    Attributes
    ----------
    folder : str
        Folder of the study, with the table runs.csv and its pictures in report.html.
    columns : dict of str to numpy.ndarray
        Columns of the table, by name: ``run``, the parameters, the measures, ``status`` and ``error``, with one value per run.
        Measures of failed runs are NaN. Columns with other values than numbers (vectors, words, status, error) contain str.
    """

    def __init__(self, folder: PathLike) -> None:
        self.folder = os.fspath(folder)
        path = os.path.join(self.folder, "runs.csv")
        try:
            with open(path, newline="", encoding="utf-8") as file:
                names, *rows = csv.reader(file)
        except FileNotFoundError:
            raise _core.Error(
                f"{path}: error: there is no table, because runs are missing. run the study again: it continues"
            ) from None
        self.columns: dict[str, np.ndarray] = {
            name: _column([row[i] for row in rows], name in ("status", "error")) for i, name in enumerate(names)
        }

    @property
    def failed(self) -> np.ndarray:
        """Numbers of the runs that failed. The columns status and error have the reasons."""
        return np.flatnonzero(self.columns["status"] != "done")

    def __getitem__(self, name: str) -> np.ndarray:
        if name not in self.columns:
            raise KeyError(f"there is no column {name!r}. use one of {', '.join(map(repr, self.columns))}")
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
    """Write the table to runs.parquet too, if pyarrow is installed."""
    try:
        import pyarrow
        import pyarrow.parquet
    except ImportError:
        return
    arrays = pyarrow.table({name: pyarrow.array(column) for name, column in table.columns.items()})
    pyarrow.parquet.write_table(arrays, os.path.join(table.folder, "runs.parquet"))


_studies: dict[tuple[str, Optional[str]], Any] = {}


def _run_one(path: str, text: Optional[str], run: int, folder: str) -> str:
    """Execute a run in a Dask worker and return its row. The worker keeps the study between runs."""
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
                store.add(study.lost(run, "crashed", "Dask workers repeatedly ended during this run"))
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
    """Execute all runs of a study, like ``pellicle sweep``, and return the table.

    Runs that already have a row in the folder are not repeated, so the same call continues after Ctrl-C, a kill or a lost worker.
    The table has the same bits on one core, on all cores and on Dask.

    Parameters
    ----------
    study : path or mapping
        A study file, or a dict with its keys (docs/sweeps.md). In a dict, the path of the scene is relative to the current
        folder.
    folder : path
        Folder of the study; created if it does not exist.
    jobs : int
        Maximum number of simultaneous runs on this machine; 0: one per processor.
    client : distributed.Client, optional
        Execute the runs on the workers of this Dask cluster. The study, its scene and meshes must have the same paths there.
    timeout : float
        Maximum wall time of a run [s]; a run that takes longer is ended and its row has the status ``timeout``. 0: no limit.
        Not supported with `client`.
    retry : bool
        True: repeat runs that failed in earlier calls.

    Returns
    -------
    Sweep

    Raises
    ------
    Error
        The study is refused, or the folder contains another study. A run that fails, crashes or is killed raises no error; its
        row of the table has the reason.
    KeyboardInterrupt
        Ctrl-C was pressed.
    """
    if not isinstance(jobs, int) or not 0 <= jobs <= 1024:
        raise ValueError(f"jobs: must be an integer within 0 .. 1024, not {jobs!r}")
    if not isinstance(timeout, (int, float)) or not 0 <= timeout < float("inf"):
        raise ValueError(f"timeout: must be a finite number of seconds of at least 0 (0: no limit), not {timeout!r}")
    if client is not None and timeout:
        raise ValueError("timeout: must be 0 with a Dask client, because its workers execute several runs in one process")
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
