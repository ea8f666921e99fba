#!/usr/bin/env python3
"""Checks that the lists of `tools/mutate` fit the sources: each row of tools/limits changes text that its file has once, and names
tests that exist; each line of tools/equivalent-mutants is still in its file.

usage: mutants.py ROOT | mutants.py --self-test
"""
import pathlib
import re
import sys


def check_limits(root, rows, fail):
    for block in re.split(r"\n\s*\n", re.sub(r"^#.*\n", "", rows, flags=re.M).strip()):
        what, *fields = block.split("\n")
        row = dict(field.split(": ", 1) for field in fields)
        path = root / row["file"]
        if not path.exists() or path.read_text().count(row["before"]) != 1:
            fail(f"tools/limits: {row['file']} does not have '{row['before']}' once ({what})")
        for room, name in (test.split("/") for test in row["tests"].split()):
            of_command = room == "cli" and any((root / "tests/cli" / place).exists() for place in (f"cases/{name}.txt", f"{name}.py"))
            if not of_command and not (root / f"tests/{room}/test_{name}.c").exists():
                fail(f"tools/limits: there is no test {room}/{name} ({what})")


def check_equivalent(root, lines, fail):
    for line in lines.splitlines():
        change = re.match(r"(src/\S+): (.*)  ->  ", line)
        if change is None:
            continue
        path = root / change[1]
        if not path.exists() or change[2] not in path.read_text():
            fail(f"tools/equivalent-mutants: {change[1]} no longer has '{change[2]}'")


def self_test(root):
    found = []
    row = "a\nfile: tools/limits\nbefore: nothing has this\nafter: b\ntests: sim/none"
    check_limits(root, row.replace("nothing has this", "nothing has " + "that"), found.append)
    check_equivalent(root, "src/gone.c: a  ->  b", found.append)
    sys.exit(0 if len(found) == 3 else f"found {found}")


def main():
    root = pathlib.Path(__file__).resolve().parents[2] if sys.argv[1] == "--self-test" else pathlib.Path(sys.argv[1])
    if sys.argv[1] == "--self-test":
        self_test(root)
    found = []
    check_limits(root, (root / "tools/limits").read_text(), found.append)
    check_equivalent(root, (root / "tools/equivalent-mutants").read_text(), found.append)
    print(*found, sep="\n")
    sys.exit(1 if found else 0)


main()
