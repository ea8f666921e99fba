#!/usr/bin/env python3
"""Checks that no room of src/simulation but those of the methods asks which method runs, and that no other room names one: traits
and functions of the stepper answer that (src/simulation/stage/stepper.h).

usage: methods.py ROOT | methods.py --self-test
"""
import pathlib
import re
import sys

# what only one method or family of them has, and its name
QUESTION = re.compile(r"sim->(projector|minimise|newton|relax|modes|path)\b|solver\.method\b|solver->method\b|\bPEL_METHOD_\w+")
METHODS = ("method", "constraint", "minimise")
# files that may ask, and why
ALLOWED = {
    "gradient/adjoint.c": "sensitivities of the implicit methods",
    "gradient/adjoint_steps.c": "the same along steps",
    "gradient/step_beside.c": "the same beside a simulation",
    "boundary/edge_load.c": "unknowns of the implicit methods",
    "boundary/hold.c": "unknowns of the implicit methods",
    "sim/sim_create.c": "checks of defs; releases what all methods made",
    "stage/shells.c": "the layout of elements",
    "observe/ledger.c": "an analysis of modes moves nothing",
}
# a method by its name, and files of other floors that may name one
NAME = re.compile(r"\bPEL_METHOD_(?!COUNT)[A-Z_]+")
NAMING = {
    "physics/batch/batches.c": "the layout of constraints",
    "physics/def/rows.c": "which keys a method reads",
    "solver/solve/project.c": "multipliers of constraints",
    "runs/choice/method.c": "the choice of a method",
}


def questions(name, text):
    if name.split("/")[0] in METHODS or name in ALLOWED:
        return
    for number, line in enumerate(text.splitlines(), 1):
        found = QUESTION.search(line.split("/*")[0])
        if found:
            yield f"src/simulation/{name}:{number}: asks for the method: {found[0]}; use a trait or function of the stepper"


def names(name, text):
    if name in NAMING:
        return
    for number, line in enumerate(text.splitlines(), 1):
        found = NAME.search(line.split("/*")[0])
        if found:
            yield f"src/{name}:{number}: names a method: {found[0]}; use a trait of its stepper"


def self_test():
    assert list(names("runs/run/warnings.c", "if (method == PEL_METHOD_PBD)")) and not list(names("runs/choice/method.c", "PEL_METHOD_PBD"))
    assert not list(names("runs/run/warnings.c", "PEL_METHOD_COUNT, pel_method_words; /* PEL_METHOD_PBD */"))
    assert list(questions("tool/grip.c", "    if (sim->projector != NULL)\n"))
    assert list(questions("boundary/loads.c", "if (sim->solver.method == PEL_METHOD_PBD)"))
    assert not list(questions("boundary/loads.c", "sim->projectors; sim->stepper->is_explicit; /* sim->minimise */"))
    assert not list(questions("method/project.c", "sim->projector"))
    assert not list(questions("minimise/step_newton.c", "sim->minimise")) and not list(questions("boundary/hold.c", "sim->newton"))


def main():
    if sys.argv[1] == "--self-test":
        return self_test()
    rooms = pathlib.Path(sys.argv[1], "src/simulation")
    files = {path.relative_to(rooms).as_posix(): path.read_text() for path in sorted(rooms.glob("*/*.[ch]"))}
    found = [line for name, text in files.items() for line in questions(name, text)]
    source = rooms.parent
    others = {path.relative_to(source).as_posix(): path.read_text() for path in sorted(source.glob("*/*/*.[ch]"))
              if not path.is_relative_to(rooms)}
    found += [line for name, text in others.items() for line in names(name, text)]
    found += [f"{name}: allowed to name a method, but does not" for name in NAMING if not NAME.search(others.get(name, ""))]
    found += [f"{name}: allowed to ask, but does not" for name in ALLOWED if not QUESTION.search(files.get(name, ""))]
    print("\n".join(found) if found else "ok")
    sys.exit(1 if found or not files else 0)


main()
