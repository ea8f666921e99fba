"""Wrong arguments: the right exception with the argument's name, and never a crash."""

import random
import unittest

import numpy as np
import pellicle
from common import ball
from pellicle import Mesh, _core

SIM = pellicle.load_scene(ball())
COUNT = len(SIM.positions())


def rows(count, columns=3):
    return np.zeros((count, columns))


def with_value(value):
    array = SIM.positions()
    array[3, 1] = value
    return array


# arrays that no function for (COUNT, 3) numbers may take, and the exceptions that are right
BAD_NUMBERS = [
    (rows(COUNT - 1), ValueError),
    (rows(COUNT, 2), ValueError),
    (np.zeros(COUNT), ValueError),
    (np.zeros((COUNT, 3, 1)), ValueError),
    (with_value(np.nan), ValueError),
    (with_value(np.inf), ValueError),
    (np.full((COUNT, 3), "a"), TypeError),
    (np.zeros((COUNT, 3), complex), TypeError),
    (np.zeros((COUNT, 3), object), TypeError),
    ([[0, 0, 0], [0, 0]], ValueError),
    ("positions", TypeError),
    (None, TypeError),
    ({}, TypeError),
]

READ_ONLY = rows(COUNT)
READ_ONLY.flags.writeable = False
BAD_OUT = [
    (rows(COUNT + 1), ValueError),
    (rows(3 * COUNT, 1), ValueError),
    (np.zeros((COUNT, 3), np.float32), TypeError),
    (np.zeros((COUNT, 3), np.int64), TypeError),
    (np.zeros((COUNT, 3), ">f8"), TypeError),
    (np.zeros((3, COUNT)).T, ValueError),
    (rows(2 * COUNT)[::2], ValueError),
    (READ_ONLY, ValueError),
    (bytearray(24 * COUNT), TypeError),
    ([], TypeError),
]


class Arrays(unittest.TestCase):
    def refused(self, kind, name, function, *arguments, **keywords):
        with self.assertRaises(kind) as caught:
            function(*arguments, **keywords)
        self.assertIn(name, str(caught.exception))

    def test_numbers(self):
        before = SIM.hash
        for bad, kind in BAD_NUMBERS:
            with self.subTest(bad=repr(bad)[:60]):
                self.refused(kind, "positions", SIM.set_positions, bad)
                self.refused(kind, "velocities", SIM.set_velocities, bad)
                if bad is not None:
                    self.refused(kind, "x", SIM.energy, bad)
                    self.refused(kind, "x", SIM.gradient, bad)
        self.assertEqual(SIM.hash, before)

    def test_out(self):
        for bad, kind in BAD_OUT:
            with self.subTest(bad=repr(bad)[:60]):
                self.refused(kind, "out", SIM.positions, 0, out=bad)
                self.refused(kind, "out", SIM.velocities, 0, out=bad)
                self.refused(kind, "out", SIM.gradient, None, out=bad)

    def test_arrays_that_only_need_a_copy_are_taken(self):
        positions = SIM.positions()
        for form in (np.asfortranarray(positions), positions.astype(np.float32), positions.tolist(), positions.repeat(2, 0)[::2]):
            SIM.set_positions(form)
        SIM.set_positions(positions)

    def test_bodies_tools_and_loads(self):
        self.refused(KeyError, "body", SIM.positions, "head")
        self.refused(ValueError, "body", SIM.positions, 1)
        self.refused(ValueError, "body", SIM.positions, -1)
        self.refused(TypeError, "body", SIM.positions, [0])
        self.refused(KeyError, "tool", SIM.tool, "probe")
        self.refused(ValueError, "tool", SIM.tool, 0)
        self.refused(TypeError, "tool", SIM.tool, 0.5)
        self.refused(KeyError, "load", SIM.set_load, "thumb", [0, 0, 1])
        self.refused(ValueError, "load", SIM.set_load, 7, [0, 0, 1])
        self.refused(ValueError, "force", SIM.set_load, "finger", [0, 1])
        self.refused(ValueError, "force", SIM.set_load, "finger", [0, np.nan, 1])
        self.refused(KeyError, "energy", SIM.field, 0, "enrgy")
        self.refused(ValueError, "n", SIM.step, -1)
        self.refused(TypeError, "n", SIM.step, 1.5)
        self.refused(ValueError, "n", SIM.step, 2**70)
        self.refused(ValueError, "threads", SIM.scene.simulation, -1)

    def test_meshes(self):
        mesh = Mesh.shape("geodesic-sphere", frequency=2)
        self.refused(ValueError, "positions", Mesh, rows(3, 2), [[0, 1, 2]])
        self.refused(TypeError, "positions", Mesh, "abc", [[0, 1, 2]])
        self.refused(ValueError, "triangles", Mesh, rows(3), [[0, 1]])
        self.refused(TypeError, "triangles", Mesh, rows(3), [[0.0, 1.0, 2.0]])
        self.refused(ValueError, "triangles", Mesh, rows(3), [[0, 1, 2**40]])
        self.refused(ValueError, "weight", Mesh, rows(3), [[0, 1, 2]], {"weight": [1, 2]})
        self.refused(ValueError, "levels", mesh.subdivide, -1)
        for index in (-1, len(mesh.positions), 2**31 - 1):
            bad = Mesh(mesh.positions, mesh.triangles.copy())
            bad.triangles[4, 1] = index
            self.assertIn("bad-index", {issue["name"] for issue in bad.check()["issues"]})
            for function in (bad.subdivide, bad.measure, lambda: bad.write("never.ply")):
                with self.assertRaises(pellicle.Error):
                    function()
            bad.self_intersections()
            self.assertEqual(bad.repair()[1]["bad_triangles"], 1)
        bad = Mesh(with_nan := mesh.positions.copy(), mesh.triangles)
        with_nan[2] = np.nan
        with self.assertRaises(pellicle.Error):
            bad.subdivide()


