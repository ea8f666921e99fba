#!/usr/bin/env python3
"""Whole runs of random small scenes: bodies, methods, tools, contact, refinement and keys, with numbers that are wrong by up to
1000. Whatever the scene, a run is refused before it writes, or fails by name, or ends; and a run that ends holds:

    numbers       none in series.csv, final.ply and summary.json is NaN or infinite
    intersection  with contact and no start that is tangled, the surfaces do not cut each other at the end
    ledger        energy that appeared is within 5 % of what was supplied, or a warning says so
    threads       1 and 3 threads give the same state, series and frames
    stop          a run that takes long ends soon after a stop signal
    resume        a run that is stopped half-way and continued gives the same state, series and frames

A scene that breaks one is made smaller while it still breaks the same, and kept in the folder of --keep. Those that did
once are in tests/cli/broken and checked first.

usage: properties.py PROGRAM [--count N] [--seed N] [--jobs N] [--keep FOLDER] [--scene FILE]
"""
import argparse
import concurrent.futures
import copy
import csv
import json
import math
import pathlib
import random
import resource
import shutil
import subprocess
import sys
import tempfile
import time

SECONDS = 6  # a run that takes longer is stopped, and is no failure
STOP_SECONDS = 20  # a stop takes less than 0.5 s on an idle machine
MEMORY = 4 << 30
SHRINK_SECONDS = 120
# columns of wall time
TIMES = ("step_ms", "contact_find_ms", "contact_solve_ms", "contact_guard_ms")


# ---- scenes ----

