"""Scenes and simulations."""

import os
import signal
import subprocess
import sys
import tempfile
import threading
import unittest

import numpy as np
import pellicle
from common import ROOT, SCENES, ball, directional, is_single, shell


class Stepping(unittest.TestCase):
    def test_file_and_dict_give_the_same_bits(self):
        one = pellicle.load_scene(SCENES / "sphere-press.yaml")
        spec = ball()
        spec["bodies"][0]["mesh"]["frequency"] = 5
        two = pellicle.load_scene(spec)
        for sim in (one, two):
            sim.step(50)
        self.assertEqual(one.hash, two.hash)
        self.assertEqual(one.steps, 50)
        self.assertAlmostEqual(one.time, 0.5)
        self.assertLess(one.positions("ball")[:, 2].max(), 1)

    def test_a_mesh_in_a_dict_keeps_every_bit(self):
        mesh = pellicle.Mesh.shape("geodesic-sphere", frequency=3)
        mesh.positions *= 1 / 3
        sim = pellicle.load_scene(shell(mesh))
        held = mesh.positions.astype(np.float32) if is_single() else mesh.positions
        np.testing.assert_array_equal(sim.rest_positions(), held)
        np.testing.assert_array_equal(sim.triangles(), mesh.triangles)

    def test_ctrl_c_ends_a_long_step(self):
        spec = shell(pellicle.Mesh.shape("geodesic-sphere", frequency=24))
        spec["bodies"][0]["pinned"] = {"box": {"min": [-9, -9, -9], "max": [9, 9, -0.8]}}
        spec["solver"] = {"method": "static", "analysis": "modal", "modes": 40, "dt": 0.1}
        sim = pellicle.load_scene(spec)
        before = sim.hash

        def interrupt(number, frame):
            raise KeyboardInterrupt
        old = signal.signal(signal.SIGALRM, interrupt)
        signal.setitimer(signal.ITIMER_REAL, 0.2)
        try:
            with self.assertRaises(KeyboardInterrupt):
                sim.step()
        finally:
            signal.setitimer(signal.ITIMER_REAL, 0)
            signal.signal(signal.SIGALRM, old)
        self.assertEqual(sim.hash, before)
        self.assertEqual(sim.steps, 0)

    def test_out_is_filled_and_given_back(self):
        sim = pellicle.load_scene(ball())
        out = np.empty_like(sim.positions())
        self.assertIs(sim.positions("ball", out=out), out)
        np.testing.assert_array_equal(out, sim.positions(0))

    def test_overrides(self):
        sim = pellicle.load_scene(ball(), {"solver.dt": 0.005, "loads.finger.force": [0, 0, -2]})
        self.assertEqual(sim.scene.dt, 0.005)
        self.assertEqual(sim.scene.simulation(dt=0.002).scene.bodies, ("ball",))

    def test_set_before_the_first_step_is_a_new_scene(self):
        sim = pellicle.load_scene(ball())
        sim.set("bodies.ball.springs.stiffness", 6)
        sim.step(20)
        other = pellicle.load_scene(ball(), {"bodies.ball.springs.stiffness": 6})
        other.step(20)
        self.assertEqual(sim.hash, other.hash)

    def test_set_while_running(self):
        sim = pellicle.load_scene(ball())
        sim.step(50)
        soft = 1 - sim.positions()[:, 2].max()
        sim.energy()
        sim.set("bodies.ball.springs.stiffness", 30)
        sim.step(400)
        self.assertLess(1 - sim.positions()[:, 2].max(), soft + 0.1)
        # the functions are those of the new parameters
        self.assertLess(abs(sim.gradient() + sim.forces()).max(), 1e-5 * abs(sim.forces()).max() + (1e-5 if is_single() else 1e-6))
        for path, value in (("bodies.ball.springs.stifness", 1), ("gravity", "x"), ("solver.dt", -1)):
            with self.assertRaises(pellicle.Error):
                sim.set(path, value)

    def test_set_of_a_load(self):
        sim = pellicle.load_scene(ball())
        sim.step(10)
        sim.set("loads.finger.force", [0, 0, 0])
        depth = sim.positions()[:, 2].max()
        sim.step(400)
        self.assertGreater(sim.positions()[:, 2].max(), depth)

    def test_errors_tell_place_and_remedy(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "bad.yaml")
            with open(path, "w", encoding="utf-8") as file:
                file.write("version: 1\nbodies:\n  - name: a\n    mesh: { shape: torus }\n    sprngs: 1\nduration: 1\n")
            with self.assertRaises(pellicle.Error) as caught:
                pellicle.load_scene(path)
        error = caught.exception
        self.assertEqual((error.file, error.line, error.status), (path, 5, "bad scene"))
        self.assertIn("springs", error.remedy)
        self.assertIn("bad.yaml:5:", str(error))

    def test_diverging_is_an_error(self):
        spec = shell({"shape": "geodesic-sphere", "frequency": 3})
        sim = pellicle.load_scene(spec)
        sim.set_velocities(np.full_like(sim.positions(), 1e200))
        with self.assertRaises(pellicle.Error) as caught:
            sim.step(10)
        self.assertEqual(caught.exception.status, "diverged")


