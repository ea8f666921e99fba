"""Inflate a rubber balloon past its maximum pressure.

    build/venv/bin/python examples/python/inflate.py

The scene prescribes the volume, because past the maximum pressure there is no equilibrium at a larger pressure. The pressure is
computed from its force on the surface, and compared with the closed-form solution of a sphere of Mooney-Rivlin rubber.
"""

import numpy as np
import pellicle

RADIUS, THICKNESS, YOUNG, RATIO = 0.05, 0.5e-3, 1.2e6, 0.1


def closed_form(stretch):
    """Pressure [Pa] in a thin sphere of Mooney-Rivlin rubber (c1 + c2 = E / 6, c2 / c1 = RATIO) stretched by `stretch`."""
    c1 = YOUNG / 6 / (1 + RATIO)
    return 4 * THICKNESS / RADIUS * (1 / stretch - stretch**-7) * (c1 + RATIO * c1 * stretch**2)


def inflate(frequency=8, volume=8.0, steps=28):
    """Stretches and pressures [Pa] of a sphere that is inflated to `volume` times its volume at rest."""
    sim = pellicle.load_scene(
        {
            "bodies": [
                {
                    "name": "balloon",
                    "mesh": pellicle.Mesh.shape("geodesic-sphere", frequency=frequency, radius=RADIUS),
                    "mass": {"density": 950, "thickness": THICKNESS},
                    "membrane": {"material": "mooney-rivlin", "young": YOUNG, "poisson": 0.5, "mooney_ratio": RATIO},
                    "bending": {"model": "none"},  # the closed form is that of a membrane without bending
                    "pressure": {"volume": {"target": {"keys": [[0, 1], [1, volume]]}, "bulk": 1e6}},
                }
            ],
            "solver": {"method": "static", "dt": 1 / steps},
        }
    )
    stretches, pressures = [], []
    for _ in range(steps):
        sim.step()
        mesh = sim.mesh()
        normals = mesh.measure()["normal"]
        # the force of the pressure on a vertex is the pressure times the vertex's area, along the normal
        force = np.einsum("ij,ij->", sim.field("balloon", "pressure"), normals)
        stretches.append(sim.summary()["volume_ratio"] ** (1 / 3))
        pressures.append(force / mesh.area)
    return np.array(stretches), np.array(pressures)


if __name__ == "__main__":
    stretches, pressures = inflate()
    for stretch, pressure in zip(stretches, pressures):
        print(f"stretch {stretch:5.3f}  {pressure:7.1f} Pa  closed form {closed_form(stretch):7.1f} Pa")
    top = pressures.argmax()
    print(f"maximum {pressures[top]:.1f} Pa at stretch {stretches[top]:.3f}")
