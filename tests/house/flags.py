#!/usr/bin/env python3
"""Checks that every library file is compiled without contraction and without fast-math (the same bits everywhere).

usage: flags.py SOURCE_DIR BUILD_DIR
"""
import json
import pathlib
import re
import sys

source, build = (pathlib.Path(argument).resolve() for argument in sys.argv[1:])
commands = {
    pathlib.Path(entry["file"]).relative_to(source).as_posix(): entry["command"]
    for entry in json.loads((build / "compile_commands.json").read_text())
    if pathlib.Path(entry["file"]).is_relative_to(source / "src")
}
FORBIDDEN = r"-ffast-math|-Ofast|-funsafe-math|-fassociative-math|-ffp-contract=(?!off)|-march=native"
bad = [name for name, command in commands.items() if "-ffp-contract=off" not in command or re.search(FORBIDDEN, command)]
print(f"{len(commands)} library files, {len(bad)} with wrong flags", *bad, sep="\n")
sys.exit(1 if bad or not commands else 0)
