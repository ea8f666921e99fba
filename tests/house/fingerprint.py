#!/usr/bin/env python3
"""Checks that every member of every def of a model or simulation has a row in src/physics/model/fingerprint.c.

usage: fingerprint.py ROOT
"""
import pathlib
import re
import sys

root = pathlib.Path(sys.argv[1])
headers = "".join((root / "include/pellicle" / name).read_text() for name in ("shell.h", "model.h", "sim.h"))
headers = re.sub(r"/\*.*?\*/", "", headers, flags=re.S)
table = (root / "src/physics/model/fingerprint.c").read_text()
defs = re.findall(r"^typedef struct (pel_\w+_def|pel_quantity) \{(.*?)^\} \1;", headers, re.M | re.S)
missing, count = [], 0
for name, body in defs:
    if name == "pel_adjoint_def":  # a question about a simulation, no part of one
        continue
    for declaration in filter(None, (part.strip() for part in body.split(";"))):
        # "const double *a, b[3]": the names before brackets and commas
        for member in re.findall(r"(\w+)(?:\[\w*\])*(?=,|$)", re.sub(r"\s+", " ", declaration)):
            count += 1
            if not re.search(rf"\({name}, {member}[,)]", table):
                missing.append(f"{name}.{member}")
print(f"{len(defs)} defs with {count} members, {len(missing)} without a row in src/physics/model/fingerprint.c", *missing, sep="\n")
sys.exit(1 if missing or count < 100 else 0)
