#!/usr/bin/env python3
"""Checks that every member of every def of a model or simulation has a row in src/physics/def/rows.c, from which its
default, its key, its copy and its part of the fingerprint come.

usage: fingerprint.py ROOT
"""
import pathlib
import re
import sys

# members without a row, and why
EXEMPT = {
    "cookie": "says that a def was made by its default",
    "memory_limit of pel_refine_def": "changes no result",
    "stiffnesses of pel_tie_def": "one per vertex, and optional: src/simulation/sim/own_def.c",
    "weights of pel_load_def": "one per vertex, and optional: src/simulation/sim/own_def.c",
    "model of pel_sim_def": "has a fingerprint of its own",
    "record_contacts": "changes no result",
    "wanted": "changes no result",
    "user": "changes no result",
    "stops_short_steps": "changes no result",
}
root = pathlib.Path(sys.argv[1])
headers = "".join((root / "include/pellicle" / name).read_text() for name in ("quantity.h", "shell.h", "model.h", "solver.h", "load.h", "tool.h", "support.h", "tie.h", "joint.h", "contact.h", "wind.h", "volume.h", "sim_step.h"))
headers = re.sub(r"/\*.*?\*/", "", headers, flags=re.S)
rows = (root / "src/physics/def/rows.c").read_text().replace("\\\n", " ")
defs = {}  # def -> member -> type
for name, body in re.findall(r"^typedef struct (pel_\w+_def) \{(.*?)^\} \1;", headers, re.M | re.S):
    if name == "pel_adjoint_def":  # a question about a simulation, no part of one
        continue
    # "const double *a, b[3]": the names before brackets and commas
    defs[name] = {member: re.sub(r"const |\*", "", part).split()[0]
                  for part in filter(None, (part.strip() for part in re.sub(r"\s+", " ", body).split(";")))
                  for member in re.findall(r"(\w+)(?:\[\w*\])*(?=,|$|\))", part.split("(void")[0])}

macros = {name: (parameters.split(", "), text)
          for name, parameters, text in re.findall(r"^#define (\w+)\(([\w, ]+)\) +(.*_?OF\(.*|BODY\(.*)$", rows, re.M)}


def expand(call):
    """NAME(a, b) of a row -> OF(KIND, type, path, ...)"""
    name, arguments = call[0], call[1].split(", ")
    if name not in macros:
        return name, arguments
    parameters, text = macros[name]
    for parameter, argument in zip(parameters, arguments):
        text = re.sub(rf"\b{parameter}\b", argument, text)
    return expand(re.match(r"(\w+)\((.*)\)", text).groups())


covered = set()
for call in re.findall(r"\b([A-Z_]+)\(([^()]*)\)", rows[rows.index("static const pel_def_row rows"):]):
    name, arguments = expand(call)
    if name not in ("OF", "LIST_OF", "DEF_OF", "DEFS_OF"):
        continue
    for path in arguments[2:4] if name in ("LIST_OF", "DEFS_OF") else arguments[2:3]:
        owner = arguments[1]
        for member in path.split("."):
            covered.add((owner, member))
            owner = defs[owner][member]

members = [(name, member) for name in defs for member in defs[name]]
missing = [f"{name}.{member}" for name, member in members if (name, member) not in covered
           and member not in EXEMPT and f"{member} of {name}" not in EXEMPT]
print(f"{len(defs)} defs with {len(members)} members, {len(missing)} without a row in src/physics/def/rows.c", *missing, sep="\n")
sys.exit(1 if missing or len(members) < 100 else 0)
