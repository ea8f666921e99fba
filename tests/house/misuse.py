#!/usr/bin/env python3
"""Every public function stands in a test of misuse (tests/misuse.h), so that none is forgotten.

usage: misuse.py SOURCE
"""
import pathlib
import re
import sys


def functions(header):
    """names of the functions that a header declares"""
    text = re.sub(r"/\*.*?\*/", "", header.read_text(), flags=re.S)
    text = re.sub(r"^#.*$", "", text, flags=re.M).replace('extern "C" {', "")
    for kind, name in re.findall(r"(?:^|\n)((?:const )?\w[\w ]*[ *]+)(pel_\w+)\([^;{}]*?\)[^;{}()]*(?:\([^;]*\))?;", text, re.S):
        if "typedef" not in kind:
            yield name


def main():
    source = pathlib.Path(sys.argv[1])
    tests = "".join(path.read_text() for path in sorted((source / "tests").rglob("test_misuse.c")))
    called = set(re.findall(r"\b(pel_\w+)\(", tests))
    public = [(header.name, name) for header in sorted((source / "include").rglob("*.h")) for name in functions(header)]
    missing = [f"{header}: {name}" for header, name in public if name not in called]
    print(f"{len(public)} public functions, {len(missing)} in no test of misuse", *missing, sep="\n")
    sys.exit(1 if missing or len(public) < 200 else 0)


main()