class State(unittest.TestCase):
    def test_snapshots(self):
        sim = pellicle.load_scene(ball())
        sim.step(10)
        saved, hash_then = sim.save(), sim.hash
        sim.step(10)
        after = sim.hash
        sim.load(saved)
        self.assertEqual(sim.hash, hash_then)
        sim.step(10)
        self.assertEqual(sim.hash, after)
        with self.assertRaises(pellicle.Error):
            sim.load(saved[:-1])
        with self.assertRaises(TypeError):
            sim.load(bytearray(saved))

    def test_every_field(self):
        sim = pellicle.load_scene(shell({"shape": "geodesic-sphere", "frequency": 3}))
        positions = sim.positions()
        sim.set_positions(positions * [1.1, 1.0, 0.9])
        for name in pellicle.field_names:
            values = sim.field("shell", name)
            self.assertEqual(len(values), len(positions), name)
            self.assertTrue(np.isfinite(values).all(), name)
        np.testing.assert_allclose(sim.field(0, "displacement"), positions * [0.1, 0, -0.1], atol=1e-6)
        energy = sim.summary()["elastic_energy"]
        self.assertAlmostEqual(sim.field(0, "energy").sum(), energy, delta=1e-5 * energy)
        areas = sim.field(0, "area").sum()
        self.assertAlmostEqual(areas, sim.mesh().area, delta=1e-9 * areas)

    def test_fields_are_those_of_frames(self):
        table = (ROOT / "docs/reference/scene.md").read_text(encoding="utf-8").split("| field |")[1]
        names = [line.split("`")[1] for line in table.splitlines() if line.startswith("| `")]
        self.assertEqual(sorted(names), sorted(pellicle.field_names))
        spec = shell({"shape": "capsule"}, body={"pressure": {"outside": -40}})
        spec["output"] = {"every": 0.1, "fields": names, "precision": "double"}
        sim = pellicle.load_scene(spec)
        sim.run_until(0.1)
        with tempfile.TemporaryDirectory() as folder:
            frame = pellicle.run(spec, folder).frames[-1].mesh
            np.testing.assert_array_equal(frame.positions, sim.positions())
            for name in names:
                expected, values = frame.fields[name], sim.field("shell", name)
                tolerance = 1e-9 * max(abs(expected).max(), 1e-12)
                if name == "principal_direction":
                    # either sign, and any direction where both values are equal
                    spread = sim.field(0, "principal_stress")
                    clear = spread[:, 0] - spread[:, 1] > 1e-6 * abs(spread).max()
                    np.testing.assert_allclose(abs((expected * values).sum(axis=1))[clear], 1, atol=1e-6, err_msg=name)
                else:
                    np.testing.assert_allclose(values, expected, rtol=0, atol=tolerance, err_msg=name)

    def test_fields_on_triangles(self):
        sim = pellicle.load_scene(shell({"shape": "capsule"}))
        sim.set_positions(sim.positions() * 1.1)
        self.assertEqual(sim.field(0, "strain", on="triangles").shape, (len(sim.triangles()), 6))
        for arguments, kind in (((0, "energy"), pellicle.Error), ((0, "strain"), ValueError)):
            with self.assertRaises(kind):
                sim.field(*arguments, on="triangles" if kind is pellicle.Error else "edges")

    def test_ledger_and_readings(self):
        sim = pellicle.load_scene(ball())
        sim.step(5)
        ledger = sim.ledger()
        self.assertGreater(ledger["work_loads"], 0)
        self.assertEqual(sim.contacts()["contacts"], 0)
        self.assertEqual(sim.tools, ())
        self.assertEqual(len(sim.support()["force"]), 3)


    def test_tools_press_and_are_read(self):
        motion = [{"time": 0, "position": [0, 0, 1.31]}, {"time": 1, "position": [0, 0, 0.9]}]
        tool = {"name": "probe", "shape": "sphere", "radius": 0.3, "motion": motion}
        sim = pellicle.load_scene(ball(tools=[tool], contact={"self": True}))
        self.assertEqual(sim.tools, ("probe",))
        sim.step(20)
        self.assertGreater(sim.tool("probe")["force"][2], 0)
        self.assertEqual(sim.intersections(), 0)
        sim.set_tool("probe", [0, 0, 3])
        sim.step(50)
        reading = sim.tool("probe")
        self.assertEqual((reading["force"], reading["position"]), ((0, 0, 0), (0, 0, 3)))


    def test_joints_are_read(self):
        mesh = {"shape": "box", "size_x": 0.1, "size_y": 0.1, "size_z": 0.1}
        motor = {"name": "lift", "kind": "slider", "point": [0, 0, 0], "motor": {"speed": 0.1, "strength": 20}}
        sim = pellicle.load_scene({"version": 1, "bodies": [{"name": "box", "mesh": mesh, "rigid": {}}], "joints": [motor],
                                   "gravity": [0, 0, -9.81], "duration": 2})
        self.assertEqual(sim.joints, ("lift",))
        while sim.time < 1.995:
            sim.step()
        joint = sim.joint("lift")
        self.assertAlmostEqual(joint["speed"], 0.1, 6)
        self.assertAlmostEqual(joint["load"], 9.81, 6)
        self.assertAlmostEqual(joint["force"][2], 9.81, 6)
        self.assertAlmostEqual(joint["work"], 9.81 * joint["position"] + sim.rigid()["kinetic_energy"], 2)
        self.assertAlmostEqual(joint["position"], sim.rigid()["center"][2], 9)
        with self.assertRaises(KeyError):
            sim.joint("drop")

    def test_contact_records(self):
        motion = [{"time": 0, "position": [0, 0, 1.31]}, {"time": 1, "position": [0, 0, 0.6]}]
        tool = {"name": "probe", "shape": "sphere", "radius": 0.3, "motion": motion}
        scene = ball(tools=[tool], contact={"self": True}, solver={"method": "xpbd", "dt": 0.01, "substeps": 5})
        sim = pellicle.load_scene(scene, record_contacts=True)
        self.assertEqual(len(sim.contact_records()), 0)
        sim.step(30)
        records = sim.contact_records()
        self.assertGreater(len(records), 0)
        force = np.array(sim.tool("probe")["force"])
        tolerance = (1e-4 if is_single() else 1e-9) * np.linalg.norm(force)
        np.testing.assert_allclose(records["force"].sum(axis=0), -force, rtol=0, atol=tolerance)
        self.assertEqual((set(records["tool"]), set(records["bodies"][:, 0]), set(records["bodies"][:, 1])), ({0}, {0}, {-1}))
        np.testing.assert_allclose(np.linalg.norm(records["normal"], axis=1), 1, rtol=1e-6)
        # the place is the weighted sum of the corners, on the sphere but for the thickness of contact
        x = np.vstack([sim.positions(), np.zeros(3)])
        places = np.einsum("ij,ijk->ik", records["weights"], x[records["vertices"]])
        np.testing.assert_allclose(places, records["point"], atol=1e-6)
        distance = np.linalg.norm(records["point"] - sim.tool("probe")["position"], axis=1) - 0.3
        np.testing.assert_allclose(distance, records["gap"], atol=1e-6)
        with self.assertRaisesRegex(pellicle.Error, "record_contacts=True"):
            pellicle.load_scene(scene).contact_records()


