"""Fits: the worked examples, and data that do not tell the parameters."""

import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

import numpy as np
import pellicle
from common import ROOT, is_single, long
from pellicle import _core
from pellicle.calibration import _Problem

FITS = ROOT / "examples/fits"

try:
    import scipy  # noqa: F401
except ImportError:
    raise unittest.SkipTest("no scipy: nothing can be fitted")


@unittest.skipIf(is_single(), "in float differences of runs are too coarse for a fit")
class Calibration(unittest.TestCase):
    def setUp(self):
        place = tempfile.TemporaryDirectory()
        self.addCleanup(place.cleanup)
        self.folder = pathlib.Path(place.name)

    def check(self, fit, path, known, share):
        self.assertLess(abs(fit.values[path] / known - 1), share)
        self.assertLess(fit.low[path], known)
        self.assertGreater(fit.high[path], known)

    @long
    def test_balloon(self):
        """Constants of Mooney and Rivlin within 1 %, from data with 1 % noise."""
        fit = pellicle.calibrate(FITS / "balloon.yaml", self.folder / "fit")
        young = fit.values["bodies.balloon.membrane.young"]
        ratio = fit.values["bodies.balloon.membrane.mooney_ratio"]
        c1 = young / 6 / (1 + ratio)
        self.assertLess(abs(c1 / (1.2e6 / 6 / 1.1) - 1), 0.01)
        self.assertLess(abs(ratio * c1 / (0.1 * 1.2e6 / 6 / 1.1) - 1), 0.01)
        self.check(fit, "bodies.balloon.membrane.young", 1.2e6, 0.01)
        self.assertEqual(fit.warnings, [])
        self.assertLess(fit.misfit, 0.015)
        record = json.loads((self.folder / "fit/fit.json").read_text())
        self.assertEqual(record["parameters"]["bodies.balloon.membrane.young"]["value"], young)
        self.assertIn("<svg", (self.folder / "fit/fit.svg").read_text())
        self.assertEqual(len((self.folder / "fit/curves.csv").read_text().splitlines()), 61)

    @long
    def test_organ(self):
        """The springs of docs/volumes.md give the force of the tetrahedra within 5 % of the largest, the defaults do not."""
        scene, volumes = ROOT / "examples/organ/springs.yaml", np.loadtxt(ROOT / "examples/organ/force.csv", delimiter=",", skiprows=1)
        for young, filling, is_near in ((5721, 14410, True), (50000, 5000, False)):
            values = {"bodies.organ.springs.young": young, "bodies.organ.volumetric.young": filling}
            series = pellicle.run(scene, self.folder / str(young), values).series
            force = np.interp(-volumes[:, 0], -np.array(series["ball_z"]), series["ball_force_z"])
            self.assertEqual(abs(force - volumes[:, 1]).max() < 0.05 * volumes[:, 1].max(), is_near)

    def line(self, scene, parameters, y="work_tools"):
        """A fit of one small scene to a made-up line."""
        path = self.folder / "data.csv"
        path.write_text("time,y\n0,0\n0.1,0.001\n0.2,0.002\n0.3,0.003\n")
        (self.folder / "scene.yaml").write_text(json.dumps(scene))
        return {
            "scene": str(self.folder / "scene.yaml"),
            "parameters": parameters,
            "data": [{"file": str(path), "x": "time", "y": y}],
        }

    def scene(self):
        return {
            "version": 1,
            "bodies": [
                {
                    "name": "ball",
                    "mesh": {"shape": "geodesic-sphere", "frequency": 2},
                    "mass": {"per_vertex": 1},
                    "springs": {"stiffness": 3, "damping": 0.5},
                    "volumetric": {"stiffness": 1.5, "damping": 0.5},
                }
            ],
            "loads": [{"name": "finger", "body": "ball", "force": [0, 0, -0.01], "at": {"nearest": [0, 0, 1]}}],
            "solver": {"method": "quasi-static", "alpha": 20, "dt": 0.01},
            "duration": 0.3,
            "output": {"every_frame": 5},
        }

    def test_region(self):
        """The stiffness of a sheet and of its inclusion from markers, with noise: within their intervals and 2 %."""
        fit = pellicle.calibrate(FITS / "region.yaml", self.folder / "fit")
        self.check(fit, "bodies.sheet.membrane.young.map.0", 1.5e5, 0.02)
        self.check(fit, "bodies.sheet.membrane.young.map.1", 6e5, 0.02)

    def test_a_parameter_that_the_data_do_not_tell(self):
        parameters = {
            "bodies.ball.springs.stiffness": {"start": 3, "from": 1, "to": 9},
            "loads.finger.until": {"start": 5, "from": 1, "to": 9},
        }
        fit = pellicle.calibrate(self.line(self.scene(), parameters, "max_displacement"))
        self.assertTrue(any("do not depend on loads.finger.until" in text for text in fit.warnings), fit.warnings)
        self.assertEqual(fit.low["loads.finger.until"], -np.inf)

    def test_parameters_that_are_not_told_apart(self):
        parameters = {
            "loads.finger.force.2": {"start": -0.01, "from": -0.1, "to": -0.001},
            "solver.alpha": {"start": 20, "from": 5, "to": 30},
        }
        fit = pellicle.calibrate(self.line(self.scene(), parameters, "max_displacement"))
        self.assertTrue(any("correlated" in text or "bound" in text for text in fit.warnings), fit.warnings)

    def markers(self, solver, load=None, known=None):
        """A fit of a clamped sheet, pulled across, to where markers go."""
        scene = {
            "version": 1,
            "bodies": [
                {
                    "name": "sheet",
                    "mesh": {"shape": "grid", "nx": 8, "ny": 6, "size_x": 0.4, "size_y": 0.3},
                    "mass": {"density": 1000, "thickness": 0.01},
                    "membrane": {"material": "stvk", "young": 1e4, "poisson": 0.3, "thickness": 0.01},
                    "bending": {"model": "hinge"},
                    "volumetric": {"stiffness": 0.001},
                    "pinned": {"box": {"min": [-0.21, -1, -1], "max": [-0.19, 1, 1]}},
                }
            ],
            "loads": [
                {
                    "name": "pull",
                    "body": "sheet",
                    "force": [1, 0.1, 0.2],
                    "at": {"box": {"min": [0.19, -1, -1], "max": [0.21, 1, 1]}},
                    **(load or {}),
                }
            ],
            "gravity": [0, 0, -0.3],
            "solver": solver,
            "duration": 1,
        }
        (self.folder / "sheet.yaml").write_text(json.dumps(scene))
        known = known or {"bodies.sheet.membrane.young": 1.2e4, "bodies.sheet.volumetric.stiffness": 0.002}
        sim = pellicle.load_scene(self.folder / "sheet.yaml", known)
        sim.run_until(1)
        rows = [f"{v},{x!r},{y!r},{z!r}" for v, (x, y, z) in enumerate(sim.positions().tolist())]
        (self.folder / "markers.csv").write_text("\n".join(["vertex,x,y,z", *rows]) + "\n")
        return known, {
            "scene": str(self.folder / "sheet.yaml"),
            "parameters": {
                path: {"start": 0.7 * value, "from": 0.2 * value, "to": 5 * value, "scale": "log"} for path, value in known.items()
            },
            "data": [{"file": str(self.folder / "markers.csv"), "body": "sheet"}],
        }

    def test_derivatives_go_forward(self):
        """The same Jacobian as by differences, of markers and curves, with and without loads that change with time."""
        curve = "time,y\n0.25,0.1\n0.5,0.5\n0.75,0.7\n1,0.7\n"
        (self.folder / "curve.csv").write_text(curve)
        columns = ("sheet_support_force", "elastic_energy", "work_loads")
        curves = [{"file": str(self.folder / "curve.csv"), "x": "time", "y": c, "column_y": "y"} for c in columns]
        # after a jump whole runs end at a millionth of their forces, which differences of 1e-3 tell
        for load, share in ((None, 1e-6), ({"until": 9, "from": 0}, 1e-6), ({"from": 0.5}, 1e-4)):
            with self.subTest(load=load):
                known, fit = self.markers({"method": "static", "dt": 0.25}, load)
                problem = _Problem({**fit, "data": fit["data"] + curves}, 1)
                problem.evaluate(problem.start)
                found, expected = problem.last[1], problem.by_differences(problem.start)
                self.assertLess(np.abs(found - expected).max(), share * np.abs(expected).max())
                result = pellicle.calibrate(fit)
                self.assertEqual((result.derivatives, result.derivatives_reason), ("forward", ""))
                self.assertLess(result.evaluations, 20)
                for path, value in known.items():
                    self.assertLess(abs(result.values[path] / value - 1), 1e-4)

    def test_derivatives_of_steps_in_time(self):
        """Known numbers from the markers of a motion, with a few runs; steps end at a hundredth of their forces."""
        known, fit = self.markers({"method": "implicit", "dt": 0.05})
        problem = _Problem(fit, 1)
        problem.evaluate(problem.start)
        found, expected = problem.last[1], problem.by_differences(problem.start)
        self.assertLess(np.abs(found - expected).max(), 1e-3 * np.abs(expected).max())
        result = pellicle.calibrate(fit)
        self.assertEqual(result.derivatives, "forward")
        self.assertLess(result.evaluations, 20)
        for path, value in known.items():
            self.assertLess(abs(result.values[path] / value - 1), 1e-3)

    def test_derivatives_along_a_path_by_arc_length(self):
        """At one volume the pressure of a balloon is proportional to Young's modulus."""
        fit = json.loads(_core.load_fit(str(FITS / "balloon.yaml")))
        problem = _Problem(fit, 1)
        problem.evaluate(problem.start)
        pressure = problem.run(problem.start)[0][0]
        curve = problem.curves[0]
        by_young = problem.last[1][:, 0] / curve.scale / (problem.high[0] - problem.low[0])
        self.assertLess(np.abs(by_young - pressure).max(), 1e-5 * pressure.max())

    def test_derivatives_by_differences_where_runs_cannot_go_beside(self):
        known = {"bodies.sheet.membrane.young": 1.2e4}
        result = pellicle.calibrate(
            {**self.markers({"method": "xpbd", "dt": 0.25}, known=known)[1], "max_evaluations": 3}, self.folder / "out"
        )
        self.assertEqual(result.derivatives, "differences")
        self.assertIn("static and implicit", result.derivatives_reason)
        record = json.loads((self.folder / "out/fit.json").read_text())
        self.assertEqual(record["derivatives"], "differences")
        problem = _Problem(json.loads(_core.load_fit(str(FITS / "tissue.yaml"))), 1)
        problem.evaluate(problem.start)
        self.assertIn("tools", problem.reason)
        self.assertIsNone(problem.last)

    def test_bad_data(self):
        """Each mistake in a table is told with its line or its column."""
        parameters = {"bodies.ball.springs.stiffness": {"start": 3, "from": 1, "to": 9}}
        fit = self.line(self.scene(), parameters, "max_displacement")
        entry, path = fit["data"][0], self.folder / "bad.csv"
        for text, more, expected in (
            ("time,y\n0.1,1\n0.2,x1\n", {}, "bad.csv:3: .*'x1'"),
            ("time,y\n# taken by hand\n0.1,1\n0.2,1,5\n", {}, "bad.csv:4: .*3 cells below 2 names"),
            ("time,y\n0.1,1\n0.2,nan\n", {}, "bad.csv:3: .*not finite"),
            ("time,y\n0.1,1\n", {}, "no table of numbers"),
            ("time,y\n0.1,1\n0.2,2\n", {"column_y": "z"}, "no column 'z'. name one of time, y"),
            ("time,y\n0.1,1\n0.2,2\n", {"y": "max_displacment"}, "did you mean 'max_displacement'"),
            ("vertex,x,y,z\n0,0,0,0\n1.5,0,0,1\n", {"body": "ball"}, "whole numbers"),
        ):
            with self.subTest(text=text, more=more):
                path.write_text(text)
                data = {**entry, "file": str(path), **more}
                if "body" in more:
                    data = {"file": str(path), **more}
                with self.assertRaisesRegex(pellicle.Error, expected):
                    pellicle.calibrate({**fit, "data": [data]})

    def test_bad(self):
        parameters = {"bodies.ball.springs.stiffness": {"start": 3, "from": 1, "to": 9}}
        with self.assertRaisesRegex(pellicle.Error, "no column 'force'"):
            pellicle.calibrate(self.line(self.scene(), parameters, "force"))
        markers = self.markers({"method": "static", "dt": 1})[1]
        markers["data"][0]["body"] = "shet"
        with self.assertRaisesRegex(pellicle.Error, "no body 'shet'.*sheet"):
            pellicle.calibrate(markers)
        (self.folder / "fit.yaml").write_text("scene: scene.yaml\nparamters: {}\n")
        with self.assertRaisesRegex(pellicle.Error, "fit.yaml:2:1.*did you mean 'parameters'"):
            pellicle.calibrate(self.folder / "fit.yaml")
        fit = self.line(self.scene(), {"bodies.ball.spring.stiffness": {"start": 3, "from": 1, "to": 9}}, "max_displacement")
        with self.assertRaisesRegex(pellicle.Error, "did you mean 'springs'"):
            pellicle.calibrate(fit)

    def test_command(self):
        fit = self.line(self.scene(), {"bodies.ball.springs.stiffness": {"start": 3, "from": 1, "to": 9}}, "max_displacement")
        (self.folder / "fit.yaml").write_text(json.dumps(fit))
        command = [sys.executable, "-m", "pellicle", "calibrate", str(self.folder / "fit.yaml"), "--json"]
        result = subprocess.run(
            [*command, "--output", str(self.folder / "out")], env=dict(os.environ), capture_output=True, text=True
        )
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("bodies.ball.springs.stiffness", json.loads(result.stdout)["parameters"])
        self.assertTrue((self.folder / "out/fit.svg").is_file())


if __name__ == "__main__":
    unittest.main()
