"""Studies: the table from Python, and on the workers of Dask."""

import contextlib
import os
import pathlib
import signal
import tempfile
import unittest

import numpy as np
import pellicle


try:
    import distributed
except ImportError:
    distributed = None

SCENE = """version: 1
bodies: [{ name: ball, mesh: { shape: geodesic-sphere, frequency: 3 }, mass: { per_vertex: 1 } }]
loads: [{ name: finger, body: ball, force: [0, 0, -1], at: { nearest: [0, 0, 1] } }]
solver: { method: quasi-static, alpha: 20, dt: 0.01 }
duration: 0.5
"""


class Folder(unittest.TestCase):
    def setUp(self):
        self.place = tempfile.TemporaryDirectory()
        self.addCleanup(self.place.cleanup)
        self.folder = pathlib.Path(self.place.name)
        (self.folder / "scene.yaml").write_text(SCENE)

    def study(self, count=6):
        return {
            "scene": str(self.folder / "scene.yaml"),
            "vary": {
                "loads.finger.force": [[0, 0, -1], np.array([0, 0, -2])],
                "bodies.ball.springs.stiffness": {"from": 1, "to": 3, "count": count},
            },
            "measure": {"depth": "max_displacement", "hash": "state_hash"},
        }

    def table(self, name):
        return (self.folder / name / "runs.csv").read_bytes()


class Sweeps(Folder):
    def test_table(self):
        sweep = pellicle.sweep(self.study(), self.folder / "out", jobs=2)
        self.assertEqual(len(sweep), 12)
        self.assertEqual(list(sweep)[:3], ["run", "loads.finger.force", "bodies.ball.springs.stiffness"])
        depth = sweep["depth"].reshape(2, 6)
        # softer springs and larger forces go deeper
        self.assertTrue((np.diff(depth, axis=1) < 0).all() and (depth[1] > depth[0]).all())
        sim = pellicle.load_scene(self.folder / "scene.yaml", {"loads.finger.force": [0, 0, -2], "bodies.ball.springs.stiffness": 3})
        sim.step(50)
        self.assertEqual(sweep["hash"][-1], f"{sim.hash:016x}")
        with self.assertRaises(KeyError):
            sweep["deep"]

    def test_continues(self):
        pellicle.sweep(self.study(), self.folder / "out")
        rows = self.folder / "out/rows/1-of-1.rows"
        lines = rows.read_bytes().splitlines(keepends=True)
        rows.write_bytes(b"".join(lines[:5]) + lines[5][:20])
        whole = self.table("out")
        (self.folder / "out/runs.csv").unlink()
        pellicle.sweep(self.study(), self.folder / "out")
        self.assertEqual(self.table("out"), whole)
        self.assertEqual(len(rows.read_bytes().splitlines()), 13)

    def test_a_failed_run_is_a_row(self):
        study = self.study()
        study["vary"] = {"bodies.ball.springs.stiffness": [1, -1]}
        sweep = pellicle.sweep(study, self.folder / "out")
        self.assertEqual(sweep.failed.tolist(), [1])
        self.assertIn("out of range", sweep["error"][1])
        self.assertTrue(np.isnan(sweep["depth"][1]))

    def test_bad(self):
        with self.assertRaisesRegex(pellicle.Error, "study:1:1|unknown key 'varies'"):
            pellicle.sweep({"scene": "x", "varies": {}}, self.folder / "out")
        with self.assertRaisesRegex(ValueError, "jobs"):
            pellicle.sweep(self.study(), self.folder / "out", jobs=-1)
        with self.assertRaisesRegex(pellicle.Error, "none.yaml"):
            pellicle.sweep(self.folder / "none.yaml", self.folder / "out")
        pellicle.sweep(self.study(2), self.folder / "out")
        with self.assertRaisesRegex(pellicle.Error, "another study"):
            pellicle.sweep(self.study(3), self.folder / "out")


@unittest.skipIf(distributed is None, "no distributed: install python3-distributed to test sweeps on Dask")
class Dask(Folder):
    def test_same_table_when_a_worker_is_killed(self):
        pellicle.sweep(self.study(40), self.folder / "here")
        with contextlib.ExitStack() as stack:
            cluster = stack.enter_context(
                distributed.LocalCluster(
                    n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None, local_directory=self.place.name
                )
            )
            client = stack.enter_context(distributed.Client(cluster))
            workers = [worker["id"] for worker in client.scheduler_info()["workers"].values()]
            self.assertEqual(len(workers), 2)
            victim = next(iter(client.run(os.getpid).values()))
            rows = self.folder / "dask/rows/1-of-1.rows"

            def kill_in_the_middle():
                import time

                while not rows.exists() or len(rows.read_bytes().splitlines()) < 10:
                    time.sleep(0.002)
                os.kill(victim, signal.SIGKILL)

            import threading

            killer = threading.Thread(target=kill_in_the_middle)
            killer.start()
            sweep = pellicle.sweep(self.study(40), self.folder / "dask", client=client)
            killer.join()
        self.assertEqual(len(sweep), 80)
        self.assertEqual(self.table("dask"), self.table("here"))


if __name__ == "__main__":
    unittest.main()