class Maker:
    """One random scene. Numbers are sensible but for those that are multiplied by something from 1e-3 to 1e3."""

    def __init__(self, seed):
        self.chance = random.Random(seed)
        # most scenes are sane, so that they run
        self.wild = self.chance.choice((0, 0, 0.03, 0.15))

    def maybe(self, share):
        return self.chance.random() < share

    def number(self, low, high):
        value = math.exp(self.chance.uniform(math.log(low), math.log(high)))
        if self.maybe(self.wild):
            value *= 10 ** self.chance.uniform(-3, 3)
        return float(f"{value:.4g}")

    def vector(self, size):
        return [round(self.chance.uniform(-size, size), 4) for _ in range(3)]

    def keys(self, high=1.0):
        times = sorted({0.0, round(self.chance.uniform(0, 1), 3), round(self.chance.uniform(0, 1), 3)})
        return [[t * self.length, round(self.chance.uniform(0, high), 3)] for t in times]

    def quantity(self, low, high):
        if self.maybe(0.15):
            return {"keys": [[time, self.number(low, high)] for time, _ in self.keys()]}
        return self.number(low, high)

    def mesh(self):
        shape = self.chance.choice(("geodesic-sphere", "geodesic-sphere", "grid", "cylinder", "torus", "capsule", "uv-sphere", "disk"))
        mesh = {"shape": shape}
        if shape == "geodesic-sphere":
            mesh["frequency"] = self.chance.randint(2, 4)
        elif shape == "uv-sphere":
            mesh |= {"slices": self.chance.randint(5, 12), "rings": self.chance.randint(3, 8)}
        elif shape == "grid":
            mesh |= {"nx": self.chance.randint(2, 9), "ny": self.chance.randint(2, 9),
                     "diagonals": self.chance.choice(("one-diagonal", "union-jack"))}
        elif shape == "torus":
            mesh |= {"slices": self.chance.randint(8, 16), "rings": self.chance.randint(4, 7)}
        elif shape in ("cylinder", "capsule"):
            mesh |= {"slices": self.chance.randint(5, 10), "segments": self.chance.randint(1, 5)}
            mesh |= {"rings": self.chance.randint(1, 4)} if shape == "capsule" else {"capped": self.maybe(0.5)}
        elif shape == "disk":
            mesh["rings"] = self.chance.randint(2, 6)
        if self.maybe(0.2):
            mesh["scale"] = self.number(0.5, 2)
        return mesh

    def region(self):
        axis = self.chance.randint(0, 2)
        low = [-1e3] * 3
        low[axis] = round(self.chance.uniform(-0.2, 0.15), 3)
        return {"box": {"min": low, "max": [1e3] * 3}}

    def springs(self, body):
        if self.maybe(0.5):
            body["springs"] = {"stiffness": self.quantity(1, 10), "damping": self.quantity(0.1, 1)}
            body["mass"] = {"per_vertex": self.number(0.1, 1)}
        elif self.maybe(0.5):
            body["springs"] = {"young": self.quantity(1e3, 1e5)}
        if self.maybe(0.5):
            body["volumetric"] = {"stiffness": self.quantity(0.5, 3)} if self.maybe(0.5) else {"young": self.quantity(1e3, 1e4)}

    def shell(self, body):
        thickness = self.number(0.003, 0.1)
        body["mass"] = {"density": self.number(500, 2000), "thickness": thickness}
        law = self.chance.choice(("stvk", "corotated", "linear", "mooney-rivlin", "neo-hookean", "gent", "fung",
                                   "orthotropic", "tension-field"))
        body["membrane"] = {"material": law, "young": self.number(1e4, 1e6), "thickness": thickness,
                            "poisson": round(self.chance.uniform(0, 0.49), 3)}
        if self.maybe(0.8):
            models = ["isometric", "hinge", "hinge"]
            # a constraint: as an energy it flattens a curved rest shape, and is refused
            if self.method in ("pbd", "xpbd"):
                models += ["isometric-rest"]
            # it has unknowns on edges
            if self.method in ("static", "implicit"):
                models += ["midedge"] * 3
            body["bending"] = {"model": self.chance.choice(models)}
            if self.maybe(0.2):
                body["bending"]["stiffness"] = self.number(1e-3, 1)
        if self.maybe(0.2):
            mode = self.chance.choice(("cave", "normal", "strain", "active", "curl") if self.method in ("pbd", "xpbd") else ("normal", "strain", "active"))
            fibres = body["anisotropy"] = {"mode": mode, "direction": self.vector(1)}
            if mode == "cave":
                fibres["strength"] = self.number(1e-4, 1e-2)
            elif mode == "normal":
                fibres["gradient"] = self.number(1, 1e4)
            elif mode == "active":
                fibres["rest_length"] = self.quantity(0.7, 1)

    def pressure(self, is_open):
        kind = self.chance.choice(("outside", "inside") if is_open else ("outside", "inside", "gas", "volume"))
        if kind == "gas":
            return {"gas": {"pressure": self.number(1e3, 1e5)}}
        if kind == "volume":
            return {"volume": {"target": self.quantity(0.6, 1.4), "bulk": self.number(1e3, 1e5)}}
        return {kind: self.quantity(1, 1e3)}

    def refine(self):
        refine = {"levels": self.chance.randint(1, 2)}
        kind = self.chance.choice(("everywhere", "above", "near_tools", "curvature"))
        if kind == "curvature":
            refine["curvature"] = {"above": self.number(0.01, 1)}
        else:
            refine[kind] = True if kind == "everywhere" else self.number(0.1, 10) if kind == "above" else self.number(0.1, 1)
        if kind != "everywhere":
            refine |= {"interval": self.chance.randint(1, 3), "dwell": self.chance.randint(0, 5)}
        return refine

    def body(self, number):
        body = {"name": f"b{number}", "mesh": self.mesh()}
        is_open = body["mesh"]["shape"] in ("grid", "disk") or body["mesh"].get("capped") is False
        if number > 0:
            body["mesh"]["translate"] = [0, 0, round(self.chance.uniform(2.2, 3), 3)]
        (self.springs if self.maybe(0.45) else self.shell)(body)
        if self.maybe(0.3):
            body["pressure"] = self.pressure(is_open)
        if self.maybe(0.5):
            body["pinned"] = "boundary" if is_open and self.maybe(0.3) else self.region()
            if self.maybe(0.2):
                body["support"] = {"motion": [{"position": [0, 0, 0]}, {"time": self.length, "position": self.vector(0.1)}]}
        if self.maybe(0.2):
            body["refine"] = self.refine()
        if self.maybe(0.1) and self.method in ("xpbd", "pbd", "explicit", "implicit"):
            body["velocity"] = self.vector(1)
        if self.maybe(0.1):
            body["contact"] = {"friction": self.number(0.1, 1)}
        return body

    def tool(self, number):
        shape = self.chance.choice(("sphere", "capsule", "box"))
        sizes = {"sphere": {"radius": self.number(0.1, 0.5)}, "capsule": {"radius": self.number(0.1, 0.3), "length": self.number(0.2, 1)},
                 "box": {"size": [self.number(0.2, 3) for _ in range(3)]}}[shape]
        side = self.chance.choice((-1, 1))
        far = 1.05 + (sizes.get("radius") or sizes["size"][2] / 2) + (sizes.get("length", 0) / 2)
        way = round(self.chance.uniform(0.05, 0.6), 3)
        tool = {"name": f"t{number}", "shape": shape, **sizes,
                "motion": [{"position": [0, 0, side * far]}, {"time": self.length, "position": [*self.vector(0.1)[:2], side * (far - way)]}]}
        if self.maybe(0.3):
            tool["motion"][1]["rotation"] = {"axis": self.vector(1), "angle": round(self.chance.uniform(-90, 90), 1)}
        if self.maybe(0.2):
            tool["grasp"] = {"reach": self.number(0.05, 0.3), "from": 0.3 * self.length, "until": 0.8 * self.length}
            if self.maybe(0.3):
                tool["grasp"]["max_force"] = self.number(1, 100)
        if self.maybe(0.2):
            tool["friction"] = self.number(0.1, 1)
        return tool

    def load(self):
        load = {"body": "b0", "force": [self.number(0.1, 10) * self.chance.choice((-1, 1)) for _ in range(3)]}
        if self.maybe(0.5):
            load["at"] = {"nearest": self.vector(1)}
        if self.maybe(0.4):
            load["keys"] = self.keys()
        return load

    def solver(self):
        solver, method = {"dt": self.dt}, self.method
        if method is not None:
            solver["method"] = method
        if method in ("pbd", "xpbd") and self.maybe(0.4):
            solver["substeps"] = self.chance.randint(1, 40)
        if method in ("pbd", "xpbd", "descent") and self.maybe(0.3):
            solver["iterations"] = self.chance.randint(1, 20)
        if method in ("pbd", "xpbd", "explicit", "implicit") and self.maybe(0.3):
            solver["drag"] = self.number(0.1, 5)
        if method == "static" and self.maybe(0.2):
            solver |= {"analysis": self.chance.choice(("modal", "buckling")), "modes": self.chance.randint(1, 6)}
        if method == "quasi-static" and self.maybe(0.3):
            solver["velocity"] = "keep"
        return solver

    def rigid(self, scene):
        """a rigid body above or below the others, held by a joint or free"""
        shape = self.chance.choice(("geodesic-sphere", "box", "torus", "capsule", "cylinder"))
        mesh = {"shape": shape, "scale": round(self.chance.uniform(0.2, 0.8), 3)}
        if shape == "geodesic-sphere":
            mesh["frequency"] = 3
        height = round(self.chance.choice((-1, 1)) * self.chance.uniform(1.9, 2.5), 3)
        mesh["translate"] = [*self.vector(0.3)[:2], height]
        body = {"name": "r", "mesh": mesh, "rigid": {"density": self.number(100, 8000)}}
        if self.maybe(0.5):
            body["velocity"] = [*self.vector(1)[:2], -math.copysign(self.number(0.1, 20), height)]
        scene["bodies"].append(body)
        if self.maybe(0.4):
            joint = {"body": "r", "kind": self.chance.choice(("ball", "hinge", "slider", "weld")), "point": [*mesh["translate"][:2], height + 0.3]}
            if joint["kind"] in ("hinge", "slider"):
                joint["axis"] = self.chance.choice(([0, 0, 1], [1, 0, 0], [1, 1, 0]))
                if self.maybe(0.4):
                    joint["motor"] = {"speed": self.number(0.1, 100), "strength": self.number(0.1, 100)}
            scene["joints"] = [joint]

    def solid(self, body):
        """the same body of tetrahedra"""
        for key in ("springs", "volumetric", "membrane", "bending", "anisotropy", "pressure", "refine"):
            body.pop(key, None)
        body["mass"] = {"density": self.number(500, 2000)}
        body["volume"] = {"young": self.number(1e3, 1e6), "poisson": round(self.chance.uniform(0, 0.49), 3), "edge": self.number(0.3, 0.6),
                          "element": self.chance.choice(("linear", "smooth")),
                          "material": self.chance.choice(("stvk", "corotated", "mooney-rivlin", "neo-hookean"))}

    def opens(self, scene, body):
        """cuts, seams and tears"""
        body.pop("refine", None)
        kind = self.chance.choice(("cut", "seam", "tear"))
        if kind == "seam":
            scene["seams"] = [{"body": body["name"], "vertices": self.chance.choice(("all", self.region())), "strength": self.number(1, 1e4)}]
        else:
            scene["cuts"] = [{"body": body["name"], "at": round(self.chance.uniform(0, 0.6) * self.length, 5),
                              "path": [self.vector(0.5) for _ in range(self.chance.randint(2, 4))]}]
        if kind == "tear" and "membrane" in body:
            body["membrane"] |= {"toughness": self.number(1, 1e4), "strength": self.number(1e3, 1e5)}
            scene["tear"] = {"start": self.chance.choice(("none", "borders", "anywhere"))}

    def newer(self, scene):
        """what a scene may have beside the rest"""
        body = scene["bodies"][0]
        is_shell = "membrane" in body
        closed = body["mesh"]["shape"] not in ("grid", "disk", "cylinder")
        if is_shell and self.maybe(0.2):
            body["pressure"] = {self.chance.choice(("outside", "inside")): self.chance.choice((-1, 1)) * self.number(1e2, 1e5)}
        if is_shell and self.maybe(0.15) and self.method in (None, "implicit", "xpbd"):
            kind = self.chance.choice(("stiffness", "loss_factor"))
            body["membrane"]["damping"] = {kind: self.number(1e-4, 0.1) if kind == "stiffness" else self.number(0.01, 1)}
        if is_shell and self.maybe(0.1):
            body["membrane"] |= {"rest_scale": self.number(0.5, 2), "rest_keys": self.keys()}
        if is_shell and body.get("bending", {}).get("model") == "hinge" and self.maybe(0.1):
            body["bending"]["yield"] = self.number(0.1, 10)
        if is_shell and closed and self.maybe(0.1):
            body["fluid"] = {"density": self.number(100, 2000)}
        if closed and self.maybe(0.15):
            self.solid(body)
        if self.maybe(0.1):
            scene["wind"] = {"velocity": self.vector(20)}
            if self.maybe(0.5):
                scene["wind"]["gusts"] = {"speed": self.number(0.1, 5), "length": self.number(0.1, 2)}
        if self.maybe(0.25):
            self.rigid(scene)
        if self.maybe(0.15):
            tie = {"body": "b0", "at": self.region(), "to": self.chance.choice((None, {"body": scene["bodies"][-1]["name"]}))}
            if tie["to"] is None or tie["to"]["body"] == "b0":
                del tie["to"]
            if self.maybe(0.5):
                tie["stiffness"] = self.number(1, 1e4)
            if self.maybe(0.3):
                tie |= {"from": 0.3 * self.length, "until": 0.8 * self.length}
            scene["attachments"] = [tie]
        if self.maybe(0.15):
            self.opens(scene, body)

    def blade(self, number):
        """cuts a body while it passes, or holds its rim"""
        side = self.chance.choice((-1, 1)) * 1.4
        edge = [[0, 0, -1.2], [0, 0, 1.2]]
        tool = {"name": f"k{number}", "shape": self.chance.choice(("blade", "blade", "hook", "scissors")), "edge": edge,
                "motion": [{"position": [side, *self.vector(0.4)[:2]]},
                           {"time": self.length, "position": [side * round(self.chance.uniform(-1, 0.6), 3), *self.vector(0.4)[:2]]}]}
        if tool["shape"] == "scissors":
            tool |= {"edge": [[-side, 0.2, 0.1], [-side, -0.2, 0.1]], "closing": self.keys()}
        elif tool["shape"] == "blade" and self.maybe(0.5):
            tool["sharpness"] = self.number(1, 1e4)
        return tool

    def latest(self, scene):
        """what came after that: blades, laws that yield, muscles, numbers of the solver"""
        body = scene["bodies"][0]
        if self.maybe(0.3):
            body.pop("refine", None)
            scene.setdefault("tools", []).append(self.blade(len(scene.get("tools", []))))
        if "membrane" in body and self.maybe(0.3):
            body["membrane"] |= {"material": "elastoplastic", "yield": self.number(1e2, 1e5), "hardening": self.number(1e2, 1e5)}
            body.pop("anisotropy", None)
        elif "membrane" in body and self.maybe(0.3):
            body["anisotropy"] = {"mode": "muscle", "direction": self.vector(1), "tension": self.number(1, 1e3),
                                  "activation": {"keys": self.keys()}}
        if body.get("bending", {}).get("model") == "hinge" and self.maybe(0.3):
            body["bending"] |= {"yield": self.number(0.1, 10), "hardening": self.number(0.01, 1)}
        if self.maybe(0.15):
            scene["solver"]["alpha" if self.maybe(0.2) else "max_substeps"] = self.chance.randint(1, 30)
        if self.method == "quasi-static" and self.maybe(0.3):
            scene["solver"]["momentum"] = round(self.chance.uniform(0, 0.99), 2)
        if self.method == "xpbd" and self.maybe(0.3):
            scene["solver"]["second_order"] = self.maybe(0.5)
        if self.method == "static" and self.maybe(0.2):
            scene["solver"] |= {"path": "arc-length", "steps": self.chance.randint(2, 8)}
        if "contact" in scene and self.maybe(0.2):
            scene["contact"] |= self.chance.choice(({"sleep": False}, {"sweeps": self.chance.randint(1, 30)}, {"start": "tangled"}))

    def scene(self):
        self.method = self.chance.choice((None, "quasi-static", "explicit", "pbd", "pbd-distance", "xpbd", "xpbd", "descent", "static",
                                          "implicit"))
        self.dt = self.number(0.001, 0.02)
        steps = self.chance.randint(4, 12)
        self.length = float(f"{steps * self.dt:.6g}")
        scene = {"version": 1, "bodies": [self.body(n) for n in range(2 if self.maybe(0.2) else 1)],
                 "solver": self.solver(), "duration": self.length,
                 "output": {"every_frame": self.chance.randint(1, 3), "precision": "double"}}
        if self.maybe(0.5):
            scene["tools"] = [self.tool(n) for n in range(2 if self.maybe(0.3) else 1)]
        if self.maybe(0.5):
            scene["loads"] = [self.load()]
        if self.maybe(0.3):
            scene["gravity"] = [0, 0, -self.number(1, 10)]
        if self.maybe(0.5):
            scene["contact"] = {}
            if self.maybe(0.3):
                scene["contact"]["friction"] = self.number(0.1, 1)
            if self.maybe(0.1) and self.method in ("xpbd", "pbd", "explicit", "implicit"):
                scene["contact"]["restitution"] = round(self.chance.uniform(0, 1), 2)
            if self.maybe(0.1):
                scene["contact"]["response"] = "after"
            if self.maybe(0.1):
                scene["contact"]["thickness"] = self.number(1e-3, 1e-2)
        if self.maybe(0.6):
            self.newer(scene)
        if self.maybe(0.6):
            self.latest(scene)
        return scene


