"""Studies: the table from Python, and on the workers of Dask."""

import contextlib
import importlib.util
import os
import pathlib
import signal
import sys
import tempfile
import threading
import time
import types
import unittest
import unittest.mock

import numpy as np
import pellicle
from common import long


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

    def test_parquet(self):
        """Debian has no pyarrow: a stand-in of the two modules records what it is given."""
        given = {}
        arrow, parquet = types.ModuleType("pyarrow"), types.ModuleType("pyarrow.parquet")
        arrow.array, arrow.table, arrow.parquet = lambda column: column, dict, parquet
        parquet.write_table = lambda table, path: given.update(table=table, path=path)
        with unittest.mock.patch.dict(sys.modules, {"pyarrow": arrow, "pyarrow.parquet": parquet}):
            sweep = pellicle.sweep(self.study(2), self.folder / "out")
        self.assertEqual(given["path"], str(self.folder / "out/runs.parquet"))
        self.assertEqual(list(given["table"]), list(sweep))
        for name, column in given["table"].items():
            np.testing.assert_array_equal(column, sweep[name])
        self.assertEqual(given["table"]["depth"].dtype, np.float64)

    @long
    @unittest.skipIf(importlib.util.find_spec("pyarrow") is None, "no pyarrow: Parquet files are not read back")
    def test_parquet_is_read_back(self):
        import pyarrow.parquet

        sweep = pellicle.sweep(self.study(2), self.folder / "out")
        table = pyarrow.parquet.read_table(self.folder / "out/runs.parquet")
        self.assertEqual(table.column_names, list(sweep))
        self.assertEqual(table["depth"].to_pylist(), sweep["depth"].tolist())

    def test_ranges_and_meshes(self):
        """Python's and numpy's ranges are lists; a mesh belongs into a file, as the error says."""
        study = self.study()
        for values in (range(2, 4), np.arange(2, 4), np.linspace(2, 3, 2)):
            study["vary"] = {"bodies.ball.springs.stiffness": values}
            sweep = pellicle.sweep(study, self.folder / f"out-{type(values).__name__}-{np.asarray(values).dtype}")
            self.assertEqual(sweep["bodies.ball.springs.stiffness"].tolist(), [2, 3])
        study["scene"] = {"bodies": [{"name": "ball", "mesh": pellicle.Mesh.shape("geodesic-sphere", frequency=2)}]}
        with self.assertRaisesRegex(TypeError, "write it to a file and give {'file': path}"):
            pellicle.sweep(study, self.folder / "mesh")

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

    def long_scene(self):
        path = self.folder / "long.yaml"
        path.write_text(SCENE.replace("alpha: 20", "alpha: 5") + "output: { every: 1000 }\n")
        return path

    def kill_workers(self, rows, is_over):
        """A thread that kills the processes that do the runs of a sweep, until enough has been done."""


        def children():
            for task in pathlib.Path("/proc/self/task").iterdir():
                with contextlib.suppress(FileNotFoundError):
                    yield from map(int, (task / "children").read_text().split())

        end, others = time.monotonic() + 60, set(children())

        def kill():
            while time.monotonic() < end and not is_over(rows.read_bytes() if rows.exists() else b""):
                for child in [child for child in children() if child not in others][:1]:
                    with contextlib.suppress(ProcessLookupError):
                        os.kill(child, signal.SIGKILL)
                time.sleep(0.1)

        thread = threading.Thread(target=kill)
        thread.start()
        return thread

    def test_a_worker_that_is_killed_loses_no_run(self):
        study = self.study(40)
        pellicle.sweep(study, self.folder / "calm", jobs=2)
        kills = iter([False])
        killer = self.kill_workers(self.folder / "killed/rows/1-of-1.rows", lambda rows: rows.count(b"\n") > 5 and next(kills, True))
        pellicle.sweep(study, self.folder / "killed", jobs=2)
        killer.join()
        self.assertEqual(self.table("killed"), self.table("calm"))

    def test_a_run_that_is_killed_twice_is_a_row(self):
        study = {**self.study(), "vary": {"duration": [1e6, 0.01]}, "scene": str(self.long_scene()), "measure": ["steps"]}
        killer = self.kill_workers(self.folder / "out/rows/1-of-1.rows", lambda rows: b",crashed," in rows)
        sweep = pellicle.sweep(study, self.folder / "out", jobs=1, timeout=120)
        killer.join()
        self.assertEqual(sweep["status"][0], "crashed")
        self.assertIn("signal 9 (Killed)", sweep["error"][0])
        self.assertEqual(len(sweep), 2)

    def test_timeout_and_retry(self):
        study = {**self.study(), "vary": {"duration": [0.01, 1e6]}, "scene": str(self.long_scene()), "measure": ["steps"]}
        sweep = pellicle.sweep(study, self.folder / "out", timeout=1)
        self.assertEqual(sweep["status"].tolist(), ["done", "timeout"])
        rows = self.folder / "out/rows/1-of-1.rows"
        before = len(rows.read_bytes().splitlines())
        pellicle.sweep(study, self.folder / "out", timeout=1)
        self.assertEqual(len(rows.read_bytes().splitlines()), before)
        pellicle.sweep(study, self.folder / "out", timeout=0.5, retry=True)
        self.assertEqual(len(rows.read_bytes().splitlines()), before + 1)
        for bad in (-1, float("nan"), "1"):
            with self.assertRaisesRegex(ValueError, "timeout"):
                pellicle.sweep(study, self.folder / "out", timeout=bad)

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


@long
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
                while not rows.exists() or len(rows.read_bytes().splitlines()) < 10:
                    time.sleep(0.002)
                os.kill(victim, signal.SIGKILL)

            killer = threading.Thread(target=kill_in_the_middle)
            killer.start()
            sweep = pellicle.sweep(self.study(40), self.folder / "dask", client=client)
            killer.join()
        self.assertEqual(len(sweep), 80)
        self.assertEqual(self.table("dask"), self.table("here"))

    def test_a_run_that_ends_its_workers_is_a_row(self):
        """By a stand-in of the client: each run ends at once, the second one always loses its worker."""
        futures = []

        class Client:
            def submit(self, function, path, text, run, folder, pure):
                futures.append(run)
                future = unittest.mock.Mock()
                lost = distributed.scheduler.KilledWorker("run-1", None, 3) if run == 1 else None
                future.exception = lambda: lost
                future.result = lambda: function(path, text, run, folder)
                return future

        class Completed(list):
            add = list.append

        with unittest.mock.patch.object(distributed, "as_completed", Completed):
            sweep = pellicle.sweep(self.study(2), self.folder / "out", client=Client())
        self.assertEqual(futures, [0, 1, 2, 3, 1])
        self.assertEqual(sweep["status"].tolist(), ["done", "crashed", "done", "done"])
        with self.assertRaisesRegex(ValueError, "timeout"):
            pellicle.sweep(self.study(2), self.folder / "other", client=Client(), timeout=1)


if __name__ == "__main__":
    unittest.main()
