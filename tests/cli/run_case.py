#!/usr/bin/env python3
"""Runs one file of command-line cases in an empty folder and compares what the program says.

usage: run_case.py PROGRAM CASES.txt

    # comment
    file NAME           the lines up to `end` become the file NAME
    $ COMMAND           run by bash, with the program as `pellicle`
    long COMMAND        the same, only with PELLICLE_ALL in the environment (make nightly)
    > LINE              a line of standard output
    ! LINE              a line of standard error
    = STATUS            exit status, 0 when left out

Expected lines are complete and in order. `...` in a line stands for any text, alone on a line for any lines.
"""
import difflib
import os
import pathlib
import re
import subprocess
import sys
import tempfile


def parse(path):
    """[(line number, command, expected stdout, expected stderr, status)] and files written before each command"""
    cases, files, inside = [], [], None
    for number, line in enumerate(path.read_text().splitlines(), 1):
        if inside is not None:
            if line == "end":
                inside = None
            else:
                inside.append(line + "\n")
        elif line.startswith("file "):
            inside = []
            files.append((line[5:], inside))
        elif line.startswith(("$ ", "long ")):
            mark, command = line.split(" ", 1)
            cases.append({"line": number, "command": command, "long": mark == "long", ">": [], "!": [], "=": 0, "files": files})
            files = []
        elif line[:1] in (">", "!"):
            cases[-1][line[0]].append(line[2:])
        elif line.startswith("= "):
            cases[-1]["="] = int(line[2:])
        elif line and not line.startswith("#"):
            sys.exit(f"{path}:{number}: not understood: {line}")
    return cases


def pattern(lines):
    """a regular expression for the expected lines"""
    parts = []
    for line in lines:
        if line == "...":
            parts.append(r"(?:.*\n)*")
        else:
            parts.append(r"[^\n]*".join(re.escape(part) for part in line.split("...")) + r"\n")
    return "".join(parts)


def compare(what, expected, actual):
    """lines that say how actual differs, empty when it does not"""
    if re.fullmatch(pattern(expected), actual):
        return []
    return [f"{what} differs (- expected, + actual):"] + list(difflib.ndiff(expected, actual.splitlines()))


def run(case, folder, environment):
    for name, lines in case["files"]:
        target = folder / name
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_text("".join(lines))
    result = subprocess.run(["bash", "-c", case["command"]], cwd=folder, env=environment, capture_output=True,
                            timeout=7200 if case["long"] else 120, stdin=subprocess.DEVNULL)
    found = compare("standard output", case[">"], result.stdout.decode(errors="replace"))
    found += compare("standard error", case["!"], result.stderr.decode(errors="replace"))
    if result.returncode != case["="]:
        found.append(f"exit status is {result.returncode}, expected {case['=']}")
    return found


def main():
    program, path = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2])
    failures, cases = 0, parse(path)
    if "PELLICLE_ALL" not in os.environ:
        left = sum(case["long"] for case in cases)
        cases = [case for case in cases if not case["long"]]
        print(*[f"long: {left} commands"] if left else [], sep="\n")
    with tempfile.TemporaryDirectory() as folder:
        environment = dict(os.environ, PATH=f"{program.parent}:{os.environ['PATH']}", LC_ALL="C", XDG_STATE_HOME=f"{folder}/state")
        for case in cases:
            found = run(case, pathlib.Path(folder), environment)
            if found:
                failures += 1
                print(f"{path}:{case['line']}: $ {case['command']}", *found, sep="\n    ")
    print(f"{len(cases)} commands, {failures} failed")
    return 1 if failures else 0


sys.exit(main())
