#!/usr/bin/env python3
"""Checks that the shared library exports the public functions of the core and nothing else, and that each declaration of one
in a header begins with PEL_API.

usage: exports.py SOURCE_DIR SHARED_LIBRARY ARCHIVE NM
"""
import pathlib
import re
import subprocess
import sys

source, shared, archive, nm = sys.argv[1:]


def symbols(*arguments):
    lines = subprocess.run([nm, *arguments], check=True, capture_output=True, text=True).stdout.splitlines()
    return {fields[2] for fields in map(str.split, lines) if len(fields) == 3}


declared, bare = {}, []
for header in sorted(pathlib.Path(source, "include/pellicle").glob("*.h")):
    text = re.sub(r"/\*.*?\*/", lambda comment: re.sub(r"[^\n]", " ", comment[0]), header.read_text(), flags=re.S)
    for match in re.finditer(r"^(?!typedef|static|#|\s|pel_\w+\()[^(;={}#]*?\b(pel_[a-z0-9_]+)\(", text, re.M):
        declared[match[1]] = header.name
        if not match[0].startswith("PEL_API "):
            bare.append(f"{header.name}:{text[: match.start()].count(chr(10)) + 1}: {match[1]} without PEL_API")
exported, defined = symbols("-D", "--defined-only", shared), symbols("-g", "--defined-only", archive)
public = declared.keys() & defined
found = bare + [f"{name} of {declared[name]} is not exported" for name in sorted(public - exported)]
found += [f"{name} is exported and in no header" for name in sorted(exported - public)]
print(f"{len(exported)} functions exported, {len(defined)} defined", *found, sep="\n")
sys.exit(1 if found or not exported else 0)
