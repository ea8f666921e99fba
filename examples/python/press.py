"""Press a spherical probe into a hollow ball and plot the force over the depth.

    build/venv/bin/python examples/python/press.py [press.png]

Without matplotlib, the script only prints the numbers.
"""

import sys

import pellicle


def press():
    """Depths [m], forces [N] and residuals [N] of a probe that moves 12 mm into a ball of 50 mm radius.

    The ball is in equilibrium at each depth.
    """
    ball = pellicle.Mesh.shape("geodesic-sphere", frequency=8, radius=0.05)
    sim = pellicle.load_scene(
        {
            "bodies": [
                {
                    "name": "ball",
                    "mesh": ball,
                    "mass": {"density": 1000, "thickness": 0.005},
                    "membrane": {"material": "neo-hookean", "young": 2e5, "poisson": 0.45},
                    "bending": {"model": "hinge"},
                    "pinned": {"sphere": {"center": [0, 0, -0.05], "radius": 0.015}},
                }
            ],
            "tools": [
                {
                    "name": "probe",
                    "shape": "sphere",
                    "radius": 0.02,
                    "motion": [{"time": 0, "position": [0, 0, 0.07]}, {"time": 1, "position": [0, 0, 0.058]}],
                }
            ],
            "solver": {"method": "static", "dt": 1 / 12},
        }
    )
    depths, forces, residuals = [], [], []
    for _ in range(12):
        sim.step()
        reading = sim.tool("probe")
        depths.append(0.07 - reading["position"][2])
        forces.append(reading["force"][2])
        residuals.append(sim.solver()["residual"])
    return depths, forces, residuals


def plot(path, depths, forces):
    try:
        import matplotlib

        matplotlib.use("Agg")
        import matplotlib.pyplot as plot
    except ImportError:
        print("matplotlib is not installed, so no picture is drawn. install it (Debian: python3-matplotlib)")
        return
    plot.plot([1e3 * depth for depth in depths], forces, "o-")
    plot.xlabel("depth / mm")
    plot.ylabel("force / N")
    plot.savefig(path)


if __name__ == "__main__":
    depths, forces, residuals = press()
    for depth, force, residual in zip(depths, forces, residuals):
        print(f"{1e3 * depth:6.2f} mm  {force:8.4f} N  (residual {residual:.1e} N)")
    if len(sys.argv) > 1:
        plot(sys.argv[1], depths, forces)
