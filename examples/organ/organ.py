"""The same organ as a volume of tetrahedra and as a surface of springs, pressed by a ball: force, dent and time of both, and
which springs reproduce the volume. Prints the table of docs/volumes.md and writes organ.svg; fit.json has the fit.

    build/venv/bin/python examples/organ/organ.py FOLDER

needs the Python package (make python), numpy and scipy, and takes some minutes.
"""

import csv
import pathlib
import resource
import shutil
import sys

import numpy as np
import pellicle
from scipy.interpolate import LinearNDInterpolator

HERE = pathlib.Path(__file__).resolve().parent
AXIS, SHAPES = np.array([-0.032, 0.0]), ("springs.young", "volumetric.young")
DEPTHS = (0.005, 0.01, 0.02)
REACH = 0.08  # m, from the axis of the ball, in which surfaces are compared


class Pressed:
    """A run: the force over the height of the ball, the surface at rest and pressed, processor time of a step."""

    def __init__(self, scene, folder, overrides=None):
        before = resource.getrusage(resource.RUSAGE_SELF).ru_utime
        run = pellicle.run(HERE / scene, folder, overrides or {}, threads=1)
        self.seconds = resource.getrusage(resource.RUSAGE_SELF).ru_utime - before
        self.height, self.force = np.array(run.series["ball_z"]), np.array(run.series["ball_force_z"])
        self.volume = float(run.series["volume_ratio"][-1])
        self.steps = len(self.height) - 1
        first, last = run.frames[0].mesh, run.frames[-1].mesh
        self.triangles, self.rest, self.end = first.triangles, first.positions, last.positions

    def on_top(self):
        """vertices of the surface that look up, within reach of the ball"""
        a, b, c = (self.rest[self.triangles[:, k]] for k in range(3))
        normals = np.zeros_like(self.rest)
        for k in range(3):
            np.add.at(normals, self.triangles[:, k], np.cross(b - a, c - a))
        lengths = np.linalg.norm(normals, axis=1)
        up = np.divide(normals[:, 2], lengths, out=np.zeros(len(lengths)), where=lengths > 0)
        return np.flatnonzero((up > 0.3) & (self.radius() < REACH))

    def radius(self):
        return np.linalg.norm(self.rest[:, :2] - AXIS, axis=1)

    def profile(self):
        """mean depth of the dent in rings around the axis"""
        top = self.on_top()
        rings = np.linspace(0, REACH, 17)
        depth, radius = (self.rest - self.end)[top, 2], self.radius()[top]
        middle = 0.5 * (rings[1:] + rings[:-1])
        means = [depth[(radius >= a) & (radius < b)].mean() for a, b in zip(rings, rings[1:])]
        return middle, np.array(means)

    def row(self, name):
        forces = [np.interp(d, self.height[0] - self.height, self.force) for d in DEPTHS]
        middle, depth = self.profile()
        half = np.interp(-0.5 * depth[0], -depth, middle)
        return (f"| {name} | " + " | ".join(f"{f:.3f}" for f in forces) +
                f" | {1e3 * half:.1f} mm | {1e3 * depth[middle > 0.05].mean():.2f} mm | {100 * (1 - self.volume):.2f} % |"
                f" {self.seconds / self.steps:.2f} s |")


def write_data(volume, springs, folder):
    """the measurements of the fit: the force, and the vertices of the springs where the volume has its surface"""
    with open(folder / "force.csv", "w", newline="", encoding="utf-8") as file:
        csv.writer(file).writerows([["ball_z", "ball_force_z"], *zip(volume.height[1:], volume.force[1:])])
    top, seen = volume.on_top(), springs.on_top()
    moved = LinearNDInterpolator(volume.rest[top, :2], (volume.end - volume.rest)[top])(springs.rest[seen, :2])
    inside = np.flatnonzero(np.isfinite(moved[:, 0]))[::4]
    with open(folder / "dent.csv", "w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(["vertex", "x", "y", "z"])
        for i in inside:
            writer.writerow([seen[i], *(springs.rest[seen[i]] + moved[i])])


def draw(rows, path):
    """forces over the depth, and dents over the distance"""
    parts = ['<svg xmlns="http://www.w3.org/2000/svg" width="760" height="340" font-family="sans-serif" font-size="13">',
             '<rect width="760" height="340" fill="white"/>']
    colors, most = ("#000000", "#b04030", "#2060a0"), max(p.force.max() for _, p in rows)
    frames = ((60, "depth of the ball [mm]", "force [N]", 20.0, most), (440, "distance [mm]", "dent [mm]", 80.0, 22.0))
    for left, x_name, y_name, x_most, y_most in frames:
        parts.append(f'<path d="M{left} 30V290H{left + 300}" fill="none" stroke="black"/>'
                     f'<text x="{left + 150}" y="325" text-anchor="middle">{x_name}</text>'
                     f'<text x="{left}" y="20" text-anchor="middle">{y_name}</text>')
        for k in range(1, 5):
            x, y = left + 75 * k, 290 - 65 * k
            parts.append(f'<text x="{x}" y="306" text-anchor="middle">{x_most * k / 4:g}</text>'
                         f'<text x="{left - 6}" y="{y + 4}" text-anchor="end">{y_most * k / 4:.1f}</text>')
    for i, (name, p) in enumerate(rows):
        middle, depth = p.profile()
        curves = ((frames[0], 1e3 * (p.height[0] - p.height), p.force), (frames[1], 1e3 * middle, 1e3 * depth))
        for (left, _, _, x_most, y_most), xs, ys in curves:
            at = " ".join(f"{left + 300 * x / x_most:.1f},{290 - 260 * y / y_most:.1f}" for x, y in zip(xs, ys))
            parts.append(f'<polyline points="{at}" fill="none" stroke="{colors[i]}" stroke-width="2"/>')
        parts.append(f'<text x="540" y="{50 + 18 * i}" fill="{colors[i]}">{name}</text>')
    path.write_text("\n".join([*parts, "</svg>", ""]), encoding="utf-8")


def main():
    folder = pathlib.Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    for name in ("springs.yaml", "fit.yaml"):
        shutil.copy(HERE / name, folder)
    volume, springs = Pressed("volume.yaml", folder / "volume"), Pressed("springs.yaml", folder / "springs")
    write_data(volume, springs, folder)
    fit = pellicle.calibrate(folder / "fit.yaml", folder / "fit")
    fitted = Pressed("springs.yaml", folder / "fitted", fit.values)
    names = [f"springs, {a / 1e3:.3g} and {b / 1e3:.3g} kPa" for a, b in
             ((5e4, 5e3), [fit.values[f"bodies.organ.{key}"] for key in SHAPES])]
    rows = [("tetrahedra, 5 kPa", volume), (names[0], springs), (names[1] + " (fit)", fitted)]
    print("| organ | 5 mm | 10 mm | 20 mm: force [N] | dent: half as deep at | 5 to 8 cm away | loss of volume | step |")
    print("|---|--:|--:|--:|--:|--:|--:|--:|")
    for name, pressed in rows:
        print(pressed.row(name))
    print(f"misfit {100 * fit.misfit:.1f} %")
    draw(rows, folder / "organ.svg")


if __name__ == "__main__":
    main()
