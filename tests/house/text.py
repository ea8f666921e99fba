#!/usr/bin/env python3
"""Checks the text of the project: words that must not stay, heap calls outside base/memory, calls of fmin and fmax, long
files and functions.

usage: text.py ROOT
"""
import pathlib
import re
import sys

LONGEST_FILE, LONGEST_FUNCTION, LONGEST_TEST = 1000, 60, 100
SKIPPED = {"build", "results", "dist", ".git", "node_modules"}
TEXT = {".c", ".h", ".cpp", ".py", ".md", ".txt", ".cmake", ".yaml", ".json", ".in", ""}
WORDS = {
    r"\b(TO[D]O|FIX[M]E|XX[X]|HA[C]K)\b": "unfinished",
    r"(?<![\w.])/(?:work|root|home|farm)/": "path of one machine",
}
HEAP = r"\b(malloc|calloc|realloc|aligned_alloc|strdup|strndup|asprintf|getline)\s*\("
HEAP_DOOR = "src/ground/base/memory.c"
# compilers call these where -ffast-math is off
EXTREMES = r"\bf(min|max)f?\s*\("


def text_files(root):
    for path in sorted(root.rglob("*")):
        parts = path.relative_to(root).parts
        if path.is_file() and not SKIPPED & set(parts) and path.suffix in TEXT:
            try:
                yield path.relative_to(root).as_posix(), path.read_text()
            except UnicodeDecodeError:
                pass


def problems(name, text):
    for number, line in enumerate(text.splitlines(), 1):
        for pattern, why in WORDS.items():
            if re.search(pattern, line):
                yield f"{name}:{number}: {why}: {line.strip()}"
        if name.startswith("src/") and name != HEAP_DOOR and re.search(HEAP, line.split("/*")[0]):
            yield f"{name}:{number}: heap use outside {HEAP_DOOR}: {line.strip()}"
        if name.startswith("src/") and re.search(EXTREMES, line.split("/*")[0]):
            yield f"{name}:{number}: a call of the C library in place of pel_min or pel_max: {line.strip()}"
    if not name.endswith((".c", ".h")):
        return
    if text.count("\n") > LONGEST_FILE:
        yield f"{name}: {text.count(chr(10))} lines, at most {LONGEST_FILE}"
    longest = LONGEST_TEST if name.startswith(("tests/", "bench/", "examples/")) else LONGEST_FUNCTION
    # clang-format puts both braces of a function, and only those, alone in column one
    for match in re.finditer(r"^{\n(.*?)^}$", text, re.M | re.S):
        if match[1].count("\n") > longest:
            line = text[: match.start()].count("\n") + 1
            yield f"{name}:{line}: function of {match[1].count(chr(10))} lines, at most {longest}"


root = pathlib.Path(sys.argv[1]).resolve()
found = [problem for name, text in text_files(root) for problem in problems(name, text)]
print("\n".join(found) if found else "ok")
sys.exit(1 if found else 0)