# ---- checks ----

class Broken(Exception):
    """kind: what does not hold, the same for a smaller scene; text: for people"""

    def __init__(self, kind, text):
        super().__init__(f"{kind}: {text}")
        self.kind = kind


class Slow(Exception):
    """a run that was stopped: nothing is known of its end"""


class Runs:
    def __init__(self, program, folder):
        self.program, self.folder = program, pathlib.Path(folder)

    def run(self, name, *arguments):
        def limit():
            if not sanitized:
                resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
        process = subprocess.Popen([self.program, "run", "scene.yaml", "-q", "-o", name, *arguments], cwd=self.folder, preexec_fn=limit,
                                   stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True,
                                   errors="replace")
        try:
            _, errors = process.communicate(timeout=SECONDS)
        except subprocess.TimeoutExpired:
            self.stop(process)
            raise Slow() from None
        if process.returncode not in (0, 1, 2):
            raise Broken("crash", f"ends with status {process.returncode}: {errors[-600:]}")
        return process.returncode, errors

    @staticmethod
    def stop(process):
        process.terminate()
        try:
            process.communicate(timeout=STOP_SECONDS)
        except subprocess.TimeoutExpired:
            process.kill()
            process.communicate()
            raise Broken("stop", f"goes on for {STOP_SECONDS} s after a stop signal") from None

    def series(self, name):
        with open(self.folder / name / "series.csv", newline="") as file:
            return [{key: value for key, value in row.items() if key not in TIMES} for row in csv.DictReader(file)]

    def summary(self, name):
        return json.loads((self.folder / name / "summary.json").read_text())

    def check_same(self, kind, one, two):
        if self.summary(one)["state_hash"] != self.summary(two)["state_hash"]:
            raise Broken(kind, f"state of {two} differs from that of {one}")
        rows = self.series(one), self.series(two)
        if len(rows[0]) != len(rows[1]):
            raise Broken(kind, f"{two} has {len(rows[1])} rows, {one} has {len(rows[0])}")
        for a, b in zip(*rows):
            differing = [key for key in a if a[key] != b[key]]
            if differing:
                raise Broken(kind, f"frame {a['frame']}: {differing[0]} is {b[differing[0]]} in {two}, {a[differing[0]]} in {one}")
        for path in sorted((self.folder / one / "frames").iterdir()):
            if path.read_bytes() != (self.folder / two / "frames" / path.name).read_bytes():
                raise Broken(kind, f"{path.name} of {two} differs from that of {one}")

    def check_numbers(self, name):
        for row in self.series(name):
            for key, value in row.items():
                if value != "" and not math.isfinite(float(value)):
                    raise Broken("numbers", f"{key} is {value} in frame {row['frame']}")
        text = (self.folder / name / "summary.json").read_text()
        if any(word in text for word in ("nan", "inf,", "inf}", "NaN", "Infinity")):
            raise Broken("numbers", "summary.json has one that is not finite")

    def check_end(self, scene, name):
        summary = self.summary(name)
        codes = [warning["code"] for warning in summary["warnings"]]
        contact = scene.get("contact")
        if contact is not None and contact.get("response") != "after" and summary["self_intersections_final"] > 0:
            raise Broken("intersection", f"{summary['self_intersections_final']} pairs of triangles cut each other")
        energy = summary.get("energy") or {}
        rounding = least_energy + 1e-9 * max((abs(value) for value in energy.values() if isinstance(value, float)), default=0)
        rests = summary["max_displacement"] < rest_displacement
        if not rests and energy.get("energy_error", 0) > 0.0501 * energy.get("supplied", 0) + rounding and "energy-appears" not in codes:
            raise Broken("ledger", f"{energy['energy_error']} J appeared of {energy['supplied']} J, and no warning says so")

    def check(self, scene):
        """how the run of a scene ended: done, refused or the status of the summary; Broken where something does not hold"""
        for path in self.folder.iterdir():
            if path.is_dir():
                shutil.rmtree(path)
        (self.folder / "scene.yaml").write_text(json.dumps(scene, indent=1))
        status, errors = self.run("one", "--threads", "1")
        if status == 2:
            if "error: " not in errors or (self.folder / "one").exists():
                raise Broken("refusal", f"refused, but without a word or with a folder: {errors[-300:]}")
            return "refused"
        summary = self.summary("one")
        if status == 1 and (summary["status"] not in ("diverged", "failed") or "error: " not in errors):
            raise Broken("failure", f"status {summary['status']!r}: {errors[-300:]}")
        self.check_numbers("one")
        self.run("three", "--threads", "3")
        self.check_same("threads", "one", "three")
        if status == 1:
            return summary["status"]
        self.check_end(scene, "one")
        half = (summary["frames"] - 1) // 2
        if half > 0:
            self.run("halved", "--threads", "1", "--frames", str(half))
            self.run("halved", "--threads", "2", "--resume", "halved/checkpoint")
            self.check_same("resume", "one", "halved")
        return summary["status"]

    def breaks(self, scene):
        try:
            self.check(scene)
        except Broken as broken:
            return broken
        except Slow:
            pass
        return None


