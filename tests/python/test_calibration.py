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
from common import ROOT, is_single

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

    def test_bad(self):
        parameters = {"bodies.ball.springs.stiffness": {"start": 3, "from": 1, "to": 9}}
        with self.assertRaisesRegex(pellicle.Error, "no column 'force'"):
            pellicle.calibrate(self.line(self.scene(), parameters, "force"))
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
