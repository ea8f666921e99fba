"""Soft tissue and thin shells on triangle meshes.

    import pellicle
    sim = pellicle.load_scene("scenes/balloon.yaml")
    sim.step(100)
    sim.positions("balloon")        # (vertex_count, 3) [m]

docs/python.md is the guide.
"""

from . import _core
from ._core import Error
from .mesh import Mesh
from .results import Frame, Frames, Run, read_run, run
from .simulation import Drag, Scene, Simulation, load_scene
from .study import Sweep, sweep
from .tables import Runs, read_runs
from .calibration import Fit, calibrate

__version__: str = _core.version()

#: Names of the fields that `Simulation.field` can read.
field_names: tuple[str, ...] = tuple(row[0] for row in _core.FIELDS)


def kernels() -> str:
    """Instruction set in use: "avx2" or "baseline". The results do not depend on it.

    To use "baseline", set the environment variable ``PELLICLE_KERNELS=baseline`` before Python starts.
    """
    return _core.kernels()


__all__ = [
    "Drag",
    "Error",
    "Fit",
    "Frame",
    "Frames",
    "Mesh",
    "Run",
    "Runs",
    "Scene",
    "Simulation",
    "Sweep",
    "calibrate",
    "field_names",
    "kernels",
    "load_scene",
    "read_run",
    "read_runs",
    "run",
    "sweep",
]
