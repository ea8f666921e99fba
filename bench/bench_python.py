#!/usr/bin/env python3
"""Times calls of the Python package, and steps of a 20,480-triangle shell from Python beside those of the C driver.

    PYTHONPATH=build/release/python python3 bench/bench_python.py [steps, 400 by default]

Calls are timed on a mesh of 12 vertices, so that the copy costs nothing; then the copy of 10,242 rows. The C driver's time
is that of its own loop around pel_sim_step (steps_per_second of summary.json). Rounds of both take turns; least and median.
"""

import sys
import tempfile
import time

import numpy as np
import pellicle

ROUNDS = 7


def shell(frequency, steps):
    return {
        "bodies": [
            {
                "name": "ball",
                "mesh": {"shape": "geodesic-sphere", "frequency": frequency, "radius": 1},
                "mass": {"density": 1000, "thickness": 0.01},
                "membrane": {"material": "stvk", "young": 1e5, "poisson": 0.3},
                "bending": {"model": "isometric", "weight": 0.01},
                "pressure": {"outside": 1},
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
    scene = pellicle.Scene(shell(32, steps)).prepare()
    python, driver = [], []
    with tempfile.TemporaryDirectory() as folder:
        for _ in range(ROUNDS):
            driver.append(1 / pellicle.run(scene, folder, threads=1).summary["steps_per_second"])
            sim = scene.simulation(threads=1)
            start = time.perf_counter()
            for _ in range(steps):
                sim.step()
            python.append((time.perf_counter() - start) / steps)
    for name, times in (("sim.step(), one call a step", python), ("the C driver", driver)):
        print(f"{name:34s} least {1e6 * min(times):8.1f} us   median {1e6 * np.median(times):8.1f} us a step")
    print(f"Python over C: least {min(python) / min(driver):.4f}, median {np.median(python) / np.median(driver):.4f}")


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
    time_steps(int(sys.argv[1]) if len(sys.argv) > 1 else 400)


if __name__ == "__main__":
    main()
