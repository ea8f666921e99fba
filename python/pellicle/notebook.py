"""Report pages, shown in Jupyter or written to files."""

from __future__ import annotations

import html
import json
import os
import sys
import tempfile
from typing import TYPE_CHECKING, Any, Optional

import numpy as np

from . import _core
from ._places import shared
from .mesh import PathLike

if TYPE_CHECKING:
    from .results import Run
    from .simulation import Simulation

_HEIGHT = 640


def find_page() -> str:
    """Path of the page without data: $PELLICLE_PAGE, else that of this package, else that of an installed pellicle."""
    beside = os.path.join(os.path.dirname(os.path.abspath(__file__)), "report.html")
    for place in (os.environ.get("PELLICLE_PAGE"), beside, shared("report.html")):
        if place and os.path.isfile(place):
            return place
    raise _core.Error(
        "the page for reports is not installed. run 'make web' and then 'pip install .' in Pellicle's source tree, or set the "
        "environment variable PELLICLE_PAGE to the path of report.html"
    )


def _in_notebook() -> bool:
    shell = sys.modules.get("IPython")
    return shell is not None and getattr(shell.get_ipython(), "kernel", None) is not None


def _frame(page: str) -> str:
    return f'<iframe srcdoc="{html.escape(page)}" width="100%" height="{_HEIGHT}" style="border:0"></iframe>'


class Page:
    """HTML text that a notebook shows."""

    def __init__(self, text: str) -> None:
        self.text = text

    def _repr_html_(self) -> str:
        return self.text


def _text_of_report(folder: str) -> str:
    with tempfile.TemporaryDirectory(prefix="pellicle-") as place:
        path = os.path.join(place, "report.html")
        _core.write_report(path, find_page(), (folder,), ())
        with open(path, encoding="utf-8") as file:
            return file.read()


def _write(folder: str, path: PathLike) -> str:
    target = os.path.abspath(os.fspath(path))
    _core.write_report(target, find_page(), (folder,), ())
    return target


def _table(title: str, rows: dict[str, Any]) -> str:
    """A table of values, shown if the page is not installed."""
    lines = "".join(
        f"<tr><td>{html.escape(str(key))}</td><td>{html.escape(str(value))}</td></tr>"
        for key, value in rows.items()
        if not isinstance(value, (dict, list))
    )
    return f"<p><b>{html.escape(title)}</b></p><table>{lines}</table>"


def show_run(run: "Run", path: Optional[PathLike]) -> Any:
    if path is None and _in_notebook():
        return Page(run_html(run))
    return _write(run.folder, os.path.join(run.folder, "report.html") if path is None else path)


def run_html(run: "Run") -> str:
    try:
        return _frame(_text_of_report(run.folder))
    except _core.Error:
        return _table(run.folder, run.summary)


def _write_state(sim: "Simulation", folder: str) -> None:
    """Write the present state in the format of a run's folder, with one frame."""
    os.makedirs(os.path.join(folder, "frames"))
    meshes = [sim.mesh(body) for body in range(len(sim.scene.bodies))]
    first = np.cumsum([0] + [len(mesh.positions) for mesh in meshes])
    displacement = np.concatenate([sim.field(body, "displacement") for body in range(len(meshes))])
    _core.write_frame(
        folder,
        np.concatenate([mesh.positions for mesh in meshes]),
        np.concatenate([mesh.triangles + np.int32(first[b]) for b, mesh in enumerate(meshes)]).astype(np.int32),
        (("displacement", 3, displacement),),
        sim.time,
    )
    summary = sim.summary()
    with open(os.path.join(folder, "scene.yaml"), "w", encoding="utf-8") as file:
        file.write(sim.scene.text())
    with open(os.path.join(folder, "summary.json"), "w", encoding="utf-8") as file:
        json.dump({"status": "done", "frames": 1, **summary}, file)
    with open(os.path.join(folder, "series.csv"), "w", encoding="utf-8") as file:
        numbers = {"frame": 0, **{key: value for key, value in summary.items() if isinstance(value, float)}}
        file.write(",".join(numbers) + "\n" + ",".join(map(repr, numbers.values())) + "\n")


def show_simulation(sim: "Simulation", path: Optional[PathLike]) -> Any:
    if path is None and _in_notebook():
        return Page(simulation_html(sim))
    with tempfile.TemporaryDirectory(prefix="pellicle-") as place:
        folder = os.path.join(place, "state")
        _write_state(sim, folder)
        return _write(folder, "pellicle.html" if path is None else path)


def simulation_html(sim: "Simulation") -> str:
    try:
        with tempfile.TemporaryDirectory(prefix="pellicle-") as place:
            folder = os.path.join(place, "state")
            _write_state(sim, folder)
            return _frame(_text_of_report(folder))
    except _core.Error:
        return _table(repr(sim), sim.summary())
