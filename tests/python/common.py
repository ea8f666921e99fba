"""What the tests of the Python package share."""

import os
import pathlib
import unittest

import numpy as np
import pellicle

ROOT = pathlib.Path(__file__).resolve().parents[2]
SCENES = ROOT / "scenes"

# parts that take long, or need what only `make nightly` installs
long = unittest.skipUnless("PELLICLE_ALL" in os.environ, "long: in make nightly")


def ball(**more):
    """A small ball of springs that is pressed at its pole."""
    return {
        "bodies": [
            {
                "name": "ball",
                "preset": "paper-a",
                "mesh": {"shape": "geodesic-sphere", "frequency": 3, "radius": 1},
                "volumetric": {"stiffness": 1.5, "damping": 0.5},
            }
        ],
        "loads": [{"name": "finger", "body": "ball", "force": [0, 0, -1], "at": {"nearest": [0, 0, 1]}, "until": 5}],
        "solver": {"method": "quasi-static", "alpha": 50, "dt": 0.01, "velocity": "ignore"},
        "duration": 1,
        **more,
    }


def shell(mesh, **more):
    return {
        "bodies": [
            {
                "name": "shell",
                "mesh": mesh,
                "mass": {"density": 1000, "thickness": 0.01},
                "membrane": {"material": "stvk", "young": 1e4, "poisson": 0.3, "thickness": 0.01},
                "bending": {"model": "hinge"},
                **more.pop("body", {}),
            }
        ],
        "solver": {"method": "xpbd", "dt": 0.01, "substeps": 4},
        "duration": 0.1,
        **more,
    }


def directional(function, x, direction, size):
    """Central difference of a function along a direction."""
    return (function(x + size * direction) - function(x - size * direction)) / (2 * size)


def is_single():
    """True where the state is held in float."""
    positions = pellicle.load_scene(ball()).positions()
    return bool((positions == positions.astype(np.float32)).all())
