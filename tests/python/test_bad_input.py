"""Wrong arguments: the right exception with the argument's name, and never a crash."""

import random
import unittest

import numpy as np
import pellicle
from common import ball, shell
from pellicle import Mesh, _core

SIM = pellicle.load_scene(ball())
COUNT = len(SIM.positions())
PROBE = {"name": "probe", "shape": "sphere", "radius": 0.1, "motion": [{"time": 0, "position": [0, 0, 5]}]}


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

    def test_every_function_with_numbers(self):
        """Every public function that takes numbers refuses each wrong array by the argument's name, and changes nothing."""
        sheet = pellicle.load_scene(shell({"shape": "grid", "nx": 3, "ny": 3}, tools=[PROBE]))
        count = len(sheet.positions())
        with sheet.drag([0.1, 0.1, 1], [0, 0, -1], 1, 0.1) as drag:
            takers = [
                ("positions", (count, 3), sheet.set_positions),
                ("velocities", (count, 3), sheet.set_velocities),
                ("x", (count, 3), sheet.energy),
                ("x", (count, 3), sheet.gradient),
                ("x", (count, 3), sheet.hessian),
                ("loss_gradient", (count, 3), sheet.adjoint),
                ("position", (3,), lambda value: sheet.set_tool("probe", value)),
                ("rotation", (4,), lambda value: sheet.set_tool("probe", [0, 0, 1], value)),
                ("origin", (3,), lambda value: sheet.pick(value, [0, 0, 1])),
                ("direction", (3,), lambda value: sheet.pick([0, 0, 1], value)),
                ("origin", (3,), lambda value: sheet.drag(value, [0, 0, 1], 1, 1)),
                ("direction", (3,), lambda value: sheet.drag([0, 0, 1], value, 1, 1)),
                ("target", (3,), drag.move),
                ("force", (3,), lambda value: SIM.set_load("finger", value)),
            ]
            before = sheet.hash, SIM.hash
            for name, shape, function in takers:
                whole = np.zeros(shape)
                bad = [
                    (np.zeros((*shape, 1)), ValueError),
                    (np.zeros((shape[0] + 1, *shape[1:])), ValueError),
                    (np.zeros(0), ValueError),
                    (np.float64(1), ValueError),
                    (np.full(shape, np.nan), ValueError),
                    (np.full(shape, -np.inf), ValueError),
                    (whole.astype(complex), TypeError),
                    (whole.astype(object), TypeError),
                    (whole.astype("U1"), TypeError),
                    (whole.astype("M8[s]"), TypeError),
                    (whole.astype(bool), TypeError),
                    ([[1, 2], [3]], ValueError),
                    ("text", TypeError),
                    (object(), TypeError),
                    ({}, TypeError),
                ]
                for value, kind in bad:
                    with self.subTest(function=name, value=repr(value)[:50]):
                        self.refused(kind, name, function, value)
            self.assertEqual((sheet.hash, SIM.hash), before)

    def test_every_function_with_room(self):
        """Every public function that fills an array refuses one that is not as it must be, and leaves it as it was."""
        triangles = len(SIM.triangles())
        fillers = [
            (name, (COUNT, 3), np.float64, lambda out, name=name: getattr(SIM, name)(0, out=out))
            for name in ("positions", "velocities", "forces", "rest_positions")
        ]
        fillers += [
            ("masses", (COUNT,), np.float64, lambda out: SIM.masses(0, out=out)),
            ("triangles", (triangles, 3), np.int32, lambda out: SIM.triangles(0, out=out)),
            ("field", (COUNT,), np.float64, lambda out: SIM.field(0, "energy", out=out)),
            ("vectors", (COUNT, 3), np.float64, lambda out: SIM.field(0, "displacement", out=out)),
            ("gradient", (COUNT, 3), np.float64, lambda out: SIM.gradient(None, out=out)),
        ]
        for label, shape, dtype, function in fillers:
            good = np.zeros(shape, dtype)
            self.assertIs(function(good), good)
            locked = np.zeros(shape, dtype)
            locked.flags.writeable = False
            bad = [
                (np.zeros((shape[0] + 1, *shape[1:]), dtype), ValueError),
                (np.zeros((*shape, 1), dtype), ValueError),
                (np.zeros((2 * shape[0], *shape[1:]), dtype)[::2], ValueError),
                (np.zeros(shape, np.float32), TypeError),
                (np.zeros(shape, np.int64), TypeError),
                (np.zeros(shape, np.dtype(dtype).newbyteorder(">")), TypeError),
                (np.zeros(shape, complex), TypeError),
                (np.zeros(shape, object), TypeError),
                (locked, ValueError),
                ([], TypeError),
                ("text", TypeError),
                (7, TypeError),
            ]
            if len(shape) == 2:
                bad.append((np.zeros(shape[::-1], dtype).T, ValueError))
            for out, kind in bad:
                with self.subTest(function=label, out=repr(out)[:50]):
                    self.refused(kind, "out", function, out)
                    if isinstance(out, np.ndarray) and out.dtype != object:
                        self.assertFalse(out.any())

    def test_read_only_and_strided_arrays_are_taken(self):
        """What is only read may be read-only, and of any layout."""
        locked = SIM.positions()
        locked.flags.writeable = False
        before = SIM.hash
        for form in (locked, np.asfortranarray(locked), locked[::-1][::-1], locked.astype(">f8"), memoryview(locked)):
            SIM.set_positions(form)
            self.assertEqual(SIM.energy(form), SIM.energy())
        self.assertEqual(SIM.hash, before)
        mesh = Mesh.shape("geodesic-sphere", frequency=2)
        mesh.positions.flags.writeable = mesh.triangles.flags.writeable = False
        other = Mesh(np.asfortranarray(mesh.positions), mesh.triangles.astype(np.int64)[:, ::-1][:, ::-1])
        self.assertEqual(other.volume, mesh.volume)
        self.assertEqual(len(mesh.subdivide().positions), 162)

    def test_bodies(self):
        """Errors of exchanged arguments and wrong names say what is expected."""
        with self.assertRaisesRegex(TypeError, "body: must be the name or number of a body, not <class 'numpy.ndarray'>"):
            SIM.set_positions("ball", SIM.positions())
        with self.assertRaisesRegex(KeyError, r"body: there is no body 'bal'. use one of \['ball'\]"):
            SIM.positions("bal")

    def test_indices(self):
        sim = pellicle.load_scene(ball())
        for value, kind in (
            ([0.5], TypeError), ([[1]], ValueError), ([2**40], ValueError), ("a", TypeError), ([True], TypeError),
            ([-1], (ValueError, pellicle.Error)), ([COUNT], (ValueError, pellicle.Error)), ([[1], [2, 3]], ValueError),
        ):  # fmt: skip
            with self.subTest(value=value):
                self.refused(kind, "vert", sim.set_pins, value)
        sim.set_pins([3, 4])
        sim.set_pins([])

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
