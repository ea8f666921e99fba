"""Paper B's locally anisotropic energy (mode normal) against its formulas in numpy, with the projection p, the
singular value decomposition, i4 and i5 as in section 3 of the paper: corrections of pbd, and the force of the others."""

import unittest

import numpy as np
import pellicle
from common import is_single

TRIANGLES, AXIS, STIFFNESS, GRADIENT, EDGE_SHARE = 60, np.array([0.3, -0.8, 0.5]), 700.0, 40.0, 0.05


def triangles_apart(rng):
    """Random triangles that share no vertex, at rest."""
    x = rng.uniform(-1, 1, (TRIANGLES, 3, 3)) * 0.5
    x += 3 * np.arange(TRIANGLES)[:, None, None] * np.array([1.0, 0, 0])
    return x


def deformed(rest, rng):
    """Each squeezed or stretched by a strain over three decades, turned, bent and moved."""
    out = np.empty_like(rest)
    for t, x in enumerate(rest):
        size = 10 ** rng.uniform(-3.5, -0.5) * rng.choice([-1, -1, 1])
        turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
        turn *= np.sign(np.linalg.det(turn))
        middle = x.mean(0)
        shear = np.eye(3) + size * (0.5 * rng.normal(size=(3, 3)) + np.eye(3))
        out[t] = (x - middle) @ shear.T @ turn.T + middle
    return out


def energy(rest, x, kind, axis=AXIS):
    """E_A of a triangle as in the paper: (0 where the fibre is longer than at rest), and the unit normal."""
    e1, e2 = rest[0] - rest[2], rest[1] - rest[2]
    normal = np.cross(rest[1] - rest[0], rest[2] - rest[0])
    area = 0.5 * np.linalg.norm(normal)
    normal /= 2 * area
    t1 = e1 / np.linalg.norm(e1)
    frame = np.array([t1, np.cross(normal, t1)])
    d_m = np.column_stack([frame @ e1, frame @ e2])
    a = frame @ (axis - axis @ normal * normal)
    a /= np.linalg.norm(a)
    d_s = np.column_stack([x[0] - x[2], x[1] - x[2]])
    now = np.cross(x[1] - x[0], x[2] - x[0])
    now /= np.linalg.norm(now)
    u1 = d_s[:, 0] / np.linalg.norm(d_s[:, 0])
    p = np.array([u1, np.cross(now, u1)])
    f_hat = p @ d_s @ np.linalg.inv(d_m)
    u, _, v = np.linalg.svd(f_hat)
    r = p.T @ (u @ v)
    f = p.T @ f_hat
    fibre = np.outer(a, a)
    i4, i5 = np.trace(r.T @ f @ fibre), np.trace(f.T @ f @ fibre)
    psi = {"arap": (np.sqrt(i5) - np.sign(i4)) ** 2, "sqrt": (np.sqrt(i5) - 1) ** 2, "stvk": (i5 - 1) ** 2}[kind]
    return (area * STIFFNESS / 2 * psi if i5 < 1 else 0.0), now, np.sqrt(4 / np.sqrt(3) * area)


def project(rest, x, kind, sweeps, gradient=GRADIENT, axis=AXIS):
    """pbd: C = E_A, grad C = k_A n, dx = -C / (3 k_A) n for three equal masses; five sweeps push as in the paper."""
    x = x.copy()
    for t in range(len(rest)):
        for _ in range(sweeps):
            c, normal, edge = energy(rest[t], x[t], kind, axis)
            x[t] -= 5 / sweeps * min(c / (3 * gradient), EDGE_SHARE * edge) * normal
    return x


def force(rest, x, kind):
    """On each corner: stiffness times the push of a correction."""
    f = np.empty_like(x)
    for t in range(len(rest)):
        c, normal, _ = energy(rest[t], x[t], kind)
        f[t] = -STIFFNESS * c / (3 * GRADIENT) * normal
    return f


def simulate(rest, kind, solver, gradient=GRADIENT, axis=AXIS):
    mesh = pellicle.Mesh(rest.reshape(-1, 3), np.arange(3 * len(rest)).reshape(-1, 3))
    spec = {
        "bodies": [
            {
                "name": "shell",
                "mesh": mesh,
                "mass": {"per_vertex": 2.0},
                "springs": {"stiffness": 0, "damping": 0},
                "anisotropy": {"mode": "normal", "energy": kind, "stiffness": STIFFNESS, "gradient": gradient,
                               "direction": axis.tolist()},
            }
        ],
        "solver": solver,
        "duration": 1,
    }
    return pellicle.load_scene(spec)


