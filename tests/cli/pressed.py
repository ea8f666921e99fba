#!/usr/bin/env python3
"""Scenes in which things are pressed together, with default settings, run to their ends: no frame intersects, no energy
appears, and a step does not take long. Skipped unless PELLICLE_ALL is set.

usage: pressed.py PROGRAM [NAME...]
"""
import csv
import json
import os
import pathlib
import resource
import subprocess
import sys
import tempfile

# ms of processor time of a step and 1,000 triangles: three times the largest that was measured, since machines differ
MOST_MS = 150
# of the work: energy that appears
MOST_ENERGY = 0.02


def children():
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def judge(program, scene, folder):
    """The faults of one scene, in words."""
    before = children()
    ran = subprocess.run([program, "run", scene, "-q", "-o", folder, "--threads", "1"], capture_output=True, text=True)
    seconds = children() - before
    if ran.returncode != 0:
        return [f"exit {ran.returncode}: {ran.stderr.strip()[-300:]}"]
    end = json.loads((folder / "summary.json").read_text())
    rows = list(csv.DictReader((folder / "series.csv").open()))
    work = sum(max(abs(float(row[key])) for row in rows) for key in ("work_tools", "work_loads", "work_pressure", "work_gravity"))
    appeared = max(float(row["energy_error"]) for row in rows)
    ms = 1e6 * seconds / end["steps"] / end["triangles_final"]
    frames = sorted((folder / "frames").glob("f*.vtp"))
    checks = [subprocess.run([program, "check", frame, "--json"], capture_output=True, text=True).stdout for frame in frames]
    intersecting = sum('"self_intersections": 0,' not in check for check in checks)
    print(f"{scene.stem}: {ms:.1f} ms, energy {appeared / work:.2g} of the work, {intersecting} of {len(frames)} frames intersect")
    faults = [f"{ms:.0f} ms a step and 1,000 triangles"] if ms > MOST_MS else []
    faults += [f"{appeared:.3g} J appear, the work is {work:.3g} J"] if appeared > MOST_ENERGY * work else []
    faults += [f"{intersecting} of {len(frames)} frames intersect"] if intersecting or len(frames) < 10 else []
    return faults


def main(program, *names):
    if "PELLICLE_ALL" not in os.environ:
        print("long: scenes of things pressed together")
        return 77
    scenes = sorted((pathlib.Path(__file__).parent / "pressed").glob("*.yaml"))
    failed = False
    for scene in scenes:
        if names and scene.stem not in names:
            continue
        with tempfile.TemporaryDirectory() as folder:
            for fault in judge(program, scene, pathlib.Path(folder) / "run"):
                print(f"{scene.stem}: {fault}")
                failed = True
    return failed


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
