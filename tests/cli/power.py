#!/usr/bin/env python3
"""Power failures: a run and a study are recorded, and what a disk may have after a failure at any moment is made from that: a
name whose folder was not waited for may be there or not, in any combination that is tried here (none, all, each first few, each
one alone), with all that is below it, and bytes that were not waited for are lost. From each such folder the run goes on to the same end, or
has its summary; what a command has left when it ends stays, whatever happens then.

usage: power.py PROGRAM
"""
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

SCENE = """version: 1
bodies: [{ name: ball, mesh: { shape: geodesic-sphere, frequency: 2 }, springs: { stiffness: 3 } }]
loads: [{ body: ball, force: [0, 0, -1], at: { nearest: [0, 0, 1] } }]
solver: { alpha: 50, dt: 0.01 }
duration: 1
output: { every: 0.25%s }
"""
STUDY = """scene: scene.yaml
vary: { bodies.ball.springs.stiffness: [2, 3, 4] }
measure: { depth: max_displacement }
"""


FOLDER = "folder"


class Disk:
    """Names and bytes that are on the disk for certain, and names that may be."""

    def __init__(self, record, home):
        self.record, self.home = record, home
        self.names, self.bytes, self.pending, self.folders = {}, {}, [], set()

    def take(self, line):
        word, number, rest = (line.split(" ", 2) + [""])[:3]
        if word == "file":
            self.bytes[number] = (self.record / rest).read_bytes()
        elif word == "folder":
            stay = [change for change in self.pending if os.path.dirname(change[1]) != rest]
            apply(self.names, [change for change in self.pending if change not in stay])
            self.pending = stay
        elif word == "all":
            tree = self.record / number
            self.names, self.pending = {}, []
            for path in (tree, *tree.rglob("*")):
                self.names[str(self.home / path.relative_to(tree))] = str(path) if path.is_file() else FOLDER
        elif word == "made":
            self.folders.add(rest)
            self.pending.append((word, rest, FOLDER))
        elif word == "move":
            self.pending.append(("move", rest.split("\t")[1], number, rest.split("\t")[0]))
        else:
            self.pending.append((word, rest, number))

    def states(self):
        changes = self.pending
        chosen = [[], changes] + [changes[:i] for i in range(1, len(changes))] + [[change] for change in changes]
        for some in chosen:
            names = dict(self.names)
            apply(names, some)
            yield self.state(names)

    def state(self, names):
        """the files, without those below a folder that is not there"""
        lacks = [f"{folder}/" for folder in self.folders if folder not in names]
        return {path: self.content(source) for path, source in names.items()
                if source != FOLDER and not path.startswith(tuple(lacks))}

    def content(self, source):
        """The bytes of a copy or an inode; empty where nothing was waited for."""
        return pathlib.Path(source).read_bytes() if source.startswith("/") else self.bytes.get(source, b"")


def apply(names, changes):
    for change in changes:
        if change[0] == "gone":
            names.pop(change[1], None)
        else:
            names[change[1]] = change[2]
            if change[0] == "move":
                names.pop(change[3], None)


def record(program, folder, library, arguments, home):
    notes = pathlib.Path(tempfile.mkdtemp(dir=folder))
    subprocess.run([program, *arguments], cwd=folder, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                   env={**os.environ, "LD_PRELOAD": str(library), "RECORD": str(notes)})
    disk, seen = Disk(notes, home), {}
    for number, line in enumerate((notes / "log").read_text().splitlines()):
        disk.take(line)
        for state in disk.states():
            files = {path: data for path, data in state.items() if path.startswith(f"{home}/") and not path.endswith((".tmp", "lock"))}
            seen.setdefault(tuple(sorted(files.items())), number)
    certain = {os.path.relpath(path, home) for path in disk.state(disk.names)}
    return [(dict(state), number) for state, number in seen.items()], certain


def put(state, home):
    shutil.rmtree(home, ignore_errors=True)
    home.mkdir()
    for path, data in state.items():
        pathlib.Path(path).parent.mkdir(parents=True, exist_ok=True)
        pathlib.Path(path).write_bytes(data)


def hash_of(home):
    return next(line for line in (home / "scene.yaml").read_text().splitlines() if "state_hash" in line)


def check_run(program, folder, library):
    home = folder / "run"
    (folder / "scene.yaml").write_text(SCENE % ", checkpoint: 0.25")
    subprocess.run([program, "run", "scene.yaml", "-o", "whole", "-q"], cwd=folder, check=True, stdout=subprocess.DEVNULL)
    wanted, rows = hash_of(folder / "whole"), (folder / "whole/series.csv").read_text().count("\n")
    status = json.loads((folder / "whole/summary.json").read_text())["status"]
    states, certain = record(program, folder, library, ["run", "scene.yaml", "-o", "run", "-q"], home)
    assert {"summary.json", "scene.yaml", "series.csv", "frames/f00004.vtp"} <= certain, certain
    resumed = finished = 0
    first = min((number for state, number in states if f"{home}/checkpoint" in state), default=None)
    assert first is not None
    for state, number in states:
        put(state, home)
        kept = [path for path in state if os.path.basename(path).startswith("checkpoint")]
        if f"{home}/summary.json" in state:
            assert json.loads((home / "summary.json").read_text())["status"] == status
            assert hash_of(home) == wanted and (home / "series.csv").read_text().count("\n") == rows
            assert all(path.stat().st_size > 0 for path in home.rglob("*") if path.is_file()), sorted(state)
            finished += 1
        for path in kept[:1]:
            done = subprocess.run([program, "run", "scene.yaml", "-o", "run", "--resume", path, "-q"], cwd=folder,
                                  capture_output=True, text=True)
            assert done.returncode == 0, (number, sorted(state), done.stderr)
            assert hash_of(home) == wanted
            frames = sorted((home / "frames").iterdir())
            assert len(frames) == 5 and all(frame.stat().st_size > 0 for frame in frames), frames
            resumed += 1
    assert resumed > 8 and finished > 0, (resumed, finished, len(states))
    print(f"run: {len(states)} states, {resumed} resumed, {finished} finished")


def check_study(program, folder, library):
    home = folder / "study"
    (folder / "scene.yaml").write_text(SCENE % "")
    (folder / "study.yaml").write_text(STUDY)
    states, certain = record(program, folder, library, ["sweep", "study.yaml", "-o", "study", "--jobs", "1", "-q"], home)
    assert any(path.startswith("rows/") for path in certain), certain
    table, most = (home / "runs.csv").read_text(), 0
    strip = lambda text: [line.split(",")[:3] for line in text.splitlines()]
    for state, _ in states:
        put(state, home)
        rows = b"".join(data for path, data in state.items() if "/rows/" in path).count(b"done")
        assert rows >= most, "a row that was waited for is lost"
        most = rows
        done = subprocess.run([program, "sweep", "study.yaml", "-o", "study", "--jobs", "1", "-q"], cwd=folder, capture_output=True, text=True)
        assert done.returncode == 0, (sorted(state), done.stderr)
        assert strip((home / "runs.csv").read_text()) == strip(table)
    assert most == 3, most
    print(f"study: {len(states)} states")


def main():
    program = os.path.abspath(sys.argv[1])
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name).resolve()
        library = folder / "record.so"
        subprocess.run([os.environ.get("CC", "cc"), "-shared", "-fPIC", "-o", str(library),
                        str(pathlib.Path(__file__).with_name("record.c")), "-ldl"], check=True)
        check_run(program, folder, library)
        check_study(program, folder, library)


main()
