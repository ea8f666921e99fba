"""Tables of several runs: names, missing cells, pandas and xarray where they are installed."""

import importlib.util
import os
import sys
import tempfile
import unittest
from unittest import mock

import numpy as np
import pellicle

from common import ball, long


def lacks(name):
    return unittest.skipUnless(importlib.util.find_spec(name), f"long: {name} is not installed")


class Tables(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.place = tempfile.TemporaryDirectory()
        cls.path = cls.place.name
        pellicle.run(ball(duration=0.3), os.path.join(cls.path, "short"))
        tool = {"name": "probe", "shape": "sphere", "radius": 0.1, "motion": [{"position": [0, 0, 3]}]}
        pellicle.run(ball(duration=0.5, tools=[tool]), os.path.join(cls.path, "with-tool"))
        os.mkdir(os.path.join(cls.path, "other"))

    @classmethod
    def tearDownClass(cls):
        cls.place.cleanup()

    def test_names(self):
        runs = pellicle.read_runs(self.path)
        self.assertEqual(runs.names, ("short", "with-tool"))
        self.assertEqual([len(run.series["time"]) for run in runs], [4, 6])
        self.assertIs(runs["with-tool"], runs[1])
        self.assertIn("probe_force_z", runs.columns())
        with self.assertRaisesRegex(KeyError, "short, with-tool"):
            runs["long"]
        twice = pellicle.read_runs([os.path.join(self.path, "short")] * 2)
        self.assertTrue(all(os.path.isabs(name) for name in twice.names))
        with self.assertRaisesRegex(pellicle.Error, "no folder at this path"):
            pellicle.read_runs([os.path.join(self.path, "none")])

    def test_missing_modules(self):
        runs = pellicle.read_runs(self.path)
        with mock.patch.dict(sys.modules, {"pandas": None, "xarray": None}):
            with self.assertRaisesRegex(ImportError, "pip install pandas"):
                runs.to_pandas()
            with self.assertRaisesRegex(ImportError, "pip install xarray"):
                runs.to_xarray()

    @long
    @lacks("pandas")
    def test_pandas(self):
        table = pellicle.read_runs(self.path).to_pandas()
        self.assertEqual(list(table.index.names), ["run", "frame"])
        self.assertEqual(len(table), 10)
        self.assertEqual(table.loc[("with-tool", 5), "time"], 0.5)
        self.assertTrue(np.isnan(table.loc[("short", 2), "probe_force_z"]))
        self.assertEqual(table.loc[("with-tool", 2), "probe_force_z"], 0)
        self.assertEqual(list(table.groupby("run").size()), [4, 6])

    @long
    @lacks("xarray")
    def test_xarray(self):
        data = pellicle.read_runs(self.path).to_xarray()
        self.assertEqual(dict(data.sizes), {"run": 2, "frame": 6})
        self.assertEqual(float(data["time"].sel(run="with-tool", frame=5)), 0.5)
        self.assertTrue(np.isnan(data["time"].sel(run="short", frame=5)))
        volumes = pellicle.read_run(os.path.join(self.path, "short")).series["volume"]
        np.testing.assert_array_equal(data["volume"].sel(run="short")[:4], volumes)


if __name__ == "__main__":
    unittest.main()