# ---- smaller scenes ----

def paths_of(value, path=()):
    """all places of a scene, larger parts first"""
    children = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, child in children:
        yield (*path, key)
        yield from paths_of(child, (*path, key))


def without(scene, path):
    smaller = copy.deepcopy(scene)
    at = smaller
    for key in path[:-1]:
        at = at[key]
    del at[path[-1]]
    return smaller


def rounded(scene, path):
    """the same with a plainer number there; None where there is none"""
    plainer = copy.deepcopy(scene)
    at = plainer
    for key in path[:-1]:
        at = at[key]
    value = at[path[-1]]
    if isinstance(value, bool) or not isinstance(value, float) or value == 0:
        return None
    at[path[-1]] = float(f"{value:.1g}")
    return plainer if at[path[-1]] != value else None


def shrink(runs, scene, kind):
    """leaves out what the failure does not need, again and again, for a while"""
    changed, end = True, time.monotonic() + SHRINK_SECONDS
    while changed:
        changed = False
        for make in (without, rounded):
            for path in sorted(paths_of(scene), key=len):
                if time.monotonic() > end:
                    return scene
                try:
                    smaller = make(scene, path)
                except (KeyError, IndexError, TypeError):
                    continue  # it went with a larger part
                broken = runs.breaks(smaller) if smaller is not None else None
                if broken is not None and broken.kind == kind:
                    scene, changed = smaller, True
    return scene


