#!/usr/bin/env python3
"""Runs the commands that README.md, CONTRIBUTING.md and docs/*.md show in code blocks: lines that start with `pellicle`,
`build/release/pellicle` or `make`. The commands of a page run in order in one empty folder with the scenes that the page saves,
and each must succeed. NOT_RUN lists the others with reasons. Other complete scenes are checked. Without PELLICLE_ALL in the environment
(.ci/run and make nightly set it) only the commands of README.md and CONTRIBUTING.md run.

usage: commands.py ROOT PROGRAM [render]      without `render` commands that draw are skipped, without `make web` reports
"""
import os
import re
import shlex
import subprocess
import sys
import tempfile
from pathlib import Path

BLOCK = re.compile(r"^```yaml\n([\s\S]*?)^```|^(?: {4,}|\$ )((?:build/release/)?pellicle [^\n]*|make\b[^\n]*)$", re.M)
SAVE = re.compile(r"Save this as `([\w.-]+)`")

# commands that are not run, as regular expressions of the whole command, with the reason
NOT_RUN = {
    r"make test( PRESET=asan)?": "this test is part of it",
    r"make (nightly|mutate COUNT=60|format)": "changes or compiles the sources, partly for hours",
    r"make check NAME=\S+": "one of the tests",
    r"make (web|wasm|python|live|install|machines|compilers|threads|endurance|blender)( .*)?": "stages of .ci/run and make nightly",
    r"make bench-(peers( MESH=scan.obj)?|bodies)( .*)?": "needs the compared libraries",
    r"pellicle live( [\w.]+)?( --shell)?": "serves until interrupted; the test web/live",
    r"pellicle live balloon --html \w+\.html": "needs `make wasm`; the test web/play",
    r"pellicle (run|live) pellicle/scene.yaml": "a scene that Blender wrote; make blender",
    r"pellicle bench (frames|frames-all|springs|springs-explicit|table1)": "measurements; the test cli/bench",
    r"pellicle reproduce (--all.*|precision|b-table2|b-figure10 b-figure16-18 --mesh bust.ply)": "takes minutes; the test cli/reproduce",
    r"pellicle run scenes/shell-crushed.yaml --set bodies.*": "a measurement of minutes",
    r"pellicle sweep study.yaml .*--(chunk|slurm).*": "needs a cluster; the tests cli/slurm and study/study",
    r"pellicle calibrate .*": "needs the Python package; the test python/calibration",
}
# the page that `make reproduction` writes with the results of its commands
WRITTEN = "reproduction.md"
# arguments that shorten long scenes and films
SHORT = {
    r"pellicle run (scenes/)?(balloon|shell-crushed)(\.yaml)?": " --set stop.frames=2",
    r"pellicle render \S+ -o \S+\.(gif|mp4)\b.*": " --frames 0:-1:20",
}
# results that a page expects from its reader or from another page, and the commands that make them
MADE = {
    "results/balloon": "pellicle run balloon --set stop.frames=2",
    "results/sphere-press": "pellicle run sphere-press",
    "results/lens-capsule": "pellicle run lens-capsule",
    "results/a": "pellicle run sphere-press -o results/a --set duration=0.5",
    "results/b": "pellicle run sphere-press -o results/b --set duration=0.5",
    "results/ball": "pellicle run sphere-press -o results/ball --set duration=0.5",
    "RUN": "pellicle run sphere-press -o RUN --set duration=0.5",
}


def steps(text):
    """(name of a scene or None, scene text or command) in the order of the page"""
    for match in BLOCK.finditer(re.sub(r"\\\n *", " ", text)):
        if match.group(1) is None:
            yield None, match.group(2).split(" #")[0].strip().replace("build/release/pellicle", "pellicle", 1)
            continue
        names = SAVE.findall(text[: match.start()])
        yield (names[-1] if names else "shown.yaml"), match.group(1)


class Pages:
    def __init__(self, root, program, draws):
        self.root, self.program = root, program
        self.lacks = ([] if draws else ["render"]) + ([] if (root / "build/web/report.html").exists() else ["report"])
        self.count, self.found, self.listed = 0, [], set()

    def execute(self, page, folder, command):
        """runs one command in the folder; notes its failure"""
        line = re.sub(r"^pellicle", shlex.quote(str(self.program)), command)
        if command.startswith("make demo"):
            values = dict(word.split("=") for word in command.split()[2:])
            mesh = values.get("MESH", "")
            line = shlex.join([str(self.root / "tools/demo"), str(self.program), "", mesh, values.get("SCALE", ""), ""])
        done = subprocess.run(line, shell=True, cwd=folder, capture_output=True, text=True, timeout=300)
        self.count += 1
        if done.returncode != 0:
            self.found.append(f"{page}: exit status {done.returncode}: {command}\n{done.stdout}{done.stderr}")

    def run_command(self, page, folder, command):
        for pattern in NOT_RUN:
            if re.fullmatch(pattern, command):
                self.listed.add(pattern)
                return
        if command.split()[1] in self.lacks:
            return
        for path, maker in MADE.items():
            if path in command.split() and not (folder / path).exists() and f"-o {path}" not in command:
                self.execute(page, folder, maker)
        for pattern, more in SHORT.items():
            if re.fullmatch(pattern, command) and "--frames" not in command:
                command += more
        self.execute(page, folder, command)

    def run_page(self, path):
        page = path.relative_to(self.root)
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            for source in ("scenes", "examples", "tests"):
                (folder / source).symlink_to(self.root / source)
            for scene, text in steps(path.read_text()):
                if scene is None:
                    self.run_command(page, folder, text)
                    continue
                (folder / scene).write_text(text)
                if text.startswith("version:"):
                    self.execute(page, folder, f"pellicle check {scene}")


def main():
    root = Path(sys.argv[1]).resolve()
    pages = Pages(root, Path(sys.argv[2]).resolve(), "render" in sys.argv[3:])
    for path in [root / "README.md", root / "CONTRIBUTING.md"]:
        pages.run_page(path)
    if "PELLICLE_ALL" not in os.environ:
        print(*pages.found, "long: the commands of docs/*.md", sep="\n")
        return 1 if pages.found or pages.count == 0 else 0
    for path in sorted(root.glob("docs/*.md")):
        if path.name != WRITTEN:
            pages.run_page(path)
    unused = set(NOT_RUN) - pages.listed
    if unused:
        pages.found.append(f"listed as not run, but on no page: {sorted(unused)}")
    print("\n".join(pages.found) if pages.found else f"{pages.count} commands and scenes of the pages run")
    if pages.count < 30:
        print("fewer than 30 steps were found: the pages are read wrongly")
    return 1 if pages.found or pages.count < 30 else 0


if __name__ == "__main__":
    sys.exit(main())
