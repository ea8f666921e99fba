#!/usr/bin/env python3
"""Checks that a test makes the allocations fail of every public function that creates something.

usage: allocations.py ROOT
"""
import pathlib
import re
import sys

root = pathlib.Path(sys.argv[1])
headers = "\n".join(path.read_text() for path in sorted((root / "include/pellicle").glob("*.h")))
# a function that creates something returns a status and has an out-pointer
creators = re.findall(r"^PEL_API pel_status (pel_\w+)\([^;]*\*\*[^;]*\);", headers, re.M)
tests = [path.read_text() for path in (root / "tests").rglob("test_*.c")]
tested = "\n".join(text for text in tests if re.search(r"for_(every_allocation_failure|allocation_failures)\(", text))
missing = [name for name in creators if not re.search(rf"\b{name}\(", tested)]
print(f"{len(creators)} public functions create something, {len(missing)} without an allocation test", *missing, sep="\n")
sys.exit(1 if missing or not creators else 0)