class Fuzz(unittest.TestCase):
    """The extension module by itself, with whatever arguments."""

    ROUNDS = 20_000

    def test_no_call_crashes(self):
        draw = random.Random(1)
        mesh = Mesh.shape("geodesic-sphere", frequency=2)
        sims = [pellicle.load_scene(ball())._core]
        values = [
            None, True, 0, 1, -1, 5, 2**31 - 1, 2**31, 2**63, -(2**63), 2**200, 0.5, float("nan"), float("inf"), "", "ball",
            "a\0b", b"", b"x" * 50, bytearray(24), (), [], {}, (1, 2), ("a",), (("a", 1, rows(3)),), object(),
            mesh.positions, mesh.triangles, SIM.positions(), rows(COUNT).ravel(), READ_ONLY, np.zeros((3, COUNT)).T,
            np.zeros(COUNT), np.zeros((COUNT, 3), np.int32), np.zeros(3), np.zeros(7), np.full(7, np.nan), np.zeros(0),
            np.array([[0, 1, -5]], np.int32), np.array([[0, 1, 2**31 - 1]], np.int32), np.float64(3), np.int32(2),
            memoryview(b"abc"), np.zeros((5, COUNT)), (("weight", 1, np.zeros(len(mesh.positions))),),
        ]  # fmt: skip
        safe = [name for name in dir(_core) if callable(getattr(_core, name)) and name not in ("Error", "Scene", "Sim")]
        for name in ("write_mesh", "write_report", "write_frame", "run"):
            safe.remove(name)
        functions = [getattr(_core, name) for name in safe] + [_core.Scene]
        methods = [name for name in dir(sims[0]) if not name.startswith("_")]
        functions += [getattr(sims[0], name) for name in methods]
        outcomes = {"result": 0, "exception": 0}
        for _ in range(self.ROUNDS):
            function = draw.choice(functions)
            arguments = [draw.choice(values) for _ in range(draw.randrange(8))]
            # steps and levels that take for ever prove nothing
            if getattr(function, "__name__", "") in ("step", "subdivide"):
                arguments = [a for a in arguments if not (isinstance(a, (int, np.integer)) and a > 5)]
            try:
                function(*arguments)
                outcomes["result"] += 1
            except (TypeError, ValueError, KeyError, OverflowError, RuntimeError, MemoryError):
                outcomes["exception"] += 1
        self.assertGreater(outcomes["result"], self.ROUNDS // 100)
        self.assertGreater(outcomes["exception"], self.ROUNDS // 10)


if __name__ == "__main__":
    unittest.main()
