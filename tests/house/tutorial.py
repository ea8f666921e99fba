#!/usr/bin/env python3
"""Runs the tutorial and the how-to page: saves each scene that a page tells to save, runs every indented pellicle command in
order in one empty folder, and expects each to succeed. Every other scene that a page shows whole is checked.

usage: tutorial.py ROOT PROGRAM [render]      without `render` commands that draw are left out
"""
import re
import subprocess
import sys
import tempfile
from pathlib import Path

PAGES = ["docs/tutorial.md", "docs/howto.md", "docs/scenes.md"]
BLOCK = re.compile(r"^```yaml\n([\s\S]*?)^```|^    (pellicle [^\n]*)$", re.M)
# `pellicle run` of shipped scenes has tests of its own; the demo, ParaView and reports need more than the program
SHIPPED = re.compile(r"pellicle (run [a-z-]+( |$)|render results/|.*scenes/)")
SAVE = re.compile(r"Save this as `([\w.-]+)`")


def steps(text):
    """(scene text or command) in the order of the page, each scene with the name that it is saved as"""
    for match in BLOCK.finditer(text):
        if match.group(1) is None:
            yield None, match.group(2).split(" #")[0]
            continue
        names = SAVE.findall(text[: match.start()])
        yield (names[-1] if names else "shown.yaml"), match.group(1)


def run(page, step, folder, program, draws):
    name, text = step
    if name is not None:
        if not text.startswith("version:"):
            return None
        (folder / name).write_text(text)
        command = f"pellicle check {name}"
    else:
        command = text
    if (not draws and re.match(r"pellicle (render|report)", command)) or SHIPPED.match(command) or "SCENE" in command:
        return None
    if re.match(r"pellicle render .*\.(gif|mp4)\b", command) and "--frames" not in command:
        command += " --frames 0:-1:10"  # a tenth of the film
    done = subprocess.run(
        re.sub("^pellicle", f'"{program}"', command), shell=True, cwd=folder, capture_output=True, text=True, timeout=120
    )
    return f"{page}: exit status {done.returncode}: {command}\n{done.stderr}" if done.returncode else command


def main():
    root, program = Path(sys.argv[1]), Path(sys.argv[2]).resolve()
    draws = "render" in sys.argv[3:]
    count, found = 0, []
    for page in PAGES:
        with tempfile.TemporaryDirectory() as folder:
            for step in steps((root / page).read_text()):
                said = run(page, step, Path(folder), program, draws)
                if said is None:
                    continue
                count += 1
                if ": exit status" in said:
                    found.append(said)
    print("\n".join(found) if found else f"{count} commands and scenes of the pages run")
    if count < 15:
        print("fewer than 15 steps were found: the pages are read wrongly")
    return 1 if found or count < 15 else 0


if __name__ == "__main__":
    sys.exit(main())
