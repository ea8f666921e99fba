"""Meshes."""

import math
import os
import tempfile
import types
import unittest

import numpy as np
import pellicle
from pellicle import Mesh


class Making(unittest.TestCase):
    def test_shapes_and_measures(self):
        sphere = Mesh.shape("geodesic-sphere", frequency=16, radius=2)
        self.assertEqual(len(sphere.positions), 2562)
        self.assertAlmostEqual(sphere.area / (16 * math.pi), 1, delta=0.01)
        self.assertAlmostEqual(sphere.volume / (32 * math.pi / 3), 1, delta=0.01)
        measures = sphere.measure()
        np.testing.assert_allclose(measures["mean_curvature"], 0.5, rtol=0.02)
        np.testing.assert_allclose(measures["gaussian_curvature"], 0.25, rtol=0.1)
        np.testing.assert_allclose(measures["normal"], sphere.positions / 2, atol=0.02)
        self.assertEqual(Mesh.shape("torus").check()["genus"], 1)
        with self.assertRaises(pellicle.Error) as caught:
            Mesh.shape("torsu")
        self.assertIn("torus", str(caught.exception))

    def test_files_keep_everything(self):
        mesh = Mesh.shape("capsule")
        mesh.fields["weight"] = np.linspace(0, 1, len(mesh.positions))
        mesh.fields["flow"] = mesh.positions[:, ::-1]
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "mesh.ply")
            mesh.write(path)
            back = Mesh.read(path)
        np.testing.assert_array_equal(back.positions, mesh.positions)
        np.testing.assert_array_equal(back.triangles, mesh.triangles)
        np.testing.assert_array_equal(back.fields["weight"], mesh.fields["weight"])
        np.testing.assert_array_equal(back.fields["flow"], mesh.fields["flow"])

    def test_subdivision_keeps_vertices(self):
        mesh = Mesh.shape("geodesic-sphere", frequency=2)
        fine = mesh.subdivide(2)
        self.assertEqual(len(fine.triangles), 16 * len(mesh.triangles))
        np.testing.assert_array_equal(fine.positions[: len(mesh.positions)], mesh.positions)

    def test_meshes_of_other_libraries(self):
        grid = Mesh.shape("grid", nx=2, ny=2)
        like_trimesh = types.SimpleNamespace(vertices=grid.positions.tolist(), faces=grid.triangles.astype(np.int64))
        quads = np.array([[0, 1, 4, 3]])
        block = types.SimpleNamespace(type="triangle", data=grid.triangles)
        like_meshio = types.SimpleNamespace(points=grid.positions, cells=[block], point_data={"t": np.arange(9.0)})
        old_meshio = types.SimpleNamespace(points=grid.positions, cells={"quad": quads, "line": np.array([[0, 1]])})
        for other in (like_trimesh, like_meshio, (grid.positions, grid.triangles)):
            np.testing.assert_array_equal(Mesh.of(other).triangles, grid.triangles)
        self.assertEqual(Mesh.of(like_meshio).fields["t"][8], 8)
        self.assertEqual(Mesh.of(old_meshio).triangles.tolist(), [[0, 1, 4], [0, 4, 3]])
        with self.assertRaises(TypeError):
            Mesh.of("ball.ply")


class Questions(unittest.TestCase):
    def test_check_and_repair(self):
        mesh = Mesh.shape("geodesic-sphere", frequency=2)
        soup = Mesh(mesh.positions[mesh.triangles].reshape(-1, 3), np.arange(3 * len(mesh.triangles)).reshape(-1, 3))
        names = {issue["name"] for issue in soup.check()["issues"]}
        self.assertIn("duplicate-vertex", names)
        repaired, summary = soup.repair()
        self.assertTrue(repaired.check()["closed"])
        self.assertEqual(summary["welded_vertices"], len(soup.positions) - len(mesh.positions))
        piece = Mesh.shape("geodesic-sphere", frequency=1)
        both = Mesh(np.concatenate([mesh.positions, piece.positions + 5]),
                    np.concatenate([mesh.triangles, piece.triangles + len(mesh.positions)]))
        whole, summary = both.repair(drop_parts=len(piece.triangles))
        self.assertEqual((len(whole.triangles), summary["dropped_parts"]), (len(mesh.triangles), 1))

    def test_self_intersections(self):
        mesh = Mesh.shape("geodesic-sphere", frequency=3)
        self.assertEqual(mesh.self_intersections().shape, (0, 2))
        mesh.positions[0] *= -1.5
        pairs = mesh.self_intersections()
        self.assertGreater(len(pairs), 0)
        self.assertTrue((pairs[:, 0] < pairs[:, 1]).all())
        self.assertEqual(len(mesh.self_intersections(limit=3)), 3)


if __name__ == "__main__":
    unittest.main()
