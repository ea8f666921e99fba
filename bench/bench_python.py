#!/usr/bin/env python3
"""Times calls of the Python package, and steps of a 20,480-triangle shell from Python beside a loop in C.

    PYTHONPATH=build/release/python python3 bench/bench_python.py [steps, 1000 by default]

Calls are timed on a mesh of 12 vertices, so that the copy costs nothing; then the copy of 10,242 rows. Least
and median.
"""

import sys
import time

import numpy as np
import pellicle

ROUNDS, BLOCK = 7, 10


def shell(frequency, steps):
    return {
        "bodies": [
            {
                "name": "ball",
                "mesh": {"shape": "geodesic-sphere", "frequency": frequency, "radius": 1},
                "mass": {"density": 1000, "thickness": 0.01},
                "membrane": {"material": "stvk", "young": 1e5, "poisson": 0.3},
                "bending": {"model": "isometric", "weight": 0.01},
            }
        ],
        "solver": {"method": "pbd", "dt": 1 / 60, "iterations": 1},
        "duration": steps / 60,
        "output": {"every_frame": steps},
    }


def time_call(name, function, count=20_000):
    best = []
    for _ in range(ROUNDS):
        start = time.perf_counter()
        for _ in range(count):
            function()
        best.append((time.perf_counter() - start) / count)
    print(f"{name:34s} least {1e6 * min(best):8.3f} us   median {1e6 * np.median(best):8.3f} us")


def time_steps(steps):
    """Blocks of steps in turns: one call a step, and one call a block, whose loop is in C. Both do the same work."""
    scene = pellicle.Scene(shell(32, steps)).prepare()
    sims, times = (scene.simulation(threads=1), scene.simulation(threads=1)), ([], [])
    for block in range(steps // BLOCK):
        # who comes first changes, so that neither always finds a warm machine
        for which in ((0, 1), (1, 0))[block % 2]:
            start = time.perf_counter()
            if which == 0:
                for _ in range(BLOCK):
                    sims[0].step()
            else:
                sims[1].step(BLOCK)
            times[which].append((time.perf_counter() - start) / BLOCK)
    python, c = times
    for name, column in (("one call a step", python), ("one call for all, loop in C", c)):
        print(f"{name:34s} least {1e6 * min(column):8.1f} us   median {1e6 * np.median(column):8.1f} us a step")
    print(f"Python over C: least {min(python) / min(c):.4f}, median {np.median(python) / np.median(c):.4f}")


def main():
    small = pellicle.load_scene(shell(1, 1))
    out = small.positions()
    print(f"pellicle {pellicle.__version__}, kernels {pellicle.kernels()}, {len(out)} vertices:")
    time_call("sim.positions('ball')", lambda: small.positions("ball"))
    time_call("sim.positions('ball', out=out)", lambda: small.positions("ball", out=out))
    time_call("sim.velocities('ball')", lambda: small.velocities("ball"))
    time_call("sim.time", lambda: small.time)
    time_call("sim.step(0)", lambda: small.step(0))
    large = pellicle.load_scene(shell(32, 1))
    rows = large.positions()
    print(f"{len(rows)} vertices:")
    time_call("sim.positions('ball', out=out)", lambda: large.positions("ball", out=rows), 2000)
    time_steps(int(sys.argv[1]) if len(sys.argv) > 1 else 1000)


if __name__ == "__main__":
    main()