class Threads(unittest.TestCase):
    def test_many_simulations_share_a_model(self):
        scene = pellicle.Scene(ball()).prepare()
        alone = scene.simulation(threads=1)
        alone.step(100)
        sims = [scene.simulation(threads=1) for _ in range(4)]
        threads = [threading.Thread(target=sim.step, args=(100,)) for sim in sims]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual({sim.hash for sim in sims}, {alone.hash})

    def test_a_second_thread_is_refused_during_a_step(self):
        sim = pellicle.Scene(SCENES / "balloon.yaml").simulation(threads=1)
        thread = threading.Thread(target=sim.step, args=(20,))
        thread.start()
        refused = 0
        while thread.is_alive():
            try:
                sim.positions()
            except RuntimeError as error:
                self.assertIn("another thread", str(error))
                refused += 1
        thread.join()
        self.assertGreater(refused, 0)


class Kernels(unittest.TestCase):
    def test_both_kernels_give_the_same_bits(self):
        code = "import pellicle, sys; s = pellicle.load_scene(sys.argv[1]); s.step(5); print(pellicle.kernels(), s.hash)"
        lines = []
        for kernels in ("", "baseline"):
            environment = {**os.environ, "PELLICLE_KERNELS": kernels}
            command = [sys.executable, "-c", code, str(SCENES / "caving-ball.yaml")]
            result = subprocess.run(command, env=environment, check=True, capture_output=True, text=True)
            lines.append(result.stdout.split())
        self.assertEqual(lines[0][1], lines[1][1])