# ---- all ----

def try_seed(program, seed, keep):
    return try_scene(program, Maker(seed).scene(), seed, keep)


def try_scene(program, scene, name, keep):
    with tempfile.TemporaryDirectory() as folder:
        runs = Runs(program, folder)
        try:
            return runs.check(scene), None
        except Slow:
            return "stopped", None
        except Broken as broken:
            text = str(broken)
            if keep is not None:
                scene = shrink(runs, scene, broken.kind)
                text = str(runs.breaks(scene) or broken)
                keep.mkdir(parents=True, exist_ok=True)
                (keep / f"{broken.kind}-{name}.yaml").write_text(json.dumps(scene, indent=1) + "\n")
            return "broken", text


def main():
    global sanitized, least_energy
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--count", type=int, default=60, help="scenes (default: %(default)s)")
    parser.add_argument("--seed", type=int, default=1, help="of the first one; the others follow (default: %(default)s)")
    parser.add_argument("--jobs", type=int, default=2, help="at once (default: %(default)s)")
    parser.add_argument("--keep", type=pathlib.Path, help="folder for scenes that break something, made smaller")
    parser.add_argument("--scene", type=pathlib.Path, help="checks this scene of --keep again instead")
    parser.add_argument("--sanitized", action="store_true", help="the program has a sanitizer: no limit of its memory")
    parser.add_argument("--single", action="store_true", help="the program computes in float")
    arguments = parser.parse_args()
    sanitized = arguments.sanitized
    least_energy = 1e-9 if arguments.single else 1e-20
    program = str(pathlib.Path(arguments.program).resolve())
    if arguments.scene:
        with tempfile.TemporaryDirectory() as folder:
            broken = Runs(program, folder).breaks(json.loads(arguments.scene.read_text()))
        print(broken or "holds")
        sys.exit(1 if broken else 0)
    # what was broken once
    for path in sorted(pathlib.Path(__file__).with_name("broken").glob("*.yaml")):
        end, text = try_scene(program, json.loads(path.read_text()), path.stem, None)
        if end == "broken":
            print(f"{path.name}: {text}")
            sys.exit(1)
    seeds = range(arguments.seed, arguments.seed + arguments.count)
    ends = {}
    with concurrent.futures.ThreadPoolExecutor(arguments.jobs) as pool:
        for seed, (end, text) in zip(seeds, pool.map(lambda s: try_seed(program, s, arguments.keep), seeds)):
            ends[end] = ends.get(end, 0) + 1
            if text is not None:
                print(f"seed {seed}: {text}", flush=True)
    print(f"{arguments.count} scenes:", ", ".join(f"{count} {end}" for end, count in sorted(ends.items())))
    # a generator of nothing but refusals would prove nothing
    enough = ends.get("done", 0) + ends.get("stopped", 0) >= arguments.count // 3
    if not enough:
        print("too few of them ran to their end")
    sys.exit(0 if enough and "broken" not in ends else 1)


sanitized = False
least_energy = 1e-20  # J, less is rounding
rest_displacement = 1e-11  # m, of bodies that rest: rounding moves them, of potentials far larger than what the ledger counts
main()
