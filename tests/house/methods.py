#!/usr/bin/env python3
"""Checks that nothing in src/simulation/sim but the files of the methods asks which method runs: traits and functions of the stepper
answer that (src/simulation/sim/stepper.h).

usage: methods.py ROOT | methods.py --self-test
"""
import pathlib
import re
import sys

# what only one method or family of them has, and its name
QUESTION = re.compile(r"sim->(projector|descent|relax|modes|path)\b|solver\.method\b|solver->method\b|\bPEL_METHOD_\w+")
METHODS = re.compile(r"step(_\w+|per)?\.[ch]|descent\w*\.[ch]|(project|relax)\.c")
# files that may ask, and why
ALLOWED = {
    "adjoint.c": "sensitivities of the implicit methods",
    "adjoint_steps.c": "the same along steps",
    "edge_load.c": "unknowns of the implicit methods",
    "hold.c": "unknowns of the implicit methods",
    "sim_create.c": "checks of defs; releases what all methods made",
    "shells.c": "the layout of elements",
    "snapshot.c": "memory of all methods",
    "ledger.c": "an analysis of modes moves nothing",
}


def questions(name, text):
    if METHODS.fullmatch(name) or name in ALLOWED:
        return
    for number, line in enumerate(text.splitlines(), 1):
        found = QUESTION.search(line.split("/*")[0])
        if found:
            yield f"src/simulation/sim/{name}:{number}: asks for the method: {found[0]}; use a trait or function of the stepper"


def self_test():
    assert list(questions("tool_grip.c", "    if (sim->projector != NULL)\n"))
    assert list(questions("loads.c", "if (sim->solver.method == PEL_METHOD_PBD)"))
    assert not list(questions("loads.c", "sim->projectors; sim->stepper->is_explicit; /* sim->descent */"))
    assert not list(questions("project.c", "sim->projector"))
    assert not list(questions("step_newton.c", "sim->descent")) and not list(questions("hold.c", "sim->descent"))


def main():
    if sys.argv[1] == "--self-test":
        return self_test()
    files = sorted(pathlib.Path(sys.argv[1], "src/simulation/sim").glob("*.[ch]"))
    found = [line for path in files for line in questions(path.name, path.read_text())]
    found += [f"{name}: allowed to ask, but does not" for name in ALLOWED
              if not QUESTION.search(pathlib.Path(sys.argv[1], "src/simulation/sim", name).read_text())]
    print("\n".join(found) if found else "ok")
    sys.exit(1 if found or not files else 0)


main()