class Potential(unittest.TestCase):
    def setUp(self):
        mesh = pellicle.Mesh.shape("geodesic-sphere", frequency=3)
        self.sim = pellicle.load_scene(shell(mesh, body={"pressure": {"gas": {"pressure": 5000}}}, gravity=[0, 0, -9.81]))
        random = np.random.default_rng(7)
        self.x = mesh.positions * [1.1, 0.95, 1] + 0.01 * random.standard_normal(mesh.positions.shape)
        self.direction = random.standard_normal(mesh.positions.shape)

    def test_gradient_is_the_derivative_of_the_energy(self):
        expected = directional(self.sim.energy, self.x, self.direction, 1e-6)
        self.assertAlmostEqual((self.sim.gradient(self.x) * self.direction).sum() / expected, 1, delta=1e-7)

    def test_hessian_is_the_derivative_of_the_gradient(self):
        expected = directional(self.sim.gradient, self.x, self.direction, 1e-6).ravel()
        matrix, coefficients, gradients = self.sim.hessian(self.x, parts=True)
        product = matrix @ self.direction.ravel()
        product += gradients.T @ (coefficients * (gradients @ self.direction.ravel()))
        self.assertLess(abs(product - expected).max(), 1e-7 * abs(expected).max())
        self.assertLess(abs(matrix - matrix.T).max(), 1e-9 * abs(matrix).max())
        self.assertEqual(len(coefficients), 1)
        with self.assertRaises(pellicle.Error):
            self.sim.hessian(self.x)

    def test_gradient_is_minus_the_force(self):
        sim = pellicle.load_scene(ball())
        sim.step(3)
        scale = abs(sim.forces()).max()
        self.assertLess(abs(sim.gradient() + sim.forces()).max(), 1e-5 * scale)

    def test_none_is_the_present_state(self):
        self.sim.set_positions(self.x)
        self.assertAlmostEqual(self.sim.energy(), self.sim.energy(self.sim.positions().ravel()), delta=1e-9)


class Runs(unittest.TestCase):
    def test_a_run_is_read_back(self):
        with tempfile.TemporaryDirectory() as folder:
            out = os.path.join(folder, "run")
            mesh = pellicle.Mesh.shape("geodesic-sphere", frequency=3)
            spec = shell(mesh, output={"every": 0.05, "fields": ["energy", "displacement"]})
            run = pellicle.run(spec, out)
            self.assertEqual(run.summary["status"], "done")
            self.assertEqual(len(run.frames), 3)
            np.testing.assert_allclose(run.frames.times, [0, 0.05, 0.1])
            self.assertEqual(run.series["frame"].tolist(), [0, 1, 2])
            self.assertEqual(run.frames[-1].mesh.fields["displacement"].shape, mesh.positions.shape)
            self.assertEqual([frame.time for frame in run.frames], run.frames.times.tolist())
            self.assertEqual(len(run.final.positions), len(mesh.positions))
            # the folder describes itself: its scene runs again, mesh and all
            again = pellicle.run(os.path.join(out, "scene.yaml"), os.path.join(folder, "again"))
            self.assertEqual(again.summary["state_hash"], run.summary["state_hash"])
            self.assertEqual(pellicle.read_run(out).summary, run.summary)
            self.assertIn("<", run._repr_html_())

    def test_what_is_no_run_is_refused(self):
        with tempfile.TemporaryDirectory() as folder:
            for place in (folder, os.path.join(folder, "missing")):
                with self.assertRaises(pellicle.Error):
                    pellicle.read_run(place)

    def test_a_state_can_be_shown(self):
        sim = pellicle.load_scene(ball())
        sim.step(5)
        self.assertIn("<", sim._repr_html_())
        page = ROOT / "build/web/report.html"
        if page.is_file():
            os.environ["PELLICLE_PAGE"] = str(page)
            with tempfile.TemporaryDirectory() as folder:
                path = sim.show(os.path.join(folder, "state.html"))
                self.assertGreater(os.path.getsize(path), 10_000)


if __name__ == "__main__":
    unittest.main()
