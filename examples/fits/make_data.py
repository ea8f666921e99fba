"""Generates the measurements of the fits in this folder: runs with known parameters, and noise with a fixed seed.

    build/venv/bin/python examples/fits/make_data.py
"""

import csv
import pathlib
import tempfile

import numpy as np
import pellicle

HERE = pathlib.Path(__file__).resolve().parent
SHEET = HERE / "sheet.ply"


def curve(scene, overrides, x, y):
    """Run a scene and return two columns of its series."""
    with tempfile.TemporaryDirectory() as folder:
        series = pellicle.run(HERE / scene, folder, overrides).series
    return series[x], series[y]


def write(name, header, columns):
    with open(HERE / name, "w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(header)
        writer.writerows([f"{value:.6g}" for value in row] for row in zip(*columns))


def make_sheet():
    """Write a sheet of 0.1 m x 0.06 m with the field `inclusion`: 1 in a disc, 0 outside."""
    grid = pellicle.Mesh.shape("grid", size_x=0.1, size_y=0.06, nx=20, ny=12)
    place = np.hypot(grid.positions[:, 0] - 0.01, grid.positions[:, 1])
    inclusion = np.clip((0.018 - place) / 0.004, 0, 1)
    pellicle.Mesh(grid.positions, grid.triangles, fields={"inclusion": inclusion}).write(SHEET)


def make_balloon(noise):
    volume, factor = curve(
        "balloon-scene.yaml",
        {"bodies.balloon.membrane.young": 1.2e6, "bodies.balloon.membrane.mooney_ratio": 0.1},
        "volume_ratio",
        "load_factor",
    )
    x = np.geomspace(1.05, 100, 60)
    pressure = 20000 * np.interp(x, volume, factor)
    write("balloon.csv", ["volume_ratio", "pressure"], [x, pressure * (1 + 0.01 * noise.standard_normal(len(x)))])


def make_tissue(noise):
    z, force = curve(
        "tissue-scene.yaml",
        {"bodies.tissue.membrane.young": 3e4, "bodies.tissue.volumetric.stiffness": 3},
        "probe_z",
        "probe_force",
    )
    x = np.linspace(0.0495, 0.0405, 40)
    force = np.interp(x, z[::-1], force[::-1])
    write("tissue.csv", ["probe_z", "force"], [x, force * (1 + 0.01 * noise.standard_normal(len(x)))])


def make_region(noise):
    sim = pellicle.load_scene(
        HERE / "region-scene.yaml",
        {"bodies.sheet.membrane.young.map.0": 1.5e5, "bodies.sheet.membrane.young.map.1": 6e5},
    )
    sim.run_until(sim.scene.duration)
    positions = sim.positions("sheet")
    markers = np.arange(0, len(positions), 5)
    seen = positions[markers] + 5e-5 * noise.standard_normal((len(markers), 3)) * [1, 1, 0]
    write("region.csv", ["vertex", "x", "y", "z"], [markers, *seen.T])


if __name__ == "__main__":
    make_sheet()
    make_balloon(np.random.default_rng(1))
    make_tissue(np.random.default_rng(2))
    make_region(np.random.default_rng(3))