def two_stages(rest, start, after, kind, scale):
    """The way of a step from rest in two stages (docs/solvers.md), with the force of its end; scale: dt^2 / mass."""
    g = 1 - 1 / np.sqrt(2)
    way = 0
    for _ in range(50):
        way = g**2 * scale * force(rest, start + way, kind)
    # the second stage starts at a share 1/g - 1 of the first one's way and of its velocity, way / (g dt)
    return 2 * (1 / g - 1) * way + g**2 * scale * force(rest, after, kind)


class Caving(unittest.TestCase):
    def setUp(self):
        self.rng = np.random.default_rng(7)
        self.rest = triangles_apart(self.rng)
        self.start = deformed(self.rest, self.rng)
        self.tolerance = 1e-4 if is_single() else 1e-9

    def step(self, kind, solver, **settings):
        sim = simulate(self.rest, kind, solver, **settings)
        sim.set_positions(self.start.reshape(-1, 3))
        sim.step()
        return sim.positions().reshape(-1, 3, 3)

    def test_corrections(self):
        pushes = {}
        for kind in ("arap", "sqrt", "stvk"):
            for sweeps in (1, 5, 12):
                after = self.step(kind, {"method": "pbd", "dt": 0.01, "iterations": sweeps})
                expected = project(self.rest, self.start, kind, sweeps)
                np.testing.assert_allclose(after, expected, rtol=0, atol=self.tolerance)
            pushes[kind] = np.linalg.norm(after - self.start, axis=2).max(axis=1)
        np.testing.assert_allclose(pushes["arap"], pushes["sqrt"], rtol=0, atol=1e-12)
        moved = pushes["arap"] > 0
        self.assertGreater(moved.sum(), TRIANGLES // 3)
        self.assertLess(moved.sum(), TRIANGLES)
        # stvk: four times the energy of a small strain, where the bound does not act
        small = moved & (pushes["stvk"] < 1e-3)
        ratio = pushes["stvk"][small] / pushes["arap"][small]
        self.assertGreater(small.sum(), 5)
        self.assertTrue(is_single() or (np.abs(ratio - 4) < 1).all())

    def test_strength_and_direction(self):
        solver, ways = {"method": "pbd", "dt": 0.01, "iterations": 5}, []
        for gradient in (4.0, 40.0, 400.0, 4000.0):
            after = self.step("arap", solver, gradient=gradient)
            np.testing.assert_allclose(after, project(self.rest, self.start, "arap", 5, gradient), rtol=0, atol=self.tolerance)
            ways.append(np.linalg.norm(after - self.start, axis=2).max(axis=1))
        # the push is C / (3 k_A): a decade of k_A is a decade of the push, where the bound does not act
        for less, more in zip(ways[1:], ways):
            moved = (less > 1e-6) & (more < 1e-3)
            self.assertGreater(moved.sum(), 2)
            self.assertTrue((less <= more).all() and (is_single() or np.abs(more[moved] / less[moved] - 10).max() < 0.5))
        turned = np.array([0.8, 0.3, -0.2])
        after = self.step("arap", solver, axis=turned)
        np.testing.assert_allclose(after, project(self.rest, self.start, "arap", 5, axis=turned), rtol=0, atol=self.tolerance)
        way = np.linalg.norm(after - self.start, axis=2).max(axis=1)
        self.assertGreater(np.abs(way - ways[1]).max(), 0.1 * ways[1].max())

    def test_pushes_do_not_depend_on_sweeps(self):
        ways = [self.step("arap", {"method": "pbd", "dt": 0.01, "iterations": n}) - self.start for n in (1, 5, 40)]
        for way in ways[1:]:
            np.testing.assert_allclose(way, ways[0], rtol=0, atol=2e-3 * np.abs(ways[0]).max())

    def test_forces(self):
        dt, mass = 0.01, 2.0
        for kind in ("arap", "stvk"):
            after = self.step(kind, {"method": "xpbd", "dt": dt, "substeps": 1, "second_order": False})
            way = dt**2 / mass * force(self.rest, self.start, kind)
            np.testing.assert_allclose(after - self.start, way, rtol=0, atol=self.tolerance * (1 + np.abs(way).max()))
            after = self.step(kind, {"method": "implicit", "dt": dt})
            way = two_stages(self.rest, self.start, after, kind, dt**2 / mass)
            # a stage converges to 1e-3 of its forces
            np.testing.assert_allclose(after - self.start, way, rtol=0, atol=3e-3 * np.abs(way).max())
            self.assertGreater(np.abs(way).max(), 1e-4)


if __name__ == "__main__":
    unittest.main()
